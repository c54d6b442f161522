"""Loads that are weights of floors nobody has drawn: their share in a push by mass, in closed form; what is refused."""

from __future__ import annotations

import pytest
from engine import block, rectangle, scene, simulation, solve, tables
from engine.limits import solved

from dem_cli.analyses.curve_answers import shaken_masses
from dem_cli.errors import CaseError

G, DENSITY, WIDTH, HEIGHT = 9.81, 2000.0, 0.5, 2.0
WEIGHT = G * DENSITY * WIDTH * HEIGHT
FLOOR = 0.7 * WEIGHT


def pier(dimension: int, pattern: str = "mass", **load) -> dict:
    """A pier that tips before it slides, with a floor on the middle of its top."""
    shapes = {"base": (-3.0, 3.0, -1.0, 0.0), "pier": (0.0, WIDTH, 0.0, HEIGHT)}
    drawn = []
    for name, (left, right, low, high) in shapes.items():
        corners = rectangle(left, low, right, high)
        if dimension == 3:
            corners = [[x, y, z] for x, z in corners for y in (-0.5, 0.5)]
        drawn.append(block(name, corners, **({"fixed": True} if name == "base" else {})))
    flat = [0.0] * (dimension - 2)
    floor = {"block": "pier", "force": [0.0, *flat, -FLOOR], "at": [WIDTH / 2, *flat, HEIGHT]}
    push = {"kind": "pushover", "pattern": pattern, "direction": [1.0, 0.0, *flat], "resolution": 1e-3}
    return tables(*drawn, dimension=dimension, friction=2.0, load=[floor | load], analysis=push)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_floor_pushes_where_it_presses(dimension):
    """About the toe: (W + F) b/2 = λ (W h/2 + F h) with inertia, without it F pushes nothing."""
    for inertia, push in ((True, WEIGHT * HEIGHT / 2 + FLOOR * HEIGHT), (False, WEIGHT * HEIGHT / 2)):
        expected = (WEIGHT + FLOOR) * WIDTH / 2 / push
        case = pier(dimension, inertia=inertia)
        assert solved(case).associated.multiplier == pytest.approx(expected, rel=1e-6)
        assert solve(case)[0]["failure_load"] == pytest.approx(expected, rel=2e-3)


def test_a_floor_along_a_line_and_one_on_many_blocks():
    """What falls on what lies under a line, and what several blocks share, push by all of it."""
    line = pier(2, inertia=True)
    line["load"] = [{"line": [[0.1, 2.0], [0.4, 2.0]], "force_per_length": [0.0, -FLOOR / 0.3], "inertia": True}]
    shared = pier(2, inertia=True)
    del shared["load"][0]["at"]
    for case, lever in ((line, HEIGHT), (shared, HEIGHT / 2)):
        made = scene(case)
        assert made.model.live_loads[1, 0] == pytest.approx(WEIGHT + FLOOR)
        expected = (WEIGHT + FLOOR) * WIDTH / 2 / (WEIGHT * HEIGHT / 2 + FLOOR * lever)
        assert solved(case).associated.multiplier == pytest.approx(expected, rel=1e-6)


def test_masses_of_a_check_against_a_spectrum():
    """That of the floor counts with that of its block; without inertia masses are those of blocks to the last bit."""
    sims = [simulation(pier(2, inertia=inertia)) for inertia in (True, False)]
    with_floor, without = (shaken_masses(sim, G) for sim in sims)
    assert with_floor == pytest.approx([(WEIGHT + FLOOR) / G])
    assert without.tolist() == sims[1].model.masses[sims[1].free].tolist()


@pytest.mark.parametrize(
    ("load", "said"),
    [({"kind": "live"}, "it is no weight"), ({"force": [100.0, 0.0]}, "does not press down")],
)
def test_loads_that_are_no_weights(load, said):
    with pytest.raises(CaseError) as raised:
        scene(pier(2, "live", inertia=True, **load))
    assert said in str(raised.value)
