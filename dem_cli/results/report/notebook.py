"""Show results in a notebook: the answer of a run and its collapse as a player, in a frame below the cell."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from dem_cli.analysis_kinds import kind_of
from dem_cli.results.output.reader import Results
from dem_cli.results.report.facts import answer
from dem_cli.results.report.page import render
from dem_cli.results.report.view import view

MOST_BYTES = 2_000_000  # of all frames: a notebook keeps what it shows, once for each cell
HEIGHT = 640  # pixels, where the page cannot say how high it is


def cell(results: Results, summary: Mapping[str, Any], readable: bool) -> str:
    """Create the HTML of a frame that loads nothing. readable: whether frames can still be read."""
    scene = view(results, MOST_BYTES) if readable else None
    text = render(
        {"view": scene, "charts": []},
        brief=True,
        title=str(summary.get("title") or "A run that was stopped"),
        kind=kind_of(results.kind).title,
        answer=answer(summary),
        verdicts=[],
        warnings=[str(text) for text in summary.get("warnings") or ()],
        rows=[],
        checks=[],
        model=[],
        numbers=[],
        scene=scene,
        charts=[],
        pictures=[],
        case="",
        version=summary.get("version", "–"),
        runs=None,
    )
    height = HEIGHT if scene else HEIGHT // 3
    return f'<iframe srcdoc="{escape(text)}" width="100%" height="{height}" style="border: 0"></iframe>'
