"""Joints that are not plane, or not only frictional, where they could go wrong: limits, symmetries, mixtures."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, mirrored, rectangle, scene, simulation, solve, tables

from dem_cli.core.engine import measures
from dem_cli.core.kernels import records as slot
from dem_cli.errors import CaseError

PUSH = {"kind": "pushover", "direction": [1.0, 0.0], "pattern": "mass", "resolution": 0.002}
GRAVITY = {"kind": "gravity"}
MATERIALS = {"stone": {"density": 2000.0}, "ground": {"density": 2000.0}}
WEIGHT = 2000.0 * 9.81 * 0.5  # of one block of `tower` [N], on 1 m²
BONDS = {"mohr-coulomb": {}, "fracture": {"fracture_energy_tension": 10.0, "fracture_energy_shear": 10.0}}
BROKEN_LINE = {"sides": 3, "aperture": 1e-3}
RANDOM = [
    {"sides": [3, 7], "aperture": [0.0, 2e-4]},
    {"sides": [2, 8], "aperture": [1e-4, 2e-4]},
    {"sides": [2, 6], "lengths": [[0.01, 0.03]], "aperture": [0.0, 2e-4], "keep": "lengths"},
    {"sides": [3, 5], "aperture": [0.0, 2e-4], "over": "face"},
]


def coulomb(friction: float = 0.6, **more) -> dict:
    return {"law": "coulomb", "friction": friction, **more}


def bonded(law: str, strength: float, friction: float = 0.6) -> dict:
    return {"law": law, "friction": friction, "cohesion": strength, "tension": strength, **BONDS[law]}


def tower(count: int, joint: dict, analysis: dict, base: dict | None = None, size: float = 1.0, **more) -> dict:
    """Blocks of 1 × 0.5 (times size) on a base, or hanging from it where count < 0; `base`: another joint for that."""
    step = 0.5 * size * np.sign(count)
    ends = [sorted((i * step, (i + 1) * step)) for i in range(abs(count))]
    blocks = [block(f"b{i}", rectangle(0.0, low, size, high), material="stone") for i, (low, high) in enumerate(ends)]
    low, high = sorted((0.0, -step))
    ground = block("base", rectangle(-size, low, 2.0 * size, high), fixed=True, material="ground")
    joints = {"inner": joint} if base is None else {"inner": joint, "base": base}
    if base is not None:
        more["interface"] = [{"between": ["stone", "ground"], "joint": "base"}]
    return tables(ground, *blocks, materials=MATERIALS, joints=joints, analysis=analysis, **more)


def generated(structure: dict, joint: dict, analysis: dict, **more) -> dict:
    """A wall of 21 blocks or a column of 14, with the sizes of the thesis."""
    made = {"material": "stone", "block": [0.04, 0.0175], "thickness": 0.08, **structure}
    case = tables(materials=MATERIALS, joints={"dry": joint}, analysis=analysis, **more)
    return {**{key: value for key, value in case.items() if key != "block"}, "structure": [made]}


WALL = {"kind": "wall", "courses": 6, "blocks_per_course": 3, "bond": "running", "first": "half", "base": True}
COLUMN = {"kind": "column", "courses": 14, "base_extension": 0.02}


def failure_load(case: dict) -> float:
    summary = solve(case)[0]
    assert summary["status"] == "ok", summary["status"]
    assert abs(summary["energy_closure"]) < 0.01
    return summary["failure_load"]


# -- profiles ----------------------------------------------------------------------------------------


def test_mirror_and_size_change_nothing():
    case = tower(4, coulomb(profile=BROKEN_LINE), PUSH)
    large = tower(4, coulomb(profile=BROKEN_LINE | {"aperture": 1e-2}), PUSH, size=10.0)
    load = failure_load(case)
    assert failure_load(mirrored(case)) == pytest.approx(-load if load < 0 else load, rel=0.004)
    assert failure_load(large) == pytest.approx(load, rel=0.004)


def test_flatter_profiles_come_closer_to_plane_joints():
    loads = [failure_load(tower(4, coulomb(profile=BROKEN_LINE | {"aperture": a}), PUSH)) for a in (4e-3, 1e-3, 1e-4)]
    assert loads[0] < loads[1] < loads[2] < 0.5 * (1 + 1e-3)
    assert loads[2] == pytest.approx(0.5, rel=0.006)


@pytest.mark.parametrize("structure", [WALL, COLUMN], ids=["wall", "column"])
@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_random_profiles_stand(structure, seed):
    summary = solve(generated(structure, coulomb(profile=RANDOM[seed]), GRAVITY, seed=seed))[0]
    assert summary["status"] == "ok"
    if "over" not in RANDOM[seed]:  # joints that part and meet by nanometres while they settle lose some of very little
        assert abs(summary["energy_closure"]) < 0.01


def test_same_seed_same_bytes():
    case = generated(WALL, coulomb(profile=RANDOM[0]), GRAVITY, seed=1)
    one, two, other = (simulation(c, "large") for c in (case, case, case | {"seed": 2}))
    for sim in (one, two):
        sim.advance(500, slot.HOLD_LOAD)
    assert one.geometry.profile.tobytes() == two.geometry.profile.tobytes()
    assert one.bodies.positions.tobytes() == two.bodies.positions.tobytes()
    assert one.geometry.profile.tobytes() != other.geometry.profile.tobytes()


def test_at_rest_on_a_profile_nothing_drifts():
    sim = simulation(tower(3, coulomb(profile=BROKEN_LINE), PUSH), "large")
    sim.set_load(0.1 / sim.live_scale)
    sim.advance(20_000, slot.HOLD_LOAD)
    before = sim.places()
    sim.advance(100_000, slot.HOLD_LOAD)
    assert np.abs(sim.places() - before).max() < 1e-12


@pytest.mark.parametrize("sides", [2, 5])
def test_failure_is_proved_though_any_load_rolls(sides):
    """The motion of microrotations is no elastic one: failure is not looked for hundreds of metres away."""
    case = tower(1, coulomb(0.3, profile={"sides": sides, "aperture": 1e-2}), PUSH)
    assert failure_load(case) == pytest.approx(0.3, rel=0.004)


def test_sliding_far_on_a_profile():
    case = tower(1, coulomb(0.3, profile=BROKEN_LINE), PUSH | {"follow": 1.4})
    summary, records = solve(case)
    assert summary["failure_load"] == pytest.approx(0.3, rel=0.004)
    assert abs(summary["energy_closure"]) < 0.01
    rows = np.array([row.displacement for row in records.rows])
    assert np.isfinite(rows).all()
    assert rows.max() > 1.3


def test_fixed_geometry_is_refused():
    case = tower(1, coulomb(profile=BROKEN_LINE), PUSH | {"kinematics": "fixed"})
    with pytest.raises(CaseError, match="microrotations"):
        solve(case)


# -- bonds -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", BONDS)
@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_bond_is_pulled_apart_at_its_strength(law, kinematics):
    """ft·A + W, at a load that is put on in steps: their swing must not break what holds."""
    lift = PUSH | {"direction": [0.0, 1.0], "kinematics": kinematics}
    assert failure_load(tower(1, bonded(law, 2e5), lift)) == pytest.approx(1.0 + 2e5 / WEIGHT, rel=0.003)


@pytest.mark.parametrize("law", BONDS)
@pytest.mark.parametrize("count", [1, 4])
def test_hanging_blocks_hold_as_long_as_their_joints(law, count):
    """Gravity put on at once would swing, and break at twice the strength that is needed."""
    for strength, stands in ((1.03, True), (0.97, False)):
        summary = solve(tower(-count, bonded(law, strength * count * WEIGHT), GRAVITY))[0]
        assert (summary["status"] == "ok") == stands


@pytest.mark.parametrize("law", BONDS)
def test_weak_bonds_carry_what_friction_carries(law):
    case = generated(WALL, bonded(law, 1e-2), PUSH | {"start": "gravity"})
    assert failure_load(case) == pytest.approx(0.6, rel=0.006)


@pytest.mark.parametrize(("friction", "load"), [(0.7, 0.4), (0.3, 0.3)], ids=["turns over", "slides"])
@pytest.mark.parametrize(
    "joint",
    [{"law": "elastic"}, bonded("mohr-coulomb", 1e8), bonded("fracture", 1e8) | {"fracture_energy_tension": 1e9}],
    ids=lambda joint: joint["law"],
)
def test_monolith_on_friction(joint, friction, load):
    """Five blocks that hold together: min(μ, b/h) of the whole, exactly."""
    joint = joint | ({"fracture_energy_shear": 1e9} if joint["law"] == "fracture" else {})
    found = failure_load(tower(5, joint, PUSH, coulomb(friction)))
    assert found == pytest.approx(load, rel=0.002)


def test_two_laws_are_each_as_alone():
    """What gives way is the one joint of the second law; the same with that law everywhere."""
    slip = {"law": "slip-degrading", "friction": 0.25, "residual": 0.5, "slip_scale": 0.01}
    mixed = failure_load(tower(2, coulomb(0.9), PUSH, slip))
    alone = failure_load(tower(2, slip, PUSH))
    assert mixed == pytest.approx(0.25, rel=0.002)
    assert alone == pytest.approx(0.25, rel=0.002)


# -- other laws --------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 4])
def test_gravity_below_the_strength_crushes_nothing(count):
    strength = 1.03 * count * WEIGHT
    case = tower(count, {"law": "crushing", "friction": 0.6, "compression": strength}, GRAVITY)
    assert solve(case)[0]["status"] == "ok"
    from dem_cli.core.engine.budget import Budget
    from dem_cli.core.statics.equilibrium import stand

    sim = simulation(case)
    assert stand(sim, Budget(1_000_000)).state == "equilibrium"
    assert sim.contacts.memory.max() == 0.0


def test_stone_is_crushed_at_its_strength():
    joint = {"law": "crushing", "friction": 0.6, "compression": 5.0 * WEIGHT}
    press = {"kind": "pushover", "direction": [0.0, -1.0], "pattern": "mass", "resolution": 0.002}
    assert failure_load(tower(1, joint, press)) == pytest.approx(4.0, rel=0.004)


@pytest.mark.parametrize(
    "joint",
    [
        coulomb(0.5, softening={"residual": 0.4, "slip_start": 0.001, "slip_length": 0.001}),
        {"law": "slip-degrading", "friction": 0.5, "residual": 0.4, "slip_scale": 0.001},
    ],
    ids=["softening", "slip-degrading"],
)
def test_peak_friction_fails_and_residual_friction_is_left(joint):
    summary, records = solve(tower(1, joint, PUSH | {"follow": 0.01}))
    assert summary["failure_load"] == pytest.approx(0.5, rel=0.004)
    assert records.rows[-1].load == pytest.approx(0.2, rel=0.02)


def test_friction_is_static_where_time_has_no_meaning():
    joint = {"law": "rate-dependent", "friction": 0.5, "friction_dynamic": 0.2, "velocity": 0.01}
    assert failure_load(tower(1, joint, PUSH)) == pytest.approx(0.5, rel=0.004)


@pytest.mark.parametrize("law", BONDS)
def test_limit_analysis_bounds_bonds_beside_the_failure_load(law):
    """Its bound is that of the whole bond, which carries no less than what breaks."""
    summary = solve(tower(2, bonded(law, 10.0), PUSH | {"limit": True}))[0]
    assert not [text for text in summary["warnings"] if "limit analysis" in text]
    assert summary["failure_load"] <= summary["limit_analysis"]["associated"] * 1.002


def test_limit_analysis_says_what_it_cannot():
    joint = {"law": "barton", "jrc": 8.0, "jcs": 5e7, "residual_angle_deg": 28.0}
    summary = solve(tower(2, joint, PUSH | {"limit": True}))[0]
    (said,) = [text for text in summary["warnings"] if text.startswith("no limit analysis")]
    assert "law 'barton' is curved" in said
    assert "limit_analysis" not in summary or summary["limit_analysis"] == {}


def test_all_points_of_uneven_joints_are_recorded():
    """Joints of two, three and more points in one scene: each record says where, and of which joint."""
    case = generated(WALL, coulomb(profile=RANDOM[0] | {"only": "bed"}), GRAVITY, seed=1)
    made, sim = scene(case), simulation(case, "large")
    record, counts = measures.contact_record(sim), np.diff(sim.joints.starts)
    assert len(set(counts.tolist())) > 3
    assert (np.bincount(record.joint) == counts).all()
    assert record.points.shape == (counts.sum(), made.model.dimension)
