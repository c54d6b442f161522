"""Study of interrupts: SIGINT and SIGTERM at random moments of every command, beside busy processes."""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dem_cli.app.sweep.pool import GRACE
from studies.interrupts.commands import COMMANDS, InterruptedCommand
from studies.interrupts.trial import InterruptTrial, gone_on, interrupted, started
from studies.study import StudyRunner
from studies.template import table

SIGNALS = (signal.SIGINT, signal.SIGTERM)
COUNT = 72  # of each command
BUSY = 2  # processes beside
LIMIT = 3.0  # s that a command may go on
EVERY = 8  # interrupted commands, of which one goes on afterwards
WORDS = {"sweep_alone": "sweep, one process", "time_history": "time history"}


class InterruptStudy(StudyRunner):
    """A section per command: seconds and exit codes of its interrupts, and what was wrong."""

    parts, solves = "COMMAND", False

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--count", type=int, default=COUNT, help=f"interrupts of each command ({COUNT})")
        parser.add_argument("--busy", type=int, default=BUSY, help=f"busy processes beside ({BUSY})")
        parser.add_argument("--seed", type=int, default=1, help="of the moments (1)")

    def measure(self, section: str, options: argparse.Namespace) -> dict[str, Any]:
        command, numbers = COMMANDS[section], random.Random(f"{section} {options.seed}")
        with tempfile.TemporaryDirectory() as place, busy(options.busy):
            straight, load = Path(place) / "straight", [os.getloadavg()[0]]
            for _ in range(2):  # the first one may compile
                shutil.rmtree(straight, ignore_errors=True)
                begun = time.monotonic()
                assert started(command, straight).wait() == 0, (straight / "said.txt").read_text()
                whole = time.monotonic() - begun
            trials = {number: [] for number in SIGNALS}
            for i in range(options.count):
                number = SIGNALS[i % len(SIGNALS)]
                trials[number].append(one(command, Path(place), numbers, number, whole, i % EVERY == 0))
            load.append(os.getloadavg()[0])
        rows = [summarised(signal.Signals(number).name, found) for number, found in trials.items()]
        return {
            "whole": round(whole, 1),
            "busy": options.busy,
            "load": [round(value, 1) for value in load],
            "signals": rows,
        }

    def said(self, section: str, found: Any) -> str:
        rows = ["  ".join(row_of(one)) for one in found["signals"]]
        return "\n".join([f"{section}: {found['whole']} s, load {found['load']}", *rows])

    def problems(self, section: str, found: Any) -> list[str]:
        return [f"{section}, {row['signal']}: {line}" for row in found["signals"] for line in row["problems"]]


def one(
    command: InterruptedCommand, place: Path, numbers: random.Random, number: int, whole: float, resume: bool
) -> InterruptTrial:
    """An interrupt at a random moment; another moment where the command was done by then."""
    while True:
        folder, delay, group = place / "trial", numbers.uniform(0.0, whole), numbers.random() < 0.5
        trial = interrupted(command, folder, number, lambda _, delay=delay: time.sleep(delay), group)
        if trial is not None and resume and not trial.problems:
            trial.problems += gone_on(command, folder, place / "straight")
        shutil.rmtree(folder, ignore_errors=True)
        if trial is not None:
            return trial


@contextmanager
def busy(count: int) -> Iterator[None]:
    """Processes that want a core each."""
    others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for other in others:
            other.kill()
            other.wait()


def summarised(name: str, trials: Sequence[InterruptTrial]) -> dict[str, Any]:
    """All interrupts with one signal."""
    codes = Counter("hung" if trial.code is None else str(trial.code) for trial in trials)
    return {
        "signal": name,
        "codes": dict(sorted(codes.items())),
        "seconds": sorted(round(trial.seconds, 2) for trial in trials),
        "cpu": sorted(round(trial.cpu, 2) for trial in trials),
        "problems": [line for trial in trials for line in trial.problems],
    }


def row_of(row: Mapping[str, Any]) -> list[str]:
    """A row of the table."""
    times, codes = row["seconds"], dict(row["codes"])
    known = [codes.pop(code, 0) for code in ("130", "0")]
    unbegun = sum(codes.pop(code, 0) for code in ("-2", "-15", "1"))
    late = sum(value > LIMIT for value in times)
    at = [of[int(share * (len(of) - 1))] for of in (times, row["cpu"]) for share in (0.5, 0.95, 1.0)]
    wrong = f"**{len(row['problems'])}**" if row["problems"] or codes else "0"
    return [
        row["signal"],
        *map(str, (len(times), *known, unbegun)),
        *(f"{value:.2f}" for value in at),
        str(late),
        wrong,
    ]


def values(kept: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows."""
    head = [
        *("command", "runs for", "load", "signal", "interrupts", "130", "0", "unbegun", "median", "95 %", "longest"),
        *("CPU: median", "95 %", "most", f"above {LIMIT:g} s", "wrong"),
    ]
    sections = {name: found for name, found in kept.items() if name in COMMANDS}
    rows = [
        [WORDS.get(name, name), f"{found['whole']} s", " to ".join(map(str, found["load"])), *row_of(row)]
        for name, found in sections.items()
        for row in found["signals"]
    ]
    all_rows = [row for found in sections.values() for row in found["signals"]]
    return {
        "table": table(head, rows),
        "count": sum(len(row["seconds"]) for row in all_rows),
        "longest": max((value for row in all_rows for value in row["seconds"]), default=0.0),
        "wrong": sum(len(row["problems"]) for row in all_rows),
        "limit": LIMIT,
        "every": EVERY,
        "above": sum(value > LIMIT for row in all_rows for value in row["seconds"]),
        "hung": sum(row["codes"].get("hung", 0) for row in all_rows),
        "grace": GRACE,
        "cores": os.cpu_count(),
        "busy": max(found["busy"] for found in sections.values()),
    }


STUDY = InterruptStudy(
    "interrupts", "Ctrl-C and SIGTERM at random moments of every command", COMMANDS, values, machine=True
)
