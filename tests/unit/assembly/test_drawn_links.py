"""Ends of ties: which blocks hold them, and what is said where none does."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, tables

from dem_cli.assembly import validate
from dem_cli.assembly.assemble import assembly
from dem_cli.errors import CaseError
from dem_cli.links.link import FIXED_POINT

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
