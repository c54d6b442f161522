"""Study of what runs cost: seeded cases of every kind, what `dem check` says of them and what `dem run` takes.

Only the second of two runs counts where the first one compiled anything.
"""

from __future__ import annotations

import argparse
import json
import re
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from studies.costs.fresh_cases import FAMILIES, FreshCase
from studies.study import StudyRunner

DEM = (sys.executable, "-m", "dem_cli")
LONGEST = 60  # CPU s of a run; what takes longer is stopped, and counts where the range ends below
COMPILED = 0.5  # s: a run that compiled for longer is run again
SECONDS = {"ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0}
RANGE = re.compile(r"^  cost +(\S+) (\S+) to (\S+) (\S+) of CPU time", re.MULTILINE)


class CostStudy(StudyRunner):
    """A section per family: of each seed the range, and CPU seconds of a run."""

    parts, solves = "FAMILY", False

    def __init__(self, name: str, about: str) -> None:
        super().__init__(name, about, dict.fromkeys(FAMILIES))
        self.inside: list[bool] = []

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--seeds", type=int, nargs=2, default=(1, 3), metavar=("FIRST", "LAST"), help="1 3")

    def check(self, options: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
        super().check(options, parser)
        if options.write or options.redraw:
            parser.error("this study has no page: what it prints says whether the ranges hold")

    def measure(self, section: str, options: argparse.Namespace) -> list[dict[str, Any]]:
        first, last = options.seeds
        found = [measured(section, seed) for seed in range(first, last + 1)]
        self.inside += [one["inside"] for one in found if one["inside"] is not None]
        return found

    def said(self, section: str, found: Any) -> str:
        words = {True: "inside", False: "OUTSIDE", None: "not known"}
        return "\n".join(
            f"{section} {one['seed']}: {one['low']:.3g} to {one['high']:.3g} s said, "
            f"{one['seconds']:.2f} s{'' if one['ended'] else ' and more'}: {words[one['inside']]}"
            for one in found
        )

    def main(self, words: Sequence[str] | None = None) -> int:
        self.inside.clear()
        code = super().main(words)
        print(f"{sum(self.inside)} of {len(self.inside)} runs lie within what was said")
        return code


def measured(family: str, seed: int) -> dict[str, Any]:
    """What was said of a case and what it took. inside: None where the run was stopped within the range."""
    with tempfile.TemporaryDirectory() as place:
        case = Path(place) / "case.toml"
        case.write_text(FreshCase(family, seed).text(), encoding="utf-8")
        said = RANGE.search(subprocess.run([*DEM, "check", case], capture_output=True, text=True, check=True).stdout)
        assert said is not None
        low, high = (float(said[i]) * SECONDS[said[i + 1]] for i in (1, 3))
        seconds, compiling = _run(case)
        if compiling is not None and compiling > COMPILED:
            seconds, compiling = _run(case)
    ended = compiling is not None
    inside = low <= seconds <= high if ended or seconds > high else None
    return {"seed": seed, "low": low, "high": high, "seconds": seconds, "ended": ended, "inside": inside}


def _run(case: Path) -> tuple[float, float | None]:
    """CPU seconds of a run, and those of its compilation; None where it was stopped."""
    results, before = case.with_name("results"), _spent()
    subprocess.run(
        [*DEM, "run", case, "-o", results, "-q"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=_limited,
    )  # fmt: skip
    seconds = _spent() - before
    if seconds >= LONGEST:
        return seconds, None
    return seconds, json.loads((results / "summary.json").read_text(encoding="utf-8"))["compile_seconds"]


def _limited() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST + 5))


def _spent() -> float:
    """CPU seconds of all processes that were waited for."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


STUDY = CostStudy("costs", "What `dem check` says that runs cost, and what they cost")
