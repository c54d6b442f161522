"""Failure loads of blocks in space with an answer by hand, mirrored and turned structures, planar twins."""

from __future__ import annotations

from dataclasses import replace

import pytest
from engine import solve
from studies.space.by_hand import BY_HAND
from studies.space.structures import mirrored, quarter
from studies.space.walls import WALLS, tapered_drums

from dem_cli.core.engine.settings import DEFAULT

RESOLUTION = 5e-4


def load_of(case: dict, **analysis) -> float:
    """The failure load, the middle of its bracket; bracket and books are as they should be."""
    case = {**case, "analysis": {**case["analysis"], "resolution": RESOLUTION, **analysis}}
    summary, _ = solve(case)
    assert summary["status"] == "ok", summary["warnings"]
    low, high = summary["failure_load_bracket"]
    assert high - low <= 1.01 * RESOLUTION * high
    assert abs(summary["energy_closure"]) < 0.01
    return 0.5 * (low + high)


@pytest.mark.parametrize("name", BY_HAND)
def test_load_by_hand(name):
    known = BY_HAND[name]
    assert load_of(known.case) == pytest.approx(known.load, rel=known.tolerance)


@pytest.mark.parametrize("change", [quarter, mirrored])
def test_turned_and_mirrored(change):
    case = tapered_drums()
    assert load_of(change(case)) == pytest.approx(load_of(case), rel=RESOLUTION)


def test_one_history_is_none():
    """A T wall whose path is given up: the load is raised a second time, in small steps, and both are said."""
    limit = replace(DEFAULT.limit, path=replace(DEFAULT.limit.path, effort=3e4))
    summary, _ = solve(WALLS["T, towards the leg"], settings=replace(DEFAULT, limit=limit))
    found = {one["method"]: one for one in summary["histories"]}
    assert not found["zero-dilation path"]["finished"]
    assert found["in larger steps"]["load"] == pytest.approx(found["raised from gravity"]["load"], rel=0.02)
