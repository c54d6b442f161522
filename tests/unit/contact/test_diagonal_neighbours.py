"""Gaps of the start are between faces that look at each other or under a corner: diagonal neighbours have none."""

from __future__ import annotations

import numpy as np
import pytest
from engine import scene
from synthetic.spatial_case import extruded_tables

from dem_cli.core.contact.gaps import gaps_of_start
from dem_cli.core.engine.kinematics import why_moving

GAP = 3e-4  # [m]; up to 1.4 mm closes between such blocks
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def turned(polygon: np.ndarray, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return polygon @ np.array([[c, s], [-s, c]])


def gaps(dimension: int, other: np.ndarray) -> list[tuple[float, bool]]:
    """Between a square metre whose top right corner is (1, 1), and a polygon."""
    blocks = [{"id": name, "vertices": place.tolist()} for name, place in (("a", SQUARE), ("b", other))]
    tables = {
        "materials": {"stone": {"density": 2000.0}},
        "joints": {"dry": {"friction": 0.6}},
        "block": [{"id": "ground", "vertices": (SQUARE - [0.0, 9.0]).tolist(), "fixed": True}, *blocks],
        "dimension": 2,
    }
    found = gaps_of_start(scene(tables if dimension == 2 else extruded_tables(tables)).model)
    return list(zip(found.widths.round(9).tolist(), found.close.tolist(), strict=True))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(
    ("beside", "degrees"),
    [(0.0, 0.0), (GAP, 0.0), (-GAP, 0.0), (0.0, 8.0), (0.0, 45.0)],
    ids=["level", "past", "over a sliver", "a little turned", "corner to corner"],
)
def test_diagonal_neighbours_have_no_gap(dimension, beside, degrees):
    """Their lowest corner is at the height of the top of the square, right of it."""
    other = turned(SQUARE, degrees)
    other += [1.0 + GAP - other[:, 0].min(), 1.0 + beside - other[other[:, 0].argmin(), 1]]
    assert gaps(dimension, other) == []


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("degrees", [0.0, 3.0, 8.0, 45.0])
def test_faces_and_corners_over_a_face_have_one(dimension, degrees):
    """Before the middle of the right side of the square: a side that looks at it, or the leftmost corner."""
    other = turned(SQUARE, degrees)
    other += [1.0 + GAP - other[:, 0].min(), 0.5 - other[other[:, 0].argmin(), 1]]
    assert gaps(dimension, other) == [(GAP, True)]


def test_a_core_of_rubble_keeps_its_geometry():
    """One of its stones is 0.2 mm beside the end of one of the outer leaf, past its edge: no gap that may close."""
    made = scene(
        {
            "dimension": 3,
            "materials": {"stone": {"density": 2000.0}},
            "joints": {"dry": {"friction": 0.7}},
            "structure": [WALL],
            "analysis": {"kind": "pushover", "direction": [0.0, 1.0, 0.0]},
        }
    )
    assert why_moving(made.request, made.model) is None


WALL = {
    "kind": "wall",
    "block": [0.5826, 0.1664, 0.3393],
    "courses": 2,
    "blocks_per_course": 2,
    "leaves": 3,
    "bond": "running",
    "through_stones": 0.3,
    "core": {"thickness": 0.1357},
}
