"""Frequencies in space: tensors of inertia whose axes are not those of the world, directions, rocking stiffness."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine import block, scene, simulation, tables
from scipy.spatial.transform import Rotation

from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.dynamics.frequencies import limiting, modes, system
from dem_cli.core.dynamics.landing import landing
from dem_cli.core.dynamics.rocking_stiffness import turn_sideways
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.model.scales import smallest_edge

SIDES = np.array([0.5, 0.8, 1.5])
TILTED = Rotation.from_rotvec([0.4, -0.7, 0.5])
CORNERS = {"dry": {"friction": 0.6, "kn": 1e9, "ks": 4e8, "points": "vertices"}}  # closed forms are those of corners


def stones(turn: Rotation) -> list[dict]:
    """A block on a base, all turned about the origin."""
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    base = corners * [4, 4, 1] - [2, 2, 1]
    return [
        block("base", turn.apply(base).tolist(), fixed=True),
        block("b", turn.apply(corners * SIDES).tolist()),
    ]


def case(turn: Rotation, **more) -> dict:
    return {"dimension": 3, **tables(*stones(turn), joints=CORNERS, **more)}


def found(turn: Rotation):
    sim = simulation(case(turn))
    return modes(system(sim), 6, 3, sim.model.n_blocks), sim, sim.model.block_ids.index("b")


def inertia(turn: Rotation, mass: float) -> np.ndarray:
    """Tensor of the block along the axes of the world, by its sides."""
    own = mass / 12.0 * np.diag((SIDES**2).sum() - SIDES**2)
    return turn.as_matrix() @ own @ turn.as_matrix().T


def test_directions_do_not_matter():
    """A block and its base turned in space: the same frequencies, shapes and effective masses turned along."""
    upright, _, b = found(Rotation.identity())
    tilted, sim, other = found(TILTED)
    assert tilted.frequencies == pytest.approx(upright.frequencies, rel=1e-9)
    back = np.hstack([TILTED.inv().apply(tilted.shapes[:, other, :3]), TILTED.inv().apply(tilted.shapes[:, other, 3:])])
    likeness = np.abs((back * upright.shapes[:, b]).sum(axis=1)) / (upright.shapes[:, b] ** 2).sum(axis=1)
    assert likeness == pytest.approx(np.ones(6), rel=1e-9)
    assert tilted.effective_masses.sum(axis=0) == pytest.approx([sim.model.masses[other]] * 3, rel=1e-9)


def test_shapes_are_orthogonal_with_the_tensor_of_inertia():
    modal, sim, b = found(TILTED)
    masses = np.zeros((6, 6))
    masses[:3, :3] = sim.model.masses[b] * np.eye(3)
    masses[3:, 3:] = inertia(TILTED, sim.model.masses[b])
    assert np.abs(masses[3:, 3:] - np.diag(np.diag(masses[3:, 3:]))).max() > 0.1 * masses[3, 3]
    shapes = modal.shapes[:, b]
    assert shapes @ masses @ shapes.T == pytest.approx(np.eye(6), abs=1e-12)
    stiffness = system(sim).stiffness.toarray()
    omega = 2.0 * math.pi * modal.frequencies
    assert shapes @ stiffness @ shapes.T == pytest.approx(np.diag(omega**2), abs=1e-9 * omega[-1] ** 2)


def test_a_centre_makes_a_joint_elastic_all_over():
    """Four corners are three times as stiff against turning as an elastic joint; with a centre it is exact."""
    slow = []
    for points in ("vertices", "vertices+centre"):
        joints = {"dry": {"friction": 0.6, "kn": 1e9, "ks": 1e12, "points": points}}
        sim = simulation({"dimension": 3, **tables(*stones(Rotation.identity()), joints=joints)})
        slow.append(modes(system(sim), 2, 3, sim.model.n_blocks).frequencies)
    mass, area = 2000.0 * SIDES.prod(), SIDES[0] * SIDES[1]
    for frequencies, share in zip(slow, (4.0, 12.0), strict=True):
        for frequency, side in zip(frequencies, SIDES[:2], strict=True):
            about_base = mass * (side**2 + SIDES[2] ** 2) / 12.0 + mass * (SIDES[2] / 2) ** 2
            expected = math.sqrt(1e9 * area * side**2 / share / about_base) / (2.0 * math.pi)
            assert frequency == pytest.approx(expected, rel=1e-3)  # ks is 1000 times kn, not infinite


@pytest.mark.parametrize("angle", [0.0, 0.4, math.pi / 4, 1.3])
def test_rocking_stiffness_in_any_plan(angle):
    """ε = 2 ρ g (h/b)²/kn of the narrower side b, however the block lies in plan."""
    made = scene(case(Rotation.from_rotvec([0.0, 0.0, angle])))
    joints = joints_of_start(
        made.model,
        bodies_at_rest(made.model),
        joint_properties(made.request, made.model, 1e6),
        smallest_edge(made.model),
    ).joints
    sways = 2.0 * 2000.0 * 9.81 * (1.5 / 0.5) ** 2 / 1e9
    assert turn_sideways(made.model, joints) == pytest.approx(sways, rel=1e-6)


@pytest.mark.parametrize("turn", [Rotation.identity(), TILTED])
def test_a_block_lands_as_it_would_stand(turn):
    """On the largest face, whatever the direction: as fast as where that face lies on a base."""
    joints = CORNERS
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    far = block("base", (corners - [0.5, 0.5, 9.0]).tolist(), fixed=True)
    flat = SIDES[[1, 2, 0]]  # it lies on 0.8 m x 1.5 m
    loose = simulation({"dimension": 3, **tables(far, block("b", turn.apply(corners * flat).tolist()), joints=joints)})
    base = block("base", (corners * [9, 9, 1] - [4, 4, 1]).tolist(), fixed=True)
    lies = simulation({"dimension": 3, **tables(base, block("b", (corners * flat).tolist()), joints=joints)})
    frequency, which = landing(loose)
    assert frequency == pytest.approx(limiting(lies).frequency, rel=1e-9)
    assert loose.model.block_ids[which] == "b"
    assert landing(lies) == (0.0, -1)
