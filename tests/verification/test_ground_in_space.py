"""Ground motion with three components: the frame that moves with the base, and supports with motions of their own."""

from __future__ import annotations

import engine
import numpy as np
import pytest
from engine import tables

PULSE = {"kind": "pulse", "shape": "sine"}
MOTIONS = [
    {**PULSE, "amplitude": 4.0, "frequency": 2.0, "direction": [1.0, 0.0, 0.0]},
    {**PULSE, "amplitude": 4.5, "frequency": 1.6, "direction": [0.0, 2.0, 0.0]},
    {**PULSE, "amplitude": 1.0, "frequency": 4.0, "direction": [0.0, 0.0, 1.0], "start": 0.1},
]


def box(name: str, x, y, z, **more) -> dict:
    return {"id": name, "vertices": [[float(a), float(b), float(c)] for a in x for b in y for c in z], **more}


def rocking(motion: list, *more: dict) -> dict:
    """A prism that rocks along both axes of its base."""
    return tables(
        box("base", (-2, 2), (-2, 2), (-0.5, 0), fixed=True),
        box("b", (-0.25, 0.25), (-0.3, 0.3), (0, 1.5)),
        *more,
        dimension=3,
        joints={"j": {"friction": 2.0, "kn": 1e9}},
        motion=motion,
        analysis={"kind": "time-history", "duration": 1.0},
        damping={"contact_fraction": 1.0},
        monitor=[
            {"block": "b", "quantity": "rotation"},
            *({"block": "b", "component": axis, "absolute": absolute} for absolute in (False, True) for axis in "xyz"),
        ],
    )


def test_a_support_that_moves_is_a_base_that_moves():
    """The same motion as body force and as a prescribed support, seen from where the base stands still."""
    far = box("far", (50, 51), (0, 1), (0, 1), fixed=True)
    _, carried = engine.solve(rocking(MOTIONS, far))
    summary, moved = engine.solve(rocking([{**motion, "blocks": ["base"]} for motion in MOTIONS], far))
    assert abs(summary["energy_closure"]) < 2e-3  # with the work of the support, through springs and dashpots
    ground = carried.history.base[:, 2]
    assert (np.ptp(ground, axis=0) > 0.005).all()
    assert (moved.history.base == 0.0).all()
    here, there = carried.history.monitors, moved.history.monitors
    assert here[:, 0].max() > 0.02
    assert (np.ptp(here[:, 1:3], axis=0) > 0.005).all()  # it rocks both ways
    assert np.abs(here[:, 0] - there[:, 0]).max() < 1e-4 * here[:, 0].max()
    for k in range(3):
        assert np.abs(here[:, 1 + k] + ground[:, k] - there[:, 1 + k]).max() < 1e-4 * np.ptp(here[:, 1:3])
        assert np.abs(here[:, 4 + k] - there[:, 4 + k]).max() < 1e-4 * np.ptp(here[:, 4 + k])


def test_base_is_the_sum_of_its_components():
    """One sine of acceleration a along each axis for T ends a T²/(2π) farther, whatever the length of its direction."""
    _, records = engine.solve(rocking(MOTIONS))
    ends = [m["amplitude"] / (2 * np.pi * m["frequency"] ** 2) for m in MOTIONS]
    assert records.history.base[-1, 2] == pytest.approx(ends, rel=1e-9)
    assert records.history.base[-1, 1] == pytest.approx([0.0] * 3, abs=1e-12)
