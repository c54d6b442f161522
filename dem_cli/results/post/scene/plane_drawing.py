"""Drawing of structures in the plane: polygons, initial outlines, joints by state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, Frame
from dem_cli.results.output.paraview.vertices import rest_vertices
from dem_cli.results.post import style
from dem_cli.results.post.scene.joint_strokes import strokes
from dem_cli.results.post.scene.link_lines import draw_lines


class PlaneDrawing:
    """Drawing of a structure in the plane."""

    legend: tuple[str, ...] = STATES  # of joints that are drawn
    force_width = 1.0
    lights: tuple[float, ...] = (1.0,)  # by which blocks are lighter or darker than their stone

    def __init__(self, model: Model):
        self.model = model

    def flat(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 2) unchanged [m]."""
        return points

    def window(self, corners: Sequence[np.ndarray], low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the limits of the picture, a part of the plane."""
        return low, high

    def draw_blocks(self, axis: Any, low: np.ndarray, high: np.ndarray) -> Callable[[np.ndarray], None]:
        """Draw the blocks, filled, fixed ones as ground; returns a function that moves their corners (n_vertices,
        2).
        """
        from matplotlib.collections import PolyCollection

        fixed = self.model.fixed[self.model.part_blocks]
        faces = [style.GROUND if f else style.STONE for f in fixed]
        blocks = PolyCollection([], facecolors=faces, edgecolors=style.STONE_EDGE, linewidths=0.6)
        axis.add_collection(blocks)
        return lambda corners: blocks.set_verts(self._polygons(corners))

    def draw_supports(self, axis: Any, colour: str) -> None:
        """Draw hatches over fixed blocks."""
        from matplotlib.collections import PolyCollection

        fixed = self.model.fixed[self.model.part_blocks]
        parts = [part for part, held in zip(self._polygons(rest_vertices(self.model)), fixed) if held]
        axis.add_collection(
            PolyCollection(parts, facecolors="none", edgecolors=colour, hatch="////", linewidths=0.0, zorder=1.5)
        )

    def draw_rest(self, axis: Any, low: np.ndarray, high: np.ndarray) -> None:
        """Draw the initial outlines of the blocks."""
        from matplotlib.collections import PolyCollection

        rest = self._polygons(rest_vertices(self.model))
        axis.add_collection(
            PolyCollection(rest, facecolors="none", edgecolors=style.REST, linewidths=0.7, linestyles=(0, (3, 2)))
        )

    def draw_joints(self, axis: Any, frame: Frame, hairline: float) -> None:
        """Colour each half of a joint by its contact point; open by less than `hairline` [m]: faint."""
        from matplotlib.collections import LineCollection

        contacts, found, width = frame.contacts, strokes(frame.contacts), joint_width(self.model)
        colours = [state_colour(int(contacts.state[i]), contacts.gap[i] < hairline) for i in found.points]
        lines = list(zip(found.starts, found.ends))
        axis.add_collection(LineCollection(lines, colors=colours, linewidths=width, capstyle="butt", zorder=3))
        _, owner, counts = np.unique(contacts.joint, return_inverse=True, return_counts=True)
        for i in np.flatnonzero(counts[owner] == 1):
            axis.plot(*contacts.points[i], "o", ms=1.4 * width, color=colours[i], zorder=3)

    def draw_links(self, axis: Any, frame: Frame) -> None:
        """Draw ties and bars over all blocks: lines as dark as their force."""
        draw_lines(axis, frame, self.flat)

    def finish(self, axis: Any) -> None:
        """Draw no axes: x is to the right and y upwards."""

    def _polygons(self, corners: np.ndarray) -> list[np.ndarray]:
        return [corners[a:b] for a, b in zip(self.model.part_starts, self.model.part_starts[1:])]


def joint_width(model: Model) -> float:
    """Return the width of the strokes of joints [points]."""
    return float(np.clip(32.0 / np.sqrt(model.n_blocks + 1), 0.6, 3.2))


def state_colour(state: int, hairline: bool) -> tuple[str, float]:
    """Return colour and opacity of a joint; open hairlines are faint."""
    name = STATES[state]
    return style.STATE_COLOURS[name], 0.3 if name == "open" and hairline else 1.0
