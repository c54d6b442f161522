"""Generate the blocks of a building: walls on their axes, cut where they meet askew, floors and the base."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from dem_cli.case.base import KeyProblem, check_count
from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.geometry import polyhedron
from dem_cli.core.geometry.halfspaces import behind_all
from dem_cli.core.geometry.polyhedron import Polyhedron
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.building.bed import Floors, Slab
from dem_cli.masonry.structures.building.courses import WallCourses
from dem_cli.masonry.structures.building.elevation import Pocket, WallElevation
from dem_cli.masonry.structures.building.floors import floors_of
from dem_cli.masonry.structures.building.irregular import IrregularWall, zones_of
from dem_cli.masonry.structures.building.plan import Junction, Plan, PlanAxis, plan_of
from dem_cli.masonry.structures.building.runs import Passes, Run, runs_of, turn_by_turn
from dem_cli.masonry.structures.building.table import Building
from dem_cli.masonry.structures.patterns.pattern_wall import stone_figures
from dem_cli.masonry.structures.stones import Part, Stone
from dem_cli.masonry.structures.tops import Gable, with_gable

WELD = 1e-12  # of the size of a building: coordinates that close are the same, but for round-off
ASKEW = 1e-9  # of a block: an end that is cut askew

Planes = list[tuple[np.ndarray, float]]


def build(building: Building) -> list[Block]:
    """Generate the blocks of a building: the base first, then the walls in order, course by course, then the floors."""
    plan = plan_of(building)
    floors = floors_of(building, plan)
    elevations = _elevations(building, plan, floors)
    walls = [block for each in elevations for block in _blocks(building, plan, each)]
    blocks = [*_base(building, elevations), *walls, *(_slab(slab) for slab in floors.slabs)]
    return _welded(blocks)


def figures(building: Building) -> list[tuple[str, str]]:
    """Describe the stones drawn at random for walls of irregular stones, for `dem check`."""
    plan = plan_of(building)
    walls = _elevations(building, plan, floors_of(building, plan))
    tilings = [(wall.axis.name, _irregular(building, plan, wall)) for wall in walls]
    return [(f"{name} stones", stone_figures(each.tiling)) for name, each in tilings if each and each.tiling.stones]


def loose_ends(building: Building) -> str:
    """Return the key by which stones may slide out of jambs; "": none. Ends of walls are dressed."""
    for i, wall in enumerate(building.walls):
        pattern = wall.pattern or building.pattern
        if pattern is not None and pattern.jambs == "rubble" and wall.openings:
            return "pattern.jambs" if wall.pattern is None else f"walls.{i}.pattern.jambs"
    return ""


def _elevations(building: Building, plan: Plan, floors: Floors) -> list[WallCourses]:
    """Create the elevations of all walls. Raises KeyProblem: gables that obstruct each other."""
    _check_gables(building, plan)
    passes = _passes(plan, floors.pockets)
    return [_elevation(building, plan, wall, floors.pockets.get(wall, []), passes) for wall in range(len(plan.axes))]


def _irregular(building: Building, plan: Plan, wall: WallCourses) -> IrregularWall | None:
    """Return the irregular masonry of a wall with a pattern; None: it is laid in regular courses."""
    pattern = wall.table.pattern or building.pattern
    if pattern is None:
        return None
    return IrregularWall(wall, zones_of(building, plan, wall), pattern, building.seed or 0)


def _check_gables(building: Building, plan: Plan) -> None:
    """Raise KeyProblem where two gables collide above the junction of their walls."""
    for junction in plan.junctions:
        one, other = (building.walls[wall] for wall in junction.walls)
        if one.gable is not None and other.gable is not None:
            message = f"wall '{one.id}' has one too, and they meet: of two walls that meet one has a gable"
            raise KeyProblem(message, "walls", max(junction.walls), "gable")


def _passes(plan: Plan, pockets: dict[int, list[Pocket]]) -> Passes:
    """Decide which wall passes in each course: in turn, but none into a floor pocket on the far face of the other."""
    held = {
        (id(junction), pocket.course): 1 - junction.of(wall)
        if pocket.across[1] <= pocket.across[0]
        else junction.of(wall)
        for wall, found in pockets.items()
        for junction in plan.met(wall)
        for pocket in found
        if _behind(plan, wall, junction, pocket)
    }

    def passes(junction: Junction, course: int) -> int:
        return held.get((id(junction), course), turn_by_turn(junction, course))

    return passes


def _behind(plan: Plan, wall: int, junction: Junction, pocket: Pocket) -> bool:
    """Test whether a wall that ends at this one would come out in a floor pocket on its other face."""
    mine = junction.of(wall)
    other, end = junction.walls[1 - mine], junction.ends[1 - mine]
    low, high = plan.zone(wall, junction)
    if junction.ends[mine] or not end or pocket.right <= low or pocket.left >= high:
        return False
    right, left = plan.axes[wall].faces.tolist()
    side = plan.towards(other, wall, -end)
    return pocket.across[0] > right if side > 0 else pocket.across[1] < left


def _elevation(building: Building, plan: Plan, wall: int, pockets: Sequence[Pocket], passes: Passes) -> WallCourses:
    """Create the elevation of a wall, with the courses of a gable above the others."""
    table = building.walls[wall]
    courses = [each.courses or building.courses for each in building.walls]
    levels = building.levels[: courses[wall] + 1]
    eaves = float(levels[-1])
    if table.gable is not None:
        check_count(table.gable.height / building.block[1], "walls", wall, "gable", "height")
        levels = _with_gable(levels, table.gable, building.block[1])

    def present(other: int, course: int) -> bool:
        return course < courses[other]

    runs = [runs_of(plan, wall, course, present, passes) for course in range(len(levels) - 1)]
    return WallCourses(wall, plan.axes[wall], table, building.block[0], building, levels, eaves, runs, tuple(pockets))


def _with_gable(levels: np.ndarray, gable: Gable, course: float) -> np.ndarray:
    """Add the bed joints of a gable, about as high as other courses, the last one at the tip; stepped: below it."""
    if gable.edges == "stepped":
        return with_gable(levels, gable, course)
    count = max(1, round(gable.height / course))
    return np.concatenate([levels, levels[-1] + gable.height * np.arange(1, count + 1) / count])


def _blocks(building: Building, plan: Plan, wall: WallCourses) -> list[Block]:
    """Generate the blocks of a wall at their places in the plan."""
    irregular = _irregular(building, plan, wall)
    if irregular is None:
        return _set_up(wall, wall.stones())
    found = irregular.stones()
    return [*_set_up(wall, found.dressed), *_set_up(wall, found.others, cut=False)]


def _set_up(elevation: WallCourses, named: Sequence[tuple[str, Stone]], cut: bool = True) -> list[Block]:
    """Place the stones of a wall in the plan, cut where it ends askew."""
    if not named:
        return []
    parts = [part for _, stone in named for part in stone.parts]
    low, high = np.array([part.across for part in parts]).T
    solids = iter(polyhedron.prisms([part.shape for part in parts], low, high))
    to_plan = _turn(elevation.axis)
    blocks = []
    for name, stone in named:
        planes = [_planes(elevation, stone.course, part) if cut else [] for part in stone.parts]
        material = stone.material or elevation.table.material
        left = [behind_all(next(solids), each) for each in planes]
        shapes = tuple(to_plan(solid) for solid in left if solid is not None)
        blocks.append(Block(name, shapes, material, course=stone.course, row=stone.leaf))
    return blocks


def _planes(elevation: WallElevation, course: int, part: Part) -> Planes:
    """Return the cutting planes of a part: skew ends of its run that it reaches into."""
    if not course:
        return []
    (low, foot), (high, head) = part.shape.min(axis=0).tolist(), part.shape.max(axis=0).tolist()
    reach = ASKEW * elevation.length
    laid = int(
        np.searchsorted(elevation.levels, 0.5 * (foot + head))
    )  # a stone may have got a piece of the next course
    run = _run_of(elevation.runs[laid - 1], low, high, reach)
    found = []
    for line, sign, inside in (
        (run.start, -1.0, low >= run.start.max() - reach),
        (run.stop, 1.0, high <= run.stop.min() + reach),
    ):
        if not inside:
            right, left = elevation.across
            normal = sign * np.array([left - right, line[0] - line[1], 0.0])
            normal /= norm(normal)
            found.append((normal, float(product(normal, [line[0], right, 0.0]))))
    return found


def _run_of(runs: Sequence[Run], low: float, high: float, reach: float) -> Run:
    """Find the run of a part between two places along the wall; at a skew junction two runs may overlap."""

    def beyond(run: Run) -> tuple[float, float]:
        before, after = low - float(run.start.min()), float(run.stop.max()) - high
        return max(-before, -after, reach), min(abs(before), abs(after))

    return min(runs, key=beyond)


def _turn(axis: PlanAxis) -> Callable[[Polyhedron], Polyhedron]:
    """Return the transformation of polyhedra from coordinates of a wall to those of the plan."""

    def turned(solid: Polyhedron) -> Polyhedron:
        x, y, z = solid.vertices.T
        flat = axis.start + x[:, None] * axis.along + y[:, None] * axis.across
        return Polyhedron(np.column_stack([flat, z]), solid.faces)

    return turned


def _slab(slab: Slab) -> Block:
    return Block(slab.name, (upright(slab.outline, slab.low, slab.high),), slab.material, mass=slab.mass)


def upright(outline: np.ndarray, low: float, high: float) -> Polyhedron:
    """Create a prism over an outline in plan (n, 2), counter-clockwise, from one height to another."""
    solid = polyhedron.prism(outline[::-1], low, high)  # drawn in x and z, from y to y
    x, up, y = solid.vertices.T
    return Polyhedron(np.column_stack([x, y, up]), tuple(face[::-1] for face in solid.faces))


def _base(building: Building, elevations: Sequence[WallElevation]) -> list[Block]:
    """Create the fixed blocks below the walls."""
    depth, beyond = building.base_depth, building.base_extension
    if building.base == "none":
        return []
    footprints = {each.axis.name: _footprint(each, beyond) for each in elevations}
    if building.base == "slab":
        corners = np.concatenate(list(footprints.values()))
        (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
        footprints = {"": np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])}
    return [
        Block(f"base-{name}".strip("-"), (upright(outline, -depth, 0.0),), "", fixed=True)
        for name, outline in footprints.items()
    ]


def _footprint(elevation: WallElevation, beyond: float) -> np.ndarray:
    """Return the corners of the ground below a wall, with a margin around it [m], (4, 2)."""
    axis = elevation.axis
    (low, high), (right, left) = elevation.span, axis.faces
    local = np.array(
        [
            [low - beyond, right - beyond],
            [high + beyond, right - beyond],
            [high + beyond, left + beyond],
            [low - beyond, left + beyond],
        ]
    )
    return axis.start + product(local, np.stack([axis.along, axis.across]))


def _welded(blocks: Sequence[Block]) -> list[Block]:
    """Weld blocks: coordinates that differ by round-off become equal, so that touching faces share them."""
    parts = [part for block in blocks for part in block.parts]
    points = np.concatenate([part.vertices for part in parts])
    gap = WELD * float(np.ptp(points, axis=0).max())
    for axis in range(3):
        values, back = np.unique(points[:, axis], return_inverse=True)
        first = np.concatenate([[True], np.diff(values) > gap])
        points[:, axis] = values[first][np.cumsum(first) - 1][back]
    pieces = iter(np.split(points, np.cumsum([len(part.vertices) for part in parts])[:-1]))
    return [
        replace(block, parts=tuple(Polyhedron(next(pieces), part.faces) for part in block.parts)) for block in blocks
    ]
