"""What motion at a constant load proves: failure, nothing yet, or that a structure at rest is another one."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, running_wall, simulation, tables

from dem_cli.core.contact.detect import world_corners
from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.measures import free_falls
from dem_cli.core.kernels import records as slot
from dem_cli.core.model.scales import depth
from dem_cli.core.statics.compliance import compliance
from dem_cli.core.statics.equilibrium import relax, settle_or_fail, stand
from dem_cli.core.statics.failure_test import FailureTest, displaced, moved_far

GROUND = block("ground", rectangle(-3, -1, 6, 0), fixed=True)
NEEDLE = block("needle", rectangle(0, 0, 0.25, 1))
FREE = block("free", rectangle(0, 5, 1, 6))


def test_depth_counts_courses():
    sim = simulation(tables(*running_wall(5, 3)))
    assert sim.depth == 5


def test_depth_of_blocks_that_no_joint_reaches():
    assert depth(np.empty((0, 2), int), np.array([True, False])) == 0


CHAMFERED = [[0, 0], [0.25 - 1e-6, 0], [0.25, 1e-6], [0.25, 1], [0, 1]]


@pytest.mark.parametrize("corners", [rectangle(0, 0, 0.25, 1), CHAMFERED])
def test_width_is_no_edge(corners):
    """A tiny edge at a corner makes no block narrow."""
    sim = simulation(tables(GROUND, block("b", corners)))
    assert sim.model.shapes.widths[1] == pytest.approx(0.25, rel=0.05)


def watch(sim, looks: int, scale: float):
    """The first proof of failure in so many looks, each √2 of the time of the last."""
    motion, done = FailureTest(sim, scale), 0
    for look in range(2, looks):
        sim.advance(100 * round(2 ** (look / 2)) - done, slot.HOLD_LOAD)
        done = 100 * round(2 ** (look / 2))
        if failing := motion.look():
            return failing
    return None


def test_a_block_that_falls_freely_fails():
    failing = watch(simulation(tables(GROUND, FREE)), 16, 1e-9)
    assert failing is not None
    assert failing.growth > 3.5


@pytest.mark.parametrize(("up", "fails"), [(1.0, False), (0.0, True)])
def test_a_thrown_block_does_not_fail_in_its_flight(up, fails):
    """Faster than its own weight could make it: a knock, and no failure before it would have landed."""
    sim = simulation(tables(GROUND, FREE))
    steps = 20_000
    sim.bodies.velocities[1, 1] = up * 0.5 * free_falls(sim)[1] * steps
    assert (watch(sim, 14, 1e-9) is not None) is fails


def test_coming_to_rest_elsewhere_is_no_equilibrium():
    """A block that leans too far falls on its side and lies there."""
    turned = np.array(rectangle(0, 0, 0.25, 1)) @ np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    leaning = block("leaning", turned - turned.min(axis=0))
    case = tables(GROUND, leaning, joints={"dry": {"friction": 1.0, "kn": 1e7}})
    sim = simulation(case, "large")
    verdict = stand(sim, Budget(1_000_000))
    assert verdict.state == "failure"


def test_rest_after_toppling_names_the_block():
    """At rest on its side, after it stood."""
    sim = simulation(tables(GROUND, NEEDLE, joints={"dry": {"friction": 1.0, "kn": 1e8}}), "large")
    assert stand(sim, Budget(100_000)).state == "equilibrium"
    scale, since = measures.dead_scale(sim), sim.places()
    sim.bodies.positions[1], sim.bodies.orientations[1] = (0.75, 0.125), -np.pi / 2
    sim.bodies.corners[:] = world_corners(sim.shape, sim.bodies.positions, sim.bodies.orientations)
    sim.detect()
    verdict = settle_or_fail(sim, 0.0, Budget(200_000), scale, since=since)
    assert (verdict.state, verdict.block) == ("failure", "needle")
    assert displaced(sim, sim.places(), scale) is None


def _pier(n: int, side: float = 0.3) -> list[dict]:
    """Square blocks on each other on a base."""
    base = block("base", rectangle(-1.0, -0.3, 1.5, 0.0), fixed=True)
    return [base, *(block(f"b{i}", rectangle(0.0, side * i, side, side * (i + 1))) for i in range(n))]


@pytest.mark.parametrize("force", [5000.0, 10_000.0])
def test_a_cantilever_that_bends_by_much_of_its_width_stands(force):
    """Elastic joints that hold whatever comes; its end has moved by F Σ z²/K, K = kn b³/12, and a little more."""
    joints = {"j": {"law": "elastic", "kn": 3.33e9, "ks": 1.332e9}}
    pull = [{"block": "b9", "force": [force, 0.0], "at": [0.15, 3.0]}]
    sim = simulation(tables(*_pier(10), joints=joints, load=pull), "large")
    start = sim.places()
    assert stand(sim, Budget(100_000)).state == "equilibrium"
    levers = 3.0 - 0.3 * np.arange(10)
    turned = force * levers / (3.33e9 * 0.3**3 / 12.0)
    slid = 10 * force / (1.332e9 * 0.3)
    exact = (turned * (levers - 0.15)).sum() + slid  # of the centroid of the last block
    assert sim.places()[-1, 0] - start[-1, 0] == pytest.approx(exact, rel=0.05)
    block_far, distance = moved_far(sim, start)
    assert sim.model.block_ids[block_far] == "b9"
    assert distance == pytest.approx(exact, rel=0.05)


def test_a_tower_that_lies_on_the_ground_does_not_stand():
    """Its blocks kept their places against each other, and the lowest one stands on no joint of before."""
    joints = {"dry": {"friction": 1.0, "kn": 1e9}}
    sim = simulation(tables(*_pier(2), joints=joints), "large")
    assert stand(sim, Budget(100_000)).state == "equilibrium"
    scale, since = measures.dead_scale(sim), sim.places()
    sim.bodies.positions[1:], sim.bodies.orientations[1:] = [(0.45, 0.15), (0.75, 0.15)], -np.pi / 2
    sim.bodies.corners[:] = world_corners(sim.shape, sim.bodies.positions, sim.bodies.orientations)
    sim.detect()
    verdict = settle_or_fail(sim, 0.0, Budget(200_000), scale, since=since)
    assert verdict.state == "failure"
    assert verdict.block in ("b0", "b1")


def test_a_small_fall_onto_the_ground_is_no_failure():
    """A gap of a thousandth of a block closes."""
    sim = simulation(tables(GROUND, block("b", rectangle(0, 1e-3, 1, 1.001))), "large")
    assert stand(sim, Budget(1_000_000)).state == "equilibrium"


def test_relax_says_when_blocks_moved_away():
    above = block("b", rectangle(0, 0.5, 1, 1.5))
    sim = simulation(tables(GROUND, above, joints={"dry": {"friction": 1.0, "kn": 1e7}}), "large")
    assert relax(sim, 0.0, 1e-5, 400_000).state == "failure"


def test_a_needle_is_held_by_its_width():
    """1.5 % above the load that turns it over, moments over its length seem to balance."""
    sim = simulation(tables(GROUND, block("needle", rectangle(0, 0, 1e-3, 1)), friction=1.0))
    assert stand(sim, Budget(10**5)).state == "equilibrium"
    exact, (_, elastic) = 1e-3, compliance(sim)
    held = sim.save()
    assert settle_or_fail(sim, 0.995 * exact, Budget(10**6), elastic * exact).state == "equilibrium"
    sim.restore(held)
    assert settle_or_fail(sim, 1.015 * exact, Budget(10**6), elastic * exact).state == "failure"
