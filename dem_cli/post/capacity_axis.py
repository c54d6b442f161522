"""Axis of a capacity curve: displacement of the live load where that is controlled or goes to and fro, else the largest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.output.reader import Results

LIVE, LARGEST = "displacement of the live load", "control displacement"


class CapacityAxis(NamedTuple):
    """Displacements that loads are drawn against."""

    values: np.ndarray  # of each row of the history [m]
    label: str
    failure: float | None  # displacement at failure, or at the peak [m]; None: not known

    @property
    def farthest(self) -> float:
        """Largest size [m]."""
        return float(np.abs(self.values).max(initial=0.0))

    @property
    def signed(self) -> bool:
        """Whether it is that of the live load, which has a sign."""
        return self.label == LIVE


def capacity_axis(results: Results) -> CapacityAxis:
    """What the loads of a run are drawn against."""
    history, summary = results.history, results.summary
    curve = summary.get("capacity_curve")
    if (curve or "turning_points" in summary) and "live_displacement" in history:
        return CapacityAxis(history["live_displacement"], LIVE, curve["peak_displacement"] if curve else None)
    values, given = history["displacement"], summary.get("displacement_at_failure")
    if given:
        return CapacityAxis(values, LARGEST, float(given))
    loading = values[history["stage"] == "loading"]
    return CapacityAxis(values, LARGEST, float(loading.max()) if len(loading) and loading.max() > 0 else None)


def of_frames(results: Results, axis: CapacityAxis, frames: Sequence[Mapping[str, Any]]) -> list[float]:
    """Displacement of frames on an axis [m]: of the row of their step and load. frames: as the view has them."""
    if not axis.signed:
        return [frame["displacement"] for frame in frames]
    steps, loads = results.history["step"], results.history["load"]
    top = float(np.abs(loads).max(initial=0.0)) or 1.0
    rows = [int(np.argmin(abs(steps - f["step"]) + abs(loads - f["load"]) / top)) for f in frames]
    return [float(axis.values[row]) for row in rows]
