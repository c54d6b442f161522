"""A case from standard input: `dem run -`, and every other command that takes a case."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main

CASE = """\
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.7
[[structure]]
kind = "column"
courses = 2
block = [0.4, 0.8]
[analysis]
kind = "pushover"
follow = 0.0
resolution = 0.02
"""
SWEEP = '[sweep]\n"joints.dry.friction" = [0.6, 0.7]\n'
SHAKEN = (
    CASE.split("[analysis]")[0]
    + """\
[analysis]
kind = "time-history"
[motion]
kind = "record"
file = "east.csv"
unit = "m/s2"
step = 0.01
"""
)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def dem(*words, given: str | bytes):
    return CliRunner().invoke(main, list(words), input=given)


def test_run_names_results_after_it():
    assert dem("run", "-", "-q", given=CASE).exit_code == 0
    found = json.loads(Path("results/stdin/summary.json").read_text(encoding="utf-8"))
    assert (found["title"], found["status"]) == ("stdin", "ok")
    assert dem("run", "-", "-q", "-o", "there", "--set", "title='a title'", given=CASE).exit_code == 0
    again = json.loads(Path("there/summary.json").read_text(encoding="utf-8"))
    assert (again["title"], again["failure_load"]) == ("a title", found["failure_load"])


@pytest.mark.parametrize(
    "words",
    [("check", "-"), ("limit", "-"), ("build", "-", "-o", "model.vtu"), ("sweep", "-", "--dry-run")],
    ids=lambda words: words[0],
)
def test_every_command_that_takes_a_case(words):
    found = dem(*words, given=CASE + SWEEP)
    assert found.exit_code == 0, found.output


def test_runs_of_a_sweep_in_other_processes():
    assert dem("sweep", "-", "-q", "-j", "1", given=CASE + SWEEP).exit_code == 0
    rows = Path("results/stdin_sweep/sweep.csv").read_text(encoding="utf-8").splitlines()
    assert [row.split(",")[1] for row in rows[1:]] == ["0.6", "0.7"]


def test_records_are_sought_in_the_working_directory():
    found = dem("check", "-", given=SHAKEN)
    assert found.exit_code == 2
    assert "<stdin>:13:8: motion.file: no such file" in found.output
    Path("east.csv").write_text("".join(f"{0.1 * (i % 7)}\n" for i in range(100)), encoding="utf-8")
    assert dem("check", "-", given=SHAKEN).exit_code == 0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            CASE.replace("friction", "frcition"),
            "<stdin>:4:1: joints.dry.frcition: unknown key, did you mean 'friction'?",
        ),
        (CASE + "x = [1,\n", "<stdin>:14:1: not valid TOML"),
        ("", "<stdin>: the file is empty"),
        (b"a = '\xff'\n", "<stdin>:1: not UTF-8 text (byte 0xff)"),
    ],
)
def test_messages_name_it_with_the_line(given, message):
    found = dem("check", "-", given=given)
    assert found.exit_code == 2
    assert message in found.output


def test_a_fault_of_the_program_leaves_the_case(monkeypatch):
    def broken(loaded):
        raise RuntimeError("a fault")

    monkeypatch.setattr("dem_cli.app.api.laid", broken)
    assert dem("check", "-", given=CASE).exit_code == 70
    (report,) = Path.cwd().glob("dem-internal-error-*.txt")
    assert f"---- <stdin>\n{CASE}" in report.read_text(encoding="utf-8")
