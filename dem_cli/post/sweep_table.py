"""The table of a sweep, read back: swept keys, answers, and which runs have none."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dem_cli.errors import UsageError
from dem_cli.output.csv_cells import text_of
from dem_cli.output.sweep_files import CSV, FACTS, IDENTITY_COLUMNS
from dem_cli.post.labels import nearest, plain, unknown

ANSWER_COLUMNS = (  # what is drawn where nobody says: the first of these that has values
    "failure_load", "safety_factor", "critical_value", "median", "collapsed", "collapse_time",
)  # fmt: skip


@dataclass(frozen=True)
class SweepTable:
    """Table of a sweep: rows in the order of the plan."""

    title: str
    keys: tuple[str, ...]  # swept
    columns: dict[str, list[Any]]  # by name: numbers, truths, words; None where a run has no answer
    folder: Path

    @property
    def names(self) -> list[str]:
        """All columns but those that only tell runs apart."""
        return [name for name in self.columns if name not in IDENTITY_COLUMNS]

    @property
    def count(self) -> int:
        """Number of runs."""
        return len(self.columns["run"])

    def exact(self, name: str) -> str:
        """The column that `name` means, in full or by the end of its path. Raises UsageError."""
        if found := nearest(name, self.names):
            return found
        ends = [one for one in self.names if plain(one).endswith(f".{plain(name)}")]
        if len(ends) == 1:
            return ends[0]
        raise unknown(name, self.names)

    def only(self, wanted: Mapping[str, Any]) -> SweepTable:
        """The rows that have these values. Raises UsageError where there are none."""
        exact = {self.exact(name): value for name, value in wanted.items()}
        rows = [i for i in range(self.count) if all(self.columns[name][i] == value for name, value in exact.items())]
        if not rows:
            some = next(iter(exact))
            there = ", ".join(map(shown, distinct(self.columns[some])[:12]))
            raise UsageError(f"--where: no run has these values ({some}: {there})")
        kept = {name: [values[i] for i in rows] for name, values in self.columns.items()}
        keys = tuple(key for key in self.keys if key not in exact or len(distinct(kept[key])) > 1)
        return SweepTable(self.title, keys, kept, self.folder)

    def answer(self) -> str:
        """The column that matters most. Raises UsageError."""
        peaks = [name for name in self.names if name.startswith("peaks.") and name.endswith(".peak")]
        values = [name for name in self.names if name.startswith("monitors.") and name.endswith(".value")]
        for name in (*ANSWER_COLUMNS, *peaks, *values):
            if any(value is not None for value in self.columns.get(name, ())):
                return name
        why = "no column is the answer; choose one with -y (--list shows all)" if "ok" in self.columns["status"] else (
            "no run has an answer yet")  # fmt: skip
        raise UsageError(f"{self.folder / CSV}: {why}")

    def ranked(self) -> list[str]:
        """Swept keys with more than one value: numbers before words, most values first."""
        varied = [key for key in self.keys if len(distinct(self.columns[key])) > 1]
        return sorted(varied, key=lambda key: (not numeric(self.columns[key]), -len(distinct(self.columns[key]))))


def is_sweep(folder: Path) -> bool:
    """Whether a folder holds a sweep."""
    return (folder / CSV).is_file() or (folder / FACTS).is_file()


def read_sweep(folder: Path) -> SweepTable:
    """The table in a folder. Raises UsageError."""
    try:
        facts = json.loads((folder / FACTS).read_text(encoding="utf-8")) if (folder / FACTS).is_file() else {}
        with (folder / CSV).open(encoding="utf-8", newline="") as file:
            names, *rows = list(csv.reader(file)) or [[]]
        names = list(map(text_of, names))
    except FileNotFoundError:
        raise UsageError(f"{folder}: no sweep.csv yet; `dem sweep` writes it, the same command goes on") from None
    except (OSError, ValueError) as error:
        raise UsageError(f"{folder / CSV}: not a readable table of a sweep ({error})") from None
    whole = all(len(row) == len(names) for row in rows)
    columns = {name: [value(row[i]) for row in rows] for i, name in enumerate(names)} if whole else {}
    if not rows or "run" not in columns or "status" not in columns:
        raise UsageError(f"{folder / CSV}: not a table of a sweep, or one without runs")
    columns["run"] = [row[names.index("run")] for row in rows]  # 1e5 may be a name
    keys = facts.get("keys") or names[names.index("run") + 1 : names.index("status")]
    return SweepTable(str(facts.get("title", "")), tuple(keys), columns, folder)


def value(text: str) -> Any:
    """What a cell holds: a number, a truth, a word, or nothing."""
    if text in ("", "true", "false"):
        return {"": None, "true": True, "false": False}[text]
    try:
        return float(text)
    except ValueError:
        return text_of(text)


def numeric(values: Sequence[Any]) -> bool:
    """Whether all that is there are numbers or truths."""
    return all(isinstance(v, (int, float)) for v in values if v is not None)


def distinct(values: Sequence[Any]) -> list[Any]:
    """Different values that are there: numbers by size, words as they come."""
    found = list(dict.fromkeys(v for v in values if v is not None))
    return sorted(found) if numeric(found) else found


def is_answer_in_words(values: Sequence[Any]) -> bool:
    """Whether a column holds words, or truths."""
    return not numeric(values) or all(isinstance(v, bool) for v in values if v is not None)


def shown(v: Any) -> str:
    """A value as a legend has it."""
    if isinstance(v, bool):
        return "yes" if v else "no"
    return f"{v:.6g}" if isinstance(v, float) else "–" if v is None else str(v)
