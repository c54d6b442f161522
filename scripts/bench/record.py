"""Benchmark records, one per measurement, as JSON; pages and pictures are made from nothing else."""

from __future__ import annotations

import json
import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from dem_cli.errors import UsageError

RECORD_FORMAT = 1


@dataclass(frozen=True)
class Measurement:
    """One measurement: what was timed, under which setting, its times and what came out."""

    case: str  # structure, such as "T21 μ 0.5"
    axis: str  # what is varied, or the thing measured
    value: Any  # where on the axis: a number or a name
    best: float  # CPU seconds, or `unit`
    median: float
    repeats: int
    unit: str = "s"
    found: dict[str, Any] = field(default_factory=dict)  # load, error, steps, … as the group says


@dataclass
class GroupResult:
    """Records of one group of benchmarks; notes say what was skipped and why."""

    records: list[Measurement] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class BenchOptions:
    """Options of a benchmark: how much is measured."""

    quick: bool = False  # the smallest sizes, once: does it work?
    long: bool = False  # the largest ones as well: hours
    repeats: int | None = None  # rounds; default: as the group says

    def rounds(self, default: int) -> int:
        """How often each thing is measured."""
        return self.repeats or (1 if self.quick else default)


def record(case: str, axis: str, value: Any, seconds: Sequence[float], unit: str = "s", **found: Any) -> Measurement:
    """A record of repeated measurements; other work only adds time, so that the best counts."""
    best, median = (float(f"{time:.4g}") for time in (min(seconds), statistics.median(seconds)))
    return Measurement(case, axis, value, best, median, len(seconds), unit, found)


def as_json(groups: dict[str, dict[str, Any]]) -> str:
    """The text of a results file, a line per record. groups: name -> {"machine", "notes", "records"}."""

    def text(value: Any) -> str:
        return json.dumps(value, ensure_ascii=False, allow_nan=False)

    lines = []
    for name, group in groups.items():
        records = ",\n   ".join(text(table) for table in group["records"])
        parts = (f'"machine": {text(group["machine"])}', f'"notes": {text(group["notes"])}')
        lines.append(f"  {text(name)}: {{\n   " + ",\n   ".join((*parts, f'"records": [\n   {records}\n   ]')) + "}")
    body = "{\n" + ",\n".join(lines) + "\n }" if lines else "{}"
    return f'{{"format": {RECORD_FORMAT},\n "groups": {body}}}\n'


def group_table(found: GroupResult, machine: dict[str, Any]) -> dict[str, Any]:
    """One group as JSON holds it."""
    return {"machine": machine, "notes": found.notes, "records": [asdict(r) for r in found.records]}


def read(path: Path) -> dict[str, dict[str, Any]]:
    """Groups of a results file. Raises UsageError where it is none of ours."""
    try:
        tables = json.loads(path.read_text(encoding="utf-8"))
        if tables["format"] != RECORD_FORMAT:
            raise UsageError(f"{path}: written by another version of scripts/benchmark; remove it and measure again")
        return dict(tables["groups"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UsageError(f"{path}: no results of scripts/benchmark ({error})") from None


def records_of(group: dict[str, Any]) -> list[Measurement]:
    """The records of one group of a results file."""
    return [Measurement(**table) for table in group["records"]]
