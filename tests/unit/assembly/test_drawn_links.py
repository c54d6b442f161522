"""Ends of ties and paths of bars: which blocks hold them, and what is said where none does."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, tables

from dem_cli.case.plausibility import doubts
from dem_cli.core.links.link import FIXED_POINT
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly import validate
from dem_cli.masonry.assembly.assemble import assembly

FLOOR = block("floor", rectangle(-3, -1, 3, 0), fixed=True)
TWO = (block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(0, 1, 1, 2)))
HELD = {"stiffness": 1e6}


def case(*ties: dict, **more) -> dict:
    return tables(FLOOR, *TWO, tie=[{**HELD, **tie} for tie in ties], analysis={"kind": "gravity"}, **more)


def test_ends_are_points_of_the_blocks_in_which_they_lie():
    made = scene(
        case({"ends": [[0.5, 1.5], [0.5, -0.5]]}, {"id": "rock", "ends": [[1, 0.2], [5, 3]], "anchored": True})
    )
    (ties,), model = made.model.links, made.model
    assert made.model.link_names == ("tie-1", "rock")
    assert ties.blocks.tolist() == [[made.number("b"), made.number("floor")], [made.number("a"), FIXED_POINT]]
    assert ties.arms[0] == pytest.approx([0.0, 0.0, 0.5, 0.0])
    assert ties.arms[1] == pytest.approx([0.5, -0.3, 5.0, 3.0])
    assert ties.lengths == pytest.approx([2.0, np.hypot(4.0, 2.8)])
    assert ties.started(np.array([1.0, 2.0])).arms[1] == pytest.approx([0.5, -0.3, 4.0, 1.0])
    assert model.only([0, 1], np.array([True, False])).links == ()


WRONG = {
    "unknown block": ({"ends": [[0.5, 1.5], [0.5, -0.5]], "block": "c"}, "block: unknown block 'c'"),
    "outside": ({"ends": [[0.5, 1.5], [0.5, 3.5]]}, "there is no block at"),
    "elsewhere": ({"ends": [[0.5, 1.5], [0.5, -0.5]], "block": "a"}, "is not in block 'a'; it lies in 'b'"),
    "between": ({"ends": [[0.5, 1.0], [0.5, -0.5]]}, "edge of several blocks"),
    "one block": ({"ends": [[0.2, 1.5], [0.8, 1.5]]}, "both ends are held by block 'b'"),
    "supports": ({"ends": [[-1, -0.5], [5, 3]], "anchored": True}, "both ends are held by supports"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_ends(name):
    table, said = WRONG[name]
    with pytest.raises(CaseError) as error:
        scene(case(table))
    assert said in str(error.value)


def test_monitors_of_ties_that_there_are_not():
    monitor = [{"tie": "rope", "quantity": "force"}]
    made = scene(case({"ends": [[0.5, 1.5], [0.5, -0.5]]}, monitor=monitor))
    found = validate.problems(made.case, made.model, assembly(made.case).blocks)
    assert [problem.path for problem in found] == [("monitor", 0, "tie")]


def test_a_tie_holds_up_what_nothing_else_does():
    hung = block("hung", rectangle(2, 2, 3, 3))
    tie = {"ends": [[2.5, 3.0], [2.5, 5.0]], "anchored": True, **HELD}
    held, falls = (tables(FLOOR, hung, tie=ties, analysis={"kind": "gravity"}) for ties in ([tie], []))
    for table, count in ((held, 0), (falls, 1)):
        made = scene(table)
        assert len(validate.problems(made.case, made.model, assembly(made.case).blocks)) == count


ROD = {"rod": {"area": 1e-4, "young": 2e11, "bond_stiffness": 1e9}}


def barred(*paths, **more) -> dict:
    tables_of = [{"bar": "rod", "path": path, **more.pop("keys", {})} for path in paths]
    return tables(FLOOR, *TWO, bars=ROD, reinforcement=tables_of, analysis={"kind": "gravity"}, **more)


def test_bars_are_cut_at_joints_and_corners():
    made = scene(barred([[0.5, 1.5], [0.5, 0.5], [0.8, 0.5], [0.8, -0.5]], keys={"element": 0.2, "anchored": ["end"]}))
    (bars,) = made.model.links
    assert made.model.link_names == ("bar-1",)
    pairs = [(made.number("b"), made.number("a")), (made.number("a"), made.number("floor"))]
    assert bars.blocks.tolist() == [list(pair) for pair in pairs]
    assert bars.length(0) == pytest.approx(2.3)
    assert bars.reach.sum() == pytest.approx(2.3)
    assert bars.reach.max() <= 0.2 * (1 + 1e-9)
    assert bars.axes == pytest.approx(np.array([[0.0, -1.0], [0.0, -1.0]]))
    elements = bars.stiffness[len(bars.slips) :][: len(bars.crossing)]
    assert elements[0] == 0.0
    assert elements[-1] > 0.0


WRONG_PATHS = {
    "outside": ([[0.5, 1.5], [0.5, 2.5]], "from [0.5, 2] to [0.5, 2.5] there is no block"),
    "beside": ([[-0.5, 1.5], [0.5, 1.5]], "from [-0.5, 1.5] to [0, 1.5] there is no block"),
    "one block": ([[0.2, 1.5], [0.8, 1.5]], "it lies in block 'b' alone"),
    "in a joint": ([[0.5, 1.5], [0.5, 1.0], [0.9, 1.0]], "the bar runs along the joint of"),
}


@pytest.mark.parametrize("name", WRONG_PATHS)
def test_wrong_paths(name):
    path, said = WRONG_PATHS[name]
    with pytest.raises(CaseError) as error:
        scene(barred(path))
    assert said in str(error.value)
    assert len(error.value.problems) == 1


WRONG_CASES = {
    "unknown bar": ({"reinforcement": [{"bar": "rope", "path": [[0.5, 1.5], [0.5, 0.5]]}]}, "unknown bar 'rope'"),
    "stiffer than its bond": (
        {"bars": {"rod": ROD["rod"] | {"area": 1e30}}},
        "times as stiff as its bond; at most 1e+08",
    ),
    "endless elements": ({"bars": {"rod": ROD["rod"] | {"bond_stiffness": 1e29}}}, "at most 10,000 are made"),
    "no place": ({"monitor": [{"bar": "bar-1", "quantity": "force"}]}, "monitor.0.at: missing"),
    "no bar": ({"monitor": [{"block": "a", "at": 0.1}]}, "not used without bar"),
    "quantity": ({"monitor": [{"bar": "bar-1", "at": 0.1, "quantity": "opening"}]}, "'force', 'slip'"),
    "strains": (
        {"materials": {"stone": {"density": 2000.0, "young": 1e9, "deformation": "uniform-strain"}}},
        "not known beside [[reinforcement]]",
    ),
}


@pytest.mark.parametrize("name", WRONG_CASES)
def test_wrong_cases_with_bars(name):
    more, said = WRONG_CASES[name]
    with pytest.raises(CaseError) as error:
        scene(barred([[0.5, 1.5], [0.5, 0.5]]) | more)
    assert said in str(error.value)


def test_a_monitor_beyond_the_end_of_a_bar():
    monitor = [{"bar": "bar-1", "at": 1.5, "quantity": "force"}, {"bar": "bar-2", "at": 0.5, "quantity": "slip"}]
    made = scene(barred([[0.5, 1.5], [0.5, 0.5]], monitor=monitor))
    found = validate.problems(made.case, made.model, assembly(made.case).blocks)
    assert [problem.path for problem in found] == [("monitor", 0, "at"), ("monitor", 1, "bar")]


def test_long_elements_are_said():
    made = scene(barred([[0.5, 1.5], [0.5, 0.5]], keys={"element": 0.1}))
    (doubt,) = [one for one in doubts(made.case) if one.path[0] == "reinforcement"]
    assert "0.0283 m is the default" in doubt.message
