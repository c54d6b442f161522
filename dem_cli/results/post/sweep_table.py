"""Table of a sweep, read back: swept keys, answers, and runs without one."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dem_cli.errors import DamagedResults, UsageError
from dem_cli.input_limits import TABLE_BYTES, UnreadableInput, read_bounded
from dem_cli.results.output.csv_cells import text_of
from dem_cli.results.output.sweep_files import CSV, FACTS, IDENTITY_COLUMNS
from dem_cli.results.post.labels import nearest, plain, unknown

ANSWER_COLUMNS = (  # drawn by default: the first of these that has values
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
        """All columns except those that only identify runs."""
        return [name for name in self.columns if name not in IDENTITY_COLUMNS]

    @property
    def count(self) -> int:
        """Number of runs."""
        return len(self.columns["run"])

    def exact(self, name: str) -> str:
        """Return the column that `name` means, in full or by the end of its path. Raises UsageError."""
        if found := nearest(name, self.names):
            return found
        ends = [one for one in self.names if plain(one).endswith(f".{plain(name)}")]
        if len(ends) == 1:
            return ends[0]
        raise unknown(name, self.names)

    def only(self, wanted: Mapping[str, Any]) -> SweepTable:
        """Return the rows that have these values. Raises UsageError where there are none."""
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
        """Return the most important column. Raises UsageError."""
        peaks = [name for name in self.names if name.startswith("peaks.") and name.endswith(".peak")]
        values = [name for name in self.names if name.startswith("monitors.") and name.endswith(".value")]
        for name in (*ANSWER_COLUMNS, *peaks, *values):
            if any(value is not None for value in self.columns.get(name, ())):
                return name
        why = "no column is the answer; choose one with -y (--list shows all)" if "ok" in self.columns["status"] else (
            "no run has an answer yet")  # fmt: skip
        raise UsageError(f"{self.folder / CSV}: {why}")

    def ranked(self) -> list[str]:
        """Return the swept keys with more than one value: numbers before text, most values first."""
        varied = [key for key in self.keys if len(distinct(self.columns[key])) > 1]
        return sorted(varied, key=lambda key: (not numeric(self.columns[key]), -len(distinct(self.columns[key]))))


def is_sweep(folder: Path) -> bool:
    """Test whether a folder contains a sweep."""
    return (folder / CSV).is_file() or (folder / FACTS).is_file()


def read_sweep(folder: Path) -> SweepTable:
    """Read the table of a sweep. Raises UsageError, and DamagedResults for a damaged one."""
    try:
        facts = read_facts(folder)
        names, *rows = list(csv.reader(io.StringIO(_text(folder, CSV), newline=""))) or [[]]
    except FileNotFoundError:
        raise UsageError(f"{folder}: no sweep.csv yet; `dem sweep` writes it, the same command goes on") from None
    except csv.Error as error:
        raise DamagedResults(f"{CSV} is no table ({error})", folder) from None
    names = list(map(text_of, names))
    short = next((i for i, row in enumerate(rows, 2) if len(row) != len(names)), None)
    if short is not None:
        raise DamagedResults(f"{CSV}: row {short} has {len(rows[short - 2])} cells, not {len(names)}", folder)
    for name in ("run", "status"):
        if name not in names:
            raise DamagedResults(f"{CSV}: the column '{name}' is missing", folder)
    if not rows:
        raise DamagedResults(f"{CSV} has no rows", folder)
    columns = {name: [value(row[i]) for row in rows] for i, name in enumerate(names)}
    columns["run"] = [row[names.index("run")] for row in rows]  # 1e5 may be a name
    if any(Path(run).name != run for run in columns["run"]):
        raise DamagedResults(f"{CSV}: the column 'run' holds what is no name of a run", folder)
    keys = facts.get("keys") or names[names.index("run") + 1 : names.index("status")]
    unknown_keys = [key for key in keys if key not in columns]
    if unknown_keys:
        raise DamagedResults(f"{CSV}: the column '{unknown_keys[0]}' is missing, which {FACTS} names", folder)
    return SweepTable(str(facts.get("title", "")), tuple(keys), columns, folder)


def read_facts(folder: Path) -> dict[str, Any]:
    """Read sweep.json; {} where there is none. Raises DamagedResults."""
    if not (folder / FACTS).exists():
        return {}
    try:
        facts = json.loads(_text(folder, FACTS))
    except (ValueError, RecursionError) as error:
        raise DamagedResults(f"{FACTS} is not valid JSON ({error})", folder) from None
    if not isinstance(facts, dict):
        raise DamagedResults(f"{FACTS} is not a table", folder)
    keys = facts.get("keys") or []
    if not isinstance(keys, list) or not all(isinstance(key, str) for key in keys):
        raise DamagedResults(f"{FACTS}: keys is not a list of words", folder)
    return facts


def _text(folder: Path, name: str) -> str:
    """Read the text of a file of a sweep. Raises DamagedResults, UsageError, and FileNotFoundError."""
    try:
        return read_bounded(folder / name, TABLE_BYTES).decode("utf-8")
    except FileNotFoundError:
        raise
    except UnicodeDecodeError as error:
        raise DamagedResults(f"{name} is not UTF-8 text (byte {error.start})", folder) from None
    except (OSError, UnreadableInput) as error:
        raise UsageError(f"{folder / name}: {getattr(error, 'strerror', None) or error}") from None


def value(text: str) -> Any:
    """Parse a cell of a sweep's table: a number, a truth value, text, or nothing."""
    if text in ("", "true", "false"):
        return {"": None, "true": True, "false": False}[text]
    try:
        return float(text)
    except ValueError:
        return text_of(text)


def numeric(values: Sequence[Any]) -> bool:
    """Test whether all given values are numbers or truth values."""
    return all(isinstance(v, (int, float)) for v in values if v is not None)


def distinct(values: Sequence[Any]) -> list[Any]:
    """Return the different given values: numbers sorted, text in order."""
    found = list(dict.fromkeys(v for v in values if v is not None))
    return sorted(found) if numeric(found) else found


def is_answer_in_words(values: Sequence[Any]) -> bool:
    """Test whether a column contains text or truth values."""
    return not numeric(values) or all(isinstance(v, bool) for v in values if v is not None)


def shown(v: Any) -> str:
    """Format a value for a legend."""
    if isinstance(v, bool):
        return "yes" if v else "no"
    return f"{v:.6g}" if isinstance(v, float) else "–" if v is None else str(v)
