"""Axonometric views of structures in space: parallel projection from an azimuth and an elevation.

By default three quarters of the wide side are seen, from where the structure moves to and a little from above.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.errors import UsageError
from dem_cli.results.output.paraview.vertices import rest_vertices

AZIMUTH_ASIDE, ELEVATION = 32.0, 22.0  # degrees: from the middle of the wide side, and above the ground
_STILL = 1e-12  # of the size of the structure: who moves less does not move
_STRAIGHT = 0.05  # of the motion: a smaller one to a side is neglected


class Standpoint(NamedTuple):
    """Viewpoint requested by a user."""

    view: str | None = None  # "front" or "3d"; None: front in the plane, 3d in space
    azimuth: float | None = None  # in space, from x towards y [deg]; None: as it is best
    elevation: float | None = None  # in space, above the ground [deg]


AS_BEST = Standpoint()


class Axonometry(NamedTuple):
    """Axonometric view: unit vectors of the picture."""

    right: np.ndarray  # (3,)
    up: np.ndarray  # (3,)
    eye: np.ndarray  # from the structure to the reader, (3,)

    def placed(self, points: np.ndarray) -> np.ndarray:
        """Project points to picture coordinates: right, up, towards the viewer [m], (n, 3)."""
        return points @ np.stack(self).T

    def flat(self, points: np.ndarray) -> np.ndarray:
        """Project points in space to the picture plane [m], (n, 2)."""
        return points @ np.stack(self[:2]).T


def seen_from(azimuth: float, elevation: float) -> Axonometry:
    """Create the view from an azimuth in degrees from x towards y, and an elevation above the horizontal; z is
    upwards.
    """
    turn, rise = np.radians(azimuth), np.radians(elevation)
    eye = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    right = np.array([-np.sin(turn), np.cos(turn), 0.0])
    return Axonometry(right, np.cross(eye, right), eye)


def wide_side(model: Model) -> np.ndarray:
    """Return the direction of the wider side of the box around the movable blocks: x or y, unit, (2,)."""
    free = ~model.fixed if not model.fixed.all() else model.fixed
    extents = np.ptp(rest_vertices(model)[free[model.vertex_blocks], :2], axis=0)
    return np.eye(2)[int(extents[1] > extents[0])]


def looks_right(model: Model, view: Axonometry) -> float:
    """Return 1 where the visible wide side faces the right of the viewer, −1 where it faces the left."""
    along = wide_side(model)
    normal = np.array([-along[1], along[0], 0.0])
    return float(np.sign(normal @ view.eye) * np.sign(normal @ view.right) or -1.0)


def azimuth_of(model: Model, frame: Frame | None, aside: float = AZIMUTH_ASIDE) -> float:
    """Choose the azimuth in degrees that shows most: of the wide side, towards which the blocks move in this frame.

    aside: from the middle of that side [deg].
    """
    free = ~model.fixed if not model.fixed.all() else model.fixed
    along = wide_side(model)
    across = np.array([along[1], -along[0]])  # −y of a wall along x
    motion = np.zeros(2)
    if frame is not None:
        moved = (frame.positions - model.centroids)[free, :2]
        motion = moved.sum(axis=0) if np.abs(moved).max() > _STILL * np.ptp(model.centroids, axis=0).max() else motion
    least = -_STRAIGHT * np.linalg.norm(motion)
    sides = [vector if motion @ vector >= least else -vector for vector in (across, along)]
    turn = np.radians(aside)
    eye = np.cos(turn) * sides[0] + np.sin(turn) * sides[1]
    return float(np.degrees(np.arctan2(eye[1], eye[0])))


def axonometry(model: Model, frame: Frame | None, asked: Standpoint = AS_BEST) -> Axonometry:
    """Create the view of a structure in space; frame: whose motion should be seen best."""
    oblique, (_, azimuth, elevation) = asked.view != "front", asked
    if azimuth is None:
        azimuth = azimuth_of(model, frame, AZIMUTH_ASIDE if oblique else 0.0)
    if elevation is None:
        elevation = ELEVATION if oblique else 0.0
    return seen_from(azimuth, elevation)


def refuse_in_plane(asked: Standpoint) -> None:
    """Raise UsageError for an azimuth or an elevation of a structure in the plane."""
    if asked.azimuth is not None or asked.elevation is not None:
        raise UsageError("--azimuth and --elevation are for structures in space; this one lies in the plane")
