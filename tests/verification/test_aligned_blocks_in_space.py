"""Two equal cubes pressed on each other: force and moment go on smoothly where their edges pass each other."""

from __future__ import annotations

import engine
import numpy as np
import pytest
from studies.space.structures import box, tables

PRESSED, TILTED = 1e-4, 5e-5  # overlap over the side, and slope: all corners press, each with its own force
STEPS = 41


def wrench(sim, saved, shift: float, yaw: float) -> np.ndarray:
    """Normal forces on the upper cube and their moment about its centroid over N and N·L, at a place (6,)."""
    sim.restore(saved)
    cube = np.array([1])
    centre = sim.bodies.positions[1].copy()
    sim.turn(cube, np.array([0.6, 0.8, 0.0]) * TILTED, centre)
    sim.turn(cube, np.array([0.0, 0.0, yaw]), centre)
    sim.displace(cube, np.array([shift, 0.0, -PRESSED]))
    sim.find_faces()
    joints, gaps = sim.joints, sim.tracking.measured(sim.bodies).gaps
    pushed = (joints.kn * np.maximum(-gaps, 0.0))[:, None] * joints.frames[:, :3]
    moments = np.cross(joints.points - sim.bodies.positions[1], pushed)
    found = np.concatenate([pushed.sum(axis=0), moments.sum(axis=0)])
    return found / abs(found[2])


@pytest.mark.parametrize(("shifts", "yaws"), [
    (np.zeros(STEPS), np.linspace(-4e-5, 4e-5, STEPS)),
    (np.linspace(-4e-5, 4e-5, STEPS), np.full(STEPS, 1e-3)),
    (np.linspace(-4e-5, 4e-5, STEPS), np.zeros(STEPS)),
], ids=["yaw through zero", "shift through alignment, turned", "shift through alignment"])  # fmt: skip
def test_no_jump_where_edges_are_aligned(shifts, yaws):
    """Triangles alone jump by 3e-3 N·L here; shares that fade leave the slope times the step, 2e-6 of the side."""
    cubes = [box("low", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), fixed=True), box("high", (0.0, 0.0, 1.0), (1.0, 1.0, 2.0))]
    sim = engine.simulation(tables(*cubes), "large")
    saved = sim.save()
    found = np.array([wrench(sim, saved, shift, yaw) for shift, yaw in zip(shifts, yaws, strict=True)])
    beyond = np.abs(np.diff(found, n=2, axis=0)).max(axis=0)
    assert beyond[:3].max() < 1e-5  # of N
    assert beyond[3:].max() < 1e-5  # of N·L
