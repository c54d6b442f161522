"""Create the report page of a sweep: a sortable table of all runs, and a chart of any two of its columns."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from urllib.parse import quote

from dem_cli.errors import UsageError
from dem_cli.results.output.store import CASE
from dem_cli.results.output.sweep_files import RUNS
from dem_cli.results.post.sweep_table import ANSWER_COLUMNS, SweepTable, distinct, read_facts, read_sweep, shown
from dem_cli.results.report.facts import BAD, GOOD, LOOK, Headline
from dem_cli.results.report.page import case_text, render

OTHERS, MOST_LINES = "the other keys", 12  # of the chart at first
MOST_VALUES = 12  # of a key that are listed
RUN_PAGES = ("report.html", "collapse.png", "render.png", "summary.json")  # what a run's link opens, the best first


def page(folder: Path, place: Path) -> str:
    """Create the HTML of the sweep in `folder`, for a file in `place`. Raises UsageError where it cannot be read."""
    table = read_sweep(folder)
    runs = {
        "columns": list(table.columns),
        "rows": [list(row) for row in zip(*table.columns.values())],
        "swept": list(table.keys),
        "others": OTHERS,
        "main": main_columns(table),
        "axes": axes(table),
        "links": links(table, place),
    }
    return render(
        {"runs": runs},
        title=table.title or folder.resolve().name,
        kind="Sweep",
        answer=answer(table),
        verdicts=[],
        warnings=failures(table),
        rows=keys(table),
        checks=[],
        model=[],
        numbers=[],
        scene=None,
        charts=[],
        pictures=[],
        case=case_text(folder / CASE),
        provenance={},
        version=read_facts(folder).get("version", "–"),
        command="sweep",
        runs=runs,
    )


def main_columns(table: SweepTable) -> list[str]:
    """Return the columns that the table of a sweep shows at first: varying parameters, and answers."""
    reasons = ["reason"] if any(table.columns.get("reason", ())) else []
    modes = [name for name in ("failure_mode",) if name in table.columns]
    brackets = [name for name in table.columns if name.startswith(("peaks.", "failure_load_bracket"))]
    return [
        "run",
        *table.keys,
        "status",
        *reasons,
        *(n for n in ANSWER_COLUMNS if n in table.columns),
        *modes,
        *brackets,
    ]


def axes(table: SweepTable) -> dict[str, str | None]:
    """Choose the first chart: the answer over the swept number with most values, lines for the others."""
    ranked = table.ranked()
    across, others = ranked[0] if ranked else None, ranked[1:]
    lines = len(set(zip(*(table.columns[key] for key in others)))) if others else 1
    family = OTHERS if len(others) > 1 and lines <= MOST_LINES else others[-1] if others else None
    try:
        return {"x": across, "y": table.answer(), "family": family}
    except UsageError:  # no run has an answer yet
        return {"x": across, "y": None, "family": family}


def answer(table: SweepTable) -> Headline:
    """Return the headline of a sweep: numbers of runs and their answers."""
    states = [str(state) for state in table.columns["status"]]
    counts = {"solved": states.count("ok"), "to do": states.count("waiting")}
    counts["failed"] = len(states) - sum(counts.values())
    more = [f"{count:,} {name}" for name, count in counts.items() if count or name == "solved"]
    for name in ANSWER_COLUMNS:
        found = [value for value in table.columns.get(name, ()) if isinstance(value, float)]
        if found:
            more.append(f"{name.replace('_', ' ')} {min(found):.4g} to {max(found):.4g}")
    tone = BAD if not counts["solved"] else LOOK if counts["failed"] or counts["to do"] else GOOD
    return Headline("sweep of", f"{table.count:,} runs", ", ".join(more), tone)


def failures(table: SweepTable) -> list[str]:
    """List the reasons why runs failed, the most frequent first."""
    pairs = zip(table.columns["status"], table.columns.get("reason", [None] * table.count))
    found = Counter(str(reason or state) for state, reason in pairs if state not in ("ok", "waiting"))
    said = [f"{count:,} {'run' if count == 1 else 'runs'} failed: {reason}" for reason, count in found.most_common(5)]
    others = len(found) - len(said)
    return said + ([f"{others:,} other reasons stand in the table"] if others else [])


def keys(table: SweepTable) -> list[tuple[str, str]]:
    """List the swept keys with their values, and the frequency of each failure mode."""
    lines = []
    for key in table.keys:
        values = distinct(table.columns[key])
        text = ", ".join(map(shown, values))
        if len(values) > MOST_VALUES:
            text = f"{len(values)} values from {shown(values[0])} to {shown(values[-1])}"
        lines.append((key, text))
    modes = [str(mode) for mode in table.columns.get("failure_mode", ()) if mode is not None]
    if modes:
        lines.append(("failure modes", ", ".join(f"{mode} {modes.count(mode):,}" for mode in sorted(set(modes)))))
    return lines


def links(table: SweepTable, place: Path) -> dict[str, str]:
    """Return the best file to open of each run, seen from `place`."""
    found, base = {}, Path(os.path.relpath(table.folder / RUNS, place)).as_posix()
    for run in filter(None, table.columns["run"]):
        name = next((name for name in RUN_PAGES if (table.folder / RUNS / run / name).is_file()), None)
        if name:
            found[run] = quote(f"{base}/{run}/{name}")
    return found
