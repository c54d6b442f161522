"""Natural frequencies against closed forms, and the stiffness against the forces of the engine's own loops."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from engine import block, rectangle, running_wall, simulation, tables
from hypothesis import given, settings
from hypothesis import strategies as st

from dem_cli.core.dynamics.frequencies import highest_frequency, limiting, modes, system
from dem_cli.core.dynamics.time_step import time_step
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.kernels.contact_forces import make_contact_forces
from dem_cli.errors import CaseError

BOOK = Path(__file__).resolve().parents[2] / "reference" / "classical_benchmarks.toml"


def joint(kn: float, ks: float | None = None, **more) -> dict:
    return {"dry": {"friction": 0.6, "kn": kn, "ks": kn if ks is None else ks, "points": 2, **more}}


def stack(n: int, width: float, height: float, kn: float, ks: float, density: float = 2000.0, **more):
    """n equal blocks on each other, on fixed ground."""
    ground = block("ground", rectangle(-width / 2, -height, width / 2, 0.0), fixed=True)
    stones = [block(f"b{i + 1}", rectangle(-width / 2, i * height, width / 2, (i + 1) * height)) for i in range(n)]
    return simulation(tables(ground, *stones, joints=joint(kn, ks, **more), density=density))


def lowest(sim, count: int, closed=None):
    return modes(system(sim, closed), count, sim.model.dimension, sim.model.n_blocks)


def of_axis(found, axis: int):
    """The modes that move along one axis alone."""
    others = [i for i in range(found.shapes.shape[2]) if i != axis]
    pure = np.abs(found.shapes[:, :, others]).max(axis=(1, 2)) < 1e-6 * np.abs(found.shapes[:, :, axis]).max(axis=1)
    return found.frequencies[pure]


def sway(width: float, height: float, kn: float, ks: float, mass: float) -> np.ndarray:
    """Sliding and rocking of a block on two springs below its lower corners, ω² [1/s2]: 2 × 2, by hand.

    kn, ks: of the whole joint [N/m]. With u of the centroid and θ, its base slides by u + θ h/2.
    """
    inertia = mass * (width**2 + height**2) / 12.0
    a, b = ks / mass, (ks * height**2 / 4.0 + kn * width**2 / 4.0) / inertia
    c = ks * (height / 2.0) / math.sqrt(mass * inertia)
    return (a + b) / 2.0 + np.array([-1.0, 1.0]) * math.hypot((a - b) / 2.0, c)


def test_bounce_of_the_data_book():
    rows = {row["id"]: row for row in tomllib.loads(BOOK.read_text(encoding="utf-8"))["result"]}
    found = lowest(stack(1, 1.0, 1.0, 1e9, 1e9), 3)
    assert of_axis(found, 1) == pytest.approx(rows["bounce_f"]["value"], rel=1e-7)


@pytest.mark.parametrize("ratio", [0.1, 0.4, 1.0, 3.0])
def test_sway_of_a_block(ratio):
    found = lowest(stack(1, 0.4, 1.1, 1e9, ratio * 1e9), 3)
    expected = np.sqrt(sway(0.4, 1.1, 0.4e9, ratio * 0.4e9, 0.4 * 1.1 * 2000.0)) / (2 * math.pi)
    vertical = math.sqrt(0.4e9 / 880.0) / (2 * math.pi)
    assert found.frequencies == pytest.approx(np.sort([*expected, vertical]), rel=1e-12)


@pytest.mark.parametrize(("ratio", "factor"), [(2.0, 1.96), (1.0, None), (5.0, None)])
def test_highest_frequency_of_a_block(ratio, factor):
    """docs/numerics.md: 1.96 √(K/M) for h/b = 2."""
    sim = stack(1, 1.0, ratio, 1e9, 1e9)
    over = highest_frequency(sim) / math.sqrt(1e9 / (2000.0 * ratio))
    assert over == pytest.approx(math.sqrt(sway(1.0, ratio, 1.0, 1.0, 1.0)[1]), rel=1e-12)
    if factor is not None:
        assert over == pytest.approx(factor, abs=0.005)


@pytest.mark.parametrize("n", [2, 7, 120])
def test_chain_on_vertical_springs(n):
    """n masses on n springs, one end held: ω = 2 √(k/m) sin((2j − 1)π/(4n + 2))."""
    sim = stack(n, 1.0, 0.5, 1e8, 1e8)
    found = of_axis(lowest(sim, 6), 1)
    j = np.arange(1, n + 1)
    expected = np.sqrt(1e8 / 1000.0) / math.pi * np.sin((2 * j - 1) * math.pi / (4 * n + 2))
    assert len(found)
    assert found == pytest.approx(expected[: len(found)], rel=1e-9)


def test_shear_of_a_flat_stack():
    """Flat blocks slide and do not rock: the same formula with ks, but for (h/b)² ks/kn of the stiffness."""
    n, height = 8, 0.002
    found = lowest(stack(n, 1.0, height, 1e9, 1e6), 3)
    j = np.arange(1, 4)
    expected = math.sqrt(1e6 / (2000.0 * height)) / math.pi * np.sin((2 * j - 1) * math.pi / (4 * n + 2))
    assert found.frequencies == pytest.approx(expected, rel=1e-5)


def test_points_of_a_joint_set_its_stiffness_in_rotation():
    """Two end points are three times as stiff as a joint that is elastic all over; three points are exact."""
    slow = [lowest(stack(1, 1.0, 4.0, 1e9, 1e12, points=points), 1).frequencies[0] for points in (2, 3)]
    mass, kn = 8000.0, 1e9
    about_base = mass * (1.0 + 16.0) / 12.0 + mass * 4.0
    for found, stiffness in zip(slow, (kn / 4.0, kn / 12.0), strict=True):
        # ks is 1000 times kn, not infinite: a little slower.
        assert found == pytest.approx(math.sqrt(stiffness / about_base) / (2 * math.pi), rel=1e-3)


def test_reference_frequency_of_the_thesis():
    """180 Hz of a column of 0.32 m with kn = 0.01 E/h (6.1, 6.2); that height was inferred from this formula."""
    found = lowest(stack(1, 0.1, 0.32, 0.01 * 27.4e9 / 0.32, 0.01 * 27.4e9 / 0.32, density=2112.0), 3)
    assert of_axis(found, 1) == pytest.approx(180.0, abs=1.0)


def pressed(sim):
    """All points closed by different amounts, so that none opens."""
    sim.contacts.gaps[:] = -1e-3 * (1.0 + np.arange(len(sim.joints.kn)) / 7.0)
    sim.contacts.normal[:] = -sim.joints.kn * sim.contacts.gaps
    return sim


def test_stiffness_is_that_of_the_contact_loop():
    """Forces of the loop with fixed geometry, after a small motion of every degree of freedom."""
    sim = pressed(simulation(tables(*running_wall(3, 3), joints=joint(3e8, 2e8))))
    loop = make_contact_forces(sim.law.function)
    stiffness = system(sim).stiffness.toarray()
    free = np.flatnonzero(np.repeat(~sim.model.fixed, 3))
    kept, small = sim.save(), 1e-9

    def forces(dof: int | None) -> np.ndarray:
        sim.restore(kept)
        sim.bodies.forces[:] = 0.0
        if dof is not None:
            sim.bodies.velocities.ravel()[dof] = small
        loop(sim.joints, sim.geometry, sim.contacts, sim.bodies, 1.0, sim.like, sim.like_rotation)
        return sim.bodies.forces.ravel()[free].copy()

    before = forces(None)
    found = np.column_stack([(before - forces(dof)) / small for dof in free])
    assert np.abs(found - stiffness).max() < 1e-6 * np.abs(stiffness).max()


def wall(courses: int, length: int, ratio: float):
    return simulation(tables(*running_wall(courses, length), joints=joint(1e9, ratio * 1e9)))


@settings(max_examples=12, deadline=None)
@given(st.integers(1, 5), st.integers(1, 4), st.floats(0.05, 5.0))
def test_modes_of_walls(courses, length, ratio):
    sim = wall(courses, length, ratio)
    matrix = system(sim).stiffness.toarray()
    assert np.abs(matrix - matrix.T).max() <= 1e-12 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(matrix)[0] > -1e-12 * np.abs(matrix).max()
    model = sim.model
    count = 3 * int((~model.fixed).sum())
    found = lowest(sim, count)
    assert found.mechanisms == 0
    assert len(found.frequencies) == count
    assert (np.diff(found.frequencies) >= 0.0).all()
    masses = np.column_stack([model.masses, model.masses, model.inertias])
    flat = (found.shapes * np.sqrt(masses)).reshape(count, -1)
    assert flat @ flat.T == pytest.approx(np.eye(count), abs=1e-9)
    assert found.effective_masses.sum(axis=0) == pytest.approx(model.masses[~model.fixed].sum(), rel=1e-9)
    assert 2 * math.pi * found.frequencies[-1] == pytest.approx(highest_frequency(sim), rel=1e-9)
    assert (lowest(wall(courses, length, ratio), count).shapes == found.shapes).all()  # the same every time
    four = simulation(tables(*running_wall(courses, length), joints=joint(4e9, ratio * 4e9)))
    assert lowest(four, count).frequencies == pytest.approx(2.0 * found.frequencies, rel=1e-9)


def test_large_structures_answer_as_small_ones():
    sim = wall(14, 12, 0.4)
    found, fast = lowest(sim, 8), highest_frequency(sim)
    assert found.frequencies.size == 8
    sim.settings = replace(DEFAULT, frequency=replace(DEFAULT.frequency, dense=10**9))
    dense = lowest(sim, 8)
    assert found.frequencies == pytest.approx(dense.frequencies, rel=1e-9)
    assert np.abs(found.shapes - dense.shapes).max() < 1e-6 * np.abs(dense.shapes).max()
    assert fast == pytest.approx(highest_frequency(sim), rel=1e-9)


def test_bound_where_the_iteration_does_not_converge(monkeypatch):
    from scipy.sparse import linalg

    sim = wall(14, 12, 0.4)
    exact = highest_frequency(sim)

    def gives_up(*args, **options):
        raise linalg.ArpackNoConvergence("no", np.zeros(0), np.zeros((0, 0)))

    monkeypatch.setattr(linalg, "eigsh", gives_up)
    found = limiting(sim)
    assert not found.exact
    assert exact < found.frequency < 1.5 * exact
    assert "no more than" in time_step(sim).cause
    assert found.block in sim.joints.blocks[found.joint]


def test_motions_that_strain_nothing():
    """A block on one point turns about it; one that touches nothing moves freely."""
    sim = stack(2, 1.0, 0.5, 1e9, 1e9)
    on_one = np.array([True, False, False, False])
    found = lowest(sim, 6, on_one)
    assert found.mechanisms == 1 + 3
    assert found.loose.tolist() == [1, 2]
    assert len(found.frequencies) == 2
    none = lowest(sim, 6, np.zeros(4, bool))
    assert none.mechanisms == 6
    assert none.shapes.shape == (0, 3, 3)


def test_mechanisms_of_large_structures_are_left_out():
    sim = stack(4, 1.0, 0.5, 1e9, 1e9)
    sim.settings = replace(DEFAULT, frequency=replace(DEFAULT.frequency, dense=0, dense_share=1.0))
    closed = np.ones(8, bool)
    closed[[3, 7]] = False
    found = lowest(sim, 3, closed)
    assert found.mechanisms == 2
    assert len(found.frequencies) == 3
    assert found.frequencies[0] > 1.0


def test_the_stiffest_joint_limits_the_step():
    ground = block("ground", rectangle(-1, -1, 3, 0), fixed=True)
    small = block("small", rectangle(0, 0, 0.1, 0.1))
    case = tables(ground, small, block("large", rectangle(1, 0, 2, 1)), joints=joint(1e9))
    sim = simulation(case)
    found = time_step(sim)
    exact = math.sqrt(sway(0.1, 0.1, 1e8, 1e8, 20.0)[1])
    assert found.limit == pytest.approx(2.0 / exact, rel=1e-9)
    assert found.step == pytest.approx(1.0 / exact, rel=1e-9)
    assert found.blocks == ("small", "ground")
    assert time_step(sim, margin=0.8).step == pytest.approx(1.6 / exact, rel=1e-9)
    assert time_step(sim, forced=1e-6).step == 1e-6


def test_a_forced_step_above_the_limit_is_refused():
    sim = stack(2, 1.0, 0.5, 1e9, 1e9)
    limit = time_step(sim).limit
    assert time_step(sim, forced=limit).step == limit
    with pytest.raises(
        CaseError, match=r"analysis\.time_step: .* above the largest stable step, .*'b[12]' on '"
    ) as seen:
        time_step(sim, forced=1.01 * limit)
    assert f"{limit:.4g} s" in str(seen.value)


def test_a_block_that_flies_limits_the_step_by_where_it_may_land():
    """It has a step before it has a joint: that of lying on the face on which it vibrates fastest."""
    ground = block("ground", rectangle(-1, -1, 3, 0), fixed=True)
    flies = block("flies", rectangle(0, 1.5, 0.1, 1.55))
    sim = simulation(tables(ground, flies, joints=joint(1e9)))
    found = time_step(sim)
    exact = math.sqrt(max(sway(0.1, 0.05, 1e8, 1e8, 10.0)[1], sway(0.05, 0.1, 5e7, 5e7, 10.0)[1]))
    assert found.limit == pytest.approx(2.0 / exact, rel=1e-9)
    assert not found.held
    assert found.cause == f"'flies' where it lands on a face vibrates at {exact / (2.0 * math.pi):.4g} Hz"
    assert lowest(sim, 3).mechanisms == 3
    rests = simulation(tables(ground, block("rests", rectangle(0, 0, 1, 1)), flies, joints=joint(1e9)))
    assert (time_step(rests).limit, time_step(rests).blocks) == (found.limit, ("flies",))
    assert time_step(rests).held
