"""Draw joints.png: joint openings over their height (as in thesis Figure 7-72 and Table 7-7)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.results.output.joint_table import joints_of, steepness
from dem_cli.results.output.reader import Results
from dem_cli.results.post import style

STEEP = np.pi / 4  # to the horizontal: from there on a joint is a head joint
SEEN = 0.02  # of the widest joint: what is open by less is closed
SAME_HEIGHT = 1e-6  # of the size of the structure
GROUPS = (
    ("head joints", STEEP, np.pi, "s", style.STATE_COLOURS["open"]),
    ("bed joints", 0.0, STEEP, "o", style.THRUST),
)


def draw_joints(results: Results, path: Path) -> None:
    """Draw every open joint of the last frame, and their number at each height."""
    joints = joints_of(results)
    last, states, steep = results.frames[-1], joints.at(len(results.frames) - 1), steepness(joints)
    widths, heights = states.opening, joints.places.middles()[:, -1]
    widest = float(widths.max(initial=0.0))
    shown = widths > SEEN * widest
    factor, unit = style.length_unit(widest)
    with style.figure(path, figsize=(8.6, 4.4)) as figure:
        left, right = figure.subplots(1, 2, sharey=True, width_ratios=(2.2, 1.0))
        for label, low, high, marker, colour in GROUPS:
            here = shown & (steep >= low) & (steep < high)
            left.plot(factor * widths[here], heights[here], marker, ms=5, color=colour, alpha=0.7, label=label, lw=0)
        _draw_counts(right, heights[shown & (steep >= STEEP)], float(np.ptp(heights)) if len(heights) else 0.0)
        left.set(xlabel=f"mean opening [{unit}]", ylabel="height [m]", xlim=(0.0, None))
        right.set(xlabel=f"head joints > {factor * SEEN * widest:.2g} {unit}")
        far, unit = style.length_unit(last.displacement)
        left.set_title(f"last frame: moved {far * last.displacement:.3g} {unit}", fontsize=10, fontweight="normal")
        left.legend(loc="lower right")
        style.headline(figure, results.summary)


def _draw_counts(axis: Any, heights: np.ndarray, size: float) -> None:
    """Draw a bar for each height at which there are joints."""
    rounded = np.round(heights / (SAME_HEIGHT * size)) if size > 0.0 else heights
    levels, counts = np.unique(rounded, return_counts=True)
    levels = levels * SAME_HEIGHT * size
    thick = 0.6 * float(np.diff(levels).min(initial=size)) if len(levels) > 1 else 0.05 * size
    axis.barh(levels, counts, height=thick, color=style.STATE_COLOURS["open"], alpha=0.7)
    axis.locator_params(axis="x", integer=True)
