"""Drawing interface of a structure, the same in two and three dimensions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.results.post.scene.axonometry import AS_BEST, Standpoint, axonometry, refuse_in_plane
from dem_cli.results.post.scene.plane_drawing import PlaneDrawing
from dem_cli.results.post.scene.space_drawing import SpaceDrawing


class Drawing(Protocol):
    """Drawing of a structure with matplotlib."""

    legend: tuple[str, ...]
    lights: tuple[float, ...]
    force_width: float

    def flat(self, points: np.ndarray) -> np.ndarray:
        """Project points (n, d) to the picture plane [m], (n, 2)."""

    def window(self, corners: Sequence[np.ndarray], low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the limits of the picture that show these corners as far as they are in a box [m], (d,)."""

    def draw_blocks(self, axis: Any, low: np.ndarray, high: np.ndarray) -> Callable[[np.ndarray], None]:
        """Draw the blocks in a window; returns a function that moves their corners (n_vertices, d)."""

    def draw_supports(self, axis: Any, colour: str) -> None:
        """Draw hatches over fixed blocks, in their initial places."""

    def draw_rest(self, axis: Any, low: np.ndarray, high: np.ndarray) -> None:
        """Draw outlines of the initial geometry."""

    def draw_joints(self, axis: Any, frame: Frame, hairline: float) -> None:
        """Draw joints by state, over the displaced blocks."""

    def draw_links(self, axis: Any, frame: Frame) -> None:
        """Draw ties and bars as lines over the blocks, as dark as their force."""

    def finish(self, axis: Any) -> None:
        """Draw the directions of the axes where needed, over a picture whose limits are set."""


def _in_plane(model: Model, frame: Frame | None, asked: Standpoint) -> Drawing:
    refuse_in_plane(asked)
    return PlaneDrawing(model)


def _in_space(model: Model, frame: Frame | None, asked: Standpoint) -> Drawing:
    return SpaceDrawing(model, axonometry(model, frame, asked))


DRAWINGS: dict[int, Callable[[Model, Frame | None, Standpoint], Drawing]] = {2: _in_plane, 3: _in_space}


def drawing_of(model: Model, frame: Frame | None, asked: Standpoint = AS_BEST) -> Drawing:
    """Create the drawing for a dimension; frame: whose motion should be seen best. Raises UsageError."""
    return DRAWINGS[model.dimension](model, frame, asked)
