"""Create the report page of one run."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from dem_cli.analysis_kinds import kind_of
from dem_cli.errors import UsageError
from dem_cli.results.output.reader import Results, read
from dem_cli.results.output.store import CASE, RESULTS
from dem_cli.results.post.run_pictures import PICTURES, has_data
from dem_cli.results.report.charts import charts
from dem_cli.results.report.facts import all_numbers, answer, audit, model_rows
from dem_cli.results.report.page import case_text, render
from dem_cli.results.report.view import view

DRAWN_HERE = frozenset(("capacity.png", "histories.png", "energy.png", "fragility.png"))  # as charts, with more to see
_ALT = {"collapse.png": "The structure at failure and at the end", "modes.png": "Natural modes"}


class TerminalText(NamedTuple):
    """Summary of a run as the command line prints it."""

    rows: Sequence[tuple[str, str]]  # label and text of each line
    verdicts: Sequence[tuple[str, str]]  # of [reference]: "good" or "bad", and in words


def page(folder: Path, summary: Mapping[str, Any], said: TerminalText) -> str:
    """Create the HTML of the run in `folder`. Raises UsageError where it contains none."""
    results = read(folder) if (folder / RESULTS).is_file() else None
    if results is None and not summary:
        raise UsageError(f"{folder}: holds no results of dem run or dem sweep")
    case = results.case_text if results else case_text(folder / CASE)
    scene = view(results) if results else None
    drawn = charts(results, scene["frames"]) if results and scene else []
    return render(
        {"view": scene, "charts": drawn},
        title=str(summary.get("title") or folder.resolve().name),
        kind=kind_of(summary.get("kind")).title,
        answer=answer(summary),
        verdicts=said.verdicts,
        warnings=[str(text) for text in summary.get("warnings") or ()],
        rows=[row for row in said.rows if row[0] != "warning"],
        checks=audit(summary, results),
        model=model_rows(results.model, summary) if results else [],
        numbers=all_numbers(summary),
        scene=scene,
        charts=drawn,
        pictures=pictures(results) if results else [],
        case=case,
        provenance=results.provenance if results else {"dem": str(summary.get("version", "–"))},
        version=summary.get("version", "–"),
        command="limit" if summary.get("kind") == "limit" else "run",
        runs=None,
    )


def pictures(results: Results) -> list[dict[str, str]]:
    """Create still pictures that no chart replaces, as data addresses; none where matplotlib is missing."""
    found = []
    with tempfile.TemporaryDirectory() as place:
        for name, draw in PICTURES.items():
            if name in DRAWN_HERE or not has_data(name, results):
                continue
            path = Path(place) / name
            try:
                draw(results, path)
            except UsageError:  # no matplotlib: the view and the charts need none
                return []
            data = base64.b64encode(path.read_bytes()).decode("ascii")
            found.append({"source": f"data:image/png;base64,{data}", "alt": _ALT.get(name, Path(name).stem)})
    return found
