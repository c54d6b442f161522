"""View of a rendered structure by its dimension: viewpoint and light."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.results.post.scene.axonometry import Axonometry, Standpoint, axonometry, looks_right, refuse_in_plane

_PLANE = Axonometry(*np.eye(3))  # y is upwards
_DIRECTIONS = {"front": (0.0, 0.0, 1.0), "3d": (-0.42, 0.34, 1.0)}  # in the plane: from the structure to the eye


class RenderedView(NamedTuple):
    """Rendered view with its direction of light."""

    axes: Axonometry
    before: Axonometry  # of a reader who stands before the structure: light comes from where it would for them
    deep: bool  # oblique: with shades in corners


def view_of(model: Model, frames: Sequence[Frame], asked: Standpoint) -> RenderedView:
    """Create the view for the options. Raises UsageError where a planar structure is given an azimuth or elevation."""
    return _VIEWS[model.dimension](model, frames, asked)


def _in_plane(model: Model, frames: Sequence[Frame], asked: Standpoint) -> RenderedView:
    refuse_in_plane(asked)
    name = asked.view or "front"
    eye = np.array(_DIRECTIONS[name])
    eye /= np.linalg.norm(eye)
    right = np.cross(_PLANE.up, eye)
    right /= np.linalg.norm(right)
    return RenderedView(Axonometry(right, np.cross(eye, right), eye), _PLANE, name != "front")


def _in_space(model: Model, frames: Sequence[Frame], asked: Standpoint) -> RenderedView:
    farthest = max(frames, key=lambda frame: frame.displacement)
    axes = axonometry(model, farthest, asked)
    ahead = axes.eye + np.cross(axes.right, (0.0, 0.0, 1.0))  # half as high as the reader: tops and sides are lit
    ahead /= np.linalg.norm(ahead)
    left = (
        -looks_right(model, axes) * axes.right
    )  # light comes from the left of a reader: from where the wide side looks
    return RenderedView(axes, Axonometry(left, np.cross(ahead, axes.right), ahead), True)


_VIEWS: dict[int, Callable[[Model, Sequence[Frame], Standpoint], RenderedView]] = {2: _in_plane, 3: _in_space}
