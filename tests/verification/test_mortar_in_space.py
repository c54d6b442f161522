"""Mortar joints in space against closed forms: brittle bending, torsion, and points over areas where blocks move."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine import simulation, solve
from oracle import brittle_plate, toothed_crack
from studies.mortar.specimen import blocks_of, strength, wallette
from studies.mortar.wallettes import crack_by_crack
from studies.space.structures import box, tables

from dem_cli.core.contact.spatial_motion import place
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.placement import moves
from dem_cli.core.geometry import polygon
from dem_cli.core.kernels.records import FIXED_TO_B
from dem_cli.core.kernels.spatial_forces import measure_spatial
from dem_cli.core.statics.equilibrium import stand
from dem_cli.errors import SolverError

A, T, H = 0.4, 0.15, 0.2  # length, thickness, height [m]
TENSION, COHESION = 0.322e6, 0.483e6
MORTAR = {
    "law": "mohr-coulomb", "friction_angle_deg": 36.0, "tension": TENSION, "cohesion": COHESION, "kn": 1e11, "ks": 4e10,
    "points": 3,
}  # fmt: skip
WEIGHT = 2000.0 * 9.81 * A * T * H
BLOCKS = (
    box("base", (0.0, 0.0, -H), (A, T, 0.0), fixed=True),
    box("b", (0.0, 0.0, 0.0), (A, T, H)),
)


def on_bed(*loads: dict, analysis: dict, **joint) -> dict:
    return tables(*BLOCKS, joints={"mortar": MORTAR | joint}, load=list(loads), analysis=analysis)


@pytest.mark.parametrize("across", [False, True])
def test_a_brittle_bed_joint_breaks_at_its_tensile_strength(across):
    """Pushed at the top: M = (ft + W/A) a t²/6 about either side. Four Lobatto rows would carry a third more."""
    force = [1000.0, 0.0, 0.0] if across else [0.0, 1000.0, 0.0]
    push = {"kind": "live", "block": "b", "at": [A / 2, T / 2, H], "force": force}
    analysis = {"kind": "pushover", "pattern": "live", "kinematics": "fixed", "resolution": 0.001}
    modulus = (T * A**2 if across else A * T**2) / 6.0
    exact = (TENSION + WEIGHT / (A * T)) * modulus / H / 1000.0
    summary, _ = solve(on_bed(push, analysis=analysis))
    low, high = summary["failure_load_bracket"]
    assert low * (1 - 1e-3) < exact < high * (1 + 1e-3)
    assert ["cracks up to 1.35 times" in text for text in summary["warnings"]] == [True]  # where it is pressed


def twisted(share: float) -> dict:
    """A couple about the vertical, over that at which the first corner fails: c a t √(a² + t²)/6, weight aside."""
    torque = share * COHESION * A * T * math.hypot(A, T) / 6.0
    pull = {"kind": "dead", "block": "b", "force": [0.0, torque / A, 0.0], "at": [A, T / 2, H / 2]}
    push = {"kind": "dead", "block": "b", "force": [0.0, -torque / A, 0.0], "at": [0.0, T / 2, H / 2]}
    return on_bed(pull, push, analysis={"kind": "gravity"})


def test_torsion_is_elastic_up_to_the_first_corner():
    """Shear at a corner is T r / I_p over its share of the area: exact, and so is the strength of a brittle joint."""
    sim = simulation(twisted(0.99))
    assert stand(sim, Budget(20_000)).state == "equilibrium"
    assert np.linalg.norm(sim.contacts.shear, axis=1).max() == pytest.approx(0.99 * COHESION * A * T / 15.0, rel=2e-3)
    with pytest.raises(SolverError, match="gave up"):
        stand(simulation(twisted(1.02)), Budget(20_000))


def areas(sim) -> tuple[np.ndarray, np.ndarray]:
    """Areas of the contact points in use, and where they are."""
    measure_spatial(sim.joints, sim.geometry, sim.contacts, sim.bodies)
    used = sim.joints.kn > 0.0
    return sim.joints.kn[used] / MORTAR["kn"], sim.joints.points[used]


def moments(weights: np.ndarray, places: np.ndarray) -> np.ndarray:
    x, y = (places[:, :2] - [A / 2, T / 2]).T
    return np.array([(weights * f).sum() for f in (x**0, x, y, x * x, x * y, y * y)])


def test_points_of_blocks_that_move_are_those_of_the_start():
    sim = simulation(on_bed(analysis={"kind": "gravity"}), kinematics="large")
    weights, places = areas(sim)
    assert len(weights) == 9
    area = A * T
    assert moments(weights, places) == pytest.approx(area * np.array([1, 0, 0, A**2 / 12, 0, T**2 / 12]), abs=1e-15)


@pytest.mark.parametrize("shift", [(1e-3, 0.0), (0.1, 0.02), (0.39, 0.0), (0.2, 0.14)])
def test_area_and_first_moment_stay_those_of_the_overlap(shift):
    """A point that the base no longer covers is held at its rim and fades; the rest have the area and its centroid."""
    sim = simulation(on_bed(analysis={"kind": "gravity"}), kinematics="large")
    block = sim.model.block_ids.index("b")
    for _ in range(20):
        moves.displace(sim, np.array([block]), np.array([*shift, 0.0]) / 20.0)
        sim.bodies.corners[sim.shape.corner_blocks == block] += np.array([*shift, 0.0]) / 20.0
        sim.geometry.markers[:] = np.nan
        place(sim.joints, sim.geometry, sim.contacts, sim.bodies)
    weights, places = areas(sim)
    wide, deep = A - shift[0], T - shift[1]
    middle = np.array([shift[0] + wide / 2, shift[1] + deep / 2])
    floor = max(wide * deep, 0.25 * A * T)
    assert weights.sum() == pytest.approx(floor, rel=1e-9)
    if wide * deep > 0.05 * A * T:
        assert (weights[:, None] * places[:, :2]).sum(axis=0) / weights.sum() == pytest.approx(middle, abs=1e-9)
    inside = sim.geometry.types[sim.joints.kn > 0.0] == FIXED_TO_B
    assert (places[:, 0] > shift[0] - 1e-12).all()
    assert (places[:, 1] < T + 1e-12).all()
    assert inside.any() or wide * deep < 0.05 * A * T  # slivers stand on their corners


def test_wallettes_cover_their_outline():
    """Blocks at any angle neither overlap nor leave more than the slivers that are left out."""
    for angle, missing in ((0.0, 0.0), (15.0, 0.03), (45.0, 0.03), (90.0, 0.0)):
        area = sum(polygon.properties(corners).area for corners in blocks_of(angle))
        assert (1.0 - missing) * 0.8 * 1.6 - 1e-9 <= area <= 0.8 * 1.6 + 1e-9


@pytest.mark.parametrize("angle", [15.0, 90.0])
def test_a_wallette_is_as_strong_as_crack_by_crack(angle):
    """Another program, without steps or dynamics: 15° lies below 0° in both, 90° far above."""
    summary, _ = solve(wallette(angle, 0.4))
    low, high = (strength(load) / 1e6 for load in summary["failure_load_bracket"])
    other = crack_by_crack(angle, 0.4, 3)
    assert low * 0.98 < other["strength"] < high * 1.025
    assert other["first"] <= other["strength"]
    assert (other["strength"] < 0.322) is (angle == 15.0)


def test_crack_by_crack_finds_the_strength_of_a_bed_joint():
    found = crack_by_crack(0.0, 0.4, 5)
    assert found["first"] == pytest.approx(0.322, abs=1e-4)
    assert crack_by_crack(0.0, 0.4, 3)["strength"] == pytest.approx(0.322, abs=1e-4)


def test_soft_beds_of_a_toothed_crack_turn_about_the_pressed_edge():
    """Heads are gone when the far corner of the bed fails, at c a √(a² + 4 t²)/(h t); its other points add little."""
    crack = toothed_crack.Toothed(0.2, 0.2, 0.15, TENSION, COHESION, 1e11, 1e9)
    found = toothed_crack.strength(crack, brittle_plate.lobatto(9))
    assert found == pytest.approx(toothed_crack.beds_alone(crack), rel=0.03)
