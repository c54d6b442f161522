"""Draw the pictures of a run from its results."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.errors import UsageError
from dem_cli.interrupts import look
from dem_cli.results.output.reader import Results, read
from dem_cli.results.post.capacity import draw_capacity
from dem_cli.results.post.collapse import draw_collapse
from dem_cli.results.post.energy import draw_energy
from dem_cli.results.post.fragility import draw_fragility, has_curve
from dem_cli.results.post.histories import draw_histories
from dem_cli.results.post.joints import draw_joints
from dem_cli.results.post.modes import draw_modes, shapes
from dem_cli.results.post.safety import draw_safety, has_runs
from dem_cli.results.post.scene.axonometry import AS_BEST, Standpoint

PICTURES: dict[str, Callable[..., None]] = {  # of results, into a file; some from a standpoint
    "capacity.png": draw_capacity,
    "histories.png": draw_histories,
    "modes.png": draw_modes,
    "fragility.png": draw_fragility,
    "safety.png": draw_safety,
    "collapse.png": draw_collapse,
    "energy.png": draw_energy,
}
SEEN_FROM = frozenset(("modes.png", "collapse.png"))  # those that show the structure
ANIMATION = "collapse.gif"
JOINTS = "joints.png"  # only on request


def draw_all(folder: Path, output: Path, animate: bool = False, asked: Standpoint = AS_BEST) -> list[Path]:
    """Draw every picture that the results in `folder` allow; returns the files written. An animation takes longer.

    Raises KeyboardInterrupt between two.
    """
    results = read(folder)
    written = []
    for name, draw in PICTURES.items():
        if has_data(name, results):
            look()
            draw(results, output / name, *([asked] if name in SEEN_FROM else []))
            written.append(output / name)
    if animate:
        from dem_cli.results.post.animation import draw_animation

        draw_animation(results, output / ANIMATION, asked)
        written.append(output / ANIMATION)
    return written


def draw_one(folder: Path, name: str, path: Path, asked: Standpoint = AS_BEST) -> None:
    """Draw one picture into a file of any matplotlib format. Raises UsageError where it has no data."""
    results = read(folder)
    if name == JOINTS:
        draw_joints(results, path)
        return
    if not has_data(name, results):
        raise UsageError(f"{folder}: nothing to draw for {name.removesuffix('.png')} in a run of kind {results.kind!r}")
    PICTURES[name](results, path, *([asked] if name in SEEN_FROM else []))


def has_data(name: str, results: Results) -> bool:
    """Test whether the results have data for a picture; a capacity curve needs a load that changes."""
    no_rows = np.zeros(0)
    if name == "fragility.png":
        return has_curve(results)
    if name == "modes.png":
        return bool(shapes(results))
    if name == "safety.png":
        return has_runs(results)
    if results.kind == "modes":  # the way into gravity is no result
        return False
    if name == "collapse.png":
        return len(results.frames) > 0
    if name == "histories.png":
        return results.series is not None and len(results.series.time) > 0
    if results.kind == "safety":  # its rows are those of two structures
        return False
    if name == "capacity.png":
        return not kind_of(results.kind).timed and bool((results.history.get("load", no_rows) != 0.0).any())
    return len(results.history.get("load", no_rows)) > 0
