"""`dem run --resume` beside a folder that somebody else has made: nothing of it is run, nothing beside it changes."""

from __future__ import annotations

import json
import os
import pickle
import shutil
import struct
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from dem_cli.app import api
from dem_cli.app.cli.main import main
from dem_cli.app.pipeline.batches import BatchOptions
from dem_cli.app.pipeline.execution import Destination, run_case
from dem_cli.interrupts import Interrupts
from dem_cli.results.output.resume.checkpoints import _HEADER, Checkpoints, _header
from dem_cli.results.output.resume.kept_objects import encoded
from dem_cli.results.output.resume.kept_values import packed, unpacked
from dem_cli.results.output.resume.stages import Keeping

CASE = Path(__file__).resolve().parents[2] / "cases" / "verification" / "settlement_group.toml"
KILLED_AT = "2+", 3  # at this checkpoint of the second stage: some of what it told is told again


class Killed(BaseException):
    """As a kill, which no one answers."""


class Shell:
    """Leaves a file where pickle reads it."""

    def __reduce__(self):
        return os.system, ("touch was-here",)


PICKLE = pickle.dumps(Shell())
DOTTED = b"\x80\x04\x8c\x17dem_cli.output.folder\x8c\tos.system\x93\x8c\x0etouch was-here\x85R."


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """What a killed run has left: a stage, a checkpoint of the next, and what was told."""
    folder, whole, written = tmp_path_factory.mktemp("killed"), Checkpoints.write, []

    def writing(self, *words):
        whole(self, *words)
        written.append(words[0])
        if (words[0], written.count(words[0])) == KILLED_AT:
            raise Killed

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Checkpoints, "write", writing)
        options = BatchOptions(1, False, Keeping(first=0.0, every=0.0, worth=0.0))
        with pytest.raises(Killed):
            run_case(
                api.load_case(CASE), Destination(folder / "out"), time.perf_counter(), options=options,
                interrupts=Interrupts(ends_program=False),
            )  # fmt: skip
    return folder / ".out.dem-stages"


@pytest.fixture
def planted(killed, tmp_path, monkeypatch):
    """The same, beside earlier results and a file that is nobody's business."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(killed, tmp_path / killed.name)
    (tmp_path / "precious").write_text("keep me")
    (tmp_path / "out").mkdir()
    summary = {"title": "", "kind": "load-path", "version": "0", "status": "ok"}
    (tmp_path / "out" / "summary.json").write_text(json.dumps(summary))
    return tmp_path / killed.name


def state_in(folder):
    """The state that is asked for first."""
    return min(folder.glob("*.state"))


def refused(folder):
    """Runs the case on, and sees that the one line says what to do."""
    outside = folder.parent
    before = {path: path.read_bytes() for path in (outside / "precious", outside / "out" / "summary.json")}
    found = CliRunner().invoke(main, ["run", str(CASE), "-o", str(outside / "out"), "-q", "--resume"])
    assert found.exit_code == 2, found.output
    lines = found.output.strip().splitlines()
    assert len(lines) == 1, found.output
    assert "is damaged; delete it to start anew" in lines[0]
    assert not (outside / "was-here").exists()
    assert {path: path.read_bytes() for path in before} == before
    assert sorted(path.name for path in outside.iterdir()) == [folder.name, "out", "precious"]
    return lines[0]


def forged(path, change):
    """A state with sound checksums, in which the bytes of what changes are others."""
    more, (of, told, state) = unpacked(path.read_bytes()[_HEADER:])
    data = packed((more, (of, told, change(state))))
    path.write_bytes(_header(data) + data)


def with_text(change):
    """The bytes of a state whose JSON is another one."""

    def changed(state):
        (length,) = struct.unpack_from("<Q", state)
        text = json.dumps(change(json.loads(state[8 : 8 + length]))).encode()
        return struct.pack("<Q", len(text)) + text + state[8 + length :]

    return changed


def attribute(name, value):
    """A change of an attribute of whatever has it, if nothing does of the first object."""

    def change(node):
        states = node[1][1:]  # ["tuple", ["list", *states], more]
        state = next((each for each in states if name in each[1::2]), states[0])
        if name in state[1::2]:
            state[2 + 2 * state[1::2].index(name)] = value
        else:
            state += [name, value]
        return node

    return with_text(change)


def outcome(found):
    """Another thing that a stage has found."""
    return with_text(lambda node: [*node[:2], ["record", "_Outcome", found, None]])


def without(name):
    """A state that lacks an attribute."""

    def change(node):
        state = next(each for each in node[1][1:] if name in each[1::2])
        at = 1 + 2 * state[1::2].index(name)
        del state[at : at + 2]
        return node

    return with_text(change)


FORGED = {
    "a pickle": lambda state: PICKLE,
    "a dotted name": lambda state: DOTTED,
    "nothing": lambda state: b"",
    "an unknown record": attribute("steps", ["object", "Popen", "args", "touch was-here"]),
    "steps of text": attribute("steps", "many"),
    "steps of none": attribute("steps", None),
    "steps before the first": attribute("steps", -1),
    "calls of the loop that do nothing": attribute("longest", 0),
    "joints in tiles": attribute("tiled", True),
    "words for the terminal": with_text(lambda node: [*node[:2], ["record", "_Outcome", None, "\x1b[2J"]]),
    "an array of another shape": attribute("control", ["array", "<f8", [0], "C", True]),
    "an array of objects": attribute("control", ["array", "|O", [1], "C", True]),
    "a list as an array": attribute("control", ["list", 1.0]),
    "what lasts": attribute("model", None),
    "a method": attribute("advance", 1),
    "what lasts in place of what changes": attribute("tracking", ["named", "0.model"]),
    "a number in place of an object": attribute("bodies", 1.0),
    "no tracking of joints": without("tracking"),
    "no loads": without("loads"),
    "no more": with_text(lambda node: node[:2]),
    "fewer objects": with_text(lambda node: [node[0], ["list"], *node[2:]]),
    "no record": with_text(lambda node: [*node[:2], ["tuple", 1, None]]),
}


@pytest.mark.parametrize("change", FORGED.values(), ids=FORGED)
def test_states_that_hold_something_else(planted, change):
    forged(state_in(planted), change)
    refused(planted)


@pytest.mark.parametrize("found", [5, "x", ["list"], ["object", "Verdict", "state", "x", "unbalanced", "y"]], ids=repr)
def test_findings_that_no_stage_has(planted, found):
    for path in planted.glob("*.state"):
        if not path.stem.endswith("+"):
            forged(path, outcome(found))
    refused(planted)


@pytest.mark.parametrize("data", [PICKLE, DOTTED], ids=["pickle", "dotted"])
def test_a_pickle_is_no_state_and_was_not_told(planted, data):
    whole = state_in(planted).read_bytes()
    for planting in (data, _header(data) + data):
        state_in(planted).write_bytes(planting)
        refused(planted)
    state_in(planted).write_bytes(whole)
    tell_instead(planted, data)
    refused(planted)


def ends_of(told):
    """Where each entry ends."""
    ends = [0]
    while ends[-1] < len(told):
        ends.append(ends[-1] + _HEADER + struct.unpack_from("<Q", told, ends[-1])[0])
    return ends[1:]


def tell_instead(folder, data):
    """Each thing that was told is this one."""
    told = folder / "told"
    told.write_bytes((_header(data) + data) * len(ends_of(told.read_bytes())))


TOLD = [("close", {}), ("_guarded", 1), ("frame", (1, 2)), ("row", "x"), ("structure", None), ("runs", [1]), (1, 2)]


@pytest.mark.parametrize("entry", [*TOLD, ("row",), "row", ("row", 1, 2)], ids=repr)
def test_results_are_told_nothing_else(planted, entry):
    tell_instead(planted, encoded([], entry))
    refused(planted)


@pytest.mark.parametrize("at", [0, 7, 9, 13, 20, 30, 60, 200, -1])
def test_a_changed_byte(planted, at):
    for path in (state_in(planted), planted / "told"):
        whole = path.read_bytes()
        begin = ends_of(whole)[-2] if path.name == "told" else 0
        data = bytearray(whole)
        data[at if at < 0 else begin + at] ^= 0x10
        path.write_bytes(data)
        assert "wrong" in refused(planted)
        path.write_bytes(whole)


def test_what_was_not_written_there(planted):
    for path in (state_in(planted), planted / "told"):
        whole = path.read_bytes()
        path.write_bytes(whole + bytes(64))
        refused(planted)
        path.write_bytes(whole)
    with state_in(planted).open("r+b") as file:
        file.truncate(1 << 40)  # of which the disk holds nothing
    assert "too large" in refused(planted)


@pytest.mark.parametrize("name", ["state", "told", ".lock", "about.json"])
def test_only_plain_files_are_opened(planted, name):
    """Nobody waits for a pipe, and no link leads elsewhere."""
    path = state_in(planted) if name == "state" else planted / name
    plants = {
        "pipe": lambda: os.mkfifo(path),
        "link": lambda: path.symlink_to(planted.parent / "precious"),
        "device": lambda: path.symlink_to("/dev/zero"),
        "folder": path.mkdir,
    }
    for plant in plants.values():
        path.rmdir() if path.is_dir() else path.unlink()
        plant()
        assert "no plain file" in refused(planted)


def test_a_link_in_place_of_the_folder(planted):
    elsewhere = planted.parent / "precious"
    shutil.rmtree(planted)
    planted.symlink_to(elsewhere)
    assert "is a link" in refused(planted)
