"""The page of a sweep: a table of all runs to sort and filter, and a chart of any two of its columns."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from dem_cli.errors import UsageError
from dem_cli.output.store import CASE
from dem_cli.report.facts import BAD, GOOD, LOOK, Answer
from dem_cli.report.page import render

TABLE, FACTS, RUNS = "sweep.csv", "sweep.json", "runs"  # as dem_cli/sweep writes them
ANSWERS = (
    "failure_load", "safety_factor", "critical_value", "median", "collapsed", "collapse_time", "first_frequency",
    "failure_mode",
)  # fmt: skip
PAGES = ("report.html", "collapse.png", "render.png", "summary.json")  # what a run's link opens, the best first
OTHERS, MOST_LINES = "the other keys", 12
Cell = float | int | str | bool | None


def is_sweep(folder: Path) -> bool:
    """Whether a folder is that of a sweep."""
    return (folder / TABLE).is_file()


def page(folder: Path, place: Path) -> str:
    """HTML of the sweep in `folder`, for a file in `place`. Raises UsageError where its table cannot be read."""
    columns, rows = table(folder / TABLE)
    facts = _facts(folder / FACTS)
    swept = [key for key in facts.get("keys", ()) if key in columns]
    case = folder / CASE
    runs = {
        "columns": columns,
        "rows": rows,
        "swept": swept,
        "others": OTHERS,
        "main": main_columns(columns, rows, swept),
        "axes": axes(columns, rows, swept),
        "links": links(folder, place, columns, rows),
    }
    return render(
        {"runs": runs},
        title=str(facts.get("title", folder.resolve().name)),
        kind="Sweep",
        answer=answer(columns, rows),
        verdicts=[],
        warnings=[],
        rows=_summary(columns, rows, swept),
        checks=[],
        model=[],
        numbers=[],
        scene=None,
        charts=[],
        pictures=[],
        case=case.read_text(encoding="utf-8") if case.is_file() else "",
        provenance={},
        version=facts.get("version", "–"),
        runs=runs,
    )


def table(path: Path) -> tuple[list[str], list[list[Cell]]]:
    """Columns and rows of a CSV file, numbers as numbers, what is empty as None. Raises UsageError."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            columns, *rows = csv.reader(file)
    except (OSError, ValueError, csv.Error) as error:
        raise UsageError(f"{path}: not a table of dem sweep ({error})") from None
    return columns, [[cell(text) for text in row] for row in rows]


def cell(text: str) -> Cell:
    """What a text of the table means."""
    if text in ("", "True", "False"):
        return None if text == "" else text == "True"
    for kind in (int, float):
        try:
            value = kind(text)
        except ValueError:
            continue
        return value if abs(value) < float("inf") else text
    return text


def column(columns: Sequence[str], rows: Sequence[Sequence[Cell]], name: str) -> list[Cell]:
    """One column; nothing but None where there is none of that name."""
    return [row[columns.index(name)] for row in rows] if name in columns else [None] * len(rows)


def numbers(values: Sequence[Cell]) -> list[float]:
    """Those of them that are numbers."""
    return [value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)]


def main_columns(columns: Sequence[str], rows: Sequence[Sequence[Cell]], swept: Sequence[str]) -> list[str]:
    """What the table shows at first: what differs and what was found."""
    reasons = ["reason"] if any(column(columns, rows, "reason")) else []
    found = [name for name in columns if name in ANSWERS or name.startswith(("peaks.", "failure_load_bracket"))]
    found.sort(key=lambda name: name not in ANSWERS)
    return ["run", *swept, "status", *reasons, *found]


def axes(columns: Sequence[str], rows: Sequence[Sequence[Cell]], swept: Sequence[str]) -> dict[str, str | None]:
    """The chart at first: the answer over the swept number with most values, a line for each value of another."""
    counts = {key: len(set(numbers(column(columns, rows, key)))) for key in swept}
    across = max(counts, key=lambda key: counts[key], default=None)
    others = [key for key in swept if key != across and len(set(map(str, column(columns, rows, key)))) > 1]
    lines = len(set(zip(*(map(str, column(columns, rows, key)) for key in others))))
    family = OTHERS if len(others) > 1 and lines <= MOST_LINES else others[0] if others else None
    answers = [*(name for name in ANSWERS if name in columns), *(name for name in columns if name.startswith("peaks."))]
    up = next((name for name in answers if numbers(column(columns, rows, name))), None)
    if up is None:
        up = next((name for name in columns if name not in swept and numbers(column(columns, rows, name))), None)
    return {"x": across, "y": up, "family": family}


def answer(columns: Sequence[str], rows: Sequence[Sequence[Cell]]) -> Answer:
    """How many runs there are and what they found."""
    states = [str(state) for state in column(columns, rows, "status")]
    solved, waiting = states.count("ok"), states.count("waiting")
    other = len(states) - solved - waiting
    counts = {"solved": solved, "failed": other, "to do": waiting}
    more = [f"{count:,} {name}" for name, count in counts.items() if count or name == "solved"]
    for name in ANSWERS:
        found = numbers(column(columns, rows, name))
        if found:
            more.append(f"{name.replace('_', ' ')} {min(found):.4g} to {max(found):.4g}")
    return Answer("sweep of", f"{len(rows):,} runs", ", ".join(more), BAD if other else LOOK if waiting else GOOD)


def _summary(columns: Sequence[str], rows: Sequence[Sequence[Cell]], swept: Sequence[str]) -> list[tuple[str, str]]:
    """The swept keys with their values."""
    lines = []
    for key in swept:
        values = list(dict.fromkeys(column(columns, rows, key)))
        ranged = numbers(values)
        text = ", ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in values[:12])
        if len(values) > 12:
            text = f"{len(values)} values" + (f", {min(ranged):g} to {max(ranged):g}" if ranged else "")
        lines.append((key, text))
    modes = [str(mode) for mode in column(columns, rows, "failure_mode") if mode is not None]
    if modes:
        lines.append(("failure modes", ", ".join(f"{mode} {modes.count(mode):,}" for mode in sorted(set(modes)))))
    return lines


def links(folder: Path, place: Path, columns: Sequence[str], rows: Sequence[Sequence[Cell]]) -> dict[str, str]:
    """Of each run the best file to open, seen from `place`."""
    found, base = {}, Path(os.path.relpath(folder, place)).as_posix()
    for run in column(columns, rows, "run"):
        name = next((name for name in PAGES if (folder / RUNS / str(run) / name).is_file()), None)
        if run is not None and name:
            found[str(run)] = quote(f"{base}/{RUNS}/{run}/{name}")
    return found


def _facts(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise UsageError(f"{path}: not valid JSON ({error})") from None
    return found if isinstance(found, dict) else {}
