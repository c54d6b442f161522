"""The stepping loop: a block on a spring, work against kinetic energy, and the energy of the state."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, highest_frequency, real_masses, rectangle, running_wall, simulation, steps, tables
from reference import value

from dem_cli.core.engine import measures
from dem_cli.core.engine.loops import compiled_advance
from dem_cli.core.kernels import records as slot

KN, G = 1.0e9, 9.81
BOOK = "classical_benchmarks"


def block_on_base(kinematics: str, **joint):
    """The data book's block: 1 × 1 × 1 m, 2000 kg/m3, on kn = 1e9 Pa/m."""
    blocks = [block("base", rectangle(-1, -1, 2, 0), fixed=True), block("b", rectangle(0, 0, 1, 1))]
    case = tables(*blocks, joints={"dry": {"friction": 0.6, "kn": KN, "points": 2, **joint}})
    return simulation(case, kinematics)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_penetration_at_rest(kinematics):
    """Weight / (kn area)."""
    sim = block_on_base(kinematics)
    sim.advance(4000, slot.HOLD_LOAD)
    sunk = sim.model.centroids[1, 1] - sim.bodies.positions[1, 1]
    assert sunk == pytest.approx(value(BOOK, "spring"), rel=1e-10)
    assert measures.largest_overlap(sim) == pytest.approx(value(BOOK, "spring"), rel=1e-10)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_frequency_of_free_vibration(kinematics):
    """√(kn A/M) with the period error of the leapfrog, asin(ω dt/2)/(ω dt/2), taken off."""
    sim = block_on_base(kinematics)
    sim.advance(4000, slot.HOLD_LOAD)
    sim.rest()
    real_masses(sim)
    omega = 2 * np.pi * value(BOOK, "bounce_f")
    dt = 0.02 / omega
    sim.bodies.velocities[1, 1] = 0.2 * value(BOOK, "spring") * omega
    n, height, places = 10_000, sim.bodies.positions[1, 1], []
    for _ in range(n):
        assert steps(sim, 1, dt=dt) == 1
        places.append(sim.bodies.positions[1, 1] - height)
    places = np.array(places)
    rising = np.flatnonzero((places[:-1] <= 0) & (places[1:] > 0))
    zeros = rising + places[rising] / (places[rising] - places[rising + 1])
    period = (zeros[-1] - zeros[0]) / (len(zeros) - 1) * dt
    expected = 2 * np.pi / omega * (omega * dt / 2) / np.arcsin(omega * dt / 2)
    assert len(zeros) > 30
    assert period == pytest.approx(expected, rel=1e-6)
    assert 1 / period == pytest.approx(value(BOOK, "bounce_f"), rel=2e-5)
    amplitude = np.abs(places)
    assert amplitude[-400:].max() == pytest.approx(amplitude[:400].max(), rel=1e-4)


def test_two_points_turn_as_the_joint_does():
    """Rocking frequency of the same block, free to turn only: √(kn A b²/4 / I)."""
    sim = block_on_base("fixed")
    sim.advance(4000, slot.HOLD_LOAD)
    sim.rest()
    real_masses(sim)
    sim.loads.inverse_masses[1, :2] = 0.0
    omega = np.sqrt(KN * 0.25 / sim.model.inertias[1, 0] + KN * 0.25 / sim.model.inertias[1, 0])
    dt = 0.01 / omega
    sim.bodies.velocities[1, 2] = 1e-6 * omega
    angles = []
    for _ in range(2000):
        steps(sim, 1, dt=dt)
        angles.append(sim.bodies.orientations[1, 0])
    angles = np.array(angles)
    rising = np.flatnonzero((angles[:-1] <= 0) & (angles[1:] > 0))
    zeros = rising + angles[rising] / (angles[rising] - angles[rising + 1])
    assert 2 * np.pi / (np.diff(zeros).mean() * dt) == pytest.approx(omega, rel=2e-5)


MODES = {"load": slot.HOLD_LOAD, "creep": slot.CREEP, "fire": slot.FIRE, "tilt": slot.TILT_CREEP}
DAMPINGS = {"undamped": (0.0, 0.0), "local": (0.4, 0.0), "combined": (0.3, 0.3)}


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
@pytest.mark.parametrize("damping", DAMPINGS.values(), ids=DAMPINGS)
@pytest.mark.parametrize("mode", MODES)
def test_work_is_change_of_kinetic_energy(mode, damping, kinematics):
    """external + contact − damping to round-off, whatever drives and damps the motion."""
    pattern = {"pattern": "tilt"} if mode == "tilt" else {}
    sim = simulation(tables(*running_wall(3, 2), analysis=pattern), kinematics)
    sim.set_load(0.55)
    sim.use(0.6, *damping)
    sim.control[slot.RATE] = 1e-5
    sim.ledger[:] = 0.0
    before = sim.kinetic_energy()
    largest = 0.0
    for _ in range(40):
        steps(sim, 25, MODES[mode])
        sums = sim.ledger
        change = sums[slot.EXTERNAL] + sums[slot.CONTACT] - sums[slot.DAMPING]
        largest = max(largest, sim.kinetic_energy(), *np.abs(sums))
        assert sim.kinetic_energy() - before == pytest.approx(change, abs=1e-10 * largest)
    assert largest > 0.0


def test_relaxation_begins_again_after_a_step_uphill():
    """With the mixing of the settings, not with one that the kernel knows."""
    sim = block_on_base("fixed")
    sim.control[slot.FIRE_START], sim.control[slot.FIRE_MIX] = 0.25, 0.01
    sim.advance(1, slot.FIRE)
    sim.bodies.velocities[1, 1] *= -1.0
    sim.advance(1, slot.FIRE)
    assert sim.control[slot.FIRE_MIX] == 0.25


def test_creep_prescribes_the_rate_of_the_live_displacement():
    """q·v = rate after every step, with any damping."""
    sim = simulation(tables(*running_wall(3, 2)))
    rate = 1e-6
    sim.control[slot.RATE] = rate
    for damping in DAMPINGS.values():
        sim.use(0.85, *damping)
        for _ in range(50):
            steps(sim, 1, slot.CREEP)
            assert (sim.loads.live * sim.bodies.velocities).sum() == pytest.approx(rate, rel=1e-9)


def test_prescribed_motion_of_a_support():
    """A fixed block keeps its velocity, and its work on the others is booked under supports."""
    sim = block_on_base("large")
    sim.advance(4000, slot.HOLD_LOAD)
    sim.ledger[:] = 0.0
    energy = sim.elastic_energy()
    sim.bodies.velocities[0, 1] = 1e-6
    for _ in range(5000):
        steps(sim, 1)
    lifted = sim.bodies.positions[0, 1] - sim.model.centroids[0, 1]
    assert lifted == pytest.approx(5e-3, rel=1e-9)
    sim.bodies.velocities[0, 1] = 0.0
    sim.advance(4000, slot.HOLD_LOAD)
    weight = sim.model.masses[1] * G
    assert sim.elastic_energy() == pytest.approx(energy, rel=1e-6)
    assert sim.ledger[slot.EXTERNAL] == pytest.approx(-weight * lifted, rel=1e-6)
    assert sim.ledger[slot.SUPPORT] - sim.ledger[slot.DAMPING] == pytest.approx(weight * lifted, rel=1e-5)


def state_energy_error(kinematics: str, fraction: float, slide: float) -> tuple[float, float]:
    """Largest change of kinetic + elastic + gravity energy + friction over a free motion, of the total [-]; friction.

    Three blocks on a base, thrown sideways on their springs; all at the same instant: the kinetic energy
    is the mean of those half a step before and after.
    """
    blocks = [block("base", rectangle(-1, -1, 2, 0), fixed=True)]
    blocks += [block(f"b{i}", rectangle(0, i, 1, i + 1)) for i in range(3)]
    sim = simulation(tables(*blocks, joints={"dry": {"friction": 0.6, "kn": KN, "points": 2}}), kinematics)
    sim.advance(8000, slot.HOLD_LOAD)
    sim.rest()
    real_masses(sim)
    sim.ledger[:] = 0.0
    dt = fraction * 2 / highest_frequency(sim)
    kick = slide * value(BOOK, "spring") * 2 * np.pi * value(BOOK, "bounce_f")
    sim.bodies.velocities[1:, 0] = kick * np.array([1.0, -0.5, 0.7])
    # Half a step back, so that the throw is at the same instant for every step.
    start = sim.kinetic_energy()
    weights, errors, total = sim.model.masses * G, [], start
    for _ in range(round(600 / fraction / 10)):
        heights, before = sim.bodies.positions[:, 1].copy(), sim.kinetic_energy()
        steps(sim, 1, dt=dt)
        kinetic = 0.5 * (before + sim.kinetic_energy())
        potential = (weights * (heights - sim.model.centroids[:, 1]))[1:].sum()
        errors.append(kinetic + sim.elastic_energy() + potential + sim.ledger[slot.FRICTION])
    return float(np.ptp(errors) / total), float(sim.ledger[slot.FRICTION])


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_energy_of_the_state_closes_with_the_square_of_the_step(kinematics):
    errors = [state_energy_error(kinematics, fraction, slide=0.2)[0] for fraction in (0.2, 0.1, 0.05)]
    assert errors[0] < 0.02
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.6)
    assert errors[1] / errors[2] == pytest.approx(4.0, abs=0.6)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_energy_of_the_state_closes_while_sliding_and_lifting(kinematics):
    """Slipping, opening and closing points; the error still falls with the square of the step."""
    (coarse, friction), (fine, _) = (state_energy_error(kinematics, f, slide=8.0) for f in (0.2, 0.05))
    assert friction > 0.0
    assert fine < coarse / 8
    assert fine < 1e-4


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
@pytest.mark.parametrize("mode", MODES)
def test_compiled_is_what_is_written(mode, kinematics):
    """The stepping loop as plain Python and compiled: the same bits."""
    results = []
    for plain in (False, True):
        sim = simulation(tables(*running_wall(2, 2)), kinematics)
        sim.set_load(0.55)
        sim.use(0.6, 0.3, 0.3)
        sim.control[slot.RATE] = 1e-5
        loop = compiled_advance(kinematics, sim.law)
        (loop.py_func if plain else loop)(
            60, MODES[mode], 1.0, sim.bodies, sim.shape, sim.joints, sim.geometry, sim.contacts, sim.links,
            sim.loads, sim.control, sim.ledger, sim.like, sim.like_rotation,
        )  # fmt: skip
        results.append((sim.bodies.velocities, sim.bodies.forces, sim.ledger, sim.control))
    for compiled, written in zip(*results):
        assert np.array_equal(compiled, written)
