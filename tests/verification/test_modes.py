"""kind = "modes": frequencies under gravity against closed forms and against the engine's own vibrations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine import block, real_masses, rectangle, running_wall, simulation, solve, steps, tables

from dem_cli.analyses.modes import closed_points
from dem_cli.core.contact.detect import world_corners
from dem_cli.core.dynamics.frequencies import modes, system
from dem_cli.core.dynamics.time_step import time_step
from dem_cli.core.engine.budget import Budget
from dem_cli.core.kernels.planar_forces import make_planar_forces
from dem_cli.core.statics.equilibrium import stand
from dem_cli.errors import CaseError

GROUND = block("ground", rectangle(-3, -1, 3, 0), fixed=True)
SLENDER = block("a", rectangle(0, 0, 0.5, 1.5))
STACK = (SLENDER, block("b", rectangle(0.1, 1.5, 0.4, 2.5)))
MODES = {"kind": "modes"}


def joint(kn: float, ks: float, **more) -> dict:
    """Springs at both ends, as in the closed forms; where time goes on, joints have these anyway."""
    return {"dry": {"friction": 0.9, "kn": kn, "ks": ks, "points": 2, **more}}


def slender(kn: float, ks: float) -> float:
    """First frequency of SLENDER on its joint under gravity [Hz]: sway and rocking, less the moment of its weight."""
    width, height, mass = 0.5, 1.5, 0.75 * 2000.0
    stiff, shear, weight = kn * width, ks * width, mass * 9.81
    inertia = mass * (width**2 + height**2) / 12.0
    matrix = np.array([[shear, shear * height / 2], [shear * height / 2, shear * height**2 / 4 + stiff * width**2 / 4]])
    matrix[1, 1] -= weight * height / 2
    roots = np.sqrt([mass, inertia])
    return math.sqrt(np.linalg.eigvalsh(matrix / np.outer(roots, roots))[0]) / (2 * math.pi)


@pytest.mark.parametrize("kn", [3e6, 1e8, 1e10])
def test_slender_block_under_gravity(kn):
    """At 3e6 Pa/m gravity takes 5 % off the frequency."""
    summary, _ = solve(tables(GROUND, SLENDER, joints=joint(kn, 0.4 * kn), analysis=MODES))
    assert summary["frequencies"][0] == pytest.approx(slender(kn, 0.4 * kn), rel=1e-5)
    assert sum(summary["effective_masses"]["x"]) == pytest.approx(summary["total_mass"], rel=1e-6)
    assert sum(summary["effective_masses"]["y"]) == pytest.approx(summary["total_mass"], rel=1e-6)
    assert summary["springs"] == {"pressed": 2, "touching": 2}


def test_the_geometry_of_the_start_knows_no_weight():
    kn = 3e6
    case = tables(GROUND, SLENDER, joints=joint(kn, kn), analysis={"kind": "modes", "kinematics": "fixed"})
    light = {**case, "gravity": 9.81e-6}
    assert solve(case)[0]["frequencies"] == pytest.approx(solve(light)[0]["frequencies"], rel=1e-9)


def test_corners_that_meet_are_no_springs():
    """Four blocks with a corner in one place, on geometry that moves: those aslant from each other share nothing."""
    stones = [
        block(f"b{i}{j}", rectangle(0.4 * i, 0.2 * j, 0.4 * i + 0.4, 0.2 * j + 0.2)) for j in (0, 1) for i in (0, 1)
    ]
    keys = {"kind": "modes", "contacts": "touching"}
    found = {
        way: solve(tables(GROUND, *stones, joints=joint(5e9, 2e9), analysis=keys | {"kinematics": way}))[0]
        for way in ("fixed", "large")
    }
    assert found["large"]["springs"]["touching"] == found["fixed"]["springs"]["touching"] == 12
    assert found["large"]["frequencies"] == pytest.approx(found["fixed"]["frequencies"], rel=1e-3)


STONES = {
    "slender": (SLENDER,),
    "narrower above": STACK,
    "corner on corner": (block("a", rectangle(0, 0, 0.5, 1)), block("b", rectangle(0, 1, 0.5, 2))),
    "2.5 mm off": (block("a", rectangle(0, 0, 0.5, 1)), block("b", rectangle(0.0025, 1, 0.5025, 2))),
}


def settled(*stones: dict):
    """On soft joints under gravity: the simulation, with forces that belong to its places."""
    sim = simulation(tables(GROUND, *stones, joints=joint(3e6, 2e6)), "large")
    assert stand(sim, Budget(10**6)).state == "equilibrium"
    loop = make_planar_forces(sim.law.function)
    sim.bodies.velocities[:] = 0.0
    loop(sim.joints, sim.geometry, sim.contacts, sim.bodies, 1.0, sim.like, sim.like_rotation)
    return sim, loop


@pytest.mark.parametrize(("name", "error"), [("slender", 1e-5), ("narrower above", 1e-5), ("corner on corner", 5e-3)])
def test_geometric_stiffness_is_that_of_the_contact_loop(name, error):
    """By finite differences. Where corners meet, blending them is exact but for overlap over height."""
    sim, loop = settled(*STONES[name])
    kept, small = sim.save(), 1e-8
    free = np.flatnonzero(np.repeat(~sim.model.fixed, 3))

    def forces(dof: int, motion: float) -> np.ndarray:
        sim.restore(kept)
        number, k = divmod(dof, 3)
        sim.bodies.forces[:] = 0.0
        sim.bodies.velocities[number, k] = motion
        if k < 2:
            sim.bodies.positions[number, k] += motion
        else:
            sim.bodies.orientations[number, 0] += motion
        sim.bodies.corners[:] = world_corners(sim.shape, sim.bodies.positions, sim.bodies.orientations)
        loop(sim.joints, sim.geometry, sim.contacts, sim.bodies, 1.0, sim.like, sim.like_rotation)
        return sim.bodies.forces.ravel()[free].copy()

    found = np.column_stack([(forces(dof, -small) - forces(dof, small)) / (2 * small) for dof in free])
    sim.restore(kept)
    springs = system(sim).stiffness.toarray()
    geometric = system(sim, geometric=True).stiffness.toarray() - springs
    assert np.abs(geometric).max() > 1e-3 * np.abs(springs).max()
    assert np.abs(found - springs - geometric).max() < error * np.abs(geometric).max()


@pytest.mark.parametrize("name", list(STONES))
def test_the_engine_vibrates_at_the_frequency(name):
    """Started along the first mode, so gently that nothing opens: the period of 20 cycles."""
    sim, _ = settled(*STONES[name])
    found = modes(system(sim, closed_points(sim), geometric=True), 1, 2, sim.model.n_blocks)
    real_masses(sim)
    dt = 0.2 * time_step(sim).limit
    omega = 2 * math.pi * found.frequencies[0]
    shape = found.shapes[0]
    sim.bodies.velocities[:] = 1e-4 * omega * shape / np.abs(shape).max()
    before, weights = sim.bodies.positions.copy(), shape[:, 0] * sim.model.masses
    places = []
    for _ in range(int(20.5 / found.frequencies[0] / dt)):
        steps(sim, 1, dt=dt)
        places.append(float(weights @ (sim.bodies.positions - before)[:, 0]))
    values = np.array(places) - np.mean(places)
    ups = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    exact = ups + values[ups] / (values[ups] - values[ups + 1])
    period = dt * (exact[-1] - exact[0]) / (len(exact) - 1)
    assert len(exact) >= 19
    leapfrog = 1.0 - (omega * dt) ** 2 / 24.0
    assert period * found.frequencies[0] == pytest.approx(leapfrog, abs=3e-5)


def test_calibration_of_stiff_joints_is_exact_at_once():
    case = tables(GROUND, *STACK, joints=joint(1e11, 4e10), analysis={"kind": "modes", "measured": 40.0})
    found = solve(case)[0]["calibration"]
    assert found["met"]
    assert found["factor"] == pytest.approx((40.0 / found["computed"]) ** 2, rel=2e-3)  # gravity does count a little
    wanted = {"kn": found["factor"] * 1e11, "ks": found["factor"] * 4e10}
    assert found["joints"]["dry"] == pytest.approx(wanted, rel=1e-12)
    again = solve({**case, "joints": joint(**wanted), "analysis": MODES})[0]
    assert again["frequencies"][0] == pytest.approx(40.0, rel=1e-4)


def test_without_weight_the_factor_is_exact():
    analysis = {"kind": "modes", "measured": 40.0, "kinematics": "fixed", "mode": 2}
    found = solve(tables(GROUND, *STACK, joints=joint(1e10, 4e9), analysis=analysis))[0]["calibration"]
    assert found["frequencies_tried"] == pytest.approx([40.0], rel=5e-9)  # nine digits of 138.845994 and of 40


def test_calibration_where_gravity_counts():
    """Not proportional to the root of kn any more: more than one attempt, and the closed form in the end."""
    case = tables(GROUND, SLENDER, joints=joint(1e9, 4e8), analysis={"kind": "modes", "measured": 1.0})
    found = solve(case)[0]["calibration"]
    assert found["met"]
    assert len(found["frequencies_tried"]) > 1
    stiffness = found["joints"]["dry"]
    assert slender(stiffness["kn"], stiffness["ks"]) == pytest.approx(1.0, rel=2e-4)


def test_a_frequency_that_joints_cannot_have():
    """A block on the softest joints that hold it up still has one far above 1e-3 Hz."""
    case = tables(GROUND, SLENDER, joints=joint(1e9, 4e8), analysis={"kind": "modes", "measured": 1e-3})
    summary, _ = solve(case)
    assert not summary["calibration"]["met"]
    assert any("do not carry the structure" in text for text in summary["warnings"])


def test_head_joints_carry_nothing_under_gravity():
    wall = tables(*running_wall(4, 3), joints=joint(5e9, 2e9), analysis=MODES)
    pressed, _ = solve(wall)
    touching, _ = solve(wall, "analysis.contacts='touching'")
    assert pressed["springs"] == touching["springs"]
    assert pressed["springs"]["pressed"] < pressed["springs"]["touching"]
    assert pressed["frequencies"][0] == pytest.approx(pressed["first_frequency"]["pressed"], rel=1e-9)
    assert touching["frequencies"][0] == pytest.approx(pressed["first_frequency"]["touching"], rel=1e-9)
    assert touching["frequencies"][0] > pressed["frequencies"][0]


def test_bonded_joints_hold_without_being_pressed():
    """A lintel glued to the side of a pier: gravity pulls at one of its points."""
    elastic = {"dry": {"law": "elastic", "kn": 1e9, "ks": 1e9, "points": 2}}
    case = tables(GROUND, SLENDER, block("arm", rectangle(0.5, 1.0, 1.0, 1.3)), joints=elastic, analysis=MODES)
    summary, _ = solve(case)
    assert summary["springs"] == {"pressed": 4, "touching": 4}
    assert summary["mechanisms"] == 0


def test_auto_stiffness_is_doubted():
    summary, _ = solve(tables(GROUND, SLENDER, analysis=MODES))
    assert any("auto" in text and "follow from that choice" in text for text in summary["warnings"])
    given, _ = solve(tables(GROUND, SLENDER, joints=joint(1e9, 1e9), analysis=MODES))
    assert given["warnings"] == []


def test_what_does_not_stand_has_no_modes():
    leaning = block("a", [[0, 0], [0.5, 0], [2.5, 2], [2.0, 2]])
    summary, _ = solve(tables(GROUND, leaning, joints=joint(1e9, 1e9), analysis=MODES))
    assert summary["status"] == "does not stand under its dead loads"
    assert "frequencies" not in summary


def test_a_mode_that_is_not_there():
    case = tables(GROUND, SLENDER, joints=joint(1e9, 1e9), analysis={"kind": "modes", "measured": 3.0, "mode": 4})
    with pytest.raises(CaseError, match=r"analysis\.mode: 4 is too high: the structure has 3 natural frequencies"):
        solve(case)


def test_frames_show_the_modes():
    case = tables(GROUND, *STACK, joints=joint(1e9, 1e9), analysis={"kind": "modes", "count": 3}, output={"frames": 5})
    summary, records = solve(case)
    shown = [frame for frame in records.frames if frame.stage == "mode"]
    assert [frame.step for frame in shown] == [1, 2, 3]
    assert len(summary["frequencies"]) == 3
    for frame in shown:
        moved = np.abs(frame.positions - records.frames[0].positions).max()
        assert 0.01 < moved < 0.3
        assert frame.positions[0] == pytest.approx(records.frames[0].positions[0])
