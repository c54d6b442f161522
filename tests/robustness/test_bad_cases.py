"""Every mistake in a case file: exit 2, the whole message, no traceback, nothing written."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main

TABLE = tomllib.loads(Path(__file__).with_name("bad_cases.toml").read_text(encoding="utf-8"))
ROOT = Path(__file__).resolve().parents[2]
BAD = {bad["name"]: bad for bad in TABLE["bad"]}
BY_PROCESS = ("key of a joint", "several at once", "empty", "overlap")


def text_of(bad: dict) -> str:
    """The case file of an entry."""
    text = bad.get("text", TABLE["good"])
    for old, new in bad.get("replace", ()):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text + bad.get("append", "")


def arguments(bad: dict) -> list[str]:
    settings = [word for value in bad.get("set", ()) for word in ("--set", value)]
    return ["run", "case.toml", "-o", "out", *settings]


def expected(lines: list[str]) -> str:
    return "".join(f"error: {line}\n" for line in lines)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(folder: Path, *words: str) -> tuple[int, str]:
    """`dem WORDS` in this process: exit code and stderr. Nothing may be printed or written."""
    before = sorted(folder.rglob("*"))
    result = CliRunner().invoke(main, list(words))
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert result.stdout == ""
    assert sorted(folder.rglob("*")) == before
    return result.exit_code, result.stderr


def test_there_are_enough_of_them():
    assert len(BAD) == len(TABLE["bad"]) >= 80
    assert len({tuple(bad["says"]) for bad in BAD.values()}) > 75


@pytest.mark.parametrize("name", BAD)
def test_bad_case(name, folder):
    (folder / "case.toml").write_text(text_of(BAD[name]), encoding="utf-8")
    assert run(folder, *arguments(BAD[name])) == (2, expected(BAD[name]["says"]))


@pytest.mark.parametrize("name", BY_PROCESS)
def test_bad_case_in_its_own_process(name, folder):
    (folder / "case.toml").write_text(text_of(BAD[name]), encoding="utf-8")
    command = [sys.executable, "-m", "dem_cli", *arguments(BAD[name])]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    result = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=60, env=environment)
    assert (result.returncode, result.stdout, result.stderr) == (2, "", expected(BAD[name]["says"]))
    assert [path.name for path in folder.iterdir()] == ["case.toml"]


@pytest.mark.parametrize("command", ["check", "build"])
def test_other_commands_say_the_same(command, folder):
    bad = BAD["key of a joint"]
    (folder / "case.toml").write_text(text_of(bad), encoding="utf-8")
    more = ["-o", "model.vtu"] if command == "build" else []
    assert run(folder, command, "case.toml", *more) == (2, expected(bad["says"]))


def test_no_such_file(folder):
    (folder / "wall_21.toml").write_text(TABLE["good"], encoding="utf-8")
    said = expected(["wall21.toml: no such file, did you mean 'wall_21.toml'?"])
    assert run(folder, "run", "wall21.toml") == (2, said)
    assert run(folder, "run", "wall_21") == (
        2,
        expected(["wall_21: no such file, did you mean 'wall_21.toml'?"]),
    )
    assert run(folder, "run", "zzz") == (2, expected(["zzz: no such file"]))
    (folder / "pyproject.toml").touch()
    assert run(folder, "run", "nope.toml") == (2, expected(["nope.toml: no such file"]))
    assert run(folder, "run", "no/a.toml") == (
        2,
        expected(["no/a.toml: no such file (there is no folder 'no')"]),
    )


def test_a_folder(folder):
    (folder / "cases").mkdir()
    assert run(folder, "run", "cases") == (2, expected(["cases: is a folder; a case is a TOML file"]))


def test_not_utf8(folder):
    (folder / "case.toml").write_bytes(TABLE["good"].encode() + b"\n# M\xf6rtel\n")
    said = expected(["case.toml:20: not UTF-8 text (byte 0xf6)"])
    assert run(folder, "run", "case.toml") == (2, said)


def test_binary(folder):
    (folder / "case.toml").write_bytes(bytes(range(32)))
    code, said = run(folder, "run", "case.toml")
    assert code == 2
    assert said.startswith("error: case.toml:1:1: not valid TOML: ")


def test_wrong_line_and_column_with_byte_order_mark_and_windows_lines(folder):
    text = text_of(BAD["key of a joint"]).replace("\n", "\r\n")
    (folder / "case.toml").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert run(folder, "run", "case.toml") == (2, expected(BAD["key of a joint"]["says"]))
