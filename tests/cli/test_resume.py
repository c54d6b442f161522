"""`dem run --resume` of a run that was killed: the results of a run that nobody stopped, byte by byte."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import h5py
import pytest
from click.testing import CliRunner

from dem_cli.app import api
from dem_cli.app.cli.main import main
from dem_cli.app.pipeline.batches import BatchOptions
from dem_cli.app.pipeline.execution import Destination, run_case
from dem_cli.app.pipeline.listener import RunListener
from dem_cli.interrupts import Interrupts
from dem_cli.results.output.resume.checkpoints import Checkpoints
from dem_cli.results.output.resume.stages import Keeping
from dem_cli.results.output.store import ResultWriter

CASES = Path(__file__).resolve().parents[2] / "cases" / "verification"
MIDDLE = 10  # checkpoints
ALL = Keeping(first=0.0, every=0.005, worth=0.0)
SCRIPT = """
import sys, time
from pathlib import Path
from dem_cli.app import api
from dem_cli.results.output import store
from dem_cli.results.output.resume.stages import Keeping
from dem_cli.results.output.store import ResultWriter
from dem_cli.app.pipeline.batches import BatchOptions
from dem_cli.app.pipeline.execution import Destination, run_case
store._BUFFERED_SAMPLES, store._UNFLUSHED = 1024, 1_000_000  # a short run reaches the disk several times
options = BatchOptions(1, sys.argv[3] == "resume", Keeping(0.0, 0.02, 0.0))
run_case(api.load_case(sys.argv[1]), Destination(Path(sys.argv[2])), time.perf_counter(), options=options)
"""


class Hearer(RunListener):
    """Hears that all is kept."""

    def stages_not_kept(self, why):
        raise AssertionError(why)


def run(case, folder, keeping=None, resume=False):
    options, interrupts = BatchOptions(1, resume, keeping), Interrupts(ends_program=False)  # others come after it
    destination, started = Destination(folder), time.perf_counter()
    return run_case(
        api.load_case(case), destination, started, options=options, interrupts=interrupts, listener=Hearer()
    )


def untimed(value):
    """A summary without seconds of a clock."""
    if isinstance(value, dict):
        return {key: untimed(each) for key, each in value.items() if not key.endswith("seconds")}
    return [untimed(each) for each in value] if isinstance(value, list) else value


def results(folder):
    """Everything in the results, but for times."""
    found = {"summary": untimed(json.loads((folder / "summary.json").read_text(encoding="utf-8")))}
    with h5py.File(folder / "results.h5") as file:

        def see(name, there):
            found[name, "attributes"] = {key: repr(value) for key, value in there.attrs.items()}
            if isinstance(there, h5py.Dataset):
                values = there[()]
                found[name] = repr(values) if there.dtype.kind == "O" else (there.dtype, there.shape, values.tobytes())

        file.visititems(see)
    return found


class Killed(BaseException):
    """As a kill, which no one answers."""


def kill():
    raise Killed


def interrupt():
    os.kill(os.getpid(), signal.SIGINT)


@pytest.mark.parametrize("name", ["wall_21", "sliding_n2", "settlement_group", "follower_load"])
def test_killed_then_interrupted(name, tmp_path, monkeypatch):
    """A pushover with its collapse, a capacity curve, a settlement, a load path."""
    case, ways = CASES / f"{name}.toml", {2: kill, 7: interrupt}  # by the number of a checkpoint, of both runs
    run(case, tmp_path / "straight")
    whole, written = Checkpoints.write, []

    def writing(self, *words):
        whole(self, *words)
        written.append(words[0])
        ways.get(len(written), lambda: None)()

    monkeypatch.setattr(Checkpoints, "write", writing)
    with pytest.raises(Killed):
        run(case, tmp_path / "out", ALL)
    assert not (tmp_path / "out").exists()
    assert run(case, tmp_path / "out", ALL, resume=True)[0]["status"] == "interrupted"
    assert len(written) == 7, "what comes after an interrupt is not kept"
    run(case, tmp_path / "out", ALL, resume=True)
    assert results(tmp_path / "out") == results(tmp_path / "straight")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "straight"]


SPACE = """
title = "Two blocks in space, of which the upper one is pushed off"
dimension = 3
[materials.stone]
density = 2400.0
[joints.dry]
law = "coulomb"
friction = 0.5
kn = 1e9
[[structure]]
kind = "column"
block = [0.5, 0.5]
courses = 2
thickness = 0.5
base_extension = 0.3
[analysis]
kind = "time-history"
duration = 0.05
[damping]
contact_fraction = 0.35
[[initial]]
block = "top"
velocity = [0.2, 0.3, 0.1, 0.0, 0.0, 0.0]
[output]
frames = 3
"""
OTHERS = [  # what the cases above have not: bars, a fall, another structure, modes, safety, table, chains; then space
    "bar_pull_out", "bouncing_block", "least_thickness_arch", "modes_block", "safety_incline", "tilting_table",
    "space/slide_askew", "moving in space",
]  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_every_kind_of_stage_goes_on(name, tmp_path, monkeypatch):
    """From the middle of one, then from the end of all: each class of what a run keeps is among those that are kept."""
    case = CASES / f"{name}.toml"
    if name == "moving in space":
        case = tmp_path / "case.toml"
        case.write_text(SPACE)
    whole, keeping, written = Checkpoints.write, Keeping(first=0.0, every=0.01, worth=0.0), []

    def writing(self, *words):
        whole(self, *words)
        written.append(words[0])
        if len(written) == MIDDLE:
            raise Killed

    run(case, tmp_path / "straight")
    with monkeypatch.context() as patch:
        patch.setattr(Checkpoints, "write", writing)
        with suppress(Killed):
            run(case, tmp_path / "out", keeping)
            shutil.rmtree(tmp_path / "out")  # it had not that many
        patch.setattr(ResultWriter, "close", lambda *words: kill())
        with pytest.raises(Killed):
            run(case, tmp_path / "out", keeping, resume=True)
    run(case, tmp_path / "out", keeping, resume=True)
    assert results(tmp_path / "out") == results(tmp_path / "straight")


def test_sigkill_of_a_time_history(tmp_path):
    case, folder = CASES / "push_stop.toml", tmp_path / "out"
    told = tmp_path / ".out.dem-stages" / "told"
    run(case, tmp_path / "straight")
    size = 0
    for words in ("anew", "resume"):
        process = subprocess.Popen([sys.executable, "-c", SCRIPT, str(case), str(folder), words])
        until = time.monotonic() + 300.0
        while process.poll() is None and not (told.exists() and told.stat().st_size > size):
            assert time.monotonic() < until
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        process.wait()
        assert not folder.exists(), "it was done before it could be killed"
        size = told.stat().st_size + 5_000
    refused = CliRunner().invoke(main, ["run", str(case), "-o", str(folder), "-q"])
    assert refused.exit_code == 2
    assert "of work in" in refused.output
    assert "go on with --resume" in refused.output
    changed = CliRunner().invoke(
        main, ["run", str(case), "-o", str(folder), "-q", "--resume", "--set", "output.rate=50"]
    )
    assert changed.exit_code == 2
    assert "cannot resume: the case changed" in changed.output
    before = json.loads((told.parent / "about.json").read_text(encoding="utf-8"))["seconds"]
    done = CliRunner().invoke(main, ["run", str(case), "-o", str(folder), "-q", "--resume"])
    assert done.exit_code == 0, done.output
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["solve_seconds"] > before > 0.0
    assert results(folder) == results(tmp_path / "straight")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "straight"]
