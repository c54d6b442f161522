"""Joints with a profile: exact distances, forces that are the gradient of what the springs store, nothing lost."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from engine import block, rectangle, scene, simulation, solve, steps, tables
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dem_cli.core.contact.layout import PointLayout
from dem_cli.core.engine import measures
from dem_cli.core.engine import simulation as engine
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.planar_geometry import BLEND

APERTURE, SIDES = 0.01, 5


def stacked(shift: float = -1.0, friction: float = 0.0, **joint) -> dict:
    """A block of 1 m on a wider fixed one, or beyond its end by `shift` [m]."""
    table = tables(
        block("base", rectangle(-1.0, -1.0, 1.0 - shift, 0.0), fixed=True),
        block("top", rectangle(0.0, 0.0, 1.0, 1.0)),
    )
    table["joints"] = {"rough": {"friction": friction, "kn": 1e9, "ks": 1e9, **joint}}
    return table


def profiled(shift: float = -1.0, **more) -> dict:
    return stacked(shift, profile={"sides": SIDES, "aperture": APERTURE}, **more)


def place(sim, x: float, y: float, angle: float) -> None:
    """Puts block b there, relative to its first place, and its corners with it."""
    b = sim.joints.blocks[0, 1]
    sim.bodies.positions[b] = sim.reference_positions[b] + (x, y)
    sim.bodies.orientations[b] = angle
    c, s = np.cos(angle), np.sin(angle)
    own = sim.shape.corner_blocks == b
    sim.bodies.corners[own] = sim.bodies.positions[b] + sim.shape.corner_arms[own] @ np.array([[c, s], [-s, c]])


def stored(sim, x: float, y: float, angle: float) -> float:
    """Energy of the normal springs with block b there [J]."""
    place(sim, x, y, angle)
    gaps = sim.measured().gaps
    return float(0.5 * (sim.joints.kn * np.minimum(gaps, 0.0) ** 2).sum())


def vertices(sim) -> np.ndarray:
    """World coordinates of the chain on block b, from its right end to its left, (n, 2)."""
    _, _, b0, b1 = sim.bodies.corners[sim.geometry.edges[0]]
    along = (b0 - b1) / np.hypot(*(b0 - b1))
    into_b = np.array([along[1], -along[0]])
    return b1 + sim.geometry.profile[:, :1] * along + sim.geometry.profile[:, 1:] * into_b


small = st.floats(-2e-3, 2e-3)


@settings(max_examples=50, deadline=None)
@given(x=st.floats(-0.3, 0.3), y=small, angle=st.floats(-0.05, 0.05))
def test_gaps_are_the_heights_of_the_vertices(x, y, angle):
    """All vertices over the edge of a: their distance from it is their height."""
    sim = simulation(profiled(), "large")
    place(sim, x, y, angle)
    assert sim.measured().gaps == pytest.approx(vertices(sim)[:, 1], abs=1e-14)


@settings(max_examples=100, deadline=None)
@given(
    shift=st.sampled_from([-1.0, 0.25, 0.45]),
    x=st.floats(-0.02, 0.02),
    y=st.floats(-2e-3, 0.0),
    angle=st.floats(-0.04, 0.04),
)
def test_forces_are_the_gradient_of_the_energy(shift, x, y, angle):
    """Without friction, at ends that are corners of b on a, corners of a on a side of b, and at vertices between."""
    sim = simulation(profiled(shift), "large")
    if shift > 0.0:  # where a side meets a vertex at the corner of a, or corners blend, the normal turns
        corner = sim.bodies.corners[:, 0][sim.shape.corner_blocks == 0].max()
        assume(np.abs(vertices(sim)[:, 0] + x - corner).min() > 2 * BLEND)
    place(sim, x, y, angle)
    b, h = int(sim.joints.blocks[0, 1]), 1e-7
    sim.loads.inverse_masses[:] = 0.0  # stays where it is
    steps(sim, 1)
    force = sim.bodies.forces[b].copy()
    expected = []
    for k in range(3):
        d = h * np.eye(3)[k]
        below, above = (stored(sim, x + s * d[0], y + s * d[1], angle + s * d[2]) for s in (-1.0, 1.0))
        expected.append((below - above) / 2 / h)
    scale = sim.joints.kn.max() * 1e-3
    assert force == pytest.approx(expected, rel=1e-5, abs=1e-4 * scale)


def test_a_chain_without_rise_is_a_plane_joint():
    """The loop for profiles with two points at the ends does what the loop for plane joints does."""
    made = scene(stacked(0.3, friction=0.4, points=2))
    plain = joint_properties(made.request, made.model, 1e5)
    sims = [
        engine.Simulation(made.model, law_of(made.request), properties, "large")
        for properties in (plain, plain._replace(layouts=(PointLayout(points=2),)))
    ]
    for sim in sims:
        sim.set_load(0.3)
        sim.advance(2000, slot.HOLD_LOAD)
    assert len(sims[1].geometry.profile) == 2
    assert not len(sims[0].geometry.profile)
    for field in ("positions", "orientations", "velocities"):
        one, other = (getattr(sim.bodies, field) for sim in sims)
        assert one == pytest.approx(other, abs=1e-12)
    assert sims[0].contacts.shear == pytest.approx(sims[1].contacts.shear, abs=1e-6)


def test_nothing_is_lost_in_microrotations():
    """There and back over four vertices: the books close, and the block stands where it stood."""
    sim = simulation(profiled(friction=2.0), "large")
    sim.use(0.75, 0.3, 0.3)
    for load in (0.0, 0.7, 0.0, -0.7, 0.0):
        sim.set_load(load)
        sim.advance(30_000, slot.HOLD_LOAD)
    energy = measures.energy(sim)
    error = energy.kinetic + energy.elastic + energy.gravity + energy.friction + energy.damping - energy.external
    assert abs(error) < 3e-3 * energy.damping  # steps of 1e-3 of the aperture in snaps
    assert abs(sim.bodies.orientations[1, 0]) < 1e-4 / 60


def test_points_of_all_joints_are_carried_over():
    """A new detection keeps the profile, the stiffness and the memory of every joint that stays."""
    table = profiled(friction=0.7)
    table["block"].append(block("next", rectangle(1.0, 0.0, 2.0, 1.0), fixed=True))
    sim = simulation(table, "large")
    sim.set_load(0.1)
    sim.advance(3000, slot.HOLD_LOAD)
    old, geometry, contacts = sim.joints, sim.geometry, sim.contacts
    before = {tuple(e): (old.starts[j], old.starts[j + 1]) for j, e in enumerate(geometry.edges.tolist())}
    sim.detect()
    assert sum(end - start > 2 for start, end in before.values()) >= 1
    for j, edges in enumerate(sim.geometry.edges.tolist()):
        first, last = before[tuple(edges)]
        mine = slice(sim.joints.starts[j], sim.joints.starts[j + 1])
        for now, then in (
            (sim.geometry.profile, geometry.profile), (sim.joints.kn, old.kn), (sim.contacts.normal, contacts.normal),
            (sim.contacts.shear, contacts.shear),
        ):  # fmt: skip
            np.testing.assert_array_equal(now[mine], then[first:last])


def test_another_block_changes_no_profile():
    """Profiles are drawn by the names of blocks and their edges, wherever other blocks are."""
    profile = {"sides": [3, 7], "aperture": [1e-3, 1e-2]}
    alone, joined = stacked(profile=profile), stacked(profile=profile)
    joined["block"].insert(0, block("far", rectangle(-9.0, -9.0, -8.0, -8.5), fixed=True))
    one, other = (simulation(case, "large").geometry for case in (alone, joined))
    assert len(one.profile) >= 4
    np.testing.assert_array_equal(one.profile, other.profile)


def test_a_joint_that_takes_over_starts_from_its_force():
    """A column that falls far over its corners: new joints find their blocks inside each other, by the recess."""
    column = Path(__file__).resolve().parents[3] / "cases/validation/column_14_profile.toml"
    words = ("follow=0.22", "collapse=rate", "resolution=0.05", "step=0.05")
    summary, _ = solve(column, *(f"analysis.{word}" for word in words))
    assert abs(summary["energy_closure"]) < 1e-3
