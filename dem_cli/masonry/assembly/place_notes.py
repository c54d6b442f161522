"""Describe where in space a geometry error is, and by how much two blocks overlap."""

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
    """Functions that add location and overlap to a geometry message, for one dimension."""

    place: Callable[[Model, int], str]  # where a block is
    overlap: Callable[[Model, np.ndarray], str]  # what two parts (2,) have in common, and where


def block_place(model: Model, block: int) -> str:
    """Describe the location of a block by its centroid, for a message."""
    return f" at {rounded(model.centroids[block], model.shapes.radii[block])}"


def common_place(model: Model, parts: np.ndarray) -> str:
    """Describe the volume and middle of the overlap of two parts; empty where it is too thin for a volume."""
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
    """Format a point of a structure of this size [m] with four digits."""
    places = np.where(np.abs(point) > ROUND_OFF * size, point, 0.0)
    return show([float(f"{x:.4g}") for x in places])


NOTES = {
    2: PlaceNotes(lambda model, block: "", lambda model, parts: ""),
    3: PlaceNotes(block_place, common_place),
}
