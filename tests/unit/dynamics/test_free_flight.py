"""Blocks in space that nothing touches: Euler's equations, torques, damping of spins, samples, supports that turn.

Exact: energy and angular momentum stay, a symmetric top precesses, L̇ = torque − α L.
"""

from __future__ import annotations

import numpy as np
import pytest
from engine import scene, tables
from scipy.integrate import solve_ivp

from dem_cli.core.dynamics.initial_state import tilt
from dem_cli.core.engine import measures
from dem_cli.core.engine.dynamic import DynamicSimulation
from dem_cli.core.engine.placement import moves
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.viscous import Damping
from dem_cli.core.geometry.inertia import along_principal
from dem_cli.core.geometry.rotation import matrices, quaternions, rotation_vectors, turned_since
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.records import Ground, Watch

BOX = [[x, y, z] for x in (0.0, 0.5) for y in (0.0, 0.8) for z in (0.0, 1.4)]
WEDGE = [[0, 0, 0], [2, 0, 0], [0, 1, 0], [0.3, 0.2, 1.5], [1, 0.2, 1.2]]  # its principal axes are askew
TOP = [[x, y, z] for x in (0.0, 0.6) for y in (0.0, 0.6) for z in (0.0, 1.5)]
BASE = {"id": "base", "vertices": [[x, y, z - 9.0] for x in (-1, 1) for y in (-1, 1) for z in (-1, 0)], "fixed": True}
FREE = 1  # number of the block that flies
UNDAMPED = Damping()


def settling(vertices, damping: Damping = UNDAMPED) -> DynamicSimulation:
    """A block without weight, far from its support, before the motion begins."""
    block = {"id": "block", "vertices": [list(map(float, corner)) for corner in vertices]}
    made = scene(tables(BASE, block, dimension=3, gravity=0.0, analysis={"kind": "gravity"}))
    return DynamicSimulation(
        made.model,
        law_of(made.request),
        joint_properties(made.request, made.model, 1e5),
        damping,
    )


def flying(vertices, dt: float, damping: Damping = UNDAMPED) -> DynamicSimulation:
    """The same block before its first step; joints are not looked for on the way."""
    sim = settling(vertices, damping)
    sim.begin(dt)
    sim.control[slot.TRAVEL_LIMIT] = np.inf
    return sim


def fly(sim: DynamicSimulation, steps: int, every: int = 1, ground: Ground | None = None) -> np.ndarray:
    """Steps of it; samples of the block, (n, 3, 6)."""
    watch = Watch(np.array([FREE]), every, np.zeros((steps // every + 1, 1, 3, 6)))
    still = Ground(np.zeros((steps, 3)), np.zeros(0, np.int64), np.zeros((steps, 0, 6)))
    sim.shake(ground or still, steps, watch)
    return watch.samples[: -(-steps // every), 0]


def principal(sim: DynamicSimulation) -> np.ndarray:
    """Principal axes of the block in the world, smallest moment first, as columns."""
    order = np.argsort(sim.model.inertias[FREE])
    return (matrices(sim.bodies.orientations)[FREE] @ matrices(sim.model.principal_axes)[FREE])[:, order]


def spin(sim: DynamicSimulation, along: tuple[float, float, float]) -> None:
    """Sets the spin [rad/s] along its principal axes, smallest moment first."""
    sim.bodies.velocities[FREE, 3:] = principal(sim) @ along


def momentum(sim: DynamicSimulation) -> np.ndarray:
    """Angular momentum along the axes of the world [N m s], from moments and axes of the model."""
    axes = principal(sim)
    return axes @ (np.sort(sim.model.inertias[FREE]) * (axes.T @ sim.bodies.velocities[FREE, 3:]))


@pytest.mark.parametrize("vertices", [BOX, WEDGE], ids=["box", "askew"])
@pytest.mark.parametrize("step", [0.01, 0.001])
def test_tumbling_keeps_energy_and_angular_momentum(vertices, step):
    """100 rad about the middle axis, which is unstable."""
    sim = flying(vertices, step)
    spin(sim, (0.01, 1.0, 0.01))
    start, kinetic = momentum(sim), sim.kinetic_energy()
    samples = fly(sim, round(100.0 / step), every=round(1.0 / step))
    middle = matrices(samples[:, 0, 3:]) @ matrices(sim.model.principal_axes)[FREE]
    flips = (middle[:, :, np.argsort(sim.model.inertias[FREE])[1]] @ start) / np.linalg.norm(start)
    assert flips.min() < -0.9  # it did tumble
    assert flips.max() > 0.9
    assert np.abs(momentum(sim) - start).max() < 1e-12 * np.linalg.norm(start)
    assert sim.kinetic_energy() == pytest.approx(kinetic, rel=1e-12)


def test_a_symmetric_top_precesses():
    """Its axis turns about the angular momentum at L/I₁; the error is of second order in the step."""
    errors = []
    for step in (0.004, 0.002):
        sim = flying(TOP, step)
        spin(sim, (2.0, 1.5, 0.0))
        start, axis, moment = momentum(sim), principal(sim)[:, 0], np.sort(sim.model.inertias[FREE])[2]
        fly(sim, round(10.0 / step))
        length = np.linalg.norm(start)
        turn = matrices((start / length * (length / moment * 10.0))[None])[0]
        errors.append(np.linalg.norm(principal(sim)[:, 0] - turn @ axis))
    assert errors[1] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.01)


def test_a_thrown_block_is_where_eulers_equations_take_it():
    """Under gravity and a torque from the velocities of time 0, beside a Runge–Kutta integration; second order."""
    velocity, torque, time = np.array([1.0, -0.5, 4.0, 1.0, 4.0, -2.0]), np.array([20.0, -10.0, 15.0]), 1.0
    errors = []
    for step in (2e-3, 1e-3):
        sim = flying(WEDGE, step)
        sim.loads.dead[FREE, 2], sim.loads.dead[FREE, 3:] = -9.81 * sim.model.masses[FREE], torque
        start = sim.bodies.positions[FREE].copy()
        moves.throw(sim, np.array([FREE]), velocity)
        sim.start_moving()
        first = fly(sim, round(time / step))[0]
        assert first[1] == pytest.approx(velocity, rel=1e-12)
        flight = start + velocity[:3] * time - [0.0, 0.0, 0.5 * 9.81 * time**2]
        assert sim.bodies.positions[FREE] == pytest.approx(flight, rel=1e-12)
        turn, own = matrices(sim.bodies.orientations)[FREE], matrices(sim.model.principal_axes)[FREE]
        tensor = own @ np.diag(sim.model.inertias[FREE]) @ own.T
        errors.append(np.abs(turn - tumbled(tensor, velocity[3:], torque, time)).max())
    assert errors[1] < 1e-5
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.01)


def tumbled(tensor: np.ndarray, spin: np.ndarray, torque: np.ndarray, time: float) -> np.ndarray:
    """Rotation matrix of a body with a tensor of inertia at the start and a torque along the axes of the world."""

    def change(_: float, state: np.ndarray) -> np.ndarray:
        turn, momentum = state[:9].reshape(3, 3), state[9:]
        spin = turn @ np.linalg.solve(tensor, turn.T @ momentum)
        return np.concatenate([np.cross(spin, turn, axisb=0, axisc=0).ravel(), torque])

    state = np.concatenate([np.eye(3).ravel(), tensor @ spin])
    return solve_ivp(change, (0.0, time), state, method="DOP853", rtol=1e-12, atol=1e-12).y[:9, -1].reshape(3, 3)


@pytest.mark.parametrize("damping", [Damping(), Damping(mass=0.3, local=0.1)], ids=["undamped", "damped"])
def test_books_of_a_torque_close_to_round_off(damping):
    sim = flying(WEDGE, 1e-3, damping)
    sim.loads.dead[FREE] = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]
    spin(sim, (0.1, 1.0, 0.2))
    kinetic, ledger = sim.kinetic_energy(), sim.ledger
    fly(sim, 3000)
    taken = ledger[slot.DAMPING] + ledger[slot.MASS] + ledger[slot.DASHPOT]
    assert abs(ledger[slot.DASHPOT]) < 1e-10 * ledger[slot.EXTERNAL]
    assert (ledger[slot.MASS] > 0.0) == (damping.mass > 0.0)
    left = kinetic + ledger[slot.EXTERNAL] - taken
    assert sim.kinetic_energy() == pytest.approx(left, rel=0.0, abs=1e-12 * ledger[slot.EXTERNAL])


def test_books_are_centred_where_places_are():
    """A spin that stays: half of it, squared, at each instant, whatever the turn of the step."""
    sim = flying(WEDGE, 0.05)
    spin(sim, (1.0, 2.0, 0.5))
    kinetic = sim.kinetic_energy()
    fly(sim, 7)
    assert sim.centred_kinetic_energy() == pytest.approx(kinetic, rel=1e-13)
    assert measures.energy(sim).kinetic == pytest.approx(kinetic, rel=1e-13)


def test_mass_damping_takes_angular_momentum_alike_along_all_axes():
    """L = L₀ ((1 − α dt/2)/(1 + α dt/2))ⁿ, which is exp(−α t)."""
    rate, step, n = 0.4, 2e-3, 2500
    sim = flying(WEDGE, step, Damping(mass=rate))
    spin(sim, (1.0, 2.0, 0.5))
    start = momentum(sim)
    fly(sim, n)
    kept = ((1.0 - 0.5 * rate * step) / (1.0 + 0.5 * rate * step)) ** n
    assert np.abs(momentum(sim) - kept * start).max() < 1e-12 * np.linalg.norm(start)
    assert kept == pytest.approx(np.exp(-rate * step * n), rel=1e-6)


def test_torque_changes_angular_momentum():
    """L = L₀ + torque × time, though the block tumbles."""
    sim = flying(WEDGE, 1e-3)
    sim.loads.dead[FREE, 3:] = [30.0, -20.0, 10.0]
    spin(sim, (0.1, 3.0, 0.2))
    start = momentum(sim)
    fly(sim, 4000)
    assert np.abs(momentum(sim) - start - 4.0 * sim.loads.dead[FREE, 3:]).max() < 1e-12 * np.linalg.norm(start)


def test_a_spin_about_y_is_that_of_the_plane():
    """α = torque/I from a spin of its own, with mass damping: the same leapfrog, to round-off."""
    rate, step, n, torque = 0.2, 1e-3, 3000, 100.0
    sim = flying(BOX, step, Damping(mass=rate))
    sim.loads.dead[FREE, 4], sim.bodies.velocities[FREE, 4] = torque, 3.0
    moment, speed, angle = sim.model.inertias[FREE, 1], 3.0, 0.0
    angles = []
    for _ in range(n):
        speed = ((1.0 - 0.5 * rate * step) * speed + step * torque / moment) / (1.0 + 0.5 * rate * step)
        angle += step * speed
        angles.append(angle)
    samples = fly(sim, n)
    assert angle > 2 * np.pi
    assert sim.bodies.velocities[FREE, 4] == pytest.approx(speed, rel=1e-12)
    turned = (samples[1:, 0, 4] - angles[:-1] + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(turned).max() < 1e-12
    assert np.abs(samples[:, :, [3, 5]]).max() == 0.0


def test_samples_are_those_of_the_motion():
    """Mean spins and accelerations beside differences of the rotation vectors: Euler's gyration is in."""
    sim = flying(WEDGE, 1e-3)
    sim.loads.dead[FREE, 3:] = [3.0, -2.0, 1.0]
    spin(sim, (0.5, 2.0, 1.0))
    places, velocities, accelerations = fly(sim, 400).swapaxes(0, 1)
    steps = turned_since(quaternions(places[2:, 3:]), quaternions(places[:-2, 3:])) / 2e-3
    assert steps == pytest.approx(velocities[1:-1, 3:], abs=1e-5)
    changes = (velocities[2:, 3:] - velocities[:-2, 3:]) / 2e-3
    assert changes == pytest.approx(accelerations[1:-1, 3:], abs=1e-4)
    assert np.abs(accelerations[:, 3:]).max() > 1.0
    assert sim.accelerations(np.array([FREE]))[0] == pytest.approx(accelerations[-1], rel=1e-12)


def test_before_the_motion_accelerations_are_those_of_the_path_to_rest():
    """A monitor in a history of a structure in space that did not stand: AttributeError 'turns_of_means'."""
    sim = settling(WEDGE)
    sim.bodies.unbalanced[FREE] = force = np.array([1.0, 0.0, -2.0, 0.0, 3.0, 0.0])
    assert (sim.accelerations(np.array([FREE]))[0] == force * sim.loads.inverse_masses[FREE]).all()
    assert sim.loads.inverse_masses[FREE].all()


def test_supports_go_with_all_six_velocities():
    """Exactly: by the turn of the spin over the time, and their corners with them; no step error."""
    step, n, twist = 0.01, 250, np.array([0.1, -0.2, 0.3, 0.5, -0.4, 0.8])
    sim = flying(BOX, step)
    ground = Ground(np.zeros((n, 3)), np.array([0]), np.tile(twist, (n, 1, 1)))
    start, arms = sim.bodies.positions[0].copy(), sim.shape.corner_arms[sim.shape.corner_blocks == 0]
    fly(sim, n, ground=ground)
    turn = matrices((twist[3:] * step * n)[None])[0]
    assert rotation_vectors(sim.bodies.orientations)[0] == pytest.approx(twist[3:] * step * n, rel=1e-12)
    assert sim.bodies.positions[0] == pytest.approx(start + twist[:3] * step * n, rel=1e-13)
    corners = sim.bodies.corners[sim.shape.corner_blocks == 0]
    assert corners == pytest.approx(sim.bodies.positions[0] + arms @ turn.T, abs=1e-12)


def test_mobilities_follow():
    sim = flying(WEDGE, 0.01)
    spin(sim, (1.0, 2.0, 0.5))
    fly(sim, 100)
    axes = principal(sim)
    expected = axes @ np.diag(1.0 / np.sort(sim.model.inertias[FREE])) @ axes.T
    assert sim.bodies.mobilities[FREE].reshape(3, 3) == pytest.approx(expected, rel=1e-12, abs=1e-15)
    assert np.abs(sim.bodies.mobilities[0]).max() == 0.0
    own = along_principal(sim.bodies.velocities[:, 3:], sim.shape.axes, sim.bodies.turns)[FREE]
    assert 0.5 * (sim.model.inertias[FREE] * own**2).sum() == pytest.approx(sim.kinetic_energy(), rel=1e-13)


def test_a_tilt_goes_about_the_edge_or_corner_below_it():
    """About y to the left edge, obliquely about the corner that is outermost then; nothing else of it moves."""
    lowest = []
    for turn, at in (((0.0, -0.1, 0.0), [0.0, None]), ((0.06, -0.08, 0.0), [0.0, 0.0]), ((0.1, 0.0, 0.0), [None, 0.0])):
        sim = flying(BOX, 0.01)
        tilt(sim, np.array([FREE]), np.array(turn))
        corners = sim.bodies.corners[sim.shape.corner_blocks == FREE] + sim.origin
        low = corners[corners[:, 2].argmin()]
        lowest.append(low[2])
        for k, place in enumerate(at):
            assert place is None or low[k] == pytest.approx(place, abs=1e-12)
        assert rotation_vectors(sim.bodies.orientations)[FREE] == pytest.approx(turn, abs=1e-14)
        assert sim.bodies.turns[FREE].reshape(3, 3) == pytest.approx(matrices(np.array([turn]))[0], abs=1e-14)
    assert lowest == pytest.approx([0.0] * 3, abs=1e-12)
