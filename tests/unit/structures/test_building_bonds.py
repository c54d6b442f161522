"""Bonds and leaves of buildings: volumes and shared faces exact, no slivers, heads apart, leaves where walls meet."""

from __future__ import annotations

import numpy as np
import pytest
from shapely.ops import unary_union
from unit.structures.test_building import PLANS, Built, H, T, wall

from dem_cli.core.contact.between import StartJoints
from dem_cli.errors import CaseError

LENGTH = 0.5  # of a block [m]
BONDS = {
    "stack": {"bond": "stack"},
    "a fifth": {"offset": 0.1},
    "through-stones": {"leaves": 2, "through_stones": 0.2},
    "english": {"bond": "english", "leaves": 2},
    "flemish": {"bond": "flemish", "leaves": 2},
    "english-garden": {"bond": "english-garden", "leaves": 3},
}
CORNER = [wall("a", (0, 0), (3, 0)), wall("b", (0, 0), (0, 3))]


def shares(built, leaves):
    """Volumes of free blocks, in full blocks that are as deep as they."""
    model = built.model
    each = np.bincount(model.part_blocks, model.parts.volumes)
    depths = np.array([1.0 / leaves if name[-1] in "abc" else 1.0 for name in model.block_ids])
    return (each / (LENGTH * H * T * depths))[built.free]


def through(built):
    """Pairs of upright joints, one right above the other, not those between leaves or of two walls."""
    faces, ids = StartJoints(built.model).faces, built.model.block_ids
    found = set()
    for j in np.flatnonzero(np.abs(faces.normals[:, 2]) < 1e-9):
        one, other = (ids[i] for i in faces.blocks[j])
        leaves = {name[-1] for name in (one, other)}
        same_leaf = len(leaves & set("abc")) < 2
        if same_leaf and one.split("-")[1] == other.split("-")[1]:
            places = faces.on_first[faces.starts[j] : faces.starts[j + 1]]
            x, y = places[:, :2].mean(axis=0).round(3)
            found.add((one.split("-")[1], x, y, round(places[:, 2].min() / H)))
    return {(name, x, y, course) for name, x, y, course in found if (name, x, y, course + 1) in found}


@pytest.mark.parametrize("bond", BONDS)
@pytest.mark.parametrize("plan", ["corner 35", "stem 60", "crossing 115", "two stems"])
def test_walls_fill_their_plan_in_any_bond(plan, bond):
    walls, footprints = PLANS[plan]
    built, ground = Built(walls, courses=8, **BONDS[bond]), unary_union(footprints)
    assert built.volume == pytest.approx(8 * H * ground.area, rel=1e-12)
    assert built.exposed == pytest.approx(8 * H * ground.length + ground.area, rel=1e-9)
    same = Built([{**each, "thickness": T} for each in walls], courses=8, **BONDS[bond])
    assert shares(same, BONDS[bond].get("leaves", 1)).min() > 0.25 - 1e-9
    if bond != "stack":
        assert not through(built)


def test_stack_bond_has_heads_above_heads_between_walls_that_are_bonded():
    built = Built(CORNER, bond="stack")
    inner = {(name, x, y) for name, x, y, _ in through(built)}
    assert {name for name, _, _ in inner} == {"a", "b"}
    near = T / 2.0 + 0.25 * LENGTH - 1e-9  # of a block, behind the face of the other wall
    assert min(x if name == "a" else y for name, x, y in inner) >= near


def test_courses_of_english_bond_are_stretchers_and_headers_in_turn():
    built = Built([wall("a", (0, 0), (4, 0))], bond="english", leaves=2)
    owners, found = built.model.vertex_blocks, {}
    for i in np.flatnonzero(built.free):
        course = int(built.model.block_ids[i].split("-")[2])
        found.setdefault(course, []).append(np.ptp(built.corners[owners == i], axis=0).round(9)[:2].tolist())
    assert [LENGTH, T / 2] in found[1]
    assert [LENGTH, T / 2] not in found[2]
    headers = [size for size in found[2] if size == [LENGTH / 2, T]]
    assert len(headers) >= 12  # of 16; ends and closers are longer or shorter


def test_ends_and_corners_go_through_all_leaves():
    names = set(Built(CORNER, leaves=2).model.block_ids)
    assert {"b-a-1-1", "b-b-2-1", "b-a-1-3a", "b-a-1-3b"} <= names
    assert not {"b-a-1-1a", "b-b-2-1a"} & names


REFUSED = {
    "both": ({"bond": "stack", "offset": 0.1}, "offset: bond and offset say the same"),
    "long": ({"offset": 0.5}, "offset: 0.5 is not allowed; must be less than the block length, 0.5"),
    "one leaf": ({"through_stones": 0.2}, "through_stones: not used with leaves = 1"),
    "rubble in leaves": ({"leaves": 2, "pattern": {"kind": "voronoi", "cell": 0.3}}, "leaves: not used with a pattern"),
    "headers in rubble": (
        {"bond": "flemish", "pattern": {"kind": "voronoi", "cell": 0.3}},
        "bond: 'flemish' is not allowed with a pattern",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_keys_of_the_bond_that_do_not_go_together(what):
    more, message = REFUSED[what]
    with pytest.raises(CaseError, match=message):
        Built(CORNER, **more)
