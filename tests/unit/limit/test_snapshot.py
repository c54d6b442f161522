"""A state of collapse as a frame: forces in balance, states of the joints, a motion of sensible size."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, running_wall, tables
from engine.limits import on_a_base, solved

from dem_cli.core.limit.snapshot import SHOWN_MOTION, Collapse, frame
from dem_cli.core.records.frames import STATES


def snapshot(found, tilting: bool = False):
    a = found.associated
    made = Collapse("associated", a.multiplier, a.normal, a.shear, a.velocities, a.iterations)
    return frame(found.structure, made, tilting)


def on_blocks(contacts, n_blocks: int) -> np.ndarray:
    """Sum of the contact forces on every block, (n_blocks, 2)."""
    total = np.zeros((n_blocks, 2))
    np.add.at(total, contacts.blocks[:, 1], contacts.forces())
    np.add.at(total, contacts.blocks[:, 0], -contacts.forces())
    return total


@pytest.mark.parametrize("pattern", ["mass", "tilt"])
def test_forces_carry_the_loads(pattern):
    """On a tilting table the weight keeps its size, and turns."""
    found = solved(tables(*running_wall(6, 3), analysis={"pattern": pattern}))
    made, model = snapshot(found, pattern == "tilt"), found.structure.model
    loads = model.dead_loads + made.load * model.live_loads
    if pattern == "tilt":
        loads = loads / np.hypot(1.0, made.load)
        np.testing.assert_allclose(np.hypot(*loads[~model.fixed, :2].T), -model.dead_loads[~model.fixed, 1])
    carried = on_blocks(made.contacts, model.n_blocks)
    weight = -model.dead_loads[~model.fixed, 1].mean()
    np.testing.assert_allclose(carried[~model.fixed], -loads[~model.fixed, :2], atol=1e-5 * weight)


def test_a_rocking_block_opens_at_one_end_and_turns_about_the_other():
    found = solved(on_a_base(block("b", rectangle(0.0, 0.0, 0.3, 1.0))))
    made = snapshot(found)
    states = [STATES[k] for k in made.contacts.state]
    heel, toe = np.argsort(made.contacts.points[:, 0])
    assert states[heel] == "open"
    assert states[toe] == "sticking"
    assert made.contacts.gap[heel] > 0.0
    moved = made.positions - found.structure.model.centroids
    assert moved[1, 0] > 0.0
    assert made.orientations[1, 0] < 0.0
    radius = np.hypot(0.15, 0.5)
    assert max(np.hypot(*moved[1]), abs(made.orientations[1, 0]) * radius) == pytest.approx(SHOWN_MOTION * radius)


def test_a_sliding_block_slides():
    made = snapshot(solved(on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)))))
    assert all(STATES[k] == "sliding" for k in made.contacts.state)


def test_points_follow_their_block():
    """With the mechanism of a rocking block the toe stays where it is."""
    found = solved(on_a_base(block("b", rectangle(0.0, 0.0, 0.3, 1.0))))
    made = snapshot(found)
    toe = np.argmax(made.contacts.points[:, 0])
    np.testing.assert_allclose(made.contacts.points[toe], [0.3, 0.0], atol=1e-6)
