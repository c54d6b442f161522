"""Joints with tension, cohesion and crushing in limit analysis: closed forms, the oracle, which laws are bounded."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, running_wall, tables
from engine.limits import on_a_base, solved
from oracle.strong_joints import Points, largest_load, stress_block_load, toppling_load

from dem_cli.core.contact.layout import lobatto
from dem_cli.core.limit.associated import LOCKED, OK
from dem_cli.errors import UsageError

NEAR = 5e-6  # relative; bounds are accepted up to 1e-4 apart, and lie closer in all of these
WEIGHT = 2000.0 * 9.81  # of a cubic metre


def joint(law: str = "mohr-coulomb", friction: float = 0.6, **more) -> dict:
    return {"dry": {"law": law, "friction": friction, **more}}


def load(case: dict, **options) -> float:
    """The associated load, with its claims checked."""
    found = solved(case, **options).associated
    assert found.status == OK
    assert found.lower * (1 - NEAR) - 1e-9 <= found.multiplier <= found.upper * (1 + NEAR) + 1e-9
    return found.multiplier


def flat(**strength) -> dict:
    return on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)), joints=joint(**strength))


def tall(**strength) -> dict:
    return on_a_base(block("b", rectangle(0.0, 0.0, 0.5, 1.0)), joints=joint(**strength))


@pytest.mark.parametrize("cohesion", [1.0, 500.0, 1500.0])
def test_cohesion_holds_a_block_that_slides(cohesion):
    """λ = μ + c A / W."""
    assert load(flat(friction=0.3, cohesion=cohesion)) == pytest.approx(0.3 + cohesion / (0.2 * WEIGHT), rel=NEAR)


def test_shear_strength_that_no_normal_force_changes():
    """Livesley's first case, μ = 0: λ = c A / W, and the reduced domain is the whole one: the load is known."""
    found = solved(
        flat(friction=0.0, cohesion=800.0, cohesion_residual=800.0, points=5),
        bounds=("lower", "least"),
        associated_only=False,
    )
    assert found.associated.multiplier == pytest.approx(800.0 / (0.2 * WEIGHT), rel=NEAR)
    assert found.lower.reduced_domain == pytest.approx(found.associated.multiplier, rel=1e-5)
    assert "knows friction alone" in found.summary()["non_associated_status"]
    # Of joints that lose the cohesion of points that open less is sure: one point that is shut, 1/20 of five.
    assert found.lower.multiplier == pytest.approx(found.associated.multiplier / 20.0, rel=1e-5)
    assert found.lower.multiplier <= found.least.multiplier * (1.0 + 1e-6) <= found.associated.upper * (1.0 + 2e-6)


@pytest.mark.parametrize("cohesion", [1e3, 2e3, 4e3])
def test_walls_whose_shear_strength_is_fixed_have_one_load(cohesion):
    """Livesley: static and kinematic problem are dual, and the joints that keep their cohesion fail at that load."""
    case = tables(*running_wall(3, 3), joints=joint(friction=0.0, cohesion=cohesion, cohesion_residual=cohesion))
    found = solved(case, bounds=("lower",))
    assert found.lower.reduced_domain == pytest.approx(found.associated.multiplier, rel=1e-5)
    assert found.associated.multiplier == pytest.approx(by_oracle(case, Points(*lobatto(5), 0.0, cohesion)), rel=NEAR)


def test_tension_holds_a_block_that_topples():
    """λ = (b / h) (1 + ft A / W), whatever the points."""
    for points in (2, 5, 9):
        case = tall(friction=0.9, cohesion=1e4, tension=3e3, points=points)
        assert load(case) == pytest.approx(0.5 * (1.0 + 3e3 / WEIGHT), rel=NEAR)


@pytest.mark.parametrize("points", [2, 3, 5, 9])
@pytest.mark.parametrize("pressed", [0.3, 0.8, 0.95])
def test_crushing_of_the_toe(points, pressed):
    """Against the greedy choice of point forces; fc A = W / pressed."""
    crushed = WEIGHT / pressed
    expected = toppling_load(Points(*lobatto(points), 0.9, compression=crushed), 0.5, 1.0, 0.5 * WEIGHT)
    assert load(tall(law="crushing", friction=0.9, compression=crushed, points=points)) == pytest.approx(
        expected, rel=NEAR
    )


def test_points_against_the_stress_block():
    """The error that docs/bounds.md states, of the largest moment of the rectangular stress block: inside, outside."""
    off = {}
    for points in (2, 3, 5, 9):
        rule = lobatto(points)
        shares = np.linspace(0.02, 0.98, 97)
        exact = np.array([stress_block_load(1.0, 1.0, n, 1.0) * n for n in shares])
        found = np.array([toppling_load(Points(*rule, 1.0, compression=1.0), 1.0, 1.0, n) * n for n in shares])
        off[points] = (found - exact).min() / 0.25, (found - exact).max() / 0.25
    assert off[2] == (pytest.approx(0.0016), pytest.approx(1.0))
    assert off[3] == (pytest.approx(-1 / 3), pytest.approx(0.102, abs=1e-3))
    assert off[5] == (pytest.approx(-0.087, abs=1e-3), pytest.approx(0.037, abs=1e-3))
    assert off[9] == (pytest.approx(-0.023, abs=1e-3), pytest.approx(0.009, abs=1e-3))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("strength", [{"cohesion": 4e3, "tension": 3e3}, {"cohesion": 6e3, "tension": 0.0}])
def test_walls_against_the_oracle(seed, strength):
    rng = np.random.default_rng(seed)
    case = tables(*running_wall(3, 3), joints=joint(friction=float(rng.uniform(0.3, 0.9)), **strength))
    points = Points(*lobatto(5), case["joints"]["dry"]["friction"], **strength)
    assert load(case) == pytest.approx(by_oracle(case, points), rel=2e-6)


@pytest.mark.parametrize("compression", [1.5e4, 3e4, 1e5])
def test_crushed_walls_against_the_oracle(compression):
    case = tables(*running_wall(3, 3), joints=joint("crushing", 0.6, compression=compression, points=3))
    points = Points(*lobatto(3), 0.6, compression=compression)
    assert load(case) == pytest.approx(by_oracle(case, points), rel=2e-6)


def by_oracle(case: dict, points: Points) -> float:
    polygons = [np.array(table["vertices"]) for table in case["block"]]
    return largest_load(polygons, [table.get("fixed", False) for table in case["block"]], points)


def test_joints_without_end_never_fail():
    case = on_a_base(block("b", rectangle(0.0, 0.0, 0.5, 1.0)), joints={"dry": {"law": "elastic"}})
    assert solved(case).associated.status == LOCKED


def test_what_is_crushed_is_not_locked():
    """A push into the ground: fc A = W + λ F."""
    push = {"block": "b", "force": [0.0, -1.0], "kind": "live"}
    case = on_a_base(
        block("b", rectangle(0.0, 0.0, 1.0, 0.2)),
        load=[push],
        analysis={"pattern": "live"},
        joints=joint("crushing", compression=1e6),
    )
    assert load(case) == pytest.approx(1e6 - 0.2 * WEIGHT, rel=NEAR)


FRICTION_THAT_FALLS = {
    "coulomb": {"softening": {"residual": 0.5, "slip_start": 0.001, "slip_length": 0.001}},
    "slip-degrading": {"residual": 0.5, "slip_scale": 0.01},
    "rate-dependent": {"friction_dynamic": 0.4, "velocity": 0.1},
}


@pytest.mark.parametrize("law", FRICTION_THAT_FALLS)
def test_friction_that_falls_is_bounded_by_its_peak(law):
    """And from below by what is left of it; the rate plays no part where time has no meaning."""
    found = solved(flat(law=law, friction=0.6, **FRICTION_THAT_FALLS[law]), bounds=("lower",))
    assert found.associated.multiplier == pytest.approx(0.6, rel=2e-5)
    left = 0.6 if law == "rate-dependent" else 0.3
    assert found.lower.multiplier == pytest.approx(left, rel=1e-5)


def test_a_bond_that_breaks():
    """From above with its cohesion, from below without; its least load is not asked of joints that keep theirs."""
    bond = flat(friction=0.5, cohesion=1e3, tension=5e2, friction_residual=0.4)
    found = solved(bond, bounds=("lower",))
    assert found.associated.multiplier == pytest.approx(0.5 + 1e3 / (0.2 * WEIGHT), rel=NEAR)
    assert found.lower.multiplier == pytest.approx(0.4 * 1.0, rel=1e-5)
    with pytest.raises(UsageError, match="leave --least out"):
        solved(bond, bounds=("least",))


def test_joints_that_dilate_for_ever_are_between():
    """The reduced domain has |T| ≤ tan ψ N at least."""
    case = flat(friction=0.5, dilation_deg=10.0)
    assert solved(case, bounds=("lower",)).lower.reduced_domain == pytest.approx(np.tan(np.radians(10.0)), rel=1e-5)


def test_laws_are_mixed_joint_by_joint():
    """The upper of two blocks is glued, so that they slide as one on the lower joint; or the other way round."""
    blocks = [block(f"b{i}", rectangle(0.0, 0.2 * i, 1.0, 0.2 * i + 0.2), material=f"m{i}") for i in range(2)]
    case = on_a_base(*blocks, materials={name: {"density": 2000.0} for name in ("ground", "m0", "m1")})
    case["block"][0]["material"] = "ground"
    case["joints"]["glue"] = {"law": "mohr-coulomb", "friction": 0.6, "cohesion": 1e4}
    case["interface"] = [{"between": ["m0", "m1"], "joint": "glue"}]
    assert load(case) == pytest.approx(0.6, rel=1e-5)
    case["interface"] = [{"between": ["ground", "m0"], "joint": "glue"}]
    case["joints"]["dry"]["friction"] = 0.7
    case["joints"]["glue"]["cohesion"] = 0.15 * 0.4 * WEIGHT
    assert load(case) == pytest.approx(0.7, rel=1e-5)  # the upper joint; the lower one holds 0.75
    case["joints"]["glue"]["cohesion"] /= 3.0
    assert load(case) == pytest.approx(0.65, rel=1e-5)


def test_barton_s_friction_is_curved():
    case = flat(friction=0.5)
    case["joints"]["dry"] = {"law": "barton", "jrc": 8.0, "jcs": 5e7, "residual_angle_deg": 28.0}
    with pytest.raises(UsageError, match="law 'barton' is curved"):
        solved(case)
