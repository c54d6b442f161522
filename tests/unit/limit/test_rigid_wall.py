"""The rigid-wall hand check of the thesis's Appendix B, and where it has nothing to say."""

from __future__ import annotations

import numpy as np
import pytest
from casefiles import CASES
from engine import block, rectangle, scene, tables
from reference import book, value

from dem_cli.analyses.hand_check import hand_check
from dem_cli.core.limit.rigid_wall import TopLoad, above_the_cut, split_load

BOOK = "thesis_appendix_b"
WIDTH, HEIGHT = (book(BOOK)["geometry"][key] for key in ("width_m", "height_m"))
MASS = {4.6: book(BOOK)["material"]["wall_mass_stretchers_kg"], 2.3: book(BOOK)["material"]["wall_mass_headers_kg"]}
BRICK = {4.6: (0.08, 0.0175), 2.3: (0.04, 0.0175)}  # length, height [m]: h/b as 17.5 mm bricks give it
WALL = CASES / "verification" / "wall_21.toml"


@pytest.mark.parametrize(("ratio", "row"), [(4.6, "rig_A46_recomputed"), (2.3, "rig_A23_recomputed")])
def test_self_weight(ratio, row):
    length, height = BRICK[ratio]
    assert split_load(WIDTH, HEIGHT, 2 * height / length) == pytest.approx(value(BOOK, row), abs=5e-5)


def test_the_whole_wall_under_a_heavy_load():
    top = TopLoad(250.0, WIDTH / 2, book(BOOK)["geometry"]["top_load_height_m"])
    found = split_load(WIDTH, HEIGHT, 0.0, MASS[2.3], [top])
    assert found == pytest.approx(value(BOOK, "rig_B_recomputed"), abs=5e-3)
    length, height = BRICK[2.3]

    def load(slope, tops):
        return split_load(WIDTH, HEIGHT, slope, MASS[2.3], tops)

    heavy, light, none = (  # lost by the cut; the thesis: next to nothing but for self weight
        1.0 - load(2 * height / length, tops) / load(0.0, tops) for tops in ([top._replace(weight=750.0)], [top], [])
    )
    assert 0.0 < heavy < light < 0.06 < none


def test_a_load_far_from_the_toe_raises_it():
    top = TopLoad(250.0, 0.370, book(BOOK)["geometry"]["top_load_height_m"])
    assert split_load(WIDTH, HEIGHT, 0.0, MASS[2.3], [top]) == pytest.approx(value(BOOK, "rig_D23"), abs=0.01)


def test_without_a_cut_it_is_width_over_height():
    assert split_load(0.3, 1.0, 0.0) == pytest.approx(0.3)


def test_a_steep_cut_leaves_a_triangle():
    """The load of a triangle with its toe below and its top edge of length h / slope."""
    np.testing.assert_allclose(above_the_cut(3.0, 1.0, 2.0), [[0.0, 0.0], [0.5, 1.0], [0.0, 1.0]])
    assert split_load(3.0, 1.0, 2.0) == pytest.approx((0.5 / 3) / (2 / 3))


def test_both_shapes_meet_where_the_cut_ends_in_the_corner():
    assert split_load(1.0, 1.0, 1.0 - 1e-9) == pytest.approx(split_load(1.0, 1.0, 1.0 + 1e-9), rel=1e-6)


def test_a_case_that_is_one_running_bond_wall():
    sizes = ["structure.0.courses=34", "structure.0.blocks_per_course=10"]
    assert hand_check(scene(WALL, *sizes).case) == pytest.approx(value(BOOK, "rig_A23_recomputed"), abs=5e-5)
    assert hand_check(scene(WALL, *sizes, "analysis.pattern='tilt'").case) is not None


@pytest.mark.parametrize(
    "change",
    [
        ["structure.0.bond='stack'"],
        ["structure.0.ends='toothed'"],
        ["structure.0.courses=1"],
        ["structure.0.rotation_deg=5"],
        ["structure.0.openings=[{x=0.04, y=0.0, width=0.04, height=0.035}]"],
        ["structure.0.course_heights=[0.02, 0.02, 0.02, 0.02, 0.02, 0.03]"],
        ["analysis.direction=[1.0, 0.1]"],
        ["analysis={kind='gravity'}"],
    ],
)
def test_cases_that_are_something_else(change):
    assert hand_check(scene(WALL, *change).case) is None


def test_blocks_by_hand_are_something_else():
    case = tables(block("base", rectangle(-1, -1, 1, 0), fixed=True), block("b", rectangle(0, 0, 0.3, 1)))
    assert hand_check(scene(case).case) is None
