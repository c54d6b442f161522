"""Tangent stiffness of elastic faces that are closed in part: beside differences of the pressure that it comes from."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, simulation, tables
from studies.space.structures import box

from dem_cli.core.dynamics.pressed_stiffness import root_of_stiffness
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels.deformation.pressed_faces import fan_out_all, share_pressure

KN = 1e9
JOINTS = {"dry": {"friction": 0.6, "kn": KN}}


def on_ground(dimension: int) -> Simulation:
    """A block of 1.0 × 0.6 m on the ground."""
    if dimension == 2:
        case = tables(
            block("base", rectangle(-2, -1, 3, 0), fixed=True), block("b", rectangle(0, 0, 1, 1)),
            joints=JOINTS, analysis={"kind": "gravity"},
        )  # fmt: skip
    else:
        blocks = [box("base", (-2, -2, -1), (3, 3, 0), fixed=True), box("b", (0, 0, 0), (1, 0.6, 1))]
        case = tables(*blocks, dimension=3, joints=JOINTS, analysis={"kind": "gravity"})
    return simulation(case, "large")


def forces(sim: Simulation, overlaps: np.ndarray) -> np.ndarray:
    """Normal forces of all points at these overlaps [N]."""
    sim.contacts.gaps[:] = -overlaps
    share_pressure(sim.joints, sim.contacts, 0)
    return sim.joints.kn * np.maximum(-sim.contacts.lumped, 0.0)


CLOSED = {
    2: [(1.0, 2.0), (1.0, -0.5), (-0.2, 1.0)],
    3: [(1.0, 1.0, 2.0, 2.0), (1.0, -0.5, -2.0, -0.5), (2.0, 2.0, -1.0, -1.0), (1.0, 2.0, 1.0, -0.3)],
}


def outline(sim: Simulation) -> np.ndarray:
    """A shift and the turns of the face as overlaps of its points, those without a place at zero, (n_points, d)."""
    d, used = sim.model.dimension, sim.joints.kn > 0.0
    if d == 3:
        fan_out_all(sim.joints)
    arms = sim.joints.points[:, : d - 1] - sim.joints.points[used, : d - 1].mean(axis=0)
    return np.column_stack([np.ones(len(used)), arms]) * used[:, None]


@pytest.mark.parametrize(("dimension", "heights"), [(d, heights) for d, cases in CLOSED.items() for heights in cases])
def test_it_is_the_derivative_of_the_forces(dimension, heights):
    """Of overlaps that are linear over the face, as it moves as a plane."""
    sim = on_ground(dimension)
    planes = outline(sim)
    used = sim.joints.kn > 0.0
    overlaps = planes @ np.linalg.lstsq(planes[used], 1e-4 * np.array(heights), rcond=None)[0]
    root, step = root_of_stiffness(sim.joints, overlaps).toarray(), 1e-9
    for motion in planes.T:
        slope = (forces(sim, overlaps + step * motion) - forces(sim, overlaps - step * motion)) / (2.0 * step)
        assert planes.T @ (root.T @ root) @ motion == pytest.approx(planes.T @ slope, rel=1e-4, abs=1e-6 * KN)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_closed_face_has_the_moment_of_its_area(dimension):
    """kn A for a shift and kn b³ t/12 for a turn; an open one has none."""
    sim = on_ground(dimension)
    planes, depth = outline(sim), 0.6 if dimension == 3 else 1.0
    closed, opened = (root_of_stiffness(sim.joints, sign * 1e-5 * planes[:, 0]).toarray() for sign in (1.0, -1.0))
    shift, turn = planes[:, 0], planes[:, 1]
    assert shift @ closed.T @ closed @ shift == pytest.approx(KN * depth)
    assert turn @ closed.T @ closed @ turn == pytest.approx(KN * depth / 12.0)
    assert not (opened @ planes).any()


def test_faces_that_only_may_meet_have_none():
    """Blocks of a stack side by side, the upper ones slid off each other: their faces keep room for points."""
    blocks = [box(f"b{i}{k}", (i, 0, k), (i + 1, 0.6, k + 1), fixed=k == 0) for i in (0, 1) for k in (0, 1)]
    sim = simulation(tables(*blocks, dimension=3, joints=JOINTS, analysis={"kind": "gravity"}), "large")
    first = np.flatnonzero((sim.joints.integrated == 1) & (np.diff(sim.joints.starts) > 0))[0]
    sim.joints.kn[sim.joints.starts[first] : sim.joints.starts[first + 1]] = 0.0
    root = root_of_stiffness(sim.joints, np.zeros(len(sim.joints.kn)))
    assert root.shape == (len(sim.joints.kn),) * 2
    assert not root[sim.joints.starts[first] : sim.joints.starts[first + 1]].toarray().any()
