"""Colours of rendered blocks by displacement, velocity or rotation, and the legend of joints and forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.geometry.rotation import angles_of
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.errors import UsageError
from dem_cli.results.output.reader import Results
from dem_cli.results.post import frame_measures, style
from dem_cli.results.render.sheet import ColourBar

_MAP, _FROM, _TO = "YlGnBu", 0.03, 0.8  # light where nothing happens; not so dark that edges get lost


def colours(
    results: Results, frames: Sequence[Frame], quantity: str
) -> tuple[list[np.ndarray] | None, ColourBar | None]:
    """Return the colours of the blocks in every frame, (n_blocks, 3) each, and their scale; None of either for stone.

    Fixed blocks stay the colour of the ground. Raises UsageError for velocities that are not per second.
    """
    if quantity == "stone":
        return None, None
    if quantity == "velocity" and not kind_of(results.kind).timed:
        raise UsageError("--colour velocity: only time histories have velocities in metres per second")
    import matplotlib
    from matplotlib.colors import ListedColormap, to_rgb

    model = results.model
    rows = [block_values(model, frame, quantity) for frame in frames]
    highest = max(float(row[~model.fixed].max(initial=0.0)) for row in rows)
    factor, label = _label(quantity, highest, kind_of(results.kind).timed)
    shades = ListedColormap(matplotlib.colormaps[_MAP](np.linspace(_FROM, _TO, 256)))
    ground = model.fixed[:, np.newaxis]
    drawn = [np.where(ground, to_rgb(style.GROUND), shades(row / (highest or 1.0))[:, :3]) for row in rows]
    return drawn, ColourBar(label, 0.0, factor * highest or 1.0, shades)


def block_values(model: Model, frame: Frame, quantity: str) -> np.ndarray:
    """Compute displacement or velocity of each centroid [m, m/s], or rotation of each block [deg], (n_blocks,)."""
    d = model.dimension
    if quantity == "displacement":
        return np.linalg.norm(frame.positions - model.centroids, axis=1)
    if quantity == "velocity":
        return np.linalg.norm(frame.velocities[:, :d], axis=1)
    return np.degrees(np.abs(angles_of(frame.orientations)))


def _label(quantity: str, highest: float, shaken: bool) -> tuple[float, str]:
    if quantity == "rotation":
        return 1.0, "rotation of the block [deg]"
    base = " relative to the base" if shaken else " of the block"
    factor, unit = style.length_unit(highest)
    return factor, f"{quantity}{base} [{unit if quantity == 'displacement' else f'{unit}/s'}]"


def legend(results: Results, frames: Sequence[Frame], joints: bool, forces: str | None) -> list[Any]:
    """Return matplotlib handles for the colours of joints and the strokes of forces."""
    from matplotlib.lines import Line2D

    found = []
    if joints:
        found = [
            Line2D([], [], color=style.STATE_COLOURS[name], lw=4, label=label)
            for name, label in (("sliding", "sliding joint"), ("open", "open joint (thin: hairline)"))
        ]
        found.append(Line2D([], [], color="#57503f", lw=1, label="closed joint"))
    if forces:
        totals = [frame_measures.resultants(frame.contacts).forces for frame in frames]
        largest = max((float(np.linalg.norm(row, axis=1).max()) for row in totals if len(row)), default=0.0)
        alone = len(frames) == 1
        size = f"{'longest' if forces == 'arrows' else 'thickest'} {newtons(largest)}" if alone else "relative size"
        found.append(Line2D([], [], color=style.THRUST, lw=3.5, label=f"joint force ({size})"))
    return found


def legend_of_links(frames: Sequence[Frame]) -> list[Any]:
    """Return matplotlib handles of ties and bars, if any; five in a row leave no room for the scale of forces."""
    from matplotlib.lines import Line2D

    if all(frame.links is None for frame in frames):
        return []
    return [Line2D([], [], color=style.STEEL, lw=3.5, label="tie or bar")]


def newtons(force: float) -> str:
    """Format a force with a readable unit: 12300 -> "12.3 kN"."""
    factor, unit = next(((f, u) for f, u in ((1e6, "MN"), (1e3, "kN")) if force >= f), (1.0, "N"))
    return f"{force / factor:.3g} {unit}"
