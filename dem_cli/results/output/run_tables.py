"""Write fragility.csv and repeats.csv: one line per run, always in the same order and with every digit."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

from dem_cli.core.records.history_rows import RunRow
from dem_cli.results.output.csv_cells import cell

TABLES = {"fragility": "fragility.csv", "time-history": "repeats.csv"}  # kind of analysis -> file
RUN_COLUMNS = ("structure", "record", "intensity", "peak_acceleration", "collapsed", "collapse_time", "what")


def write_runs(path: Path, rows: Sequence[RunRow], monitors: Sequence[str]) -> None:
    """Write the run table: COLUMNS, then the peak of each monitor; empty where it is unknown or meaningless."""
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([*RUN_COLUMNS, *(cell(f"peak {name}") for name in monitors)])
        for row in rows:
            collapsed = "" if row.collapsed is None else int(row.collapsed)
            time = "" if row.time is None else row.time
            peaks = ["" if math.isnan(peak) else peak for peak in row.peaks]
            told = (row.structure, row.record, row.intensity, row.acceleration, collapsed, time, row.how, *peaks)
            table.writerow(map(cell, told))
