"""Walls: counts of the thesis, total area, bonds, ends, openings, names."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from dem_cli.core.geometry import polygon
from dem_cli.masonry.structures.placement import corner_blocks
from dem_cli.masonry.structures.wall import Wall
from dem_cli.masonry.structures.wall_blocks import build


def wall(**keys) -> Wall:
    return Wall.model_validate({"block": [0.04, 0.0175], "courses": 6, "blocks_per_course": 3} | keys)


def free(**keys):
    return [block for block in build(wall(**keys)) if not block.fixed]


def area(blocks) -> float:
    return sum(polygon.area(part) for block in blocks for part in block.parts)


def left_edges(blocks, course):
    return [float(b.parts[0][0, 0]) for b in blocks if b.id.startswith(f"{course}-")]


@pytest.mark.parametrize(
    ("courses", "per_course", "first", "count"),
    [  # data book: 21-block wall, WALL1, WALL2, WALL3, its 21-course form, appendix B
        (6, 3, "half", 21),
        (6, 3, "full", 21),
        (6, 10, "half", 63),
        (10, 10, "half", 105),
        (22, 10, "half", 231),
        (21, 10, "full", 220),
        (34, 5, "half", 187),
        (34, 10, "half", 357),
    ],
)
def test_thesis_counts(courses, per_course, first, count):
    assert len(free(courses=courses, blocks_per_course=per_course, first=first)) == count


def test_the_thesis_wall_starts_with_half_blocks_on_one_fixed_block():
    blocks = build(wall(thickness=0.08))
    assert blocks[0].id == "base"
    assert blocks[0].fixed
    assert blocks[0].parts[0].tolist() == [[0.0, -0.0175], [0.12, -0.0175], [0.12, 0.0], [0.0, 0.0]]
    assert left_edges(blocks, 1) == [0.0, 0.02, 0.06, 0.1]
    assert left_edges(blocks, 2) == [0.0, 0.04, 0.08]
    assert {block.thickness for block in blocks} == {0.08}
    assert [block.id for block in blocks[1:6]] == ["1-1", "1-2", "1-3", "1-4", "2-1"]


def test_bonds():
    assert left_edges(free(bond="stack"), 1) == [0.0, 0.04, 0.08]
    assert left_edges(free(offset=0.01), 1) == [0.0, 0.01, 0.05, 0.09]
    assert left_edges(free(offset=0.01, first="full"), 2) == [0.0, 0.01, 0.05, 0.09]
    assert left_edges(free(offset=0.0), 1) == [0.0, 0.04, 0.08]


def test_toothed_ends_have_no_part_blocks():
    blocks = build(wall(ends="toothed"))
    assert left_edges(blocks, 1) == [0.02, 0.06, 0.1]
    assert len(blocks) == 19
    assert np.ptp(blocks[0].parts[0][:, 0]) == pytest.approx(0.14)  # the base bears all of it


@given(
    courses=st.integers(1, 8),
    per_course=st.integers(1, 6),
    offset=st.floats(0.0, 0.039),
    first=st.sampled_from(["half", "full"]),
    ends=st.sampled_from(["half", "toothed"]),
)
def test_the_blocks_fill_the_wall(courses, per_course, offset, first, ends):
    blocks = free(courses=courses, blocks_per_course=per_course, offset=offset, first=first, ends=ends)
    assert area(blocks) == pytest.approx(per_course * 0.04 * courses * 0.0175, rel=1e-4)
    assert all(polygon.is_convex(block.parts[0]) for block in blocks)
    assert len({block.id for block in blocks}) == len(blocks)


def test_courses_of_their_own_size():
    blocks = free(
        course_heights=[0.01, 0.02, 0.03, 0.01, 0.01, 0.02],
        course_lengths=[0.04, 0.05, 0.03, 0.12, 0.04, 0.04],
    )
    assert area(blocks) == pytest.approx(0.12 * 0.10)
    assert left_edges(blocks, 2) == pytest.approx([0.0, 0.05, 0.10])
    assert left_edges(blocks, 4) == [0.0]
    assert max(block.parts[0][:, 1].max() for block in blocks) == pytest.approx(0.10)


OPENING = {"x": 0.03, "y": 0.0175, "width": 0.05, "height": 0.04}


def test_an_opening_leaves_rectangles():
    blocks = free(openings=[OPENING])
    assert area(blocks) == pytest.approx(0.12 * 0.105 - 0.05 * 0.04)
    hole = np.array([[0.03, 0.0175], [0.08, 0.0575]])
    for block in blocks:
        low, high = block.parts[0].min(axis=0), block.parts[0].max(axis=0)
        assert (np.minimum(high, hole[1]) - np.maximum(low, hole[0])).min() < 1e-12
        assert len(block.parts[0]) == 4


def test_a_lintel_takes_the_place_of_what_it_crosses():
    blocks = free(openings=[OPENING | {"lintel": {"height": 0.0125, "bearing": 0.02, "material": "oak"}}])
    assert area(blocks) == pytest.approx(0.12 * 0.105 - 0.05 * 0.04)
    lintel = blocks[-1]
    assert (lintel.id, lintel.material) == ("lintel-1", "oak")
    assert lintel.parts[0][0] == pytest.approx([0.01, 0.0575])
    assert lintel.parts[0][2] == pytest.approx([0.10, 0.07])


def test_a_wall_that_is_all_opening():
    with pytest.raises(ValueError, match="leave nothing of the wall"):
        free(openings=[{"x": 0.0, "y": 0.0, "width": 0.12, "height": 0.105}])


def test_corners():
    assert corner_blocks(build(wall())) == {
        "bottom-left": "1-1",
        "bottom-right": "1-4",
        "top-left": "6-1",
        "top-right": "6-3",
        "top": "6-2",
    }


BAD = {
    "course_heights: 2 values; must be one for each of the 6 courses": {"course_heights": [0.1, 0.2]},
    "offset: bond and offset say the same; give one of them": {"bond": "stack", "offset": 0.01},
    "offset: 0.04 is not allowed; must be less than the block length, 0.04": {"offset": 0.04},
    "course_lengths.1: 0.2 is not allowed; must be at most 0.12, the length of the wall": {
        "course_lengths": [0.04, 0.2, 0.04, 0.04, 0.04, 0.04]
    },
    "openings.0.width: x + width = 0.15 is not allowed; must be at most the length of the wall, 0.12": {
        "openings": [OPENING | {"x": 0.10}]
    },
    "openings.0.height: y + height = 0.14 is not allowed; must be at most the height of the wall, 0.105": {
        "openings": [OPENING | {"y": 0.10}]
    },
    "openings.0.lintel.bearing: 0.05 is not allowed; must be at most 0.03, what is left beside the opening": {
        "openings": [OPENING | {"lintel": {"height": 0.01, "bearing": 0.05}}]
    },
    "openings.0.lintel.height: the lintel would reach up to 0.1575; the wall is 0.105 high": {
        "openings": [OPENING | {"lintel": {"height": 0.1, "bearing": 0.01}}]
    },
}


@pytest.mark.parametrize(("message", "keys"), BAD.items())
def test_what_does_not_fit_is_said_at_its_key(message, keys):
    with pytest.raises(ValidationError) as error:
        wall(**keys)
    cause = error.value.errors()[0]["ctx"]["error"]
    assert f"{'.'.join(map(str, cause.keys))}: {cause}" == message
