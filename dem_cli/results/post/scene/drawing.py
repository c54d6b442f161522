"""Drawing of a structure by its dimension: what pictures ask for, in the plane and in space alike."""

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
    """The structure in a picture of matplotlib."""

    legend: tuple[str, ...]
    lights: tuple[float, ...]
    force_width: float

    def flat(self, points: np.ndarray) -> np.ndarray:
        """Where points (n, d) are in the picture [m], (n, 2)."""

    def window(self, corners: Sequence[np.ndarray], low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part of the picture that shows these corners as far as they are in a box [m], (d,)."""

    def draw_blocks(self, axis: Any, low: np.ndarray, high: np.ndarray) -> Callable[[np.ndarray], None]:
        """The blocks in a window; returns what puts their corners (n_vertices, d) in place."""

    def draw_supports(self, axis: Any, colour: str) -> None:
        """Hatches over blocks that cannot move, where they stood at the start."""

    def draw_rest(self, axis: Any, low: np.ndarray, high: np.ndarray) -> None:
        """Outlines of the start."""

    def draw_joints(self, axis: Any, frame: Frame, hairline: float) -> None:
        """Joints by state, over blocks that are in place."""

    def draw_links(self, axis: Any, frame: Frame) -> None:
        """Ties and bars as lines over the blocks, as dark as the force in them."""

    def finish(self, axis: Any) -> None:
        """Directions of the axes where they are not plain, over a picture whose limits are set."""


def _in_plane(model: Model, frame: Frame | None, asked: Standpoint) -> Drawing:
    refuse_in_plane(asked)
    return PlaneDrawing(model)


def _in_space(model: Model, frame: Frame | None, asked: Standpoint) -> Drawing:
    return SpaceDrawing(model, axonometry(model, frame, asked))


DRAWINGS: dict[int, Callable[[Model, Frame | None, Standpoint], Drawing]] = {2: _in_plane, 3: _in_space}


def drawing_of(model: Model, frame: Frame | None, asked: Standpoint = AS_BEST) -> Drawing:
    """frame: whose motion the reader should see best. Raises UsageError for a standpoint that there is not."""
    return DRAWINGS[model.dimension](model, frame, asked)
