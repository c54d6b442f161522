"""Blocks that stand on corners, edges and crossings of edges alone: failure loads by hand."""

from __future__ import annotations

import numpy as np
import pytest
from engine import scene, solve

BASE = {"id": "base", "polygon": [[-1.0, -0.5], [2.0, -0.5], [2.0, 0.0], [-1.0, 0.0]], "y": [-1.0, 2.0]}
PLATE = {"vertices": [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.5, 0.7)]}


def tetrahedron(x: float, y: float) -> dict:
    """On its apex, under the plate."""
    return {"vertices": [[x, y, 0.0], [x - 0.08, y - 0.08, 0.5], [x + 0.08, y - 0.08, 0.5], [x, y + 0.08, 0.5]]}


def ridge(x: float) -> dict:
    """A prism on its lower edge, along y, under the plate."""
    return {
        "vertices": [[place, y, z] for place, z in ((x, 0.0), (x - 0.08, 0.5), (x + 0.08, 0.5)) for y in (0.0, 1.0)]
    }


def rail(y: float) -> dict:
    """A fixed prism with its upper edge along x at z = 0."""
    corners = [[x, place, z] for place, z in ((y, 0.0), (y - 0.1, -0.3), (y + 0.1, -0.3)) for x in (-0.5, 1.5)]
    return {"id": f"rail {y}", "vertices": corners}


def square(*y: float) -> np.ndarray:
    return np.array([[0.2, y[0]], [0.8, y[0]], [0.8, y[1]], [0.2, y[1]]])


STOOLS = {  # legs, what they stand on, and the polygon of the places where they do
    "corners on a face": (
        [tetrahedron(0.1, 0.1), tetrahedron(0.9, 0.1), tetrahedron(0.5, 0.9)],
        [BASE],
        np.array([[0.1, 0.1], [0.9, 0.1], [0.5, 0.9]]),
    ),
    "edges on a face": ([ridge(0.2), ridge(0.8)], [BASE], square(0.0, 1.0)),
    "edges across edges": ([ridge(0.2), ridge(0.8)], [rail(0.3), rail(0.9)], square(0.3, 0.9)),
}


@pytest.mark.parametrize("azimuth", [-90.0, 10.0, 130.0])
@pytest.mark.parametrize("legs", STOOLS)
def test_a_stool_tips_over_a_side_of_the_polygon_that_it_stands_on(legs, azimuth):
    """Distance of the centroid from the line of two feet, along the push, over its height: the least of all sides."""
    parts, below, feet = STOOLS[legs]
    push = np.array([np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth))])
    case = {
        "dimension": 3,
        "materials": {"stone": {"density": 2000.0}},
        "joints": {"dry": {"friction": 3.0}},
        "block": [
            *({"material": "stone", "fixed": True} | block for block in below),
            {"id": "stool", "material": "stone", "parts": [*parts, PLATE]},
        ],
        "analysis": {"kind": "pushover", "pattern": "mass", "direction": [*push.tolist(), 0.0]},
    }
    model = scene(case).model
    centroid, loads = model.centroids[model.numbers["stool"]], []
    for a, b in zip(feet, np.roll(feet, -1, axis=0), strict=True):
        out = np.array([b[1] - a[1], a[0] - b[0]]) / np.linalg.norm(b - a)  # feet are counter-clockwise
        if push @ out > 1e-9:
            loads.append((a - centroid[:2]) @ out / (push @ out) / centroid[2])
    answer, _ = solve(case)
    assert answer["failure_load"] == pytest.approx(min(loads), rel=1e-3)
