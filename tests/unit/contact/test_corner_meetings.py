"""Parts that meet corner to corner at the start: which they are, how far they have moved, when they get a joint."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, simulation, tables
from engine.limits import rotated

from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.contact.start import bodies_at_rest, corner_meetings
from dem_cli.core.engine.placement import moves
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.kernels.records import HOLD_LOAD

PASSING = DEFAULT.detection.passing


def four(dimension: int, gap: float = 0.0) -> dict:
    """Two stones of 1 m on two others, all four with a corner, in space an edge, in one place."""
    places = {"base": (0, -1, 2, 0), "left": (0, 0, 1, 1), "right": (1, 0, 2, 1)}
    places |= {"over-left": (0, 1, 1, 2), "over-right": (1 + gap, 1, 2 + gap, 2)}
    blocks = []
    for name, (x0, y0, x1, y1) in places.items():
        corners = rectangle(x0, y0, x1, y1)
        if dimension == 3:
            corners = [[x, y, z] for x, z in corners for y in (0.0, 0.5)]
        blocks.append(block(name, corners, fixed=name == "base"))
    direction = [1.0] + [0.0] * (dimension - 1)
    return tables(*blocks, dimension=dimension, analysis={"kind": "pushover", "direction": direction})


def pairs(sim) -> set[frozenset[str]]:
    """Blocks that have a joint with each other."""
    return {frozenset(sim.model.block_ids[i] for i in pair) for pair in sim.joints.blocks}


ASLANT = {frozenset(("left", "over-right")), frozenset(("right", "over-left"))}


@pytest.mark.parametrize("dimension", [2, 3])
def test_stones_aslant_meet_at_a_corner_and_neighbours_do_not(dimension):
    sim = simulation(four(dimension), "large")
    found = sim.tracking.meetings
    assert {frozenset(sim.model.block_ids[i] for i in pair) for pair in found.blocks} == ASLANT
    assert np.diff(found.starts).tolist() == [2 ** (dimension - 1)] * 2  # a corner of each, in space two of each
    assert not ASLANT & pairs(sim)
    assert len(sim.joints.blocks) == 6  # two beds on the base, two above, two heads
    assert found.shifts(sim.bodies) == pytest.approx([0.0, 0.0], abs=1e-15)


def test_stones_beside_each_other_at_a_distance_do_not_meet():
    found = simulation(four(2, gap=1e-3), "large").tracking.meetings
    assert len(found.parts) == 1


def test_shifts_of_a_stone_that_is_moved_and_turned():
    """By a quarter turn about its centroid the corner of a square goes one side along."""
    sim = simulation(four(2), "large")
    number = sim.model.block_ids.index("over-right")
    sim.bodies.positions[number] += (0.3, 0.4)
    of_moved = sim.tracking.meetings.blocks[:, 1] == number
    assert sim.tracking.meetings.shifts(sim.bodies) == pytest.approx(np.where(of_moved, 0.5, 0.0), abs=1e-12)
    sim.bodies.positions[number] -= (0.3, 0.4)
    sim.bodies.orientations[number] = np.pi / 2
    assert sim.tracking.meetings.shifts(sim.bodies) == pytest.approx(np.where(of_moved, 1.0, 0.0), abs=1e-12)


@pytest.mark.parametrize("angle", [0.1, 1.0])
def test_what_meets_does_not_hang_on_directions(angle):
    model = rotated(simulation(four(2), "large").model, angle)
    bodies = bodies_at_rest(model, moves=True)
    narrow = geometry_of(2)
    found = corner_meetings(model, narrow, narrow.find(model, bodies.corners, 0.05), bodies, 1e-6)
    assert sorted(map(tuple, found.blocks.tolist())) == [(1, 4), (2, 3)]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(("share", "passed"), [(0.5, False), (2.0, True)])
def test_a_stone_has_a_joint_once_it_has_passed_the_corner(share, passed, dimension):
    """Pushed to the left, over the stone below aslant: before, nothing; after, with the normal of its top."""
    sim = simulation(four(dimension), "large")
    number, size = sim.model.block_ids.index("over-right"), np.sqrt(2.0 if dimension == 2 else 2.25)
    motion = np.zeros_like(sim.bodies.velocities)
    motion[[number - 1, number], 0] = -share * PASSING * size  # the stone beside it makes room
    moves.push(sim, motion)
    aslant = frozenset(("left", "over-right"))
    assert (aslant in pairs(sim)) is passed
    motion[:] = 0.0
    motion[number, dimension - 1] = -1e-7
    moves.push(sim, motion)
    sim.advance(1, HOLD_LOAD)
    sim.measured()
    own = np.array([frozenset(sim.model.block_ids[i] for i in pair) == aslant for pair in sim.joints.blocks])
    pressed = own[sim.joints.owners] & (sim.contacts.normal > 0.0)
    assert pressed.any() == passed
    normals = sim.joints.frames[pressed, :dimension]
    assert normals == pytest.approx(np.tile(np.eye(dimension)[-1], (len(normals), 1)), abs=1e-6)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_joint_of_corners_that_have_passed_begins_without_a_force(dimension):
    """However deep one is in the other by then: nothing did that work."""
    sim = simulation(four(dimension), "large")
    number = sim.model.block_ids.index("over-right")
    motion = np.zeros_like(sim.bodies.velocities)
    motion[[number - 1, number], 0] = -1e-3
    motion[number, dimension - 1] = -1e-5
    moves.push(sim, motion)
    own = np.array([{sim.model.block_ids[i] for i in pair} == {"left", "over-right"} for pair in sim.joints.blocks])
    own = own[sim.joints.owners] & (sim.joints.kn > 0.0)
    assert sim.measured().gaps[own].min() == pytest.approx(-1e-5, rel=1e-6)
    sim.advance(1, HOLD_LOAD)
    assert sim.contacts.normal[own].max() <= 1e-6 * sim.joints.kn[own].max() * 1e-5


def test_restored_states_know_which_corners_had_not_passed():
    sim = simulation(four(2), "large")
    before, joints = sim.save(), pairs(sim)
    motion = np.zeros_like(sim.bodies.velocities)
    motion[[3, 4], 0] = -1e-3
    moves.push(sim, motion)
    after = sim.save()
    assert pairs(sim) > joints
    sim.restore(before)
    assert pairs(sim) == joints
    sim.detect()
    assert pairs(sim) == joints
    moves.push(sim, motion)
    assert pairs(sim) > joints
    sim.restore(after)
    sim.detect()
    assert pairs(sim) > joints
