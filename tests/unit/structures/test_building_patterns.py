"""Buildings of irregular stones: volumes and shared faces exact, dressed stones where walls meet, what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shapely.ops import unary_union
from unit.structures.test_building import DOOR, DORMER, HOUSE, PLANS, WALLS, WINDOW, Built, H, T, wall

from dem_cli.errors import CaseError

RUBBLE = {"kind": "voronoi", "cell": 0.3}
COURSED = {
    "kind": "coursed",
    "spacing": [0.3, 0.05],
    "segment": [0.6, 0.2],
    "deviation": [0.0, 0.0],
    "head_spacing": [0.4, 0.1],
    "head_angle_deg": [0.0, 5.0],
}
MEAN = {"voronoi": 0.3**2, "coursed": 0.3 * 0.4}  # [m2]
COTTAGE = [{**HOUSE[0], "openings": [DOOR, WINDOW | {"x": 1.0}]}, *HOUSE[1:]]


def volumes(built, which):
    """Volumes of free blocks whose names have a word in them or not [m3]."""
    model = built.model
    each = np.bincount(model.part_blocks, model.parts.volumes)
    return np.array([each[i] for i in np.flatnonzero(built.free) if ("-dressed-" in model.block_ids[i]) == which])


@pytest.mark.parametrize("pattern", [RUBBLE, COURSED], ids=["voronoi", "coursed"])
@pytest.mark.parametrize("plan", ["corner 90", "corner 35", "stem 45", "crossing 115", "two stems", "closed"])
def test_walls_of_irregular_stones_fill_their_plan_and_share_all_faces_inside(plan, pattern):
    walls, footprints = PLANS[plan]
    same = [{**each, "thickness": T} for each in walls]
    built = Built(walls, courses=8, pattern=pattern, seed=3)
    ground = unary_union(footprints)
    assert built.volume == pytest.approx(8 * H * ground.area, rel=1e-12)
    assert built.exposed == pytest.approx(8 * H * ground.length + ground.area, rel=1e-9)
    alike = Built(same, courses=8, pattern=pattern, seed=3)
    assert volumes(alike, False).min() > 0.25 * MEAN[pattern["kind"]] * T * 0.95  # the mean of whole numbers of stones


def test_dressed_stones_are_those_of_the_regular_bond():
    walls = PLANS["closed"][0]
    regular, rubble = Built(walls).boxes(), Built(walls, pattern=RUBBLE, seed=1)
    dressed = {i for i, name in enumerate(rubble.model.block_ids) if "-dressed-" in name}
    owners = rubble.model.vertex_blocks
    boxes = {
        tuple(np.round(np.concatenate([own.min(axis=0), own.max(axis=0)]), 9))
        for own in (rubble.corners[owners == i] for i in dressed)
    }
    assert boxes <= regular
    ends = len(walls) * 6 * 2
    assert ends <= len(dressed) < 1.25 * ends  # one at either end of each course, two where that one is a short one


def test_a_cottage_with_openings_gables_and_an_arch():
    built = Built(COTTAGE, thickness=0.4, courses=10, pattern=RUBBLE, seed=1)
    voids = [opening["width"] * opening["height"] for opening in (DOOR, WINDOW, DORMER)]
    assert built.volume == pytest.approx(WALLS + 2 * 4.4 * 1.5 / 2 * 0.4 - 0.4 * sum(voids), rel=1e-12)
    faces = 2.5 * (2 * (5.4 + 4.4) + 2 * (4.6 + 3.6)) + 4 * 4.4 * 1.5 / 2 - 2 * sum(voids)
    tops = 0.4 * (2 * 4.6 + 4 * math.hypot(2.2, 1.5))
    jambs = 0.4 * (1.0 + 2 * 1.75 + 2 * (0.6 + 0.75) + 2 * (0.6 + 0.5))
    assert built.exposed == pytest.approx(faces + tops + jambs, rel=1e-9)
    assert {"b-front-lintel-1", "b-front-dressed-1-1", "b-front-1"} <= set(built.model.block_ids)
    radius, n = 0.4, 7
    arched = {"x": 1.6, "y": 0.5, "width": 2 * radius, "height": 0.75, "arch": {"voussoirs": n, "ring": 0.25}}
    walls = [wall("front", (0, 0), (5, 0), openings=[arched]), *HOUSE[1:3], wall("right", (5, 0), (5, 4))]
    hole = 2 * radius * 0.75 + n / 2 * radius**2 * math.sin(math.pi / n)
    whole = WALLS + 4.4 * 1.5 / 2 * 0.4 - 0.4 * hole
    assert Built(walls, thickness=0.4, courses=10, pattern=RUBBLE).volume == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize("floor", [{"kind": "rigid"}, {"kind": "beams", "bearing": 0.2, "height": 0.2}])
def test_floors_bear_on_dressed_stones(floor):
    floor = {"id": "f", "z": 2.0, "on": ["left", "right"], **floor}
    regular, rubble = (
        Built(COTTAGE, thickness=0.4, courses=10, floors=[floor], **more) for more in ({}, {"pattern": RUBBLE})
    )
    assert rubble.volume == pytest.approx(regular.volume, rel=1e-12)
    assert rubble.exposed == pytest.approx(regular.exposed, rel=1e-9)


def test_a_wall_has_its_own_pattern_and_stones_of_its_own_seed():
    walls = [wall("a", (0, 0), (3, 0)), wall("b", (0, 0), (0, 3)), wall("c", (3, 0), (3, 3))]
    one = [{**walls[0], "pattern": COURSED}, *walls[1:]]
    built = Built(one, seed=2)
    names = set(built.model.block_ids)
    assert {"b-a-1-1", "b-a-dressed-1-1", "b-b-1-1"} <= names
    assert not {"b-b-1", "b-b-dressed-1-1"} & names
    first, again, other = (Built(walls, pattern=RUBBLE, seed=seed).boxes() for seed in (1, 1, 2))
    assert first == again != other
    fewer = Built([walls[0], walls[1] | {"pattern": COURSED}, walls[2]], pattern=RUBBLE, seed=1).boxes()
    assert {box for box in first if box[0] > 0.3} == {box for box in fewer if box[0] > 0.3}  # those of the others stay


REFUSED = {
    "opening in dressed stones": (
        [{**HOUSE[0], "openings": [DOOR, WINDOW | {"x": 0.5}]}, *HOUSE[1:]],
        {"pattern": RUBBLE, "courses": 10, "thickness": 0.4},
        r"structure\.0\.walls\.0\.openings\.1: it reaches into dressed stones .* along wall 'front'",
    ),
    "stones as large as a wall": (
        [wall("a", (0, 0), (3, 0))],
        {"pattern": {"kind": "voronoi", "cell": 3.0}},
        r"structure\.0\.pattern\.cell: 3 makes only one stone; .* \(wall 'a'\)",
    ),
    "of a wall of its own": (
        [wall("a", (0, 0), (3, 0), pattern={"kind": "voronoi", "cell": 3.0})],
        {},
        r"structure\.0\.walls\.0\.pattern\.cell: ",
    ),
    "steps": (
        [wall("a", (0, 0), (3, 0), gable={"height": 1.0, "edges": "stepped"})],
        {"pattern": RUBBLE},
        r"walls\.0\.gable\.edges: 'stepped' is not allowed with a pattern",
    ),
    "a gable on a wall that is askew": (
        [wall("a", (0, 0), (3, 0), gable={"height": 1.0}), wall("b", (0, 0), (1, 3))],
        {"pattern": RUBBLE},
        r"walls\.0\.gable: wall 'b' meets it askew",
    ),
    "a wall higher than the foot of a gable": (
        [wall("a", (0, 0), (3, 0), gable={"height": 1.0}, courses=4), wall("b", (0, 0), (0, 3))],
        {"pattern": RUBBLE},
        r"walls\.0\.gable: wall 'b' meets it above its courses",
    ),
    "no kind": ([wall("a", (0, 0), (3, 0))], {"pattern": {"cell": 0.3}}, r"pattern\.kind: missing; must be"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_a_pattern_cannot_fill_says_why(what):
    walls, more, message = REFUSED[what]
    with pytest.raises(CaseError, match=message):
        Built(walls, **more)
