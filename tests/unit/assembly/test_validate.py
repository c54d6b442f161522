"""Geometry that cannot be: overlaps, floating blocks, no support, bad shapes; and what deserves a warning."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.model.blocks import Block
from dem_cli.masonry.assembly.assemble import assemble, assembly
from dem_cli.masonry.assembly.validate import problems, shape_problems, warnings

FLOOR = {"id": "floor", "vertices": [[0, -1], [9, -1], [9, 0], [0, 0]], "fixed": True}


def box(name, x, y, width=1.0, height=1.0, **keys):
    corners = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
    return {"id": name, "vertices": corners} | keys


@pytest.fixture
def messages(case_of):
    def find(**tables):
        case = case_of(**tables)
        found = assembly(case)
        return [(problem.path, problem.message) for problem in problems(case, found.model, found.blocks)]

    return find


def test_nothing_wrong(messages, wall):
    assert messages(structure=[wall]) == []
    assert messages(structure=[wall | {"rotation_deg": 17.0, "origin": [1e3, -50.0]}]) == []
    assert messages(block=[FLOOR, box("a", 0, 0), box("b", 1, 0), box("c", 0.5, 1.0)]) == []


SPAN = {"kind": "arch", "voussoirs": 8, "ring": 0.2}
STANDING = {
    "semicircle": SPAN | {"radius": 1.0},
    "horseshoe": SPAN | {"inner_radius": 1.0, "included_angle_deg": 230.0},
    "on columns": SPAN | {"radius": 1.0, "columns": {"width": 0.4, "height": 1.0, "courses": 3}},
    "skewback": SPAN
    | {"radius": 1.0, "included_angle_deg": 100.0, "buttresses": {"width": 0.8, "height": 1.0, "courses": 2}},
    "segmental": SPAN | {"shape": "segmental", "span": 2.0, "rise": 0.4},
    "pointed": SPAN | {"shape": "pointed", "span": 2.0, "rise": 1.7, "columns": {"width": 0.4, "height": 1.0}},
    "flat": SPAN | {"shape": "flat", "span": 1.0},
    "jack arch": SPAN | {"shape": "flat", "span": 1.0, "buttresses": {"width": 0.5, "height": 1.0}},
    "column": {"kind": "column", "block": [1.11, 0.85], "courses": 7, "top_width": 0.9},
    "cap": {"kind": "column", "drums": [{"width": 1.0, "height": 2.0}], "cap": {"width": 2.0, "height": 0.2}},
    "toothed": {"kind": "wall", "block": [0.4, 0.2], "courses": 4, "blocks_per_course": 3, "ends": "toothed"},
    "door": {
        "kind": "wall",
        "block": [0.4, 0.2],
        "courses": 8,
        "blocks_per_course": 6,
        "openings": [{"x": 1.0, "y": 0.0, "width": 0.5, "height": 0.9, "lintel": {"height": 0.25, "bearing": 0.2}}],
    },
}


@pytest.mark.parametrize("structure", STANDING.values(), ids=STANDING)
@pytest.mark.parametrize("turn", [0.0, 31.0])
def test_generated_structures_neither_overlap_nor_float(messages, structure, turn):
    assert messages(structure=[structure | {"rotation_deg": turn, "origin": [12.3, 4.5]}]) == []


def test_overlap_blames_the_block_drawn_by_hand(messages, wall):
    assert messages(structure=[wall], block=[box("a", 0.05, 0.1, 0.05, 0.1)]) == [
        (("block", 0), "block 'a' overlaps block 'wall-6-2' by 0.005 m"),
        (("block", 0), "block 'a' overlaps block 'wall-6-3' by 0.005 m"),
    ]


def test_a_block_inside_another(messages):
    [(path, message)] = messages(block=[FLOOR, box("a", 0, 0, 3, 3), box("b", 1, 1)])
    assert path == ("block", 2)
    assert message.startswith("block 'b' overlaps block 'a' by")


def test_overlaps_of_round_off_are_none(messages):
    assert messages(block=[FLOOR, box("a", 0, -1e-7), box("b", 1 - 1e-7, 0)]) == []


def test_only_the_first_few_overlaps_are_listed(messages):
    stack = [box(f"b{k}", 0.0, 0.9 * k) for k in range(9)]
    found = messages(block=[FLOOR, *stack])
    assert len(found) == 5
    assert found[-1][1].endswith("; and 3 more of this sort")


def test_floating_blocks(messages):
    blocks = [FLOOR, box("a", 0, 0), box("b", 2, 0.25), box("c", 2, 1.25), box("d", 8, 0.0005)]
    [(path, message)] = messages(block=blocks)
    assert path == ("block", 2)
    assert message == (
        "nothing holds up block 'b' and 1 more touching it; the nearest other block is 'floor', about 0.25 m away"
    )


def test_nothing_fixed(messages, wall):
    hint = "no block is fixed, everything would fall; give a structure a base or a block fixed = true"
    assert messages(structure=[wall | {"base": False}]) == [(("structure", 0), hint)]
    assert messages(block=[box("a", 0, 0)]) == [(("block", 0), hint)]


def test_parts_of_one_block(messages):
    corners = [box("", 0, 0)["vertices"], box("", 0.5, 0)["vertices"], box("", 5, 0)["vertices"]]
    found = messages(block=[FLOOR, {"id": "u", "parts": corners}])
    assert found == [
        (("block", 1), "parts 1 and 2 of block 'u' overlap by 0.5 m"),
        (("block", 1), "the parts of block 'u' do not touch each other"),
    ]


def test_two_fixed_blocks_may_overlap(messages):
    assert messages(block=[FLOOR, box("a", 0, -0.5, fixed=True)]) == []


def test_bad_shapes_of_a_generator(case_of):
    model = assemble(case_of(block=[FLOOR, box("a", 0, 0)]))
    a = model.part_starts[model.block_ids.index("a")]
    blocks = [Block(name, (), "", path=("structure", 0)) for name in model.block_ids]
    vertices = model.vertices.copy()
    vertices[a] = 0.9 * vertices[a + 2]
    assert [p.message for p in shape_problems(model._replace(vertices=vertices), blocks)] == ["block 'a' is not convex"]
    flat = np.where(np.arange(len(vertices))[:, None] >= a, vertices * [1.0, 0.0], vertices)
    [problem] = shape_problems(model._replace(vertices=flat), blocks)
    assert problem.message == "block 'a' has no area, or its corners run clockwise"


def test_warnings(case_of):
    blocks = [FLOOR, box("a", 0, 0), box("chip", 2, 0, 5e-4, 5e-4), box("leaf", 4, 0, 3.0, 1e-3)]
    assert warnings(assemble(case_of(block=blocks))) == [
        "block 'leaf' is a sliver (width / length = 3.3e-04): expect tiny steps",
        "block 'leaf' has 4.2e+03 times the size of 'chip': expect a slow run",
        "block 'a' has 4.0e+06 times the mass of 'chip': expect a slow run",
    ]
    assert warnings(assemble(case_of(block=[FLOOR]))) == ["every block is fixed: nothing can move"]
    assert warnings(assemble(case_of(block=[FLOOR, box("a", 0, 0)]))) == []


def test_far_from_the_origin(case_of, wall):
    """Said where the digits end, and not for a long structure that begins at the origin."""
    near, far, long = (
        warnings(assemble(case_of(structure=[wall | {"origin": [x, 0.0]} | more])))
        for x, more in ((-1e5, {}), (-1e9, {}), (0.0, {"blocks_per_course": 40}))
    )
    assert near == long == []
    assert len(far) == 1
    assert "shift the structure to the origin" in far[0]
