"""Monitors in the last equilibrium of a static analysis."""

from __future__ import annotations

import pytest

from dem_cli.core.records.history_rows import Energy, HistoryRow
from dem_cli.results.output.equilibrium_monitors import EquilibriumMonitors


def row(stage, load, *values):
    energy = Energy(*(0.0 for _ in Energy._fields))
    return HistoryRow(stage, 0, load, 0.0, 0.0, 0.0, energy, values)


def held(*rows):
    kept = EquilibriumMonitors(["top", "turn"], ["displacement", "rotation"])
    for one in rows:
        kept.row(one)
    return kept


LOADS = (row("gravity", 0.0, 0.0, 0.0), row("loading", 0.5, 1.0, -0.5), row("loading", 0.6, 2.0, -1.0))
FOUND = {"failure_load": 0.6, "failure_load_bracket": [0.6, 0.601], "kinematics": "large"}


def test_the_last_one_where_nothing_fails():
    values = held(*LOADS, row("settlement", 0.0, 4.0, 0.1)).values({"status": "ok"})
    assert values["top"] == {"value": 4.0, "load": 0.0, "unit": "m"}
    assert values["turn"]["unit"] == "rad"


def test_a_collapse_is_no_equilibrium():
    assert held(*LOADS, row("collapse", 0.55, 90.0, 3.0)).values(FOUND)["top"]["value"] == 2.0


def test_the_highest_load_that_was_held():
    back = row("loading", 0.55, 1.5, -0.7)  # tried after a higher one
    assert held(*LOADS, back).values(FOUND)["turn"] == {"value": -1.0, "load": 0.6, "unit": "rad"}


@pytest.mark.parametrize(("kinematics", "value"), [("fixed", 2.0), ("large", 7.0)])
def test_a_mechanism_with_fixed_geometry_rests_wherever_it_is_left(kinematics, value):
    rows = [*LOADS[:2], row("loading", 0.5995, 2.0, -1.0), row("loading", 0.6, 7.0, -3.0)]
    assert held(*rows).values({**FOUND, "kinematics": kinematics})["top"]["value"] == value


def test_a_fall_under_dead_loads_is_no_equilibrium():
    assert held(row("gravity", 0.0, 9.0, 3.0)).values({"status": "does not stand"}) == {}


def test_nothing():
    assert held().values(FOUND) == {}
    assert held(row("collapse", 0.5, 1.0, 1.0)).values({}) == {}
    kept = EquilibriumMonitors([], [])
    kept.row(LOADS[0]._replace(monitors=()))
    assert kept.values(FOUND) == {}
