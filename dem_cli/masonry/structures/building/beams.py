"""Lay the beams of a floor: square to a wall, evenly spaced, clear of openings and of other walls."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.arithmetic.products import product
from dem_cli.masonry.structures.building.bed import Bed, Floors, Slab, crossings, cut_pockets, edge_line, in_wall
from dem_cli.masonry.structures.building.bond import SHORTEST
from dem_cli.masonry.structures.building.elevation import SMALL
from dem_cli.masonry.structures.building.rooms import RoomSide

OPPOSITE = 0.5  # cosine of the angle between two walls that beams may span at most
# Corners of a beam in the first wall and in the last one, each with those at the other end of the same edges.
BEAM_ENDS = (([1, 2], [0, 3]), ([3, 0], [2, 1]))


def lay_beams(found: Floors, bed: Bed) -> None:
    """Lay beams square to the first wall, evenly spaced, each with a pocket at both ends."""
    floor, first = bed.floor, next(side for side in bed.room if side.wall == bed.building.number(bed.floor.on[0]))
    last = next(side for side in bed.room if side.wall == bed.building.number(bed.floor.on[1]))
    if abs(float(product(first.along, last.along))) < OPPOSITE:
        message = (
            f"walls '{floor.on[0]}' and '{floor.on[1]}' stand at an angle; beams go from a wall to one opposite it"
        )
        raise KeyProblem(message, "floors", bed.number, "on")
    begin, end = _clear_length(bed, first)
    count = max(1, round((end - begin) / floor.spacing))
    if (end - begin) / count < floor.width:
        message = f"{floor.width:g} m wide beams do not fit {(end - begin) / count:.3g} m apart"
        raise KeyProblem(message, "floors", bed.number, "width")
    middles = [begin + (n + 0.5) * (end - begin) / count for n in range(count)]
    for n, wanted in enumerate(middles):
        beam = _beam(bed, first, last, _moved(bed, (first, last), n, wanted, (end - begin) / count))
        mass = None if floor.mass is None else floor.mass / count
        found.slabs.append(Slab(bed.name(n + 1), beam, bed.low, bed.high, floor.material, mass))
        for side, (at, others) in zip((first, last), BEAM_ENDS, strict=True):
            cut_pockets(found, bed, side, in_wall(bed, side, beam[at], beam[others]))


def _check_beam(bed: Bed, sides: tuple[RoomSide, RoomSide], beam: np.ndarray, n: int) -> None:
    """Raise KeyProblem where a beam would run into another wall before it reaches the last one."""
    walls = tuple(bed.wall(side) for side in sides)
    met = bed.wall_under(beam, walls)
    if met is not None:
        one, other = bed.floor.bears_on
        message = f"beam {n + 1}, square to '{one}', would run into wall '{bed.plan.axes[met].name}' before it reaches "
        message += f"'{other}'; {_advice(bed, sides)}"
        raise KeyProblem(message, "floors", bed.number, "on")


def _advice(bed: Bed, sides: tuple[RoomSide, RoomSide]) -> str:
    """Suggest two walls of the room between which all beams are clear."""
    first, last = sides
    for one, other in ((last, first), *permutations([side for side in bed.room if side.wall is not None], 2)):
        if abs(float(product(one.along, other.along))) >= OPPOSITE and _are_clear(bed, (one, other)):
            names = (bed.plan.axes[bed.wall(side)].name for side in (one, other))
            return "they are clear with on = ['{}', '{}'], square to the first of them".format(*names)
    return "no two walls of this room have beams square to one of them: give a plate, kind = 'rigid'"


def _are_clear(bed: Bed, sides: tuple[RoomSide, RoomSide]) -> bool:
    """Test whether beams between two sides of a room meet no other wall."""
    walls = tuple(bed.wall(side) for side in sides)
    bearing = {wall: bed.plan.axes[wall].thickness for wall in walls}
    turned = bed._replace(bearing=bearing)
    begin, end = _clear_length(bed, sides[0])
    count = max(1, round((end - begin) / bed.floor.spacing))
    middles = [begin + (n + 0.5) * (end - begin) / count for n in range(count)]
    return all(turned.wall_under(_beam(turned, *sides, middle), walls) is None for middle in middles)


def _clear_length(bed: Bed, side: RoomSide) -> tuple[float, float]:
    """Return both ends of the inner face along a side of a room [m]."""
    inner = crossings([edge_line(bed._replace(bearing={}), each, 0.0) for each in bed.room])
    k = next(i for i, each in enumerate(bed.room) if each is side)
    begin, end = (product(inner[j % len(inner)] - side.start, side.along) for j in (k, k + 1))
    return float(begin), float(end)


def _beam(bed: Bed, first: RoomSide, last: RoomSide, middle: float) -> np.ndarray:
    """Return the outline of a beam whose axis leaves the first wall at a place along it [m], (4, 2)."""
    half = 0.5 * bed.floor.width
    at = float(product(first.along, first.start)) + middle
    sides = [(first.along, at - half), edge_line(bed, first, 0.0), (first.along, at + half), edge_line(bed, last, 0.0)]
    return crossings(sides)


def _moved(bed: Bed, sides: tuple[RoomSide, RoomSide], n: int, middle: float, spacing: float) -> float:
    """Shift a beam to the nearest place that leaves no sliver beside openings and other walls [m]."""
    walls = tuple(bed.wall(side) for side in sides)
    shifts = np.linspace(0.0, 0.45, 46) * (spacing - bed.floor.width)
    for place in (middle + sign * shift for shift in shifts for sign in (1.0, -1.0)):
        beam = _beam(bed, *sides, place)
        clear = bed.wall_under(beam, walls) is None
        if clear and all(
            _fits(bed, side, in_wall(bed, side, beam[at], beam[others]))
            for side, (at, others) in zip(sides, BEAM_ENDS, strict=True)
        ):
            return place
    _check_beam(bed, sides, _beam(bed, *sides, middle), n)
    first = sides[0]
    place = bed.plan.axes[bed.wall(first)].local((first.start + middle * first.along)[None])[0, 0]
    message = f"no place is left for a beam near {place:.4g} m along '{bed.floor.on[0]}', between openings and walls"
    raise KeyProblem(message, "floors", bed.number, "spacing")


def _fits(bed: Bed, side: RoomSide, outline: np.ndarray) -> bool:
    """Test whether a pocket keeps a quarter of a block from openings and walls beside it."""
    wall, least = bed.wall(side), SHORTEST * bed.building.block[0]
    axis, small = bed.plan.axes[wall], SMALL * bed.building.block[1]
    low, high = np.sort(axis.local(outline)[:, 0])[[0, -1]]
    zones = [bed.plan.zone(wall, junction) for junction in bed.plan.met(wall)]
    for opening in bed.building.walls[wall].openings:
        void = opening.void
        boxes = [void.reach] if len(void.joints) else void.boxes
        zones += [(x0, x1) for x0, y0, x1, y1 in boxes if y0 < bed.high - small and y1 > bed.low + small]
    return all(low >= stop + least or high <= start - least for start, stop in zones)
