"""Bearing of a floor on the walls of its room: edges of the plate or beams, pockets in the walls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry.rotation import cross
from dem_cli.masonry.structures.building.elevation import SMALL, Pocket
from dem_cli.masonry.structures.building.plan import Plan, overlap
from dem_cli.masonry.structures.building.rooms import Room, RoomSide
from dem_cli.masonry.structures.building.table import Building, Floor

THINNEST = 0.25  # of a wall: what is left of it beside a floor


class Slab(NamedTuple):
    """Plate or beam of a floor."""

    name: str
    outline: np.ndarray  # in plan, convex, counter-clockwise [m], (n, 2)
    low: float
    high: float
    material: str
    mass: float | None  # [kg]


class Floors(NamedTuple):
    """All floors of a building with the pockets that they need."""

    slabs: list[Slab]
    pockets: dict[int, list[Pocket]]  # of each wall


class Bed(NamedTuple):
    """Floor with the room, walls and bearing lengths that determine its place."""

    building: Building
    plan: Plan
    floor: Floor
    number: int
    room: Room
    bearing: dict[int, float]  # wall -> how far it reaches into it [m]
    low: float
    high: float
    courses: range  # that it interrupts

    def wall(self, side: RoomSide) -> int:
        """Return the bearing wall of a side of the room."""
        assert side.wall is not None
        return side.wall

    def wall_under(self, outline: np.ndarray, bears_on: Sequence[int]) -> int | None:
        """Find a non-bearing wall that a plate or beam would overlap; None: there is none."""
        for wall, axis in enumerate(self.plan.axes):
            table = self.building.walls[wall]
            top = float(self.building.levels[table.courses or self.building.courses])
            high = top + (table.gable.height if table.gable is not None else 0.0)
            reaches = wall not in bears_on and high > self.low + SMALL * self.building.block[1]
            if reaches and overlap(outline, axis.corners(), SMALL * self.building.block[0]):
                return wall
        return None

    def name(self, *more: int) -> str:
        """Return the name of a plate, or of a numbered beam."""
        return "-".join([self.floor.id, *map(str, more)])


def crossings(lines: Sequence[tuple[np.ndarray, float]]) -> np.ndarray:
    """Intersect consecutive lines (unit normal, distance from the origin) around a polygon [m], (n, 2)."""
    found = []
    for (n, a), (m, b) in zip([lines[-1], *lines[:-1]], lines, strict=True):
        found.append(np.array([a * m[1] - b * n[1], b * n[0] - a * m[0]]) / float(cross(n, m)))
    return np.array(found)


def edge_line(bed: Bed, side: RoomSide, gap: float) -> tuple[np.ndarray, float]:
    """Return the line of the edge of a plate along a side of its room."""
    away = 0.0
    if side.wall is not None:
        inner = 0.5 * bed.plan.axes[side.wall].thickness
        away = inner - bed.bearing[side.wall] if side.wall in bed.bearing else inner + gap
    return side.inwards, float(product(side.inwards, side.start)) + away


def in_wall(bed: Bed, side: RoomSide, ends: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return the corners of a bearing in a wall, (4, 2), between its ends and the edges to the other sides."""
    ways = others - ends
    depths = bed.bearing[bed.wall(side)] / product(ways, side.inwards)
    return np.concatenate([ends, ends + ways * np.minimum(depths, 1.0)[:, None]])


def cut_pockets(found: Floors, bed: Bed, side: RoomSide, outline: np.ndarray) -> None:
    """Cut a pocket in the wall of a side, in all courses beside the floor."""
    wall = bed.wall(side)
    axis = bed.plan.axes[wall]
    right, left = axis.faces.tolist()
    bearing = bed.bearing[wall]
    inside = product(side.along, axis.along) > 0.0  # the room lies to the left of the wall
    across = (right, left - bearing) if inside else (right + bearing, left)
    if across[1] - across[0] <= SMALL * axis.thickness:
        across = (0.0, 0.0)
    elif across[1] - across[0] < THINNEST * axis.thickness * (1.0 - SMALL):
        message = f"{bearing:g} leaves {across[1] - across[0]:.3g} m of '{axis.name}'; "
        message += f"must be {axis.thickness:g}, all of it, or at most {(1.0 - THINNEST) * axis.thickness:g}"
        raise KeyProblem(message, "floors", bed.number, "bearing")
    places = axis.local(outline)[:, 0]
    found.pockets.setdefault(wall, []).extend(
        Pocket(float(places.min()), float(places.max()), k, across) for k in bed.courses
    )
