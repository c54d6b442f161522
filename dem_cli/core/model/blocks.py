"""Blocks from a generator, with a name, a shape and a material, in their final place."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dem_cli.errors import KeyPath

PIECE = "/"  # between the name of a stone and that of each piece which it can crack into


@dataclass(frozen=True)
class Block:
    """Rigid block with name, shape and material.

    parts      convex pieces that move as one: in the plane (n, 2) arrays of corners [m], counter-clockwise; in space
               polyhedra
    course     number of the course that it is laid in, from 1 at the foot; 0: in none
    row        where a course has several blocks side by side across it, in which it is: the leaf of a wall, the side of
               a crown; empty: through all of them
    thickness  depth out of plane [m]; in space 1
    across     of a generated block, that is drawn in a plane: from where to where it goes square to that in space [m];
               None: half the thickness to either side
    mass       of the whole block [kg]; None: by the density of its material
    crack      of a piece of a stone that can crack: the joint between its pieces; empty: it is a whole stone
    path       where in the input it comes from, for error messages
    rank       place among the blocks of the input, in its order
    """

    id: str
    parts: tuple[Any, ...]  # of np.ndarray, or of Polyhedron
    material: str
    thickness: float = 1.0
    fixed: bool = False
    across: tuple[float, float] | None = None
    course: int = 0
    row: str = ""
    mass: float | None = None
    crack: str = ""
    path: KeyPath = field(default=(), compare=False)
    rank: int = field(default=0, compare=False)

    def with_fields(self, **fields: Any) -> Block:
        """Copy the block with other values of some fields, ten times as fast as `dataclasses.replace`."""
        copied = object.__new__(Block)
        copied.__dict__.update(self.__dict__, **fields)
        return copied

    @property
    def stone(self) -> str:
        """Name of the stone that the block is, or is a piece of."""
        return self.id.rpartition(PIECE)[0] if self.crack else self.id


def corners_of(part: Any) -> np.ndarray:
    """Corners of a convex piece [m], (n, 2) or (n, 3)."""
    return getattr(part, "vertices", part)
