"""Notes to mistakes in the geometry: where in space, and how much of two blocks is in the same place."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dem_cli.case.wording import show
from dem_cli.core.geometry.convex import common
from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed

ROUND_OFF = 1e-9  # of a size: coordinates that are none
ALL = 0.999  # of a part: so much of it is all of it


class PlaceNotes(NamedTuple):
    """What is added to a message in one dimension."""

    place: Callable[[Model, int], str]  # where a block is
    overlap: Callable[[Model, np.ndarray], str]  # what two parts (2,) have in common, and where


def block_place(model: Model, block: int) -> str:
    """Where the centroid of a block is."""
    return f" at {rounded(model.centroids[block], model.shapes.radii[block])}"


def common_place(model: Model, parts: np.ndarray) -> str:
    """Volume that two overlapping parts have in common, and its middle; nothing where it is too thin to have any."""
    corners, topology = undeformed(model), model.topology
    normals = shapes_of(corners).normals(corners, topology)
    offsets = (corners[topology.face_corners[topology.face_starts[:-1]]] * normals).sum(axis=1)
    faces = np.isin(topology.face_parts, parts)
    found = common(normals[faces], offsets[faces])
    if found is None:
        return ""
    whole = " (all of it)" if found.volume >= ALL * model.parts.volumes[parts].min() else ""
    place = rounded(found.centroid, model.parts.sizes[parts].min())
    return f", {found.volume:.3g} m3{whole} around {place}"


def rounded(point: np.ndarray, size: float) -> str:
    """A point of something of that size [m] as people read it."""
    places = np.where(np.abs(point) > ROUND_OFF * size, point, 0.0)
    return show([float(f"{x:.4g}") for x in places])


NOTES = {
    2: PlaceNotes(lambda model, block: "", lambda model, parts: ""),
    3: PlaceNotes(block_place, common_place),
}
