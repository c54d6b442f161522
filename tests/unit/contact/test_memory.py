"""What a contact point remembers goes with it; blocks of several convex parts move as one."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, simulation, steps, tables
from studies.space.structures import box

from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels import records as slot

W = 2000.0 * 9.81  # of the unit block [N]


def on_base(base=(-1.0, 3.0), friction=0.6, **more) -> Simulation:
    blocks = [block("base", rectangle(base[0], -1, base[1], 0), fixed=True), block("b", rectangle(0, 0, 1, 1))]
    return simulation(tables(*blocks, friction=friction, **more), "large")


def settled(sim: Simulation, load: float = 0.0) -> Simulation:
    sim.set_load(0.0)
    sim.advance(3000, slot.HOLD_LOAD)
    sim.set_load(load)
    sim.advance(6000, slot.HOLD_LOAD)
    sim.rest()
    return sim


def memory(sim: Simulation) -> dict[tuple, tuple]:
    """What each loaded point carries, by its joint's edges and its end."""
    rows = {}
    for j, edges in enumerate(sim.geometry.keys.tolist()):
        for end in (0, 1):
            p = 2 * j + end
            if sim.contacts.normal[p] > 0:
                rows[*edges, end] = (sim.contacts.normal[p], *sim.contacts.shear[p], sim.contacts.slip[p])
    return rows


def test_detection_changes_nothing_that_is_loaded():
    """Forces, shear springs, slip and stiffness survive a detection bit by bit, and so does the motion."""
    one, two = (settled(on_base(), 0.4) for _ in range(2))
    before = memory(one)
    assert len(before) == 2
    for _ in range(5):
        one.detect()
    assert memory(one) == before
    one.set_masses()
    two.set_masses()
    for sim in (one, two):
        sim.set_load(0.55)
        steps(sim, 500)
    assert np.array_equal(one.bodies.positions, two.bodies.positions)


BOND = {"law": "mohr-coulomb", "friction": 0.6, "cohesion": 1e7, "tension": 1e7, "kn": 1e9, "ks": 5e8}


def bonded(dimension: int) -> Simulation:
    """A block glued to its base, which trembles when its weight and a push come on at once; nothing breaks."""
    push = [{"kind": "live", "block": "b", "force": [W, 0.0, 0.0][:dimension]}]
    if dimension == 2:
        return on_base(joints={"dry": BOND}, load=push)
    blocks = [box("base", (-1, -1, -1), (3, 2, 0), fixed=True), box("b", (0, 0, 0), (1, 1, 1))]
    return simulation(tables(*blocks, dimension=3, joints={"dry": BOND}, load=push), "large")


@pytest.mark.parametrize("dimension", [2, 3])
def test_bonds_lose_nothing_to_detections(dimension):
    """Nothing slips and nothing breaks: no step after a detection may book a change of force as work lost."""
    sim = bonded(dimension)
    sim.use(0.25, damping=0.0)
    sim.set_load(0.5)
    for _ in range(200):
        sim.advance(3, slot.HOLD_LOAD)
        sim.detect()
    assert sim.elastic_energy() > 0.0
    assert sim.ledger[slot.FRICTION] == pytest.approx(0.0, abs=1e-9 * sim.elastic_energy())


def test_stiffness_of_a_point_survives_its_shrinking_overlap():
    sim = settled(on_base((-1.0, 3.0)))
    kn = sim.joints.kn.copy()
    sim.bodies.positions[1, 0] += 2.3
    sim.bodies.corners[sim.shape.corner_blocks == 1, 0] += 2.3
    sim.detect()
    assert np.array_equal(sim.joints.kn[sim.contacts.normal > 0], kn)


def test_rider_keeps_its_shear_force():
    """A block held by friction on a base that travels ten blocks keeps its shear force, detection by detection."""
    sim = settled(on_base((-1.0, 3.0)), 0.4)
    shear = sim.contacts.shear.sum()
    assert abs(shear) == pytest.approx(0.4 * W, rel=1e-4)
    first, lost = sim.detections, sim.ledger[slot.FRICTION]
    elastic = sim.bodies.positions[1] - sim.bodies.positions[0]
    sim.control[slot.DAMP] = sim.control[slot.DAMP_CHANGE] = 0.0
    sim.bodies.velocities[:, 0] = 1e-3
    sim.advance(10_000, slot.HOLD_LOAD)
    assert sim.detections - first > 150
    assert sim.bodies.positions[0, 0] - sim.model.centroids[0, 0] == pytest.approx(10.0)
    assert sim.contacts.shear.sum() == pytest.approx(shear, rel=1e-3)
    assert sim.ledger[slot.FRICTION] == lost
    assert sim.bodies.positions[1] - sim.bodies.positions[0] == pytest.approx(elastic, abs=1e-8)


def test_slider_keeps_sliding_at_its_limit():
    """Pushed over 1.5 m through many detections: shear = μN at every look, slip = way, friction work = μN way."""
    sim = settled(on_base((-1.0, 4.0), friction=0.4), 0.3)
    start, friction, first = sim.bodies.positions[1, 0], sim.ledger[slot.FRICTION], sim.detections
    sim.control[slot.RATE] = W * 1e-4
    worst = 0.0
    for _ in range(150):
        sim.advance(100, slot.CREEP)
        worst = max(worst, abs(abs(sim.contacts.shear.sum()) / (0.4 * sim.contacts.normal.sum()) - 1))
    way = sim.bodies.positions[1, 0] - start
    assert way == pytest.approx(1.5, rel=1e-3)
    assert sim.detections - first > 50
    assert worst < 1e-12
    assert sim.contacts.slip[sim.contacts.normal > 0] == pytest.approx([way, way], rel=1e-3)
    assert sim.ledger[slot.FRICTION] - friction == pytest.approx(0.4 * W * way, rel=2e-3)


def test_corner_turns_over_to_its_other_edge():
    """A block rolls over its corner, which carries all the weight, first with one edge, then with the other."""
    blocks = [block("base", rectangle(-2, -1, 5, 0), fixed=True), block("b", rectangle(0, 0, 1, 1))]
    sim = settled(simulation(tables(*blocks, friction=2.0), "large", ratio=1e4))
    sim.use(0.85, 0.3, 0.3)
    own = np.flatnonzero(sim.shape.corner_blocks == 1)
    corner = np.array([1.0, 0.0])
    pivot = own[np.argmin(np.abs(sim.bodies.corners[own] - corner).sum(axis=1))]
    sim.control[slot.RATE] = W * 2e-6
    sim.advance(1000, slot.CREEP)
    edges, carried = set(), []
    for _ in range(360):
        sim.advance(1000, slot.CREEP)
        (loaded,) = np.flatnonzero(sim.contacts.normal > 0)
        edges.add(tuple(sim.geometry.edges[loaded // 2].tolist()))
        assert sim.bodies.corners[pivot] == pytest.approx(corner, abs=1e-3)
        carried.append(sim.contacts.normal[loaded] / W)
    assert -sim.bodies.orientations[1, 0] > np.radians(60)
    assert len(edges) == 2
    assert sim.contacts.slip[loaded] < 1e-4
    # The rest is damping of the motion; one look may fall into the moment in which the edge changes.
    assert np.sort(np.abs(np.array(carried) - 1.0))[-2] < 0.02


L_SHAPE = [rectangle(0, 0, 1, 1), rectangle(1, 0, 2, 0.4)]


def l_block(kinematics: str, **more) -> Simulation:
    blocks = [
        block("base", rectangle(-1, -1, 3, 0), fixed=True),
        {"id": "l", "parts": L_SHAPE},
        block("seat", rectangle(1, 0.4, 1.5, 0.9)),
    ]
    return simulation(tables(*blocks, **more), kinematics)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_compound_has_a_joint_for_each_part(kinematics):
    """Two on the base, a bed and a head with the block in its corner; none between its own parts."""
    sim = l_block(kinematics)
    names = [tuple(sorted(sim.model.block_ids[i] for i in pair)) for pair in sim.joints.blocks]
    real = [n for n, kn in zip(names, sim.joints.kn[::2]) if kn > 0]
    assert real.count(("base", "l")) == 2
    assert real.count(("l", "seat")) == 2
    assert ("l", "l") not in names


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_compound_moves_as_one(kinematics):
    """One centroid, one weight; all of its corners follow one rigid motion."""
    sim = l_block(kinematics)
    i = sim.model.block_ids.index("l")
    assert sim.model.masses[i] == pytest.approx(1.4 * 2000.0)
    assert sim.model.centroids[i] == pytest.approx([(0.5 + 0.4 * 1.5) / 1.4, (0.5 + 0.4 * 0.2) / 1.4])
    sim.advance(20_000, slot.HOLD_LOAD)
    base = sim.model.block_ids.index("base")
    assert sim.bodies.forces[base, 1] == pytest.approx(-(1.4 + 0.25) * W, rel=1e-6)
    if kinematics == "large":
        sim.bodies.velocities[i] = [0.01, 0.02, 0.05]
        steps(sim, 20)
        angle = sim.bodies.orientations[i, 0]
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        own = sim.shape.corner_blocks == i
        expected = sim.bodies.positions[i] + sim.shape.corner_arms[own] @ turn
        assert angle > 0.0
        assert sim.bodies.corners[own] == pytest.approx(expected, abs=1e-12)


def test_compound_weighs_and_turns_like_the_same_block_in_one_piece():
    """A rectangle cut in two parts overturns at the same load, and has the same inertia."""
    from engine import solve

    loads, inertias = [], []
    for shape in ({"vertices": rectangle(0, 0, 1, 2)}, {"parts": [rectangle(0, 0, 1, 0.7), rectangle(0, 0.7, 1, 2)]}):
        case = tables(block("base", rectangle(-1, -1, 2, 0), fixed=True), {"id": "b", **shape}, friction=0.9)
        inertias.append(simulation(case).model.inertias[1, 0])
        loads.append(solve(case)[0]["failure_load"])
    assert inertias[1] == pytest.approx(inertias[0], rel=1e-12)
    assert loads == pytest.approx([0.5, 0.5], rel=1e-6)
