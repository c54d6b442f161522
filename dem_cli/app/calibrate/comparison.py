"""Compare calibration trials with measured values: distances, and the closest trial."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from dem_cli.app.calibrate.table import Calibration
from dem_cli.app.calibrate.trials import CalibrationTrial
from dem_cli.results.output.csv_cells import cell

OK = "ok"


class TrialAnswer(NamedTuple):
    """Answer of one trial of a calibration."""

    status: str
    failure_load: float | None = None
    bracket: tuple[float | None, float | None] = (None, None)
    displacement: float | None = None  # of what was measured, at the highest load that was held [m]; ≥ 0
    seconds: float = 0.0
    warnings: tuple[str, ...] = ()


def distance(measured: Calibration, found: TrialAnswer) -> float | None:
    """Compute the distance to the measured point, relative to measured load and displacement; None without an
    answer.
    """
    if found.status != OK or found.failure_load is None or found.displacement is None:
        return None
    load = found.failure_load / measured.failure_load - 1.0
    return math.hypot(load, found.displacement / measured.displacement - 1.0)


def rows(
    measured: Calibration, trials: Sequence[CalibrationTrial], found: Sequence[TrialAnswer]
) -> list[dict[str, Any]]:
    """Create one row per trial, that of plane joints first; lengths in metres."""
    plane = found[0].failure_load if found[0].status == OK else None
    table = []
    for trial, one in zip(trials, found, strict=True):
        shape, load = trial.shape, one.failure_load if one.status == OK else None
        table.append(
            {
                "shape": shape and shape.name,
                "sides": shape and _plain(shape.number),
                "central": shape and _plain(shape.share_in_the_middle),
                "aperture": trial.aperture,
                "failure_load": load,
                "failure_load_bracket": list(one.bracket),
                "share_of_plane": load / plane if load is not None and plane else None,
                "displacement": one.displacement if one.status == OK else None,
                "distance": distance(measured, one),
                "status": one.status,
                "seconds": one.seconds,
                "warnings": list(one.warnings),
            }
        )
    return table


def closest(table: Sequence[dict[str, Any]]) -> int | None:
    """Return the number of the row nearest to the measured point; plane joints do not count."""
    answered = [i for i, row in enumerate(table) if row["shape"] is not None and row["distance"] is not None]
    return min(answered, key=lambda i: table[i]["distance"], default=None)


def as_csv(table: Sequence[dict[str, Any]]) -> str:
    """Format the rows as CSV with a header; empty where there is no number."""
    keys = [key for key in table[0] if key not in ("failure_load_bracket", "seconds", "warnings")]
    text = io.StringIO()
    writer = csv.DictWriter(text, keys, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    for row in table:
        writer.writerow({key: cell("-".join(map(str, v)) if isinstance(v, list) else v) for key, v in row.items()})
    return text.getvalue()


def as_text(summary: Mapping[str, Any]) -> list[str]:
    """Format the table of the thesis (Table 7-2): a line per profile, the closest one marked."""
    lines: list[tuple[str, ...]] = [
        ("shape", "sides", "middle side", "aperture [mm]", "load", "of plane", "displacement [mm]", "distance", "")
    ]
    lines += [_line(row, row == summary["closest"]) for row in summary["trials"]]
    measured, plane = summary["measured"], summary["trials"][0]["failure_load"]
    load, displacement = measured["failure_load"], measured["displacement"]
    lines.append(
        ("measured", "", "", "", _number(load, ".4f"), _number(load / plane if plane else None, ".3f"),
         _number(1e3 * displacement, ".4g"), "", "")
    )  # fmt: skip
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return ["  " + "  ".join(word.ljust(w) for word, w in zip(words, widths)).rstrip() for words in lines]


def _line(row: Mapping[str, Any], closest: bool) -> tuple[str, ...]:
    """Format one trial as cells of text."""
    shape, displacement = row["shape"], row["displacement"]
    return (
        shape or "plane",
        _range(row["sides"], 1.0, "d"),
        _range(row["central"], 100.0, ".3g", " %"),
        _range(row["aperture"], 1e3, ".4g"),
        _number(row["failure_load"], ".4f"),
        _number(row["share_of_plane"], ".3f"),
        _number(None if displacement is None else 1e3 * displacement, ".4g"),
        _number(row["distance"], ".3f") if shape else "",
        row["status"] if row["status"] != OK else "closest" if closest else "",
    )


def _number(value: float | None, form: str) -> str:
    return "–" if value is None else format(value, form)


def _range(value: Any, factor: float, form: str, unit: str = "") -> str:
    """Format a number or a range; empty for None."""
    if value is None:
        return ""
    ends = value if isinstance(value, list) else [value]
    return "–".join(format(end if form == "d" else factor * end, form) for end in ends) + unit


def _plain(limits: tuple[Any, Any] | None) -> Any:
    """Reduce a range of equal ends to one number."""
    if limits is None:
        return None
    return limits[0] if limits[0] == limits[1] else list(limits)
