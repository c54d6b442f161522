"""Sides of a wall in 3D: fixed supports behind its faces, and bases with a margin all around."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic.spatial_case import spatial_case

from dem_cli.core.contact.detect import find_joints
from dem_cli.core.model.places import undeformed
from dem_cli.masonry.assembly.assemble import assemble
from dem_cli.masonry.assembly.validate import problems

WALL = {"kind": "wall", "block": [1.0, 0.5], "courses": 4, "blocks_per_course": 6, "thickness": 0.8}


def boxes(**wall):
    """Lower and upper corners of the blocks by name, and which are fixed."""
    model = assemble(spatial_case(structure=[WALL | wall]))
    corners = undeformed(model)
    found = {}
    for i, name in enumerate(model.block_ids):
        own = corners[model.vertex_blocks == i]
        found[name] = (own.min(axis=0).tolist(), own.max(axis=0).tolist(), bool(model.fixed[i]))
    return found


@pytest.mark.parametrize(
    ("side", "expected"),
    [
        ({"face": "-y"}, {"wall-side-1": ([0, -1.2, 0], [6, -0.4, 2])}),
        ({"face": "+y", "reach": 0.5}, {"wall-side-1": ([0, 0.4, 0], [6, 0.9, 2])}),
        (
            {"face": "-y", "strip": 0.3},
            {"wall-side-1-left": ([0, -0.7, 0], [0.3, -0.4, 2]), "wall-side-1-right": ([5.7, -0.7, 0], [6, -0.4, 2])},
        ),
        (
            {"face": "+y", "strip": 4.0, "ends": "right", "reach": 1.0, "height": 1.5},
            {"wall-side-1-right": ([2, 0.4, 0], [6, 1.4, 1.5])},
        ),
        ({"face": "-x"}, {"wall-side-1": ([-0.8, -0.4, 0], [0, 0.4, 2])}),
        ({"face": "+x", "reach": 0.2}, {"wall-side-1": ([6, -0.4, 0], [6.2, 0.4, 2])}),
    ],
)
def test_where_sides_are(side, expected):
    found = boxes(sides=[side], base_height=0.3, base_extension=0.2)  # a base with a margin stays below
    made = {name: box for name, box in found.items() if "side" in name}
    assert set(made) == set(expected)
    for name, (low, high) in expected.items():
        assert made[name][0] == pytest.approx(low)
        assert made[name][1] == pytest.approx(high)
        assert made[name][2]


def test_sides_go_as_deep_as_a_base_without_a_margin():
    assert boxes(sides=[{"face": "-y"}], base_height=0.3)["wall-side-1"][0] == pytest.approx([0.0, -1.2, -0.3])
    assert boxes(sides=[{"face": "-y", "height": 1.5}], base=False)["wall-side-1"][0][2] == 0.0
    assert boxes(sides=[{"face": "-y", "height": 1.5}])["wall-side-1"][1][2] == 1.5


def test_the_wall_touches_its_sides_and_only_they_are_fixed():
    case = spatial_case(
        structure=[WALL | {"sides": [{"face": "-y", "strip": 0.8}, {"face": "+x"}], "rotation_deg": 30.0}]
    )
    model = assemble(case)
    assert model.fixed.sum() == 4
    faces = find_joints(model, undeformed(model), 1e-9)
    pairs = {tuple(sorted(model.block_ids[i] for i in pair)) for pair in model.part_blocks[faces.parts]}
    left = {a for a, b in pairs if b == "wall-side-1-left"}
    assert left == {"wall-1-1", "wall-1-2", "wall-2-1", "wall-3-1", "wall-3-2", "wall-4-1"}
    assert {a for a, b in pairs if b == "wall-side-2"} >= {"wall-1-7", "wall-2-6", "wall-3-7", "wall-4-6"}


def test_sides_may_have_a_material_of_their_own():
    case = spatial_case(
        materials={"peperino": {"density": 2143.0}, "rock": {"density": 2700.0}},
        joints={"dry": {"friction": 0.6}, "slick": {"friction": 0.1}},
        interface=[{"between": ["peperino", "rock"], "joint": "slick"}],
        structure=[WALL | {"material": "peperino", "sides": [{"face": "-y", "material": "rock"}]}],
    )
    model = assemble(case)
    assert model.material_names[model.block_material[model.numbers["wall-side-1"]]] == "rock"


def test_short_names_are_of_the_wall_alone():
    model = assemble(spatial_case(structure=[WALL | {"sides": [{"face": "+x"}, {"face": "-y"}]}]))
    assert model.block_ids[model.numbers["top-right"]] == "wall-4-6"
    assert model.block_ids[model.numbers["bottom-left"]] == "wall-1-1"
    assert model.block_ids[model.numbers["side-1"]] == "wall-side-1"


@pytest.mark.parametrize(
    "structure",
    [
        WALL,
        {"kind": "column", "block": [0.5, 0.4], "courses": 3, "thickness": 0.8},
        {"kind": "arch", "voussoirs": 7, "span": 2.0, "rise": 0.5, "shape": "segmental", "ring": 0.2, "thickness": 0.8,
         "columns": {"width": 0.5, "height": 1.0}},
    ],
    ids=lambda table: table["kind"],
)  # fmt: skip
def test_a_base_has_the_same_margin_all_around(structure):
    model = assemble(spatial_case(structure=[structure | {"base_extension": 0.25}]))
    corners = undeformed(model)
    base = corners[model.fixed[model.vertex_blocks]]
    assert (base[:, 1].min(), base[:, 1].max()) == pytest.approx((-0.65, 0.65))
    above = corners[~model.fixed[model.vertex_blocks]]
    assert above[:, 0].min() - base[:, 0].min() == pytest.approx(0.25)
    assert np.abs(above[:, 1]).max() == pytest.approx(0.4)


def test_walls_at_right_angles_meet_without_overlap():
    """Origin in the middle of the thickness: one wall stands behind the left end of the other."""
    across = WALL | {"id": "return", "rotation_deg": 90.0, "origin": [0.4, 0.4, 0.0], "blocks_per_course": 3}
    case = spatial_case(structure=[WALL, across])
    found = assemble(case)
    from dem_cli.masonry.assembly.assemble import assembly

    assert problems(case, found, assembly(case).blocks) == []
