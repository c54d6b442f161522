"""Monitors of joints in space against motion in closed form: a block that turns about an edge, and slides obliquely."""

from __future__ import annotations

import numpy as np
import pytest
from engine import scene

from dem_cli.core.engine.monitors import Monitors
from dem_cli.core.geometry.rotation import matrices

B, D = 0.5, 0.8


def monitors(quantity: str, pair: list[str]) -> Monitors:
    made = scene(
        {
            "dimension": 3,
            "materials": {"stone": {"density": 2000.0}},
            "joints": {"dry": {"friction": 0.6}},
            "block": [
                {"id": "base", "vertices": corners(-2, -2, -0.5, 2, 2, 0), "material": "stone", "fixed": True},
                {"id": "b", "vertices": corners(0, 0, 0, B, D, 1), "material": "stone"},
            ],
            "analysis": {"kind": "gravity"},
            "monitor": [{"between": pair, "quantity": quantity}],
        }
    )
    return Monitors(made.request.monitors, made.model)


def corners(x0, y0, z0, x1, y1, z1) -> list[list[float]]:
    return [[float(x), float(y), float(z)] for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)]


def value(made: Monitors, moved: np.ndarray, turned: np.ndarray) -> float:
    """Of the block moved and turned so about its centroid."""
    samples = np.zeros((1, len(made.watched), 3, 6))
    samples[0, :, 0, :3] = made.model.centroids[made.watched] - made.origin
    row = list(made.watched).index(made.model.numbers["b"])
    samples[0, row, 0, :3] += moved
    samples[0, row, 0, 3:] = turned
    return float(made.series(samples, np.zeros((1, 3, 3)))[0, 0])


def test_the_widest_corner_of_a_block_that_turns_about_an_edge():
    theta = 0.2
    turn = np.array([0.0, theta, 0.0])
    arm = np.array([-0.5 * B, 0.0, 0.5])  # from the middle of its edge at x = B to the centroid
    moved = matrices(turn[np.newaxis])[0] @ arm - arm
    found = value(monitors("opening", ["base", "b"]), moved, turn)
    assert found == pytest.approx(B * np.sin(theta), rel=1e-14)


@pytest.mark.parametrize("pair", [["base", "b"], ["b", "base"]])
def test_a_slip_in_any_direction_is_its_length(pair):
    assert value(monitors("slip", pair), np.array([0.03, -0.04, 0.5]), np.zeros(3)) == pytest.approx(0.05, rel=1e-13)
