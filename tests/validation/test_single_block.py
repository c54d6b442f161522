"""Thesis 7.3.3, Table 7-1: a block on a polygon of five sides, and the same on a plane joint."""

from __future__ import annotations

import pytest
from reference import result, value
from studies.chapter7 import block, load_path

BOOK = "thesis_single_block_noncoplanar"
EXACT = block.rolling()
ASKED = 0.005  # of the load and of displacements


@pytest.fixture(scope="module")
def raised():
    return load_path.run("validation/block_on_polygon")


def test_statics_are_those_of_the_data_book():
    """0.03 %: sides of 0.2 m and turns of 1/60 there, slopes of 1/60 and 1/30 here."""
    assert EXACT["loads"][0] == pytest.approx(value(BOOK, "lambda1"), rel=1e-9)
    assert EXACT["loads"][1] == pytest.approx(value(BOOK, "lambda2_rolling"), rel=5e-4)
    assert EXACT["loads"][2] == pytest.approx(value(BOOK, "lambda3_rolling"), rel=5e-4)
    for i, name in enumerate(("lambda1", "lambda2", "lambda3")):
        digit = 1e-3  # printed with three
        assert block.first_order(i) == pytest.approx(value(BOOK, name), abs=digit)


def test_it_turns_twice_at_loads_known_to_a_thousandth():
    first, second, _ = EXACT["loads"]
    path = [first * 0.999, first * 1.001, second * 0.999, second * 1.001]
    found = load_path.run("validation/block_on_polygon_cycle", f"analysis.path={path}", "analysis.step=0.05")
    assert [block.side(block.at(found["curve"], load)) for load in path] == [0, 1, 1, 2]


def test_it_turns_over(raised):
    low, high = raised["bracket"]
    assert high - low <= 0.001 * low
    assert low <= EXACT["loads"][2] * (1 + 1e-4)
    assert high >= EXACT["loads"][2] * (1 - 1e-4)
    assert load_path.middle(raised) == pytest.approx(value(BOOK, "lambda3_rolling"), rel=ASKED)


@pytest.mark.parametrize(("i", "load"), [(0, 0.22), (1, 0.6)])
def test_how_far_it_turns(raised, i, load):
    moved = block.at(raised["curve"], load)[1]
    assert moved == pytest.approx(EXACT["corners"][i], rel=1e-3)
    assert moved == pytest.approx(value(BOOK, f"u{i + 1}_dem"), rel=ASKED)


def test_a_plane_joint_deforms_by_hand():
    found = load_path.run("validation/block_on_plane", "analysis.start=gravity", "analysis.step=0.1")
    load, moved = block.at(found["curve"], 0.2)[:2]
    assert load == pytest.approx(0.2)
    assert moved == pytest.approx(value(BOOK, "u_elastic_exact"), rel=1e-3)


def test_there_and_back_it_turns_eight_times():
    """At the loads of statics: where the resultant leaves a side, at one end going up, at the other coming down."""
    found = load_path.run("validation/block_on_polygon_cycle")
    turns = block.events(found["curve"])
    assert [(turn["from"], turn["to"]) for turn in turns] == [
        (0, 1), (1, 2), (2, 1), (1, 0), (0, -1), (-1, -2), (-2, -1), (-1, 0)
    ]  # fmt: skip
    clockwise = [turn["to"] > turn["from"] for turn in turns]
    counted = [clockwise[:2].count(True), clockwise[2:6].count(False), clockwise[6:].count(True)]
    assert counted == result(BOOK, "cycle")["value"]
    for turn, load in zip(turns, block.cycle_loads()):
        low, high = sorted(turn["loads"])
        assert low - 1e-3 * abs(load) <= load <= high + 1e-3 * abs(load)
    assert block.shown(found["curve"]) == [side for _, side in block.SHOWN]
