"""Floors of a building: plates and beams, and the pockets that they need in the walls on which they bear."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.geometry.rotation import cross
from dem_cli.structures.building.bond import SHORTEST
from dem_cli.structures.building.elevation import SMALL, Pocket
from dem_cli.structures.building.plan import Plan
from dem_cli.structures.building.rooms import Room, RoomSide, between, rooms_of
from dem_cli.structures.building.table import Building, Floor

THINNEST = 0.25  # of a wall: what is left of it beside a floor
# Corners of a beam in the first wall and in the last one, each with those at the other end of the same edges.
BEAM_ENDS = (([1, 2], [0, 3]), ([3, 0], [2, 1]))


class Slab(NamedTuple):
    """A plate or a beam."""

    name: str
    outline: np.ndarray  # in plan, convex, counter-clockwise [m], (n, 2)
    low: float
    high: float
    material: str
    mass: float | None  # [kg]


class Floors(NamedTuple):
    """All floors of a building."""

    slabs: list[Slab]
    pockets: dict[int, list[Pocket]]  # of each wall


def floors_of(building: Building, plan: Plan) -> Floors:
    """Plates and beams with their pockets. Raises KeyProblem where there is no room for one."""
    found = Floors([], {})
    rooms = rooms_of(plan) if building.floors else []
    for i, floor in enumerate(building.floors):
        on = [building.number(name) for name in floor.on]
        room = _room(plan, rooms, floor, on, i)
        bearing = _bearings(building, floor, on, i)
        layer = _layer(building, floor, i)
        _check_walls(building, floor, i, layer)
        lay = _beams if floor.kind == "beams" else _plate
        lay(found, Bed(building, plan, floor, i, room, bearing, *layer))
    return found


class Bed(NamedTuple):
    """A floor with all that decides where it lies."""

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
        """The wall of a side on which it bears."""
        assert side.wall is not None
        return side.wall

    def name(self, *more: int) -> str:
        """Of a plate, or of a beam of some number."""
        return "-".join([self.floor.id, *map(str, more)])


def _room(plan: Plan, rooms: Sequence[Room], floor: Floor, on: Sequence[int], i: int) -> Room:
    """The room that all the walls named bound."""
    fitting = [room for room in rooms if set(on) <= {side.wall for side in room}]
    if len(fitting) == 1:
        return fitting[0]
    names = ", ".join(f"'{name}'" for name in floor.on)
    if fitting:
        message = f"{len(fitting)} rooms are bounded by {names}: name more of the walls of the one that is meant"
        raise KeyProblem(message, "floors", i, "on")
    if len(on) == 2 and not any(set(on) <= set(junction.walls) for junction in plan.junctions):
        joined = any(wall in junction.walls for junction in plan.junctions for wall in on)
        if not (rooms and joined):
            return between(plan, *on)
    raise KeyProblem(f"no room is bounded by {names}; give a floor for each room", "floors", i, "on")


def _bearings(building: Building, floor: Floor, on: Sequence[int], i: int) -> dict[int, float]:
    """How far it reaches into each wall [m]."""
    found = {}
    for wall in on:
        thickness = building.walls[wall].thickness or building.thickness
        bearing = floor.bearing or thickness * (0.5 if floor.kind == "rigid" else 1.0)
        if bearing > thickness * (1.0 + SMALL):
            message = f"{bearing:g} is not allowed; must be at most {thickness:g}, the thickness of "
            raise KeyProblem(f"{message}'{building.walls[wall].id}'", "floors", i, "bearing")
        found[wall] = min(bearing, thickness)
    return found


def _layer(building: Building, floor: Floor, i: int) -> tuple[float, float, range]:
    """From where to where it goes up, and the courses beside it."""
    levels, small = building.levels, SMALL * building.block[1]
    first = int(np.abs(levels - floor.z).argmin())
    if floor.height is None:
        last = min(first + 1, len(levels) - 1)
        high = float(levels[last]) if last > first else float(levels[first]) + building.block[1]
    else:
        high = float(levels[first]) + floor.height
        near = float(levels[np.abs(levels - high).argmin()])
        if floor.kind == "rigid" and first < len(levels) - 1:
            if abs(near - high) > small:
                message = f"its upper face at {high:g} is no bed joint; the nearest one is at {near:g}"
                raise KeyProblem(message, "floors", i, "height")
            high = near
    beside = [k for k in range(first, len(levels) - 1) if levels[k] < high - small]
    return float(levels[first]), high, range(first, first + len(beside))


def _check_walls(building: Building, floor: Floor, i: int, layer: tuple[float, float, range]) -> None:
    """Raises KeyProblem where a wall does not reach up to a floor, has a gable there, or a plate meets a lintel."""
    low, high, courses = layer
    small = SMALL * building.block[1]
    for k, name in enumerate(floor.on):
        wall = building.walls[building.number(name)]
        top = float(building.levels[wall.courses or building.courses])
        if low > top + small:
            raise KeyProblem(f"wall '{name}' is {top:g} high, the floor lies at {low:g}", "floors", i, "on", k)
        if wall.gable is not None and high > top + small:
            message = f"wall '{name}' goes on as a gable from {top:g}: a floor at {low:g} bears on other walls"
            raise KeyProblem(message, "floors", i, "on", k)
        if floor.kind == "beams" or not courses:
            continue
        for n, opening in enumerate(wall.openings):
            over = opening.box[3]
            if opening.void.reach[3] > max(over, low) + small and over < high - small:
                message = f"at {low:g} it would cut what is over openings[{n + 1}] of wall '{name}'"
                raise KeyProblem(message, "floors", i, "z")


def _corners(lines: Sequence[tuple[np.ndarray, float]]) -> np.ndarray:
    """Where lines (unit normal, distance from the origin), one after the other around, cross [m], (n, 2)."""
    found = []
    for (n, a), (m, b) in zip([lines[-1], *lines[:-1]], lines, strict=True):
        found.append(np.array([a * m[1] - b * n[1], b * n[0] - a * m[0]]) / float(cross(n, m)))
    return np.array(found)


def _line(bed: Bed, side: RoomSide, gap: float) -> tuple[np.ndarray, float]:
    """The edge of a plate along a side of its room."""
    away = 0.0
    if side.wall is not None:
        inner = 0.5 * bed.plan.axes[side.wall].thickness
        away = inner - bed.bearing[side.wall] if side.wall in bed.bearing else inner + gap
    return side.inwards, float(side.inwards @ side.start) + away


def _outline(bed: Bed, gap: float) -> np.ndarray:
    corners = _corners([_line(bed, side, gap) for side in bed.room])
    arms = np.roll(corners, -1, axis=0) - corners
    if (cross(np.roll(arms, 1, axis=0), arms) <= 0.0).any():
        walls = ", ".join(f"'{bed.plan.axes[side.wall].name}'" for side in bed.room if side.wall is not None)
        message = f"the room between {walls} is not convex, or too narrow: divide it by a wall"
        raise KeyProblem(message, "floors", bed.number, "on")
    return corners


def _plate(found: Floors, bed: Bed) -> None:
    """One plate over the whole room, with pockets all along the walls that it bears on."""
    floor = bed.floor
    found.slabs.append(Slab(bed.name(), _outline(bed, floor.gap), bed.low, bed.high, floor.material, floor.mass))
    corners = _outline(bed, 0.0)
    for k, side in enumerate(bed.room):
        if side.wall in bed.bearing:
            edge = np.stack([corners[k], corners[(k + 1) % len(corners)]])
            others = np.stack([corners[k - 1], corners[(k + 2) % len(corners)]])
            _pockets(found, bed, side, _in_wall(bed, side, edge, others))


def _in_wall(bed: Bed, side: RoomSide, ends: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Corners of what lies in a wall, (4, 2): ends there, and where edges to the others leave it."""
    ways = others - ends
    depths = bed.bearing[bed.wall(side)] / (ways @ side.inwards)
    return np.concatenate([ends, ends + ways * np.minimum(depths, 1.0)[:, None]])


def _pockets(found: Floors, bed: Bed, side: RoomSide, outline: np.ndarray) -> None:
    """A pocket in the wall of a side, in all courses beside the floor."""
    wall = bed.wall(side)
    axis = bed.plan.axes[wall]
    right, left = axis.faces.tolist()
    bearing = bed.bearing[wall]
    inside = side.along @ axis.along > 0.0  # the room lies to the left of the wall
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


def _beams(found: Floors, bed: Bed) -> None:
    """Beams square to the first wall, evenly spaced, each with a pocket at both ends."""
    floor, first = bed.floor, next(side for side in bed.room if side.wall == bed.building.number(bed.floor.on[0]))
    last = next(side for side in bed.room if side.wall == bed.building.number(bed.floor.on[1]))
    if abs(float(first.along @ last.along)) < 0.5:
        message = (
            f"walls '{floor.on[0]}' and '{floor.on[1]}' stand at an angle; beams go from a wall to one opposite it"
        )
        raise KeyProblem(message, "floors", bed.number, "on")
    inner = _corners([_line(bed._replace(bearing={}), side, 0.0) for side in bed.room])
    k = bed.room.index(first)
    begin, end = ((inner[j % len(inner)] - first.start) @ first.along for j in (k, k + 1))
    count = max(1, round((end - begin) / floor.spacing))
    if (end - begin) / count < floor.width:
        message = f"{floor.width:g} m wide beams do not fit {(end - begin) / count:.3g} m apart"
        raise KeyProblem(message, "floors", bed.number, "width")
    for n in range(count):
        middle = _moved(bed, (first, last), begin + (n + 0.5) * (end - begin) / count, (end - begin) / count)
        beam = _beam(bed, first, last, middle)
        mass = None if floor.mass is None else floor.mass / count
        found.slabs.append(Slab(bed.name(n + 1), beam, bed.low, bed.high, floor.material, mass))
        for side, (at, others) in zip((first, last), BEAM_ENDS, strict=True):
            _pockets(found, bed, side, _in_wall(bed, side, beam[at], beam[others]))


def _beam(bed: Bed, first: RoomSide, last: RoomSide, middle: float) -> np.ndarray:
    """Outline of a beam whose middle line leaves the first wall at a place along it [m], (4, 2)."""
    half = 0.5 * bed.floor.width
    at = float(first.along @ first.start) + middle
    sides = [(first.along, at - half), _line(bed, first, 0.0), (first.along, at + half), _line(bed, last, 0.0)]
    return _corners(sides)


def _moved(bed: Bed, sides: tuple[RoomSide, RoomSide], middle: float, spacing: float) -> float:
    """The place nearest to where a beam belongs that leaves no sliver beside openings and other walls."""
    shifts = np.linspace(0.0, 0.45, 46) * (spacing - bed.floor.width)
    for place in (middle + sign * shift for shift in shifts for sign in (1.0, -1.0)):
        beam = _beam(bed, *sides, place)
        if all(
            _fits(bed, side, _in_wall(bed, side, beam[at], beam[others]))
            for side, (at, others) in zip(sides, BEAM_ENDS, strict=True)
        ):
            return place
    first = sides[0]
    place = bed.plan.axes[bed.wall(first)].local((first.start + middle * first.along)[None])[0, 0]
    message = f"no place is left for a beam near {place:.4g} m along '{bed.floor.on[0]}', between openings and walls"
    raise KeyProblem(message, "floors", bed.number, "spacing")


def _fits(bed: Bed, side: RoomSide, outline: np.ndarray) -> bool:
    """Whether a pocket keeps a quarter of a block from openings and walls beside it."""
    wall, least = bed.wall(side), SHORTEST * bed.building.block[0]
    axis, small = bed.plan.axes[wall], SMALL * bed.building.block[1]
    low, high = np.sort(axis.local(outline)[:, 0])[[0, -1]]
    zones = [bed.plan.zone(wall, junction) for junction in bed.plan.met(wall)]
    for opening in bed.building.walls[wall].openings:
        void = opening.void
        boxes = [void.reach] if len(void.joints) else void.boxes
        zones += [(x0, x1) for x0, y0, x1, y1 in boxes if y0 < bed.high - small and y1 > bed.low + small]
    return all(low >= stop + least or high <= start - least for start, stop in zones)
