"""Webs of vaults over a bay: barrels that meet in its diagonal planes, one drawn, the others transformed.

The second barrel is the first one stretched by the ratio of the spans, so that webs meet in planes: corners of both
webs there are the same points. One eighth is drawn; the rest is its mirror images, exact to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.frusta import frustum
from dem_cli.core.geometry.polyhedron import Polyhedron, hull
from dem_cli.masonry.structures.vaults.profile import arch_of, symmetric_joints
from dem_cli.masonry.structures.vaults.table import Vault

EIGHT = 8  # corners of a piece between two joints and two heads
Place = Callable[[np.ndarray], np.ndarray]
SIDES = ("south", "north", "west", "east")
CORNERS = {"sw": (-1.0, -1.0), "se": (1.0, -1.0), "ne": (1.0, 1.0), "nw": (-1.0, 1.0)}


class Bay(NamedTuple):
    """Bay with the common dimensions of its webs; a web is drawn as the northern one of a square bay."""

    joints: np.ndarray  # of the profile [inner, outer], across and up, (voussoirs + 1, 2, 2)
    stretch: float  # of y against x
    half: float  # from the middle to the outer face, along x [m]


def bay_of(vault: Vault) -> Bay:
    """Create the bay of a groin or a cloister vault."""
    joints = symmetric_joints(arch_of(vault))
    joints[..., 1] += vault.piers.height if vault.piers else 0.0
    span = vault.span or 0.0
    return Bay(joints, (vault.length or span) / span, float(joints[-1, 1, 0]))


def placed(piece: np.ndarray, bay: Bay, side: str) -> Polyhedron:
    """Transform a piece of the northern web to another web; stones count from the west or from the south."""
    return solid(
        {
            "north": lambda: along_y(bay)(piece),
            "south": lambda: along_y(bay)(piece) * [1.0, -1.0, 1.0],
            "east": lambda: along_x(bay)(piece),
            "west": lambda: along_x(bay)(piece) * [-1.0, 1.0, 1.0],
        }[side]()
    )


def at_corners(piece: np.ndarray, bay: Bay) -> dict[str, tuple[Polyhedron, ...]]:
    """Create corner stones: a piece of the northern web with its mirror image in the adjacent one, by corner."""
    return {
        name: tuple(solid(turned(piece) * [x, y, 1.0]) for turned in (along_y(bay), along_x(bay)))
        for name, (x, y) in CORNERS.items()
    }


def along_y(bay: Bay) -> Place:
    """Return the transformation from the square bay to the northern web."""
    return lambda piece: piece * [1.0, bay.stretch, 1.0]


def along_x(bay: Bay) -> Place:
    """Return the transformation from the square bay to the eastern web."""
    return lambda piece: piece[:, [1, 0, 2]] * [1.0, bay.stretch, 1.0]


def solid(piece: np.ndarray) -> Polyhedron:
    """Create the polyhedron of a piece; a keystone of a groin vault has points within its edges."""
    return hull(piece) if len(piece) > EIGHT else frustum(*np.split(piece, 2))


def mirrored(parts: tuple[Polyhedron, ...], signs: tuple[float, float]) -> tuple[Polyhedron, ...]:
    """Mirror polyhedra from (+x, +y) to the corner of these signs; mirrored ones have their faces flipped."""
    flip = signs[0] * signs[1] < 0.0
    return tuple(
        Polyhedron(part.vertices * [*signs, 1.0], tuple(face[::-1] for face in part.faces) if flip else part.faces)
        for part in parts
    )
