"""Buildings: volumes and shared faces exact, bonds without slivers, the same as bonded by hand, what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shapely import affinity
from shapely.geometry import Polygon, box
from shapely.ops import unary_union
from studies.space.structures import corner_wall, tee_wall, u_wall
from synthetic.spatial_case import spatial_case

from dem_cli.core.contact.between import StartJoints
from dem_cli.core.contact.detect import find_joints
from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.geometry.solids import face_areas
from dem_cli.core.model.places import undeformed
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.validate import problems

T, H = 0.3, 0.25  # thickness of walls, height of courses


def wall(name, start, end, **more):
    return {"id": name, "axis": [list(map(float, start)), list(map(float, end))], **more}


def at(degrees, length, start=(0.0, 0.0)):
    angle = math.radians(degrees)
    return start[0] + length * math.cos(angle), start[1] + length * math.sin(angle)


def building(walls, **more):
    table = {"kind": "building", "id": "b", "block": [0.5, H], "thickness": T, "courses": 6, "walls": walls}
    return table | more


class Built:
    """A building as a model, with what is free of it."""

    def __init__(self, walls, **more):
        case = spatial_case(structure=[building(walls, **more)])
        found = assembly(case)
        assert problems(case, found.model, found.blocks) == []
        self.model, self.blocks, self.corners = found.model, found.blocks, undeformed(found.model)
        self.free = ~self.model.fixed

    @property
    def volume(self):
        return self.model.parts.volumes[self.free[self.model.part_blocks]].sum()

    @property
    def exposed(self):
        """Area of all faces of free blocks that no other block touches; a part of a block may touch another one."""
        model = self.model
        areas = np.linalg.norm(face_areas(self.corners, model.topology), axis=1)
        near = find_joints(model.parts_alone(), self.corners, 1e-4)  # of one block as well
        shared = geometry_of(3).drawn(model, near, self.corners, 1e-4)
        gaps = np.linalg.norm(shared.on_second - shared.on_first, axis=1)
        faces = np.maximum.reduceat(gaps, shared.starts[:-1]) < 1e-9  # not of faces that meet at an edge, at an angle
        faces &= np.diff(shared.starts) > 2
        inner = (shared.areas * self.free[shared.blocks].sum(axis=1))[faces].sum()
        return areas[self.free[model.part_blocks[model.topology.face_parts]]].sum() - inner

    def boxes(self):
        """Lower and upper corners of free blocks, as a set."""
        owners = self.model.vertex_blocks
        return {
            tuple(np.round(np.concatenate([own.min(axis=0), own.max(axis=0)]), 9))
            for own in (self.corners[owners == i] for i in np.flatnonzero(self.free))
        }

    def lengths(self, along):
        """Length of each free block along a unit vector in plan."""
        places = self.corners[:, :2] @ np.array(along)
        owners = self.model.vertex_blocks
        return np.array([np.ptp(places[owners == i]) for i in np.flatnonzero(self.free)])


def strip(start, end, thickness=T, before=0.0, after=0.0):
    """Footprint of a wall drawn on beyond its ends."""
    arm = np.subtract(end, start)
    length, angle = float(np.hypot(*arm)), math.degrees(math.atan2(arm[1], arm[0]))
    flat = box(-before, -thickness / 2, length + after, thickness / 2)
    return affinity.translate(affinity.rotate(flat, angle, origin=(0, 0)), *start)


UPPER = box(-9.0, 0.0, 9.0, 9.0)
ENDS = {angle: at(angle, 2.5) for angle in (90, 60, 120, 35, 150, 100)}
PLANS = {
    **{
        f"corner {angle}": (
            [wall("a", (0, 0), (3, 0)), wall("b", (0, 0), end)],
            [
                strip((0, 0), (3, 0)),
                strip((0, 0), end),
                strip((0, 0), (3, 0), T, 9).intersection(strip((0, 0), end, T, 9, 9)),
            ],
        )
        for angle, end in ENDS.items()
    },
    **{
        f"stem {angle}": (
            [wall("a", (-2, 0), (3, 0)), wall("s", (0.2, 0), at(angle, 2, (0.2, 0)), thickness=0.4)],
            [strip((-2, 0), (3, 0)), strip((0.2, 0), at(angle, 2, (0.2, 0)), 0.4, 9).intersection(UPPER)],
        )
        for angle in (90, 60, 45, 110)
    },
    **{
        f"crossing {angle}": (
            [wall("s", at(angle + 180, 2), at(angle, 2), thickness=0.4), wall("a", (-2, 0.1), (3, 0.1))],
            [strip((-2, 0.1), (3, 0.1)), strip(at(angle + 180, 2), at(angle, 2), 0.4)],
        )
        for angle in (90, 50, 115)
    },
    "two stems": (
        [wall("r", (0, 0), (-0.3, -2)), wall("a", (-2, 0), (3, 0)), wall("s", (0, 0), (0.5, 2))],
        [
            strip((-2, 0), (3, 0)),
            strip((0, 0), (0.5, 2), T, 9).intersection(UPPER),
            strip((0, 0), (-0.3, -2), T, 9).intersection(affinity.scale(UPPER, 1, -1, origin=(0, 0))),
        ],
    ),
    "closed": (
        [wall(str(k), at(72 * k, 3), at(72 * k + 72, 3)) for k in range(5)],
        [Polygon([at(72 * k, 3 + T / 2 / math.cos(math.radians(36))) for k in range(5)],
                 [[at(72 * k, 3 - T / 2 / math.cos(math.radians(36))) for k in range(5)]])],
    ),
}  # fmt: skip


@pytest.mark.parametrize("plan", PLANS)
def test_walls_fill_their_plan_and_share_all_faces_inside(plan):
    walls, footprints = PLANS[plan]
    built, ground = Built(walls, courses=8), unary_union(footprints)
    assert built.volume == pytest.approx(8 * H * ground.area, rel=1e-12)
    assert built.exposed == pytest.approx(8 * H * ground.length + ground.area, rel=1e-9)


@pytest.mark.parametrize("plan", PLANS)
def test_no_block_is_a_sliver_and_no_joint_runs_through_two_courses(plan):
    built = Built(PLANS[plan][0], courses=8)
    shares = built.model.parts.volumes[built.free[built.model.part_blocks]] / (0.5 * H * T)
    assert shares.min() > 0.25 - 1e-9
    upright = StartJoints(built.model).faces
    level = np.abs(upright.normals[:, 2]) < 1e-9
    places = [upright.on_first[upright.starts[j] : upright.starts[j + 1]] for j in np.flatnonzero(level)]
    lines = [
        (tuple(np.round(np.sort(p[:, :2].round(6), axis=0).mean(axis=0), 3)), round(p[:, 2].min() / H)) for p in places
    ]
    assert not {(place, course + 1) for place, course in lines} & set(lines)


HAND_BONDED = {  # the walls of docs/space.md, drawn there block by block, and their axes
    "L": (corner_wall(), [wall("x", (0.1, 0.1), (1.2, 0.1)), wall("y", (0.1, 0.1), (0.1, 0.8))]),
    "U": (
        u_wall(),
        [wall("x", (0.1, 0.1), (1.5, 0.1)), wall("l", (0.1, 0.1), (0.1, 0.8)), wall("r", (1.5, 0.1), (1.5, 0.8))],
    ),
    "U with a window": (
        u_wall(window=(2, 3)),
        [
            wall(
                "x",
                (0.1, 0.1),
                (1.5, 0.1),
                openings=[  # from the corner of the axes: a tooth in each of two courses
                    {"x": 0.3, "y": 0.4, "width": 0.4, "height": 0.2},
                    {"x": 0.5, "y": 0.6, "width": 0.4, "height": 0.2},
                ],
            ),
            wall("l", (0.1, 0.1), (0.1, 0.8)),
            wall("r", (1.5, 0.1), (1.5, 0.8)),
        ],
    ),
    "T": (tee_wall(), [wall("x", (0.0, 0.1), (1.6, 0.1)), wall("s", (0.6, 0.1), (0.6, 0.8))]),
}


@pytest.mark.parametrize("name", HAND_BONDED)
def test_the_same_blocks_as_bonded_by_hand(name):
    blocks, walls = HAND_BONDED[name]
    corners = [np.array(block["vertices"]) for block in blocks if not block.get("fixed")]
    by_hand = {tuple(np.round(np.concatenate([c.min(axis=0), c.max(axis=0)]), 9)) for c in corners}
    assert Built(walls, block=[0.4, 0.2], thickness=0.2).boxes() == by_hand


# -- a house: openings, gables, floors ----------------------------------------------------------------------------

DOOR = {"x": 2.0, "y": 0.0, "width": 1.0, "height": 1.75, "lintel": {"height": 0.25, "bearing": 0.25}}
WINDOW = {"x": 0.8, "y": 0.9, "width": 0.6, "height": 0.75}  # on no bed joint
DORMER = {"x": 1.7, "y": 2.75, "width": 0.6, "height": 0.5, "lintel": {"height": 0.25, "bearing": 0.25}}
HOUSE = [
    wall("front", (0, 0), (5, 0), openings=[DOOR, WINDOW]),
    wall("back", (0, 4), (5, 4)),
    wall("left", (0, 0), (0, 4), gable={"height": 1.5}),
    wall("right", (5, 0), (5, 4), gable={"height": 1.5}, openings=[DORMER]),
]
WALLS = 4 * 0.4 * (5.0 + 4.0) / 2.0 * 2.5  # without openings and gables [m3]


def house(**more):
    return Built(HOUSE, **({"thickness": 0.4, "courses": 10} | more))


def test_openings_and_gables():
    built = house()
    voids = [opening["width"] * opening["height"] for opening in (DOOR, WINDOW, DORMER)]
    assert built.volume == pytest.approx(WALLS + 2 * 4.4 * 1.5 / 2 * 0.4 - 0.4 * sum(voids), rel=1e-12)
    faces = 2.5 * (2 * (5.4 + 4.4) + 2 * (4.6 + 3.6)) + 4 * 4.4 * 1.5 / 2 - 2 * sum(voids)
    tops = 0.4 * (2 * 4.6 + 4 * math.hypot(2.2, 1.5))
    jambs = 0.4 * (1.0 + 2 * 1.75 + 2 * (0.6 + 0.75) + 2 * (0.6 + 0.5))  # below the door is the base
    assert built.exposed == pytest.approx(faces + tops + jambs, rel=1e-9)
    assert {"b-front-lintel-1", "b-right-lintel-1"} <= set(built.model.block_ids)


@pytest.mark.parametrize("height", [0.1, 0.3, 1.5])
def test_a_low_gable_on_a_wall_that_is_askew(height):
    """Its lowest pieces belong to stones of the course below. Volume: Simpson across the wall, exact for a slope."""
    askew = wall("c", (2.8, 0), (2.2, 4.7))
    ends = [wall("a", (0, 0), (2.8, 0)), wall("b", (-0.6, 4.7), (2.2, 4.7))]
    level, gabled = (Built([*ends, askew | more]).volume for more in ({}, {"gable": {"height": height}}))
    length = math.hypot(0.6, 4.7)
    slope, middle = 0.6 / 4.7, length / 2.0
    half = middle + T / 2.0 * (length / 4.7 + slope)  # of the gable: to the outermost corners
    over = [middle + T / 2.0 * (length / 4.7 + side * slope) for side in (-1.0, 0.0, 1.0)]  # to either end, across

    def area(one, other):  # under the slopes, to so far on either side of the tip
        return sum(height * (x - x * x / (2.0 * half)) for x in (one, other))

    shares = zip((1.0, 4.0, 1.0), over, over[::-1], strict=True)
    volume = T * sum(share * area(one, other) for share, one, other in shares) / 6.0
    assert gabled - level == pytest.approx(volume, rel=1e-9)


def test_arches_and_steps():
    n, radius = 7, 0.4
    arched = {"x": 1.0, "y": 0.5, "width": 2 * radius, "height": 0.75, "arch": {"voussoirs": n, "ring": 0.25}}
    walls = [wall("front", (0, 0), (5, 0), openings=[arched]), *HOUSE[1:3]]
    stepped = {
        **HOUSE[2],
        "id": "right",
        "axis": [[5.0, 0.0], [5.0, 4.0]],
        "gable": {"height": 1.5, "edges": "stepped"},
    }
    built = Built([*walls, stepped], thickness=0.4, courses=10)
    hole = 2 * radius * 0.75 + n / 2 * radius**2 * math.sin(math.pi / n)
    steps = [4.4 * (1 - (k + 0.5) / 6) for k in range(6)]  # half of the height of each course is under the slope
    gables = 4.4 * 1.5 / 2 + 0.25 * sum(steps)
    assert built.volume == pytest.approx(WALLS + 0.4 * (gables - hole), rel=1e-12)
    faces = 2.5 * (2 * (5.4 + 4.4) + 2 * (4.6 + 3.6)) + 2 * (gables - hole)
    tops = 0.4 * (2 * 4.6 + 2 * math.hypot(2.2, 1.5) + 4.4 + 12 * 0.25)
    reveals = 0.4 * (2 * radius + 2 * 0.75 + n * 2 * radius * math.sin(math.pi / 2 / n))
    assert built.exposed == pytest.approx(faces + tops + reveals, rel=1e-9)
    assert {f"b-front-arch-1-{k + 1}" for k in range(n)} <= set(built.model.block_ids)


def test_names_and_courses():
    built = house(
        floors=[
            {"id": "attic", "z": 2.0, "on": ["front", "back"], "kind": "beams"},
            {"id": "roof", "z": 2.5, "on": ["front", "back"]},
        ],
        base="strips",
    )
    named = {block.id: block for block in built.blocks}
    assert named["b-front-1-1"].course == 1
    assert max(block.course for block in built.blocks) == 16
    assert {"b-base-front", "b-base-right", "b-attic-1", "b-attic-8", "b-roof"} <= set(named)
    assert {block.id for block in built.blocks if block.fixed} == {f"b-base-{each['id']}" for each in HOUSE}
    assert built.blocks[list(named).index("b-front-1-1")].parts[0].vertices[:, 0].min() == -0.2  # it passes first
    assert named["b-left-1-1"].parts[0].vertices[:, 1].min() == 0.2


def test_a_plate_bears_on_half_of_its_walls():
    whole, built = house(), house(floors=[{"id": "f", "z": 2.0, "on": ["left", "right"], "mass": 900.0}])
    plate = built.model.numbers["b-f"]
    low, high = (limit(built.corners[built.model.vertex_blocks == plate], axis=0) for limit in (np.min, np.max))
    np.testing.assert_allclose(low, [0.0, 0.2 + 0.02, 2.0], atol=1e-12)
    np.testing.assert_allclose(high, [5.0, 4.0 - 0.2 - 0.02, 2.25], atol=1e-12)
    assert built.model.masses[plate] == 900.0
    taken = 2 * 0.2 * 3.6 * 0.25  # of the walls, by its pockets
    plate_volume = 5.0 * 3.56 * 0.25
    assert built.volume == pytest.approx(whole.volume - taken + plate_volume, rel=1e-12)
    shared = StartJoints(built.model)
    below = sum(
        area
        for blocks, normal, area in zip(shared.faces.blocks, shared.faces.normals, shared.faces.areas)
        if plate in blocks and abs(normal[2]) > 0.9
    )
    assert below == pytest.approx(2 * (2 * 0.2 * 3.56), rel=1e-9)  # as much of the walls lies on it


@pytest.mark.parametrize("bearing", [0.4, 0.2])
def test_beams_have_pockets(bearing):
    floor = {"id": "f", "z": 2.0, "on": ["left", "right"], "kind": "beams", "bearing": bearing, "height": 0.2}
    whole, built = house(), house(floors=[floor])
    beams = [name for name in built.model.block_ids if name.startswith("b-f-")]
    assert len(beams) == 6  # 3.6 m at 0.6 m
    pocket, length = 2 * bearing * 0.15 * 0.25, 4.6 + 2 * bearing
    assert built.volume == pytest.approx(whole.volume + 6 * (length * 0.15 * 0.2 - pocket), rel=1e-12)
    shares = built.model.masses[built.free] / (2143.0 * 0.5 * 0.25 * 0.4)
    assert shares.min() > 0.25 * 0.25 / 0.5  # half of the height of a quarter: the tips of the gables


def test_beams_into_a_wall_askew():
    walls = [
        wall("a", (0, 0), (3, 0)),
        wall("b", (3, 0), (3.4, 3)),
        wall("c", (3.4, 3), (0, 3)),
        wall("d", (0, 3), (0, 0)),
    ]
    Built(walls, floors=[{"id": "f", "z": 1.0, "on": ["d", "b"], "kind": "beams"}])  # no overlap


def test_a_floor_between_two_walls_that_do_not_meet():
    built = Built(
        [wall("a", (0, 0), (0, 2)), wall("b", (3, 2), (3, 0))], floors=[{"id": "f", "z": 1.5, "on": ["b", "a"]}]
    )
    plate = built.corners[built.model.vertex_blocks == built.model.numbers["b-f"]]
    np.testing.assert_allclose([plate.min(axis=0), plate.max(axis=0)], [[0, 0, 1.5], [3, 2, 1.75]], atol=1e-12)


def test_a_wall_does_not_pass_where_a_floor_bears_behind_it():
    outside = wall("buttress", (2.5, 0), (2.5, -1.5))
    walls = [*HOUSE[1:], wall("front", (0, 0), (5, 0)), outside]
    Built(walls, thickness=0.4, courses=10, floors=[{"id": "f", "z": 2.0, "on": ["front", "back"]}])  # no overlap


def test_mirrored_and_turned_plans_have_the_same_blocks():
    def volumes(walls):
        built = Built(walls)
        return np.sort(built.model.parts.volumes[built.free[built.model.part_blocks]])

    walls = [wall("a", (0, 0), (3, 0)), wall("b", (0, 0), (0.5, 2.0)), wall("c", (1.7, 0), (1.7, 2.2))]
    ways = {
        "mirrored": lambda p: [-p[0], p[1]],
        "turned": lambda p: [-p[1], p[0]],
        "the other way": None,
    }
    for name, way in ways.items():
        axes = [each["axis"][::-1] if way is None else [way(p) for p in each["axis"]] for each in walls]
        changed = [{**each, "axis": axis} for each, axis in zip(walls, axes)]
        np.testing.assert_allclose(volumes(changed), volumes(walls), rtol=1e-9, err_msg=name)


REFUSED = {
    "gables that meet": (
        [wall("a", (0, 0), (3, 0), gable={"height": 1.0}), wall("b", (0, 0), (0, 3), gable={"height": 0.5})],
        {},
        r"structure\.0\.walls\.1\.gable: wall 'a' has one too, and they meet: of two walls that meet one has a gable",
    ),
    "angle": (
        [wall("a", (0, 0), (3, 0)), wall("b", (0, 0), (3, 0.5))],
        {},
        "walls.1.axis: .* overlap at an angle of 9.46°",
    ),
    "one line": ([wall("a", (0, 0), (3, 0)), wall("b", (3, 0), (5, 0))], {}, "walls.1.axis: .* go on in one line"),
    "three at a place": (
        [wall("a", (0, 0), (3, 0)), wall("b", (0, 0), (-2, 2)), wall("c", (0, 0), (-2, -2))],
        {},
        "meet too near to each other at",
    ),
    "two near": (
        [wall("a", (0, 0), (3, 0)), wall("b", (1, 0), (1, 2)), wall("c", (1.2, 0), (1.2, 2))],
        {},
        "meet too near to each other at \\[1, 0\\]",
    ),
    "apart": (
        [wall("a", (0, 0), (3, 0)), wall("b", (2.7, 0.4), (4.7, 2.4), thickness=1.0)],
        {},
        "overlap, but their axes do not meet",
    ),
    "short": ([wall("a", (0, 0), (3, 0)), wall("b", (1, 0), (1, 0.1))], {}, "walls.1.axis: wall 'b' is too short"),
    "sliver": (
        [wall("a", (0, 0), (3, 0)), wall("b", (1, 0), (1, 0.2))],
        {},
        "walls.1.axis: a piece is left that is too short",
    ),
    "opening in a corner": (
        [
            wall("a", (0, 0), (3, 0), openings=[{"x": 0.0, "y": 0.5, "width": 0.5, "height": 0.5}]),
            wall("b", (0, 0), (0, 3)),
        ],
        {},
        "walls.0.openings.0: it goes from 0 to 0.5 along wall 'a', which is free of other walls from",
    ),
    "opening beside a corner": (
        [
            wall("a", (0, 0), (3, 0), openings=[{"x": 0.2, "y": 0.5, "width": 0.5, "height": 0.5}]),
            wall("b", (0, 0), (0, 3)),
        ],
        {},
        "walls.0.openings.0: a piece is left that is too short, 0.05 m long",
    ),
    "opening above": (
        [wall("a", (0, 0), (3, 0), openings=[{"x": 0.5, "y": 1.0, "width": 0.5, "height": 1.0}])],
        {},
        "walls.0.openings.0: it reaches up to 2; wall 'a' is 1.5 high",
    ),
    "name": ([wall("a", (0, 0), (3, 0)), wall("a", (0, 0), (0, 3))], {}, "walls.1.id: the name 'a' is taken"),
    "floor on nothing": (
        HOUSE,
        {"floors": [{"id": "f", "z": 1.0, "on": ["roof"]}]},
        "floors.0.on.0: there is no wall 'roof'",
    ),
    "floor between joints": (HOUSE, {"floors": [{"id": "f", "z": 1.1, "on": ["left"]}]}, "nearest one is at 1"),
    "no such room": (
        [wall("a", (0, 0), (3, 0)), wall("b", (0, 0), (0, 3))],
        {"floors": [{"id": "f", "z": 1.0, "on": ["a", "b"]}]},
        "no room is bounded by 'a', 'b'",
    ),
    "beams around a corner": (
        HOUSE,
        {"floors": [{"id": "f", "z": 1.0, "on": ["left", "front"], "kind": "beams"}]},
        "floors.0.on: walls 'left' and 'front' stand at an angle",
    ),
    "leaf too thin": (
        HOUSE,
        {"floors": [{"id": "f", "z": 1.0, "on": ["left"], "bearing": 0.28}]},
        "leaves 0.02 m of 'left'",
    ),
    "arch in a wall that passes": (
        [
            wall(
                "a",
                (0, 0),
                (4, 0),
                openings=[{**DOOR, "x": 0.8, "lintel": None, "arch": {"voussoirs": 9, "ring": 0.3}}],
            ),
            wall("s", (2, 0), (2, 2)),
        ],
        {"courses": 12},
        "walls.0.openings.0: its arch, from 0.5 to 2.1 along wall 'a', reaches into another wall",
    ),
    "floor at the foot of a gable": (
        HOUSE,
        {"courses": 10, "floors": [{"id": "f", "z": 2.5, "on": ["left", "right"]}]},
        "floors.0.on.0: wall 'left' goes on as a gable from 2.5",
    ),
    "floor above a wall": (
        [*HOUSE[:3], wall("right", (5, 0), (5, 4), courses=4)],
        {"courses": 10, "floors": [{"id": "f", "z": 2.0, "on": ["left", "right"]}]},
        "floors.0.on.1: wall 'right' is 1 high, the floor lies at 2",
    ),
    "plate in a lintel": (
        HOUSE,
        {"courses": 10, "floors": [{"id": "f", "z": 1.75, "on": ["front", "back"]}]},
        "floors.0.z: at 1.75 it would cut what is over openings\\[1\\] of wall 'front'",
    ),
    "two rooms": (
        [*HOUSE, wall("spine", (2.5, 0), (2.5, 4))],
        {"floors": [{"id": "f", "z": 1.0, "on": ["front", "back"]}]},
        "2 rooms are bounded by 'front', 'back'",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_built_says_why(what):
    walls, more, message = REFUSED[what]
    with pytest.raises(CaseError, match=message):
        Built(walls, **more)


def test_there_are_no_buildings_in_the_plane():
    with pytest.raises(CaseError, match="'building' is not allowed in 2D"):
        spatial_case(dimension=2, structure=[building(HOUSE)])
