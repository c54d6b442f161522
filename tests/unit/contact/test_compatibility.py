"""B against motion by finite differences: opening and sliding of every point while one block moves a little."""

from __future__ import annotations

import numpy as np
import pytest
from engine import running_wall, simulation, tables

from dem_cli.core.contact.compatibility import compatibility, free_columns, relative_motion
from dem_cli.core.geometry.rotation import frames, turned


@pytest.fixture(scope="module")
def wall():
    return simulation(tables(*running_wall(3, 3)), "fixed")


def carried(sim, motion: np.ndarray, block: int) -> np.ndarray:
    """Places to which a block takes all points along [m], (n_points, 2)."""
    arms = sim.joints.points - sim.bodies.positions[block]
    return sim.bodies.positions[block] + motion[:2] + turned(arms, float(motion[2]))


def test_motion_at_points_by_finite_differences(wall):
    joints, small = wall.joints, 1e-6
    b = compatibility(wall.model, joints).toarray()
    directions = frames(joints.frames, 2)
    for column, block in enumerate(np.flatnonzero(~wall.model.fixed)):
        for k in range(3):
            step = small * np.eye(3)[k]
            moved = (carried(wall, step, block) - carried(wall, -step, block)) / (2 * small)
            along = np.einsum("pdk,pk->pd", directions, moved)
            sign = (joints.blocks[joints.owners, 1] == block).astype(float) - (joints.blocks[joints.owners, 0] == block)
            expected = sign[:, None] * along
            assert b[:, 3 * column + k].reshape(-1, 2) == pytest.approx(expected, abs=1e-9)


def test_columns_are_those_of_free_blocks(wall):
    rows, columns = relative_motion(wall.joints, 2), free_columns(wall.model, wall.joints)
    assert rows.shape == (len(wall.joints.kn), 2, 2, 3)
    assert columns.shape == (len(wall.joints.kn), 2, 3)
    fixed = wall.model.fixed[wall.joints.blocks[wall.joints.owners]]
    assert np.array_equal(columns < 0, np.repeat(fixed[:, :, None], 3, axis=2))
    assert columns.max() == 3 * (~wall.model.fixed).sum() - 1


def test_the_same_matrix_gives_the_forces_on_the_blocks(wall):
    """Its transpose, by the contact loop: forces of the wall under its weight are in equilibrium."""
    from dem_cli.core.engine.budget import Budget
    from dem_cli.core.statics.equilibrium import stand

    assert stand(wall, Budget(10**6)).state == "equilibrium"
    contacts, free = wall.contacts, ~wall.model.fixed
    reactions = np.column_stack([contacts.normal, contacts.shear]).ravel()
    forces = (compatibility(wall.model, wall.joints).T @ reactions).reshape(-1, 3)
    dead = wall.loads.dead[free]
    assert forces[:, :2] == pytest.approx(-dead[:, :2], abs=1e-4 * np.abs(dead).max())
