"""Table of a sweep: one row per run, in the order of the plan, exact and without time of day.

The same runs give the same bytes, however often they were interrupted and wherever they ran.
"""

from __future__ import annotations

import csv
import sqlite3
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dem_cli.app.sweep.plan import show_value
from dem_cli.app.sweep.run import FAILED, WAITING, PlannedSweep, Summary
from dem_cli.results.output.atomic_file import whole
from dem_cli.results.output.csv_cells import cell
from dem_cli.results.output.scalars import plain
from dem_cli.results.output.sweep_files import CSV, IDENTITY_COLUMNS, SQLITE

ELSEWHERE = frozenset(("title", "version", "kind", "status", "reason", "traceback", "skipped", "search", "threads",
                       "runs_done_before"))  # fmt: skip
Row = dict[str, Any]


def rows(sweep: PlannedSweep, known: Mapping[str, Summary]) -> list[Row]:
    """Create a row per run: `run`, the swept keys, `status`, `reason`, then numbers and text of the summary."""
    found = []
    for number, (run, job) in enumerate(zip(sweep.plan.runs, sweep.jobs, strict=True)):
        if job is None:
            summary: Summary = {"status": FAILED, "reason": sweep.reasons[number]}
        else:
            summary = known.get(job.id, {"status": WAITING})
        status, _, why = str(summary["status"]).partition(": ")
        values = sweep.base | run.values
        row = {"run": job.id if job else "", **{key: values.get(key) for key in sweep.plan.keys}}
        row |= {"status": status, "reason": summary.get("reason") or why or _gave_up(summary)}
        row |= {key: value for key, value in answers(summary).items() if key not in row}
        for key in ("reason", "warnings"):  # the same in every place where the case lies
            if job is not None:
                row[key] = str(row.get(key, "")).replace(job.path, Path(job.path).name)
        found.append(row)
    return found


def _gave_up(summary: Summary) -> str:
    """Return the reason why a run did not converge, the last of its warnings."""
    warnings = summary.get("warnings")
    if not isinstance(warnings, list) or not warnings:
        return ""
    return str(warnings[-1]) if str(summary["status"]).startswith("not converged") else ""


def answers(summary: Summary) -> Row:
    """Flatten a summary to numbers and text by path, pairs of numbers as two; no lists but `warnings`, no times."""
    found: Row = {}

    def walk(path: str, value: Any) -> None:
        if isinstance(value, Mapping):
            for key, item in value.items():
                if path or key not in ELSEWHERE:
                    walk(f"{path}.{key}" if path else str(key), item)
        elif path.endswith("seconds"):
            return
        elif isinstance(value, list):
            if len(value) == 2 and all(isinstance(item, (int, float)) for item in value):
                found.update({f"{path}.{i}": item for i, item in enumerate(value)})
            elif path == "warnings":
                found[path] = " | ".join(map(str, value))
        else:
            found[path] = value

    walk("", plain(summary))
    return found


def columns(table: Sequence[Row], keys: Sequence[str]) -> list[str]:
    """Return every column, in the order of first appearance."""
    wanted = dict.fromkeys(["run", *keys, *IDENTITY_COLUMNS[1:]])
    for row in table:
        wanted |= dict.fromkeys(row)
    return list(wanted)


def write(folder: Path, table: Sequence[Row], keys: Sequence[str]) -> None:
    """Write sweep.csv and sweep.sqlite (table `runs`), each atomically. Raises OutputError."""
    names = columns(table, keys)
    write_csv(folder, table, names)
    with whole(folder / SQLITE) as part:
        _write_sqlite(part, table, names)


def write_csv(folder: Path, table: Sequence[Row], names: Sequence[str]) -> None:
    """Write only sweep.csv, while runs go on."""
    with whole(folder / CSV) as part, part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(map(cell, names))
        writer.writerows([_cell(row.get(name)) for name in names] for row in table)


def _cell(value: Any) -> Any:
    if value is None or isinstance(value, str):
        return cell(value or "")
    return repr(value) if isinstance(value, float) else show_value(value)


def _write_sqlite(path: Path, table: Sequence[Row], names: Sequence[str]) -> None:
    quoted = ['"' + name.replace('"', '""') + '"' for name in _different(names)]
    path.unlink(missing_ok=True)
    with sqlite3.connect(path) as base:
        base.execute(f"CREATE TABLE runs ({', '.join(quoted)})")
        base.executemany(
            f"INSERT INTO runs VALUES ({', '.join('?' * len(names))})",
            ([_stored(row.get(name)) for name in names] for row in table),
        )
    base.close()


def _different(names: Sequence[str]) -> list[str]:
    """Make column names unique for SQLite, which takes "Top" and "top" for one column."""
    seen: dict[str, int] = {}
    found = []
    for name in names:
        count = seen[name.lower()] = seen.get(name.lower(), 0) + 1
        found.append(name if count == 1 else f"{name} ({count})")
    return found


def _stored(value: Any) -> Any:
    return value if value is None or isinstance(value, (int, float, str)) else show_value(value)
