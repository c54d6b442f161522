"""Failure loads of blocks in space with an answer by hand, mirrored and turned structures, planar twins."""

from __future__ import annotations

import pytest
from engine import solve
from studies.space.by_hand import BY_HAND
from studies.space.structures import box, frustum, mirrored, quarter, regular, tables, towards

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


def tapered_drums() -> dict:
    ground = box("ground", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), fixed=True)
    radii = [0.40, 0.36, 0.32, 0.28]
    drums = [
        frustum(f"drum-{k}", regular(6, low), regular(6, high), 0.5 * k, 0.5 * (k + 1))
        for k, (low, high) in enumerate(zip(radii, radii[1:]))
    ]
    return tables(ground, *drums, friction=0.7, direction=towards(20.0))


@pytest.mark.parametrize("change", [quarter, mirrored])
def test_turned_and_mirrored(change):
    case = tapered_drums()
    assert load_of(change(case)) == pytest.approx(load_of(case), rel=RESOLUTION)
