"""Blocks that deform in time histories: columns that vibrate along themselves and sway, damping, books, impacts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine import scene
from scipy.optimize import curve_fit

from dem_cli.core.dynamics.frequencies import modes, system
from dem_cli.core.dynamics.time_step import time_step
from dem_cli.core.engine import measures
from dem_cli.core.engine.dynamic import DynamicSimulation
from dem_cli.core.engine.placement import moves
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.viscous import Damping, strain_rates, turned_loads
from dem_cli.core.geometry.rotation import moments, turning, turns_of
from dem_cli.core.kernels import records as slot
from dem_cli.core.model.uniform_strain import mode_loads

N, HIGH, DEEP, SAMPLED = 3, 0.3, 0.5, 10


def column(dimension: int, damping: Damping, lift: float = 0.0) -> DynamicSimulation:
    """Pressed by its weight on a fixed block, joints ten times as stiff as blocks; the highest block starts above."""

    def box(k: int) -> dict:
        low = (k - 1) * HIGH + (lift if k == N else 0.0)
        flat = [[0.0, low], [0.4, low], [0.4, low + HIGH], [0.0, low + HIGH]]
        corners = flat if dimension == 2 else [[x, y, z] for x, z in flat for y in (0.0, DEEP)]
        return {"id": f"b{k}", "fixed": k == 0, "vertices": corners} | ({"thickness": DEEP} if dimension == 2 else {})

    stone = {"density": 2000.0, "young": 1e9, "poisson": 0.2, "deformation": "uniform-strain"}
    case = {
        "dimension": dimension,
        "materials": {"stone": stone},
        "joints": {"dry": {"law": "coulomb", "friction": 0.9, "kn": 3e10, "ks": 3e10, "points": 5}},
        "block": [box(k) for k in range(N + 1)],
        "analysis": {"kind": "time-history", "duration": 1.0},
    }
    made = scene(case)
    sim = DynamicSimulation(made.model, law_of(made.request), joint_properties(made.request, made.model), damping)
    if not lift:
        sim.use_combined_damping()
        for _ in range(20):
            sim.advance(200, slot.HOLD_LOAD)
    return sim


def vibrating(dimension: int, axis: int, ratio: float = 0.0) -> tuple[np.ndarray, float, DynamicSimulation]:
    """Free vibration in the mode that moves most mass along an axis: place of the highest block over its amplitude,
    step of the samples in radians, the simulation after eight periods; ratio: of damping, by stiffness."""
    sim = column(dimension, Damping())
    found = modes(system(sim), 12, dimension, sim.model.n_blocks)
    mode = int(np.argmax(found.effective_masses[:, axis]))
    omega = 2.0 * math.pi * found.frequencies[mode]
    if ratio:
        sim = column(dimension, Damping(stiffness=2.0 * ratio / omega))
    step = 0.5 * time_step(sim).step
    sim.begin(step)
    amplitude = 1e-7
    shape = found.shapes[mode] * amplitude / found.shapes[mode][-1, axis]
    r, m = sim.strained.turns.shape[1:]
    shape[:, dimension : dimension + r] += np.einsum("nrm,nm->nr", sim.strained.turns, shape[:, -m:])  # mean spins
    sim.bodies.velocities[:] = omega * shape
    sim.start_moving()
    n_steps = round(16.0 * math.pi / omega / step)
    watch = sim.watch(np.array([N]), SAMPLED, n_steps // SAMPLED + 1)
    rest = sim.bodies.positions[N, axis]
    sim.shake(sim._still(n_steps), n_steps, watch)
    return (watch.samples[:, 0, 0, axis] - rest) / amplitude, SAMPLED * step * omega, sim


@pytest.mark.parametrize("axis", [1, 0])
def test_column_vibrates_freely_in_its_mode(axis):
    """Along itself and swaying, where blocks turn and shear: a sine of the frequency of the mode, for eight periods."""
    place, step, sim = vibrating(2, axis, 1e-9)
    assert place == pytest.approx(np.sin(step * np.arange(len(place))), abs=0.02)
    assert abs(measures.closure(sim)) < 1e-6


def test_damping_by_stiffness_is_in_blocks_and_joints():
    """ζ from eight periods. Blocks damped before and apart from the joints about them would lose 2 % less."""
    ratio = 0.02
    place, step, sim = vibrating(2, 1, ratio)
    phase = step * np.arange(len(place))
    fitted, _ = curve_fit(lambda x, lost, speed: np.exp(-lost * x) * np.sin(speed * x), phase, place, (ratio, 1.0))
    assert fitted[0] == pytest.approx(ratio, rel=5e-3)
    assert abs(measures.closure(sim)) < 1e-6


@pytest.mark.parametrize("dimension", [2, 3])
def test_loads_at_points_do_to_a_turned_block_what_they_did(dimension):
    """Forces that turn with their points and the block: nothing changes for its modes."""
    sim = column(dimension, Damping(), lift=1e-3)
    forces, arms = np.random.default_rng(1).normal(size=(2, N + 1, dimension))
    turned = np.random.default_rng(2).normal(size=(N + 1, 1 if dimension == 2 else 4))
    orientations = turned if dimension == 2 else turned / np.linalg.norm(turned, axis=1)[:, None]
    strained, radii, turn = strain_rates(sim.model, Damping(), 1e-4), sim.shape.radii, turning(orientations)

    def loads(forces, arms):
        return np.column_stack([forces, moments(arms, forces), mode_loads(arms, forces, radii)])

    modes = slice(sim.model.rotations.stop, None)
    before = turned_loads(strained, loads(forces, arms), sim.bodies.turns)[:, modes]
    after = turned_loads(strained, loads(turn(forces), turn(arms)), turns_of(orientations))[:, modes]
    assert after == pytest.approx(before)


def test_loads_at_points_turn_on_the_way():
    sim = column(2, Damping(), lift=2.0)
    sim.dead_loads[N, 3:] = 1.0, 200.0, 300.0
    sim.begin(1e-4)
    moves.throw(sim, np.array([N]), np.array([0.0, 0.0, 20.0, 0.0, 0.0, 0.0]))
    sim.shake(sim._still(120), 120, sim.watch(np.array([N]), 120, 2))
    assert sim.bodies.orientations[N, 0] > 0.2
    now = turned_loads(sim.strained, sim.dead_loads, sim.turns_of_means)
    assert sim.loads.dead[N] == pytest.approx(now[N])
    assert abs(sim.loads.dead[N, 4] - sim.dead_loads[N, 4]) > 50.0


def test_books_balance_over_an_impact():
    """A block falls by 2 mm on two others: what its waves in the blocks hold and lose is in the books."""
    sim = column(2, Damping(fraction=0.3), lift=2e-3)
    step = time_step(sim).step
    sim.begin(step)
    n_steps = round(0.04 / step)
    sim.shake(sim._still(n_steps), n_steps, sim.watch(np.array([N]), n_steps, 2))
    assert np.abs(sim.bodies.modes).max() > 0.0
    assert abs(measures.closure(sim)) < 1e-2


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_block_is_thrown_as_a_rigid_one(dimension):
    """[[initial]] gives a velocity of blocks; strains have none. It was an internal error."""
    sim = column(dimension, Damping())
    rigid = sim.model.rotations.stop
    sim.bodies.velocities[:] = 7.0
    moves.throw(sim, np.array([N]), np.arange(1.0, rigid + 1.0))
    assert sim.bodies.velocities[N].tolist() == [*range(1, rigid + 1)] + [0.0] * (
        sim.bodies.velocities.shape[1] - rigid
    )
    assert (sim.bodies.velocities[:N] == 7.0).all()
