"""Blocks whose faces have no more than a tip in common: they hold each other there."""

from __future__ import annotations

import engine
import numpy as np

from dem_cli.core.geometry.rotation import matrices

TIP = 0.005  # m, of cubes of 1 m: 2.5e-5 of a face


def cube(name: str, x: float, y: float, z: float, **more) -> dict:
    corners = [(x + i, y + k, z + m) for i in (0.0, 1.0) for k in (0.0, 1.0) for m in (0.0, 1.0)]
    return engine.block(name, corners, **more)


def test_a_cube_let_go_over_a_tip_does_not_fall_through_it():
    """It turns about the tip; falling free it would be 5 cm lower."""
    case = engine.tables(
        cube("below", 0.0, 0.0, -1.0, fixed=True),
        cube("above", 1.0 - TIP, 1.0 - TIP, 0.0),
        dimension=3,
        analysis={"kind": "time-history", "duration": 0.1, "settle": False, "coda": 0.0},
        damping={"none": True},
        output={"frames": 20},
    )
    summary, records = engine.solve(case)
    above = records.frames[0].positions[1]
    tip = np.array([1.0 - TIP, 1.0 - TIP, 0.0]) - above
    heights = [
        (frame.positions[1] + matrices(frame.orientations)[1].reshape(3, 3) @ tip)[2] for frame in records.frames
    ]
    assert min(heights) > -0.1 * TIP
    assert abs(summary["energy_closure"]) < 1e-3
