"""Walls of masonry: leaves alone and bonded, gables out of their plane, an arch in a wall against limit analysis."""

from __future__ import annotations

from typing import Any

import pytest
from engine import solve
from engine.limits import solved

RESOLUTION = 1e-3
THICKNESS, LENGTH = 0.4, 1.0
WALL = {"kind": "wall", "block": [0.5, 0.25, THICKNESS], "courses": 4, "length": LENGTH}
DOOR = {"x": 0.7, "y": 0.0, "width": 0.8, "height": 0.75, "arch": {"voussoirs": 7, "ring": 0.25}}


def case(wall: dict[str, Any], direction: list[float], resolution: float = RESOLUTION) -> dict[str, Any]:
    return {
        "dimension": len(direction),
        "materials": {"stone": {"density": 2200.0}},
        "joints": {"dry": {"friction": 0.7}},
        "structure": [wall],
        "analysis": {"kind": "pushover", "pattern": "mass", "direction": direction, "resolution": resolution},
    }


def out_of_plane(**keys: Any) -> float:
    """Failure load of a wall pushed out of its plane, middle of the bracket."""
    summary, _ = solve(case(WALL | keys, [0.0, 1.0, 0.0]))
    assert summary["failure_mode"] == "rocking"
    return sum(summary["failure_load_bracket"]) / 2.0


def test_leaves_that_nothing_ties_together_carry_what_each_does_alone():
    """Half of the thickness over the height; bonded by headers the whole of it."""
    height = 4 * 0.25
    assert out_of_plane(leaves=2) == pytest.approx(THICKNESS / 2.0 / height, rel=RESOLUTION)
    assert out_of_plane(leaves=2, bond="english") == pytest.approx(THICKNESS / height, rel=RESOLUTION)


def test_a_gable_turns_about_its_foot():
    """Half of the thickness over the height of the centroid: of the triangle alone, and of it on a wall."""
    gable, height = 0.9, 4 * 0.25
    middle = (height * height / 2.0 + gable / 2.0 * (height + gable / 3.0)) / (height + gable / 2.0)
    found = out_of_plane(gable={"height": gable})
    assert found == pytest.approx(THICKNESS / 2.0 / middle, rel=RESOLUTION)


def test_an_arch_in_a_wall_stands_and_fails_as_limit_analysis_says():
    """Courses cut around its voussoirs, in the plane: the bracket meets the load of zero dilation within 0.5 %."""
    wall = WALL | {"block": [0.5, 0.25], "courses": 7, "length": 2.2, "openings": [DOOR]}
    tables = case(wall, [1.0, 0.0], 0.004)
    summary, _ = solve(tables)
    low, high = summary["failure_load_bracket"]
    non_associated = solved(tables, associated_only=False).non_associated.load
    assert low * 0.995 <= non_associated <= high * 1.005


POINTED = {"shape": "pointed", "rise": 0.7, "voussoirs": 8, "ring": 0.25}
RUIN = {
    "courses": 10,
    "length": 5.0,
    "profile": [[0.0, 2.5], [2.0, 2.5], [3.4, 1.9], [5.0, 1.9]],
    "openings": [
        {"x": 0.8, "y": 0.5, "width": 0.9, "height": 0.6, "arch": POINTED},
        {"x": 3.4, "y": 0.6, "width": 0.7, "height": 0.7, "arch": {"shape": "circle", "voussoirs": 10, "ring": 0.2}},
    ],
}
CHAPEL = {"bond": "flemish", "leaves": 2, "courses": 7, "length": 2.2, "gable": {"height": 0.9}, "openings": [DOOR]}
RUBBLE = {"leaves": 3, "core": {"thickness": 0.2}, "through_stones": 0.2, "quoins": {"length": 0.5, "height": 2}}


@pytest.mark.parametrize(("dimension", "keys"), [(2, RUIN), (3, CHAPEL), (3, RUBBLE)], ids=["ruin", "chapel", "rubble"])
def test_masonry_stands_under_its_own_weight(dimension, keys):
    wall = WALL | keys if dimension == 3 else WALL | {"block": [0.5, 0.25]} | keys
    summary, _ = solve(case(wall, [1.0, 0.0, 0.0][:dimension]) | {"analysis": {"kind": "gravity"}})
    assert summary["status"] == "ok"
