"""One interrupt of a command in processes of its own: how long it went on, its exit code, what is wrong afterwards."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import dem_cli
from dem_cli.errors import DemError
from studies.interrupts.commands import InterruptedCommand, Kept
from studies.places import ROOT

PATIENCE = 60.0  # s after which it hangs
SOON = 10.0  # s in which all its processes are gone, the tracker of multiprocessing too
TOO_LATE, INTERRUPTED = 0, 130
UNBEGUN = (-signal.SIGINT, -signal.SIGTERM)  # Python itself has not read the program yet
SITE = "Fatal Python error: init"  # nor here, with exit code 1
HALF_DONE = (".dem-new-", ".dem-old-", ".part-", ".lock")


@dataclass
class InterruptTrial:
    """What became of one."""

    code: int | None  # exit code; None: it hung
    seconds: float  # from the signal to its end
    cpu: float = 0.0  # s of all its processes in that time: what it would take if the machine were its own
    problems: list[str] = field(default_factory=list)


def started(command: InterruptedCommand, folder: Path, more: tuple[str, ...] = ()) -> subprocess.Popen:
    """The command at work in a folder of its own, in a session of its own."""
    (folder / "tmp").mkdir(parents=True, exist_ok=True)
    if command.text:
        (folder / "case.toml").write_text(command.text, encoding="utf-8")
    environment = os.environ | {
        "PYTHONPATH": str(ROOT), "TMPDIR": str(folder / "tmp"), "PYTHONFAULTHANDLER": "1", "NUMBA_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }  # fmt: skip
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell starts what runs behind it so, and children inherit
        signal.signal(signal.SIGINT, signal.default_int_handler)
    with (folder / "said.txt").open("ab") as said:
        return subprocess.Popen(
            [sys.executable, "-m", "dem_cli", *command.words, "-q", *more], cwd=folder, env=environment, stdout=said,
            stderr=said, start_new_session=True,
        )  # fmt: skip


def interrupted(
    command: InterruptedCommand,
    folder: Path,
    number: int,
    wait: Callable[[subprocess.Popen], None],
    whole_group: bool = False,
) -> InterruptTrial | None:
    """Starts it, waits, sends a signal; None where it was done before that.

    whole_group: all its processes hear the signal, as with Ctrl-C in a terminal.
    """
    before = cpu_of_children()
    process = started(command, folder)
    wait(process)
    kept = command.kept(folder)
    if process.poll() is not None:
        return None
    begun, spent = time.monotonic(), cpu_of_group(process.pid)
    (os.killpg if whole_group else os.kill)(process.pid, number)
    try:
        code = process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGABRT)  # it says where it is
        process.wait()
        os.killpg(process.pid, signal.SIGKILL)
        return InterruptTrial(None, PATIENCE, 0.0, [f"hangs: {(folder / 'said.txt').read_text()}"])
    trial = InterruptTrial(code, time.monotonic() - begun, max(0.0, cpu_of_children() - before - spent))
    trial.problems = problems(command, folder, code, kept) + survivors(process.pid)
    return trial


def cpu_of_children() -> float:
    """CPU of all that were waited for [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def group_of(group: int) -> dict[Path, list[str]]:
    """Processes of a group: their folders in /proc, and what stands in `stat` from the state on."""
    found = {}
    for file in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            fields = file.read_text().rpartition(")")[2].split()
            if int(fields[2]) == group:
                found[file.parent] = fields
    return found


def cpu_of_group(group: int) -> float:
    """CPU of the processes of a group, and of those that they have waited for [s]; 0 where the system does not tell."""
    ticks = sum(int(value) for fields in group_of(group).values() for value in fields[11:15])
    return ticks / os.sysconf("SC_CLK_TCK")


def problems(command: InterruptedCommand, folder: Path, code: int, kept: Kept) -> list[str]:
    """What is not as promised, a line each."""
    said = (folder / "said.txt").read_text(encoding="utf-8")
    unbegun = code in UNBEGUN or (code == 1 and SITE in said)
    found = [] if code in (TOO_LATE, INTERRUPTED) or unbegun else [f"exit code {code}: {said[-300:]}"]
    names = [path for path in folder.rglob("*") if any(word in path.name for word in HALF_DONE)]
    found += [f"left: {path.relative_to(folder)}" for path in names if path.name not in (".sweep.lock", ".tables.lock")]
    found += [f"left in the folder of temporary files: {path.name}" for path in (folder / "tmp").iterdir()]
    if unbegun:
        found += [f"ended by the signal, and left {path.name}" for path in folder.glob("*out*")]
    for path, text in kept.items():
        if not (path.exists() and path.read_bytes().startswith(text)) and code != TOO_LATE:
            found.append(f"lost: {path.relative_to(folder)}")
    for summary in folder.rglob("summary.json"):
        try:
            with dem_cli.open(summary.parent) as result:
                assert result.status
        except (DemError, OSError, AssertionError) as error:
            if not (summary.parent / "calibrated.toml").exists():
                found.append(f"not readable: {summary.relative_to(folder)}: {error}")
    return found


def survivors(group: int) -> list[str]:
    """Processes of the command that have not gone soon after it."""
    until = time.monotonic() + SOON
    while True:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return []
        if time.monotonic() > until:
            words = {(place / "cmdline").read_text().replace("\0", " ") for place in group_of(group)}
            return [f"a process of it goes on: {', '.join(words)}"]
        time.sleep(0.01)


def gone_on(command: InterruptedCommand, folder: Path, straight: Path) -> list[str]:
    """The same command once more: its table is that of one that nobody interrupted."""
    if command.again is None or not any(folder.glob("*out*")):
        return []
    journal = (folder / ".out.dem-runs").exists()
    code = started(command, folder, command.again if journal else ()).wait()
    if code != 0:
        return [f"going on ends with exit code {code}"]
    same = (folder / command.table).read_bytes() == (straight / command.table).read_bytes()
    return [] if same else ["gone on, it has another table"]
