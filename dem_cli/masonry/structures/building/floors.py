"""Generate the floors of a building: plates and beams, and their pockets in the bearing walls."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, islice

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.geometry.rotation import cross
from dem_cli.masonry.structures.building.beams import lay_beams
from dem_cli.masonry.structures.building.bed import Bed, Floors, Slab, crossings, cut_pockets, edge_line, in_wall
from dem_cli.masonry.structures.building.elevation import SMALL
from dem_cli.masonry.structures.building.plan import Plan, overlap
from dem_cli.masonry.structures.building.rooms import Room, between, rooms_of
from dem_cli.masonry.structures.building.table import Building, Floor


def floors_of(building: Building, plan: Plan) -> Floors:
    """Lay all floors of a building with their pockets. Raises KeyProblem where there is no room for one."""
    found = Floors([], {})
    rooms = rooms_of(plan) if building.floors else []
    for i, floor in enumerate(building.floors):
        on = [building.number(name) for name in floor.on]
        room = _room(plan, rooms, floor, on, i)
        bearing = _bearings(building, floor, on[: len(floor.bears_on)], i)
        layer = _layer(building, floor, i)
        _check_walls(building, floor, i, layer)
        lay = lay_beams if floor.kind == "beams" else _plate
        laid = len(found.slabs)
        lay(found, Bed(building, plan, floor, i, room, bearing, *layer))
        _check_slabs(found.slabs[:laid], found.slabs[laid:], i)
    return found


def _check_slabs(before: Sequence[Slab], after: Sequence[Slab], i: int) -> None:
    """Raise KeyProblem where a floor would overlap an earlier one."""
    for slab in after:
        small = SMALL * float(np.ptp(slab.outline, axis=0).max())
        for other in before:
            apart = slab.low >= other.high - small or slab.high <= other.low + small
            if not apart and overlap(slab.outline, other.outline, small):
                message = f"'{slab.name}' and '{other.name}' would lie in the same place: where floors of two rooms "
                message += "bear on one wall give either a bearing of at most half of its thickness"
                raise KeyProblem(message, "floors", i, "bearing")


def _room(plan: Plan, rooms: Sequence[Room], floor: Floor, on: Sequence[int], i: int) -> Room:
    """Find the room that is bounded by all the named walls. Raises KeyProblem where it is not unique."""
    fitting = [room for room in rooms if set(on) <= {side.wall for side in room}]
    if len(fitting) == 1:
        return fitting[0]
    names = ", ".join(f"'{name}'" for name in floor.on)
    if fitting:
        raise KeyProblem(
            f"{len(fitting)} rooms are bounded by {names}: {_advice(plan, fitting, floor)}", "floors", i, "on"
        )
    if len(on) == 2 and not any(set(on) <= set(junction.walls) for junction in plan.junctions):
        joined = any(wall in junction.walls for junction in plan.junctions for wall in on)
        if not (rooms and joined):
            return between(plan, *on)
    raise KeyProblem(f"no room is bounded by {names}; give a floor for each room", "floors", i, "on")


def _advice(plan: Plan, rooms: Sequence[Room], floor: Floor) -> str:
    """Suggest the fewest further walls that identify each of these rooms."""
    walls = [{plan.axes[side.wall].name for side in room if side.wall is not None} - {*floor.on} for room in rooms]
    found = []
    for own in walls:
        tried = (names for count in (1, 2) for names in combinations(sorted(own), count))
        telling = (names for names in tried if sum(own >= {*names} for own in walls) == 1)
        found += [" and ".join(f"'{name}'" for name in names) for names in islice(telling, 1)]
    which = f"; {', or '.join(sorted(found))}" if found else ""
    after = "; beams bear on the first two alone" if floor.kind == "beams" else ""
    return f"name more of the walls of the one that is meant{which}{after}"


def _bearings(building: Building, floor: Floor, on: Sequence[int], i: int) -> dict[int, float]:
    """Return the bearing length in each wall [m]. Raises KeyProblem where it exceeds the thickness."""
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
    """Return lower and upper level of a floor, and the courses beside it."""
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
    """Raise KeyProblem where a wall is too low for a floor, has a gable there, or a plate meets a lintel."""
    low, high, courses = layer
    small = SMALL * building.block[1]
    for k, name in enumerate(floor.bears_on):
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


def _outline(bed: Bed, gap: float) -> np.ndarray:
    corners = crossings([edge_line(bed, side, gap) for side in bed.room])
    arms = np.roll(corners, -1, axis=0) - corners
    if (cross(np.roll(arms, 1, axis=0), arms) <= 0.0).any():
        walls = ", ".join(f"'{bed.plan.axes[side.wall].name}'" for side in bed.room if side.wall is not None)
        message = f"the room between {walls} is not convex, or too narrow: divide it by a wall"
        raise KeyProblem(message, "floors", bed.number, "on")
    return corners


def _plate(found: Floors, bed: Bed) -> None:
    """Lay one plate over the whole room, with pockets all along its bearing walls."""
    floor = bed.floor
    outline = _outline(bed, floor.gap)
    met = bed.wall_under(outline, list(bed.bearing))
    if met is not None:
        message = f"the plate would run into wall '{bed.plan.axes[met].name}', which stands in the room: let it end "
        raise KeyProblem(f"{message}at walls on both sides, as one that divides the room", "floors", bed.number, "on")
    found.slabs.append(Slab(bed.name(), outline, bed.low, bed.high, floor.material, floor.mass))
    corners = _outline(bed, 0.0)
    for k, side in enumerate(bed.room):
        if side.wall in bed.bearing:
            edge = np.stack([corners[k], corners[(k + 1) % len(corners)]])
            others = np.stack([corners[k - 1], corners[(k + 2) % len(corners)]])
            cut_pockets(found, bed, side, in_wall(bed, side, edge, others))
