"""Modes of structures in space against dense eigenvalues of differences of the engine's forces, and its vibrations."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
from engine import block, real_masses, rectangle, simulation, solve, steps, tables

from dem_cli.analyses.modes import closed_points, touching_points
from dem_cli.core.contact.detect import world_corners
from dem_cli.core.dynamics.frequencies import modes, system
from dem_cli.core.dynamics.time_step import time_step
from dem_cli.core.engine.budget import Budget
from dem_cli.core.geometry.rotation import turned_further, turns_of
from dem_cli.core.statics.equilibrium import stand

KN, KS = 3e6, 2e6  # so soft that weight counts: 0.2 to 5 % of the stiffness


def box(name: str, x, y, z, **more) -> dict:
    return block(name, [(a, b, c) for a in x for b in y for c in z], **more)


GROUND = box("ground", (-4, 4), (-4, 4), (-1, 0), fixed=True)
STONES = {
    "slender": [box("a", (0, 0.5), (0, 0.8), (0, 1.5))],
    "narrower above": [box("a", (0, 0.5), (0, 0.8), (0, 1.5)), box("b", (0.1, 0.4), (0.1, 0.6), (1.5, 2.5))],
    "corner on corner": [box("a", (0, 0.5), (0, 0.8), (0, 1)), box("b", (0, 0.5), (0, 0.8), (1, 2))],
}


SHORT = np.array([5e-4, -5e-4])  # head joints are 1 mm open: stones that just touch would be half of a spring


def wall() -> list[dict]:
    """Three courses in running bond, one stone thick."""
    stones = []
    for course in range(3):
        cuts = [0.0, 0.6, 1.2, 1.8] if course % 2 == 0 else [0.0, 0.3, 0.9, 1.5, 1.8]
        for i, ends in enumerate(zip(cuts[:-1], cuts[1:], strict=True)):
            stones.append(box(f"b{course}-{i}", tuple(ends + SHORT), (0, 0.3), (0.25 * course, 0.25 * course + 0.25)))
    return stones


def house() -> list[dict]:
    """Two courses of four walls whose corners go over each other."""
    stones = []
    for course in range(2):
        z, inner, outer = (0.4 * course, 0.4 * course + 0.4), [0.4, 1.2, 2.0], [0.0, 0.8, 1.6, 2.4]
        for side in (0.0, 2.0):
            across = (side, side + 0.4)
            for along, cuts in ((0, outer if course == 0 else inner), (1, inner if course == 0 else outer)):
                for i, ends in enumerate(zip(cuts[:-1], cuts[1:], strict=True)):
                    length = tuple(ends + SHORT)
                    place = (length, across) if along == 0 else (across, length)
                    stones.append(box(f"c{course}-{along}-{side:g}-{i}", *place, z))
    return stones


def settled(stones: list[dict], kn: float = KN):
    """Under gravity on soft joints, with forces that belong to the places of the blocks."""
    joints = {"dry": {"friction": 0.9, "kn": kn, "ks": KS / KN * kn, "points": 2}}
    sim = simulation({"dimension": 3, **tables(GROUND, *stones, joints=joints)}, "large")
    assert stand(sim, Budget(10**6)).state == "equilibrium"
    real_masses(sim)
    sim.bodies.velocities[:] = 0.0
    kept = sim.save()
    steps(sim, 1, dt=1e-9)
    forces = sim.contacts.normal.copy(), sim.contacts.shear.copy()
    sim.restore(kept)
    sim.contacts.normal[:], sim.contacts.shear[:] = forces
    return sim


def stiffness_of_forces(sim, small: float = 1e-5) -> np.ndarray:
    """−∂(forces)/∂(places and rotation vectors) of the free blocks, as the compiled loop answers to small motions."""
    kept, bodies = sim.save(), sim.bodies

    def forces(dof: int, motion: float) -> np.ndarray:
        sim.restore(kept)
        number, k = divmod(dof, 6)
        bodies.velocities[number, k] = motion / 1e-9
        if k < 3:
            bodies.positions[number, k] += motion
        else:
            bodies.orientations[[number]] = turned_further(bodies.orientations[[number]], motion * np.eye(3)[k - 3])
        bodies.turns[:] = turns_of(bodies.orientations)
        bodies.corners[:] = world_corners(sim.shape, bodies.positions, bodies.orientations)
        steps(sim, 1, dt=1e-9)
        return bodies.forces[~sim.model.fixed].ravel().copy()

    free = np.flatnonzero(np.repeat(~sim.model.fixed, 6))
    found = np.column_stack([(forces(dof, -small) - forces(dof, small)) / (2 * small) for dof in free])
    sim.restore(kept)
    return found


def masses_of(stones: list[dict], density: float = 2000.0) -> np.ndarray:
    """Mass matrix of upright boxes in the order of the model, (n, n): by their sides."""
    found = []
    for stone in stones:
        x, y, z = np.ptp(np.array(stone["vertices"]), axis=0)
        mass = density * x * y * z
        found += [mass, mass, mass, *(mass / 12.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y]))]
    return np.diag(found)


def ordered(sim, stones: list[dict]) -> list[dict]:
    """Stones as the model has them."""
    by_name = {stone["id"]: stone for stone in stones}
    return [by_name[name] for name in sim.model.block_ids if name != "ground"]


@pytest.mark.parametrize(("name", "error"), [("slender", 1e-6), ("narrower above", 2e-6), ("corner on corner", 2e-5)])
def test_geometric_stiffness_is_that_of_the_contact_loop(name, error):
    """Its symmetric part; measured 7e-8, 2e-7 and 7e-6 of the geometric stiffness."""
    sim = settled(STONES[name])
    found = stiffness_of_forces(sim)
    springs = system(sim, closed_points(sim)).stiffness.toarray()
    geometric = system(sim, closed_points(sim), geometric=True).stiffness.toarray() - springs
    assert np.abs(geometric).max() > 1e-3 * np.abs(springs).max()
    assert np.abs(0.5 * (found + found.T) - springs - geometric).max() < error * np.abs(geometric).max()


@pytest.mark.parametrize("stones", [wall(), house()], ids=["wall", "house"])
def test_modes_are_those_of_dense_eigenvalues(stones):
    """Of scipy.linalg.eigh, from differences of forces and masses by hand: frequencies within 2.5e-5, the others 1e-4.

    What is not symmetric of the forces moves a frequency by less than 4e-6.
    """
    sim = settled(stones)
    forces = stiffness_of_forces(sim)
    matrix, masses = 0.5 * (forces + forces.T), masses_of(ordered(sim, stones))
    values, vectors = scipy.linalg.eigh(matrix, masses)
    unsymmetric = np.sort(scipy.linalg.eigvals(forces, masses).real)
    n = len(values) // 6
    found = modes(system(sim, closed_points(sim), geometric=True), 10, 3, sim.model.n_blocks)
    frequencies = np.sqrt(values[:10]) / (2 * math.pi)
    assert found.frequencies == pytest.approx(frequencies, rel=5e-5)
    assert np.sqrt(unsymmetric[:10]) / (2 * math.pi) == pytest.approx(frequencies, rel=1e-5)
    base = np.tile(np.eye(6)[:, :3], (n, 1))
    total = masses[::6, ::6].sum()
    assert found.effective_masses == pytest.approx((vectors.T @ masses @ base)[:10] ** 2, abs=1e-4 * total)
    likeness = np.abs(found.shapes[:, ~sim.model.fixed].reshape(10, -1) @ masses @ vectors[:, :10])
    assert np.diag(likeness) == pytest.approx(np.ones(10), abs=1e-3)
    without = modes(system(sim, closed_points(sim)), 1, 3, sim.model.n_blocks).frequencies[0]
    assert without / frequencies[0] > 1.001  # what gravity takes away


@pytest.mark.parametrize("name", list(STONES))
def test_the_engine_vibrates_at_the_frequency(name):
    """Started along each of the first two modes, so gently that nothing opens: the period of 20 cycles."""
    sim = settled(STONES[name])
    found = modes(system(sim, closed_points(sim), geometric=True), 2, 3, sim.model.n_blocks)
    kept, dt = sim.save(), 0.2 * time_step(sim).limit
    for frequency, shape in zip(found.frequencies, found.shapes, strict=True):
        sim.restore(kept)
        real_masses(sim)
        sim.loads.inverse_masses[:, 3:] = sim.bodies.mobilities[:, ::4]  # upright boxes: nothing beside the diagonal
        omega = 2 * math.pi * frequency
        sim.bodies.velocities[:] = 1e-4 * omega * shape / np.abs(shape).max()
        before, weights = sim.bodies.positions.copy(), shape[:, :3] * sim.model.masses[:, None]
        places = []
        for _ in range(int(20.5 / frequency / dt)):
            steps(sim, 1, dt=dt)
            places.append(float((weights * (sim.bodies.positions - before)).sum()))
        values = np.array(places) - np.mean(places)
        ups = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
        exact = ups + values[ups] / (values[ups] - values[ups + 1])
        period = dt * (exact[-1] - exact[0]) / (len(exact) - 1)
        assert len(exact) >= 19
        assert period * frequency == pytest.approx(1.0 - (omega * dt) ** 2 / 24.0, abs=5e-5)


DEPTH = (0, 0.8)
TWINS = {  # rectangles, and by how much the twin may differ
    "slender": ([rectangle(0, 0, 0.5, 1.5)], 1e-9),
    "narrower above": ([rectangle(0, 0, 0.5, 1.5), rectangle(0.1, 1.5, 0.4, 2.5)], 1e-6),
    # Where corners meet, a point goes on with one of the blocks; in the plane from half-way on with the other one.
    "corner on corner": ([rectangle(0, 0, 0.5, 1), rectangle(0, 1, 0.5, 2)], 1e-3),
    "2.5 mm off": ([rectangle(0, 0, 0.5, 1), rectangle(0.0025, 1, 0.5025, 2)], 3e-5),
}


@pytest.mark.parametrize("name", list(TWINS))
def test_planar_twin(name):
    """Modes of rectangles are among those of their prisms: motions in the plane of x and z."""
    rectangles, error = TWINS[name]
    ground = block("ground", rectangle(-4, -1, 4, 0), fixed=True)
    joints = {"dry": {"friction": 0.9, "kn": KN, "ks": KS, "points": 2}}
    flat = [block("ab"[i], corners) for i, corners in enumerate(rectangles)]
    planar = simulation(tables(ground, *flat, joints=joints), "large")
    assert stand(planar, Budget(10**6)).state == "equilibrium"
    expected = modes(system(planar, closed_points(planar), geometric=True), 6, 2, planar.model.n_blocks).frequencies
    sides = [np.array(corners) for corners in rectangles]
    prisms = [box("ab"[i], np.unique(c[:, 0]), DEPTH, np.unique(c[:, 1])) for i, c in enumerate(sides)]
    sim = settled(prisms)
    found = modes(system(sim, closed_points(sim), geometric=True), 12, 3, sim.model.n_blocks)
    others = np.abs(found.shapes[:, :, [1, 3, 5]]).max(axis=(1, 2)) / np.abs(found.shapes).max(axis=(1, 2))
    assert found.frequencies[others < 1e-2] == pytest.approx(expected, rel=error)


def test_points_without_a_gap_are_counted_once():
    """A slot of a joint that no point uses has no gap, and is no spring."""
    sim = settled(STONES["slender"])
    assert closed_points(sim).sum() == touching_points(sim).sum() == 4
    assert len(sim.joints.kn) > 4


def case(stones: list[dict], **analysis) -> dict:
    joints = {"dry": {"friction": 0.9, "kn": KN, "ks": KS, "points": 2}}
    more = {"joints": joints, "analysis": {"kind": "modes", **analysis}, "output": {"frames": 5}}
    return {"dimension": 3, **tables(GROUND, *stones, **more)}


def test_answers_and_frames_of_a_run():
    summary, records = solve(case(STONES["slender"], count=6))
    total = summary["total_mass"]
    assert total == pytest.approx(0.5 * 0.8 * 1.5 * 2000.0)
    assert {axis: sum(masses) for axis, masses in summary["effective_masses"].items()} == pytest.approx(
        dict.fromkeys("xyz", total), rel=1e-6
    )
    assert summary["springs"] == {"pressed": 4, "touching": 4}
    shown = [frame for frame in records.frames if frame.stage == "mode"]
    assert [frame.step for frame in shown] == [1, 2, 3, 4, 5, 6]
    rest = next(frame for frame in records.frames if frame.stage != "mode")
    free = [i for i, place in enumerate(rest.positions) if place[2] > 0.0]
    for frame in shown:
        assert frame.orientations.shape == (2, 4)
        assert np.linalg.norm(frame.orientations, axis=1) == pytest.approx(np.ones(2))
        moved = np.abs(frame.positions - rest.positions).max() + np.abs(frame.orientations - rest.orientations).max()
        assert 0.01 < moved < 0.5
        assert np.abs(frame.positions - rest.positions)[free].max() == np.abs(frame.positions - rest.positions).max()


def test_stiffness_from_a_measured_frequency():
    """Sway across the narrow side, less the moment of the weight: 2 × 2 by hand, at the calibrated stiffness."""
    found = solve(case(STONES["slender"], measured=3.0))[0]["calibration"]
    assert found["met"]
    width, depth, height, mass = 0.5, 0.8, 1.5, 0.5 * 0.8 * 1.5 * 2000.0
    stiff, shear = (found["joints"]["dry"][key] * width * depth for key in ("kn", "ks"))
    sway = np.array([[shear, shear * height / 2], [shear * height / 2, shear * height**2 / 4 + stiff * width**2 / 4]])
    sway[1, 1] -= mass * 9.81 * height / 2
    masses = np.diag([mass, mass * (width**2 + height**2) / 12.0])
    assert math.sqrt(scipy.linalg.eigh(sway, masses)[0][0]) / (2 * math.pi) == pytest.approx(3.0, rel=2e-4)
