"""Compatibility and equilibrium matrices: signs against the contact loop, duality, fixed blocks."""

from __future__ import annotations

import numpy as np
import pytest
from casefiles import CASES
from engine import block, rectangle, scene, simulation, tables, turned

from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.engine import measures
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.kernels import records as slot
from dem_cli.core.limit.matrices import structure_of
from dem_cli.core.model.scales import smallest_edge

ARCH = CASES / "verification" / "arch_21.toml"


def structure(case):
    made = scene(case)
    model = made.model
    properties = joint_properties(made.request, model)
    joints = joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model)).joints
    return structure_of(model, joints)


@pytest.mark.parametrize("name", ["arch_21", "wall_with_door", "groove", "trilith"])
def test_forces_are_those_of_the_contact_loop(name):
    """After some steps, Bᵀ r is what the compiled loop put on the blocks."""
    path = CASES / "verification" / f"{name}.toml"
    sim = simulation(path)
    sim.advance(40, slot.HOLD_LOAD)
    s = structure(path)
    reactions = np.column_stack([sim.contacts.normal, sim.contacts.shear]).ravel()
    forces = s.on_blocks(s.compatibility.T @ reactions)
    assert np.abs(reactions).max() > 0.0
    np.testing.assert_allclose(forces[sim.free], sim.bodies.forces[sim.free], atol=1e-12 * np.abs(reactions).max())


def test_gaps_are_those_of_the_contact_loop():
    """B u is the opening that the compiled loop integrates."""
    sim, s = simulation(ARCH), structure(ARCH)
    before = sim.contacts.gaps.copy()
    sim.advance(40, slot.HOLD_LOAD)
    moved = np.column_stack([measures.displacements(sim), sim.bodies.orientations])
    moved -= sim.bodies.velocities  # gaps lag a step
    opened = (s.compatibility @ moved.ravel()[s.free]).reshape(-1, 2)[:, 0]
    np.testing.assert_allclose(opened, sim.contacts.gaps - before, atol=1e-9 * np.abs(opened).max())


def test_a_block_lifted_off_its_base_opens_and_one_pushed_slides():
    table = tables(
        block("base", rectangle(-1.0, -1.0, 1.0, 0.0), fixed=True), block("b", rectangle(-0.5, 0.0, 0.5, 0.4))
    )
    s = structure(table)
    right, up, turn = (s.compatibility.toarray()[:, i].reshape(2, 2) for i in range(3))
    np.testing.assert_allclose(up, [[1.0, 0.0], [1.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(right, [[0.0, -1.0], [0.0, -1.0]], atol=1e-12)  # the tangent points to −x
    np.testing.assert_allclose(np.sort(turn[:, 0]), [-0.5, 0.5], atol=1e-12)


def test_free_degrees_of_freedom_skip_fixed_blocks():
    s = structure(ARCH)
    n_free = int((~s.model.fixed).sum())
    assert s.compatibility.shape[1] == 3 * n_free == len(s.free) == len(s.scales)
    whole = s.on_blocks(np.ones(len(s.free)))
    assert (whole[s.model.fixed] == 0.0).all()
    assert (whole[~s.model.fixed] == 1.0).all()


def test_a_rigid_motion_of_everything_moves_no_joint():
    corners = rectangle(-0.5, 0.0, 0.5, 0.4)
    upper = rectangle(-0.5, 0.4, 0.5, 0.8)
    table = tables(block("a", turned(corners, 0.3)), block("b", turned(upper, 0.3)))
    s = structure(table)
    spin = 0.7
    velocities = np.column_stack([spin * np.array([-1.0, 1.0]) * s.model.centroids[:, ::-1], np.full(2, spin)])
    np.testing.assert_allclose(s.compatibility @ velocities.ravel(), 0.0, atol=1e-12)
