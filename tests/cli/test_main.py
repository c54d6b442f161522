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
from dem_cli.app.cli import internal_error
from dem_cli.app.cli import main as shell
from dem_cli.app.cli.main import COMMANDS, main
from dem_cli.errors import CaseError, CaseProblem, DemError, OutputError, SolverError, UsageError

ROOT = Path(__file__).resolve().parents[2]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}


def python(*words: str, **more) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=60, env=ENVIRONMENT, **more)


def test_help_imports_nothing_but_click():
    code = (
        "import sys; from dem_cli.app.cli.main import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "print(sorted({'numpy', 'pydantic', 'numba', 'rich', 'tomli', 'h5py'} & set(sys.modules)))"
    )
    result = python("-c", code)
    assert result.stdout.splitlines()[-1] == "[]"
    assert all(f"  {name} " in result.stdout for name in COMMANDS)


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="threads of a process are counted in /proc")
def test_linear_algebra_does_not_keep_other_cores_busy():
    code = (
        "import os, dem_cli.app.cli.main, numpy; numpy.ones((400, 400)) @ numpy.ones((400, 400))\n"
        "print(len(os.listdir('/proc/self/task')))"
    )
    free = {name: value for name, value in ENVIRONMENT.items() if not name.endswith("_NUM_THREADS")}
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, env=free)
    assert result.stdout.split() == ["1"]


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("dem re", ["plain,render", "plain,report"]),
        ("dem run wa", ["file,wa"]),
        ("dem check --set a=1 wa", ["file,wa"]),
        ("dem new dru", ["plain,drums"]),
        ("dem report --op", ["plain,--open"]),
        ("dem --ver", ["plain,--version"]),
    ],
)
def test_the_tab_key_completes(typed, offered, monkeypatch):
    """A case is the name of a file, which bash completes by itself; commands are offered without importing any."""
    monkeypatch.setenv("_DEM_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(typed.count(" ")))
    assert CliRunner().invoke(main, [], prog_name="dem").output.split() == offered


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

    def install(body, *words):
        arguments = [click.Argument(["words"], nargs=-1, expose_value=False)]
        replaced = click.Command("check", callback=body, params=arguments)
        real = shell.LazyGroup.get_command
        monkeypatch.setattr(
            shell.LazyGroup,
            "get_command",
            lambda self, ctx, name: replaced if name == "check" else real(self, ctx, name),
        )
        return CliRunner().invoke(main, ["check", *words])

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


def fault():
    raise ZeroDivisionError("so many\nblocks")


def test_a_fault_of_ours_is_a_message_and_a_file(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DEM_TRACEBACK")
    (tmp_path / "case.toml").write_text("title = 'é'", encoding="utf-8")
    result = command(fault, "case.toml")
    (file,) = tmp_path.glob("dem-internal-error-*.txt")
    assert (result.exit_code, result.stdout) == (70, "")
    assert result.stderr.splitlines() == [
        "internal error: ZeroDivisionError: so many",
        "This is a fault of dem, not of the case.",
        f"Please send this file, which has the traceback and the case: {file}",
    ]
    text = file.read_text(encoding="utf-8")
    assert text.startswith(f"dem {__version__}, Python ")
    assert "\ncommand: dem check case.toml\n" in text
    assert "in fault\n" in text
    assert text.endswith("---- case.toml\ntitle = 'é'")


def test_a_fault_of_ours_where_nothing_can_be_written(command, monkeypatch, tmp_path):
    monkeypatch.delenv("DEM_TRACEBACK")
    monkeypatch.setattr(internal_error.Path, "cwd", lambda: tmp_path / "gone")
    monkeypatch.setattr(internal_error.tempfile, "gettempdir", lambda: str(tmp_path / "gone"))
    result = command(fault)
    assert result.exit_code == 70
    assert "No report could be written (No such file or directory); DEM_TRACEBACK=1 shows" in result.stderr


def test_the_traceback_of_a_fault_is_shown_on_request(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for value, shown in (("1", True), ("0", False)):
        monkeypatch.setenv("DEM_TRACEBACK", value)
        assert ("Traceback" in command(fault).stderr) is shown


def test_want_of_memory_is_no_fault(command, monkeypatch):
    def body():
        raise MemoryError("unable to allocate 64 GiB")

    monkeypatch.delenv("DEM_TRACEBACK")
    result = command(body)
    said = (
        "error: not enough memory for what was asked for: unable to allocate 64 GiB; fewer blocks or frames need less\n"
    )
    assert (result.exit_code, result.stderr) == (3, said)


@pytest.mark.parametrize(
    ("place", "said"),
    [
        (
            "dem_cli.core.contact.assemble.empty_contacts",
            "the joints between blocks (12 blocks): no more could be had; fewer",
        ),
        (
            "dem_cli.masonry.structures.wall_blocks._course",
            "the blocks: no more could be had; fewer, larger blocks need less\n",
        ),
        ("dem_cli.core.engine.simulation.Simulation.save", "the contact points that are stepped (12 blocks): no more"),
    ],
)
def test_want_of_memory_says_what_it_was_for_and_what_needs_less(place, said, monkeypatch, tmp_path):
    def full(*_, **__):
        raise MemoryError

    monkeypatch.setattr(place, full)
    path = tmp_path / "wall.toml"
    path.write_text(
        "[materials.stone]\ndensity = 2300.0\n[joints.dry]\nfriction = 0.6\n[[structure]]\nkind = 'wall'\n"
        "block = [0.6, 0.3]\ncourses = 3\nblocks_per_course = 3\n[analysis]\nkind = 'pushover'\n"
    )
    result = CliRunner().invoke(main, ["check", str(path)])
    assert result.exit_code == 3
    assert f"error: not enough memory for {said}" in result.stderr


def in_bash(line: str) -> subprocess.CompletedProcess:
    """`dem` and what a shell does with its output."""
    words = ["bash", "-c", f'set -o pipefail; "{sys.executable}" -m dem_cli {line}']
    return subprocess.run(words, capture_output=True, text=True, timeout=60, env=ENVIRONMENT)


def test_a_reader_that_goes_away_is_no_error():
    result = in_bash("schema | head -n 1")
    assert (result.stdout, result.stderr) == ("{\n", "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no device that is full")
def test_a_full_disk_below_what_is_printed_is_no_fault():
    result = in_bash("schema > /dev/full")
    said = "error: cannot print to the standard output: no space left on device\n"
    assert (result.returncode, result.stderr) == (3, said)


def test_a_command_that_ended_runs_what_others_left_for_the_end_and_no_more():
    code = (
        "import atexit, sys\n"
        "class Slow:\n"
        "    def __del__(self): print('freed')\n"
        "kept = Slow()\n"
        "from dem_cli.app.cli.main import main\n"
        "atexit.register(print, 'left for the end')\n"
        "sys.argv = ['dem', *sys.argv[1:]]\n"
        "main()"
    )
    assert python("-c", code, "--version").stdout.splitlines()[1:] == ["left for the end"]
    refused = python("-c", code, "nothing")
    assert (refused.returncode, refused.stdout.splitlines()) == (2, ["left for the end"])
    assert "no command 'nothing'" in refused.stderr
