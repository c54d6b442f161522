"""Time histories that break programs: corners inside corners, extreme joints and dampers, starts that cannot be."""

from __future__ import annotations

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables, turned

PULSE = {"kind": "pulse", "shape": "sine", "amplitude": 7.0, "frequency": 2.0}
GROUND = block("base", rectangle(-3, -1, 3, 0), fixed=True)


def shaken(*blocks: dict, kn: float = 1e9, **more) -> dict:
    """Blocks on the ground, under one sine of 0.7 g."""
    return tables(
        GROUND, *blocks,
        **{
            "joints": {"j": {"friction": 0.7, "kn": kn}}, "motion": PULSE,
            "analysis": {"kind": "time-history", "duration": 0.8}, **more,
        },
    )  # fmt: skip


def column(n: int = 4) -> list[dict]:
    return [block(f"b{i}", rectangle(-0.25, 0.3 * i, 0.25, 0.3 * i + 0.3)) for i in range(n)]


def arch(n: int = 8, inner: float = 1.0, outer: float = 1.2) -> list[dict]:
    angles = np.linspace(0.0, np.pi, n + 1)
    rays = np.column_stack([np.cos(angles), np.where(np.sin(angles) < 1e-12, 0.0, np.sin(angles))])
    return [
        block(f"v{i}", [inner * rays[i], outer * rays[i], outer * rays[i + 1], inner * rays[i + 1]]) for i in range(n)
    ]


@pytest.mark.parametrize("lean", [-0.3, 0.0, 0.2])  # of the faces: corners of 107°, 90° and 79°
@pytest.mark.parametrize("turn", [-0.4, 0.0, 0.4])
def test_corners_inside_each_other_are_pushed_apart_by_one_joint(turn, lean):
    """Whichever way one corner came into the other: never by none of the pairs of faces there, never by two."""
    low, high = [[0, -1], [1, -1], [1, lean], [0, 0]], [[-1, 0.7 * lean], [0, 0], [-0.3, 1], [-1, 1]]
    for direction in np.radians(np.arange(-65, -25, 3)):
        shift = 2e-3 * np.array([np.cos(direction), np.sin(direction)])
        blocks = block("a", low, fixed=True), block("b", np.array(turned(high, turn)) + shift)
        sim = engine.simulation(tables(*blocks), "large")
        pressed = np.minimum.reduceat(sim.measured().gaps, sim.joints.starts[:-1]) < 0.0
        assert pressed.sum() == 1, np.degrees(direction)


@pytest.mark.parametrize("fraction", [5.0, 10.0, 20.0])
def test_an_arch_that_falls_makes_no_energy(fraction):
    """Voussoirs meet corner to corner while they fall."""
    analysis = {"kind": "time-history", "duration": 0.8, "fallen_deg": 179.0, "dropped": 5.0}
    case = shaken(*arch(), damping={"contact_fraction": fraction}, analysis=analysis)
    summary, records = engine.solve(case)
    energies = [row.energy for row in records.rows]
    errors = [
        e.kinetic + e.elastic + e.gravity + e.friction + e.dashpots - e.external for e in energies
    ]  # fmt: skip
    assert summary["largest_displacement"] > 0.5
    assert np.diff(errors).max() < 0.03 * max(abs(e.gravity) for e in energies)
