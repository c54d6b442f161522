"""Blocks that overhang by some per mille of an edge: loads in closed form, columns with offsets against the oracle."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, solve, tables
from engine.limits import solved
from oracle.limit_lp import limit_load

from dem_cli.core.limit.associated import FALLS, OK

LEAN = 0.465  # of the centroid of the block beyond the middle of its foot [m]
RESOLUTION = 1e-3
STILL = {"resolution": RESOLUTION, "follow": 0.0}


def leaning(overhang: float, lean: float = LEAN, **analysis) -> dict:
    """A parallelogram, foot 1 m, 2 m high, whose foot ends so far [m] beyond its pedestal."""
    corners = [[0.0, 0.0], [1.0, 0.0], [1.0 + 2 * lean, 2.0], [2 * lean, 2.0]]
    blocks = block("pedestal", rectangle(0.0, -1.0, 1.0 - overhang, 0.0), fixed=True), block("leaning", corners)
    return tables(*blocks, analysis={"kind": "pushover", **STILL, **analysis})


def exact(overhang: float, lean: float = LEAN) -> float:
    """It turns about the end of the pedestal, 1 − overhang; its centroid lies at 0.5 + lean, 1 m high."""
    return (1.0 - overhang) - (0.5 + lean)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
@pytest.mark.parametrize(("overhang", "load"), [(0.002, 0.033), (0.005, 0.030), (0.008, 0.027), (0.012, 0.023)])
def test_a_block_turns_about_the_end_of_its_pedestal(overhang, load, kinematics):
    """Forces balance to 1e-5 of the weight; where geometry moves it leans on joints of kn h/W = 1e6 before it turns."""
    assert exact(overhang) == pytest.approx(load, abs=1e-12)
    summary, _ = solve(leaning(overhang, kinematics=kinematics))
    low, high = summary["failure_load_bracket"]
    error = 1.2e-5 if kinematics == "fixed" else 5e-5
    assert low - error <= load <= high + error
    assert summary["failure_load"] == pytest.approx(load, abs=RESOLUTION * load + error)


@pytest.mark.parametrize("overhang", [0.002, 0.005, 0.008, 0.012, -0.002, -0.012])
def test_limit_analysis_of_the_same(overhang):
    """Beyond the edge, and within it: there the block turns about its own corner."""
    found = solved(leaning(overhang)).associated
    assert found.status == OK
    assert found.multiplier == pytest.approx(exact(max(overhang, 0.0)), rel=1e-7)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_a_block_falls_whose_centroid_is_beyond_its_pedestal(kinematics):
    """By 1 mm, with its foot 5 mm beyond."""
    assert exact(0.005, 0.496) == pytest.approx(-0.001)
    summary, _ = solve(leaning(0.005, 0.496, kinematics=kinematics))
    assert summary["status"] == "does not stand under its dead loads"
    assert solved(leaning(0.005, 0.496)).associated.status == FALLS


def drums(seed: int, n: int = 14) -> dict:
    """Drums 1 m wide, 0.4 m high, each up to 9 mm off and up to 15 mm wider or narrower."""
    rng = np.random.default_rng(seed)
    blocks = [block("base", rectangle(-1.0, -1.0, 2.0, 0.0), fixed=True)]
    for i in range(n):
        left, right = rng.uniform(-9e-3, 9e-3), 1.0 + rng.uniform(-15e-3, 15e-3)
        blocks.append(block(f"drum{i}", rectangle(left, 0.4 * i, left + right, 0.4 * (i + 1))))
    return tables(*blocks, analysis={"kind": "pushover", **STILL})


@pytest.mark.parametrize("seed", range(6))
def test_drums_with_offsets(seed):
    """They turn over an end of some joint, and never slide: the load is unique. The oracle finds overlaps by itself."""
    case = drums(seed)
    polygons = [np.array(b["vertices"]) for b in case["block"]]
    load = limit_load(polygons, [True] + [False] * (len(polygons) - 1), case["joints"]["dry"]["friction"]).multiplier
    assert solved(case).associated.multiplier == pytest.approx(load, rel=1e-6)
    summary, _ = solve(case)
    low, high = summary["failure_load_bracket"]
    assert low * (1 - 1e-5) <= load <= high * (1 + 1e-5)
    assert summary["failure_load"] == pytest.approx(load, rel=1.5 * RESOLUTION)
