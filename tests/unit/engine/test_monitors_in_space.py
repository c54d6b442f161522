"""Monitors in 3D against a block that turns about an edge of its base: closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic.spatial_case import spatial_case

from dem_cli.core.engine.monitors import Monitors
from dem_cli.masonry.assembly.assemble import assemble
from dem_cli.masonry.assembly.solver_request import solver_request

COLUMN = {"kind": "column", "block": [0.4, 1.2], "courses": 1, "thickness": 0.6, "rotation_deg": 30.0,
          "origin": [1.0, 2.0, 3.0]}  # fmt: skip
ANGLES = np.linspace(0.0, 0.5, 6)
ACROSS = np.array([-0.5, np.sqrt(0.75), 0.0])  # the column's own y; it turns about its edge at +y, along its own x
ALONG = np.array([np.sqrt(0.75), 0.5, 0.0])


def values(*monitors):
    """Of a column that tilts over its edge at +y by ANGLES: columns of monitors."""
    case = spatial_case(structure=[COLUMN], monitor=list(monitors))
    watching = Monitors(solver_request(case).monitors, assemble(case))
    model = watching.model
    samples = np.zeros((len(ANGLES), len(watching.watched), 3, 6))
    samples[:, :, 0, :3] = model.centroids[watching.watched] - watching.origin
    row = list(watching.watched).index(model.numbers["1"])
    c, s = np.cos(ANGLES)[:, None], np.sin(ANGLES)[:, None]
    up = np.array([0.0, 0.0, 1.0])
    samples[:, row, 0, :3] += ACROSS * (-0.3 * c + 0.6 * s + 0.3) + up * (0.3 * s + 0.6 * c - 0.6)
    samples[:, row, 0, 3:] = -ANGLES[:, None] * ALONG  # right-handed: y turns towards −z
    return watching.series(samples, np.zeros((len(ANGLES), 3, 3)))


def test_opening_of_a_joint_is_that_of_its_furthest_corner():
    found = values({"between": ["base", "1"], "quantity": "opening"})
    assert found[:, 0] == pytest.approx(0.6 * np.sin(ANGLES), abs=1e-12)


def test_points_and_rotations_by_component():
    tip = np.array([1.0, 2.0, 4.2]) + 0.3 * ACROSS
    found = values(
        {"point": tip.tolist()},
        {"point": tip.tolist(), "component": "z"},
        {"block": "1", "quantity": "rotation"},
        {"block": "1", "quantity": "rotation", "component": "y"},
    )
    assert found[:, 0] == pytest.approx(2.0 * 1.2 * np.sin(ANGLES / 2.0), abs=1e-12)
    assert found[:, 1] == pytest.approx(1.2 * (np.cos(ANGLES) - 1.0), abs=1e-12)
    assert found[:, 2] == pytest.approx(ANGLES, abs=1e-12)
    assert found[:, 3] == pytest.approx(-0.5 * ANGLES, abs=1e-12)
