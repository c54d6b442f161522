"""Printed results that pages of docs/ compute: what dem has beside what the seed has, from the data of those pages."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import groupby
from typing import Any

import numpy as np
from reference import results

from studies import storage
from studies.appendix_b.failure_loads import load_of
from studies.chapter6.records import capacities
from studies.chapter7 import block, heights, shapes, walls
from studies.chapter7.load_path import middle, top
from studies.church.displacement import moved
from studies.paper001.walls import orderings

Result = dict[str, Any]  # a [[result]] of the data book
Pair = tuple[Any, Any]  # of dem, and printed as dem has it
WIDE = 2e-3  # m, from which a joint counts as open


@cache
def data(name: str) -> dict[str, Any]:
    """docs/data/NAME.json."""
    return storage.read(name)


def shape_load(row: Result) -> Pair:
    """Of a row of Table 7-2, over the load of plane joints."""
    return middle(data("chapter7")["shapes"]["runs"][row["id"]]) / shapes.PLANE, row["value"]


def shape_top(row: Result) -> Pair:
    """Displacement of its upper edge [m]."""
    held = data("chapter7")["shapes"]["runs"][row["id"]]["curve"][-1]
    return top(held, shapes.HEIGHT), row["top_displacement_m"]


def five_sides_top(row: Result) -> Pair:
    """Displacement of the upper edge under a load, shape E [m]."""
    load = dict(shapes.DETAILS)[row["id"]]
    curve = data("chapter7")["shapes"]["five_sides"]["curve"]
    return top(min(curve, key=lambda held: abs(held[0] - load)), shapes.HEIGHT), row["value"]


def column_load(row: Result) -> Pair:
    """Of Tables 7-4 and 7-5."""
    plane = heights.BASE / row["column_height_m"]
    return middle(data("chapter7")["heights"]["runs"][row["id"]]), (1.0 - row["value"]) * plane


def turn(row: Result) -> Pair:
    """Load of a turn of the block on a polygon."""
    found = data("chapter7")["block"]
    number = int(row["id"][-1]) - 1
    return float(np.mean([*found["turns"], found["runs"]["raised"]["bracket"]][number])), row["value"]


def corner(row: Result) -> Pair:
    """Displacement of its upper corner after a turn [m]."""
    load = {"u1": 0.22, "u2": 0.6}[row["id"][:2]]
    return block.at(data("chapter7")["block"]["runs"]["raised"]["curve"], load)[1], row["value"]


def turns_of_the_cycle(row: Result) -> Pair:
    """How many turns there are, one way and the other."""
    turns = block.events(data("chapter7")["block"]["runs"]["cycle"]["curve"])
    ways = [turn["to"] > turn["from"] for turn in turns]
    return [len(list(those)) for _, those in groupby(ways)], row["value"]


def six_blocks(row: Result) -> Pair:
    """Load at which the right part of the wall of 21 blocks turns."""
    return walls.six_of(data("chapter7")["walls"]["walls"]["21"]["joint"]), row["value"]


def deep(row: Result) -> Pair:
    """With twice the aperture."""
    return middle(data("chapter7")["walls"]["deep"]["joint"]), row["value"]


def softer(row: Result) -> Pair:
    """Failure load with friction that falls, over that without; printed: no change."""
    found = data("chapter7")["band"]
    return middle(found["c" if row["id"].endswith("09") else "d"]) / middle(found["b"]), 1.0 + row["value"]


def open_joints(row: Result) -> Pair:
    """Open vertical joints of the five upper layers."""
    one = data("chapter7")["band"][row["id"][-1]]
    return sum(width > WIDE for layer in one["widths"] for width in layer), row["top_total"]


def top_load(row: Result) -> Pair:
    """A test of Appendix B."""
    return _of_test(int(row["id"].split("_")[0][1:])), row["value"]


def square(row: Result) -> Pair:
    """Bricks as long as they are high."""
    return load_of(_rows_of_b()[f"square {row['id'][-1]}"]), row["value"]


def _of_test(number: int) -> float:
    return load_of(_rows_of_b()[f"test {number}"])


def _rows_of_b() -> dict[str, Any]:
    return {row["name"]: row for row in data("appendix_b")["failure_loads"]["rows"]}


def table_tests(_: Result) -> Pair:
    """Tests on the table whose outcome is that of most of 20 artificial records of 8 s, and those that stood; all."""
    tests = [one for key, one in results("thesis_arch_shaking").items() if key.startswith("test_")]
    least = capacities(data("chapter6")["records"]["8 s"])
    right = sum(bool((least <= one["peak_over_static"]).mean() > 0.5) == one["value"] for one in tests)
    return (right, sum(not one["value"] for one in tests)), len(tests)


def mean_capacity(row: Result) -> Pair:
    """Lowest peak at which the arch falls, over 20 records of 20 s."""
    return float(capacities(data("chapter6")["records"]["20 s"]).mean()), row["value"]


def column_onset(row: Result) -> Pair:
    """Peak of a harmonic motion at which a column begins to rock, over the static one."""
    return float(np.mean(data("chapter6")["column"]["onsets"]["as the thesis"])), row["value"]


def church_top(row: Result) -> Pair:
    """Top of the nave wall on joints of 6e5 t/m, at 0.05 and 0.056 [m]; None where the slice does not stand."""
    load = {"top_5pct": 0.05, "top_56": 0.056}[row["id"]]
    return moved(data("church")["displacement"]["5"]["curve"], load), row["value"]


def pressure_crack(row: Result) -> Pair:
    """Pressure at which the wall with bars has lost half of its first stiffness [kPa]."""
    wall = data("mortar")["pressure_wall"]["walls"][1]
    slopes = np.diff(wall["pressures"]) / np.diff(wall["deflections"])
    return float(wall["pressures"][int(np.argmax(slopes < 0.5 * slopes[0]))]), row["value"] / 1000.0


def seven_bodies(row: Result) -> Pair:
    """Virtual work of the mechanism."""
    return data("church")["models"]["cases"]["statics"], row["value"]


def wall_order(row: Result) -> Pair:
    """An ordering of pushover curves of paper 001."""
    return orderings(data("paper001"))[row["id"]], row["value"]


PAGES: dict[str, tuple[Callable[[Result], Pair], ...]] = {  # of docs/, that show what these take
    "chapter7": (
        shape_load, shape_top, five_sides_top, column_load, turn, corner, turns_of_the_cycle, six_blocks, deep, softer,
        open_joints,
    ),
    "appendix_b": (top_load, square),
    "chapter6": (table_tests, mean_capacity, column_onset),
    "church": (seven_bodies, church_top),
    "mortar": (pressure_crack,),
    "paper001": (wall_order,),
}  # fmt: skip
COMPUTED = {one.__name__: (one, page) for page, those in PAGES.items() for one in those}
