"""The shell around the commands: what is imported, exit codes, no traceback."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from dem_cli import __version__
from dem_cli.cli import main as shell
from dem_cli.cli.main import COMMANDS, main
from dem_cli.errors import CaseError, CaseProblem, DemError, OutputError, SolverError, UsageError

ROOT = Path(__file__).resolve().parents[2]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}


def python(*words: str, **more) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=60, env=ENVIRONMENT, **more)


def test_help_imports_nothing_but_click():
    code = (
        "import sys; from dem_cli.cli.main import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "print(sorted({'numpy', 'pydantic', 'numba', 'rich', 'tomli', 'h5py'} & set(sys.modules)))"
    )
    result = python("-c", code)
    assert result.stdout.splitlines()[-1] == "[]"
    assert all(f"  {name} " in result.stdout for name in COMMANDS)


def test_help_is_quick():
    times = []
    for _ in range(5):  # the best of several: other programs run on this machine too
        start = time.perf_counter()
        assert python("-m", "dem_cli", "--help").returncode == 0
        times.append(time.perf_counter() - start)
    assert min(times) < 0.3


def test_every_command_exists():
    for name in COMMANDS:
        result = CliRunner().invoke(main, [name, "--help"])
        assert result.exit_code == 0, result.output
        assert f"dem {name}" in result.stdout


def test_version():
    result = CliRunner().invoke(main, ["--version"])
    assert (result.exit_code, result.stdout) == (0, f"dem {__version__}\n")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["chekc"], "Error: no command 'chekc', did you mean 'check'? (commands: run, check, "),
        (["zzz"], "Error: no command 'zzz' (commands: run, check, "),
        (["check"], "Error: Missing argument 'CASE'."),
        (["check", "a.toml", "b.toml"], "Error: Got unexpected extra argument (b.toml)"),
        (["check", "a.toml", "--sett", "a=1"], "Error: No such option"),
        (["build", "a.toml"], "Error: Missing option '-o' / '--output'."),
        (["new", "brick"], "Error: Invalid value for 'KIND': 'brick' is not one of "),
        (["--nothing"], "Error: No such option '--nothing'."),
    ],
)
def test_wrong_arguments_exit_with_2(words, said):
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 2
    assert said in result.stderr
    assert result.stdout == ""


def test_no_arguments_print_the_help():
    result = CliRunner().invoke(main, [])
    assert result.exit_code == 2
    assert "Commands:" in result.output


@pytest.fixture
def command(monkeypatch):
    """A function that makes `dem check` do something else."""

    def install(body):
        replaced = click.Command("check", callback=body)
        real = shell.LazyGroup.get_command
        monkeypatch.setattr(
            shell.LazyGroup,
            "get_command",
            lambda self, ctx, name: replaced if name == "check" else real(self, ctx, name),
        )
        return CliRunner().invoke(main, ["check"])

    return install


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (UsageError("no such thing"), 2, "error: no such thing\n"),
        (
            CaseError([CaseProblem(("a", 0), "bad"), CaseProblem((), "worse")]),
            2,
            "error: a.0: bad\nerror: worse\n",
        ),
        (SolverError("gave up"), 3, "error: gave up\n"),
        (OutputError("disk full"), 3, "error: disk full\n"),
        (DemError("something"), 1, "error: something\n"),
        (KeyboardInterrupt(), 130, "\ninterrupted\n"),
        (click.Abort(), 130, "interrupted\n"),
    ],
)
def test_an_error_is_a_line_and_an_exit_code(command, error, code, said):
    def body():
        raise error

    result = command(body)
    assert (result.exit_code, result.stderr, result.stdout) == (code, said, "")


@pytest.mark.parametrize(("value", "code"), [(None, 0), (0, 0), (1, 1), (3, 3), (130, 130)])
def test_a_command_returns_its_exit_code(command, value, code):
    assert command(lambda: value).exit_code == code


def test_a_slip_of_ours_is_not_hidden(command):
    def body():
        raise ZeroDivisionError

    assert isinstance(command(body).exception, ZeroDivisionError)


def test_a_reader_that_goes_away_is_no_error():
    line = f'"{sys.executable}" -m dem_cli schema | head -n 1'
    result = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {line}"],
        capture_output=True,
        text=True,
        timeout=60,
        env=ENVIRONMENT,
    )
    assert (result.stdout, result.stderr) == ("{\n", "")
