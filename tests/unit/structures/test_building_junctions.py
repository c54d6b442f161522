"""Walls that meet under load: T, X and double T stand under their weight; a buttress turns over by hand."""

from __future__ import annotations

import pytest
from synthetic.spatial_case import spatial_case

from dem_cli.analyses.solve import solve
from dem_cli.core.records.ports import Observer
from dem_cli.masonry.assembly.assemble import assemble

T, L, H = 0.3, 0.6, 0.25  # thickness of walls, length and height of blocks [m]
HOST = {"id": "host", "axis": [[-0.9, 0.0], [0.9, 0.0]]}
STEM = {"id": "stem", "axis": [[0.0, 0.0], [0.0, 1.0]]}
PLANS = {
    "T": [HOST, STEM],
    "X": [HOST, STEM | {"axis": [[0.0, -0.9], [0.0, 0.9]]}],
    "double T": [HOST, STEM, {"id": "other", "axis": [[0.0, 0.0], [0.0, -1.0]]}],
}


COURSED = {
    "kind": "coursed",
    "spacing": [0.25, 0.05],
    "segment": [0.6, 0.2],
    "deviation": [0.0, 0.02],
    "head_spacing": [0.3, 0.1],
}


def summary(walls, analysis, courses, **more):
    table = {"kind": "building", "id": "b", "block": [L, H], "thickness": T, "courses": courses, "walls": walls}
    case = spatial_case(structure=[table | more], analysis=analysis, output={"frames": 0})
    found = solve(case, assemble(case), Observer()).summary
    assert found["status"] == "ok"
    return found


@pytest.mark.parametrize("plan", PLANS)
def test_walls_that_meet_stand_under_their_weight(plan):
    assert 0.0 < summary(PLANS[plan], {"kind": "gravity"}, 4)["largest_displacement"] < 1e-4 * 4 * H


def test_walls_of_irregular_courses_stand_under_their_weight():
    found = summary(PLANS["T"], {"kind": "gravity"}, 4, pattern=COURSED, seed=1)
    assert 0.0 < found["largest_displacement"] < 1e-4 * 4 * H


def test_a_wall_turns_over_its_buttress_and_leaves_its_heel_behind():
    """A wall as long as a block, a buttress of one block more: nothing lifts the wall in its first two courses.

    The wall goes from -T/2 to T/2, the buttress on to the toe at 3/2 T. In odd courses the wall is one block, in even
    ones the buttress goes through it. All above the heel turns about the toe as one.
    """
    walls = [HOST | {"axis": [[-0.5 * L, 0.0], [0.5 * L, 0.0]]}, STEM | {"axis": [[0.0, 0.0], [0.0, 1.5 * T]]}]
    low, high = summary(walls, {"kind": "pushover", "direction": [0.0, 1.0, 0.0], "resolution": 0.002}, 6)[
        "failure_load_bracket"
    ]
    resists = pushes = 0.0
    for course in range(6):
        if course == 0:
            pieces = [(T * T, 0.5 * T)]  # plan area and distance to the toe: the tip of the buttress alone
        elif course == 1:
            pieces = [(2 * T * T, T)]  # the buttress through the wall, without the pieces beside it
        else:
            pieces = [(L * T, 1.5 * T), (T * T, 0.5 * T)]
        for area, arm in pieces:
            resists += area * arm
            pushes += area * (course + 0.5) * H
    by_hand = resists / pushes
    assert by_hand == pytest.approx(0.3844660, rel=1e-6)
    assert low == pytest.approx(by_hand, rel=2e-3)
    assert low <= by_hand <= high * (1 + 1e-3)


def test_a_wall_of_irregular_courses_turns_over_its_foot():
    push = {"kind": "pushover", "direction": [0.0, 1.0, 0.0], "resolution": 0.002}
    low, high = summary([HOST], push, 6, pattern=COURSED, seed=1)["failure_load_bracket"]
    by_hand = T / (6 * H)  # all stones reach through the wall: half of its thickness to half of its height
    assert low == pytest.approx(by_hand, rel=2e-3)
    assert high == pytest.approx(by_hand, rel=2e-3)
