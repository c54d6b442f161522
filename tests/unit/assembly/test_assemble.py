"""From case to arrays: masses, loads of each pattern, names, order."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.assemble import assemble, assembly, joint_table
from dem_cli.masonry.assembly.validate import problems, warnings

SQUARE = {"id": "a", "vertices": [[1, 1], [0, 0], [1, 0], [0, 1]], "thickness": 2.0}
FLOOR = {"id": "floor", "vertices": [[-1, -1], [9, -1], [9, 0], [-1, 0]], "fixed": True}
L_SHAPE = {"id": "l", "parts": [[[0, 0], [3, 0], [3, 1], [0, 1]], [[0, 1], [1, 1], [1, 3], [0, 3]]]}


def test_the_thesis_wall(case_of, wall):
    model = assemble(case_of(structure=[wall]))
    assert model.n_blocks == model.n_parts == 22
    assert model.block_ids[0] == "wall-base"
    assert model.fixed.tolist() == [True] + [False] * 21
    full = model.block_ids.index("wall-2-2")
    assert model.masses[full] == pytest.approx(0.12, rel=1e-3)  # the data book's 0.12 kg
    assert model.inertias[full, 0] == pytest.approx(model.masses[full] * (0.04**2 + 0.0175**2) / 12)
    assert model.centroids[full] == pytest.approx([0.06, 0.02625])
    assert model.masses[~model.fixed].sum() == pytest.approx(0.12 * 0.105 * 0.08 * 2143.0)
    assert model.dead_loads[:, 1] == pytest.approx(-9.81 * model.masses)
    for array in model:
        if isinstance(array, np.ndarray):
            assert array.flags["C_CONTIGUOUS"]
    kinds = {name: getattr(model, name).dtype for name in ("part_blocks", "part_starts", "block_material")}
    assert set(kinds.values()) == {np.dtype(np.int64)}


def test_blocks_are_numbered_from_the_lowest_up_and_left_to_right(case_of, wall):
    turned = assemble(case_of(structure=[wall | {"rotation_deg": 0.0, "origin": [3.3, 0.1]}]))
    courses = [int(name.split("-")[1]) for name in turned.block_ids[1:]]
    assert courses == sorted(courses)
    assert turned.block_ids[1:5] == ("wall-1-1", "wall-1-2", "wall-1-3", "wall-1-4")


def test_names_and_aliases(case_of, wall):
    alone = assembly(case_of(structure=[wall])).model.numbers
    assert alone["top-right"] == alone["wall-top-right"] == alone["wall-6-3"] == alone["6-3"]
    assert alone["base"] == 0
    two = assembly(case_of(structure=[wall, wall | {"origin": [1.0, 0.0]}])).model.numbers
    assert "top-right" not in two
    assert two["wall2-top-right"] == two["wall2-6-3"]


def test_a_block_called_like_an_alias_wins(case_of, wall):
    found = assembly(case_of(structure=[wall], block=[SQUARE | {"id": "top-right"}]))
    assert found.blocks[found.model.numbers["top-right"]].path == ("block", 0)


def test_corners_in_any_order_and_compounds(case_of):
    model = assemble(case_of(block=[SQUARE, L_SHAPE]))
    square, shape = (model.block_ids.index(name) for name in "al")
    assert model.masses[square] == pytest.approx(2143.0 * 2.0)
    assert model.inertias[square, 0] == pytest.approx(2143.0 * 2.0 / 6)
    assert model.n_parts == 3
    assert model.centroids[shape] == pytest.approx([1.1, 1.1])
    corners = model.vertices[model.part_starts[1] :] + model.centroids[shape]
    assert corners.min(axis=0) == pytest.approx([0.0, 0.0])


def test_pattern_mass(case_of, wall):
    case = case_of(structure=[wall], analysis={"direction": [-2.0, 0.0]})
    model = assemble(case)
    expected = np.where(model.fixed, 0.0, -9.81 * model.masses)
    assert model.live_loads[:, 0] == pytest.approx(expected)
    assert not model.live_loads[:, 1:].any()


def test_no_pattern_no_live_loads(case_of, wall):
    assert not assemble(case_of(structure=[wall], analysis={"kind": "gravity"})).live_loads.any()


LOADS = [
    {"block": "a", "force": [0.0, -500.0], "at": [0.75, 1.0]},
    {"block": "a", "force": [30.0, 0.0], "at": [0.0, 0.75], "kind": "live"},
    {"block": "a", "force": [1.0, 2.0], "kind": "live"},
]


def test_point_loads_about_the_centroid(case_of):
    model = assemble(case_of(block=[SQUARE, FLOOR], load=LOADS, analysis={"pattern": "live"}))
    a = model.block_ids.index("a")
    assert model.dead_loads[a] == pytest.approx([0.0, -500.0 - 9.81 * model.masses[a], -500.0 * 0.25])
    assert model.live_loads[a] == pytest.approx([31.0, 2.0, -30.0 * 0.25])
    assert not model.live_loads[1 - a].any()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_pattern_tilt_turns_what_is_dead(case_of, sign):
    case = case_of(block=[SQUARE, FLOOR], load=LOADS, analysis={"pattern": "tilt", "direction": [sign, 0.0]})
    model = assemble(case)
    a = model.block_ids.index("a")
    force = 500.0 + 9.81 * model.masses[a]
    assert model.live_loads[a] == pytest.approx([sign * force, 0.0, -sign * 500.0 * 0.5])
    angle = 0.3  # what a table turned by that angle gives, in its own frame
    turned = math.cos(angle) * (model.dead_loads[a] + math.tan(angle) * model.live_loads[a])
    assert turned[:2] == pytest.approx([sign * force * math.sin(angle), -force * math.cos(angle)])


def test_joints_between_materials(case_of):
    case = case_of(
        materials={name: {"density": 1000.0} for name in ("stone", "oak", "lead")},
        joints={"dry": {"friction": 0.6}, "wood": {"friction": 0.3}, "soft": {"friction": 0.2}},
        interface=[
            {"between": ["oak", "stone"], "joint": "wood"},
            {"between": ["lead", "lead"], "joint": "soft"},
        ],
        block=[SQUARE | {"material": "oak"}],
    )
    names, table = joint_table(case)
    assert names == ("dry", "wood", "soft")
    assert table.tolist() == [[0, 1, 0], [1, 0, 0], [0, 0, 2]]


BAD = {
    "block.0.vertices: corners 1 and 3 are the same point, [0, 0]; give each once": {
        "block": [FLOOR | {"vertices": [[0, 0], [1, 0], [0, 0], [1, 1]]}]
    },
    "block.0.parts.1: the corners lie on one line: the polygon has no area": {
        "block": [L_SHAPE | {"parts": [*L_SHAPE["parts"][:1], [[0, 0], [1, 1], [2, 2]]]}]
    },
    "load.0.block: unknown block 'flor', did you mean 'floor'? (allowed: 'floor', 'a')": {
        "block": [FLOOR, SQUARE],
        "load": [{"block": "flor", "force": [0.0, 1.0]}],
    },
    "settlement.0.block: block 'a' is not fixed; only a fixed block can be moved": {
        "block": [FLOOR, SQUARE],
        "settlement": [{"block": "a", "displacement": [0.0, -0.1]}],
    },
    "analysis.direction: [0, 0] is not allowed; a direction has a length": {
        "block": [FLOOR],
        "analysis": {"direction": [0.0, 0.0]},
    },
    "analysis.direction: a table tilts towards +x or −x; the direction must have an x component": {
        "block": [FLOOR],
        "analysis": {"direction": [0.0, 1.0], "pattern": "tilt"},
    },
    "structure.0: voussoir 1 is not convex; use more voussoirs or a thinner ring": {
        "structure": [{"kind": "arch", "voussoirs": 1, "radius": 1.0, "ring": 0.1}]
    },
}


@pytest.mark.parametrize(("message", "tables"), BAD.items())
def test_what_is_wrong(case_of, message, tables):
    with pytest.raises(CaseError) as error:
        assemble(case_of(**tables))
    assert str(error.value) == message


def test_a_name_taken_twice(case_of, wall):
    with pytest.raises(CaseError) as error:
        assemble(case_of(structure=[wall], block=[SQUARE | {"id": "wall-2-3"}]))
    assert str(error.value) == "block.0.id: the name 'wall-2-3' is taken by a block of structure.0; give another"


def test_ten_thousand_blocks_in_less_than_five_seconds(case_of, wall):
    case = case_of(structure=[wall | {"courses": 100, "blocks_per_course": 100}])
    start = time.process_time()
    found = assembly(case)
    assert problems(case, found.model, found.blocks) == []
    assert warnings(found.model) == []
    assert found.model.n_blocks == 10_051
    assert time.process_time() - start < 5.0
