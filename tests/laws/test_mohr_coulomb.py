"""Mohr-Coulomb along displacement paths, against its closed form: bond, residual values, dilation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from lawpaths import joint, ramp
from pydantic import ValidationError

from dem_cli.core.laws.displacement_path import drive

KN, KS, AREA = 2.0e9, 8.0e8, 0.05
C, FT, MU = 0.4e6, 0.2e6, 0.75
CUT, PULL = C * AREA, FT * AREA  # [N]
POINT_KN, POINT_KS = KN * AREA, KS * AREA
BRITTLE = joint("mohr-coulomb", friction=MU, cohesion=C, tension=FT)
BREAKS = PULL / POINT_KN  # opening at which the bond breaks [m]
N = 3.0e4
CLOSED = -N / POINT_KN


def along(path, law=BRITTLE, **options):
    return drive(law.law, law.table, path, **{"kn": KN, "ks": KS, "area": AREA} | options)


def closes(done, **tolerance):
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], **{"rel": 1e-12} | tolerance)
    assert np.diff(done.lost).min() >= -1e-12 * done.lost[-1]


def test_tension_breaks_at_ft():
    """N = −kn g up to ft A, then nothing; pressed again, as a joint without bond."""
    done = along(ramp((2 * BREAKS, 0.0), (0.0, 0.0), (CLOSED, 0.0), (0.0, 0.0), (2 * BREAKS, 0.0), n=400))
    gap = done.path[:, 0]
    intact = np.arange(len(gap)) < np.argmax(gap > BREAKS)
    np.testing.assert_allclose(done.normal, np.where(intact, -POINT_KN * gap, np.maximum(-POINT_KN * gap, 0.0)))
    assert done.normal.min() == pytest.approx(-PULL, rel=2 / 400)
    # The energy of the spring is lost, and half a step of its force.
    assert done.lost[-1] == pytest.approx(0.5 * PULL**2 / POINT_KN, rel=2 / 400)
    closes(done)


@pytest.mark.parametrize("normal", [-0.5 * PULL, 0.0, N])
def test_shear_breaks_at_c_and_falls_to_friction(normal):
    """Paper 002, Figure 2a: c A + μ N, then μ N at once; in tension to nothing."""
    closed, peak = -normal / POINT_KN, CUT + MU * normal
    done = along(ramp((closed, 0.0), (closed, 2 * peak / POINT_KS), n=501))
    force, slide = -done.shear[:, 0], done.path[:, 1]
    broken = POINT_KS * slide > peak
    np.testing.assert_allclose(force, np.where(broken, MU * max(normal, 0.0), POINT_KS * slide), rtol=1e-12, atol=1e-7)
    assert force.max() == pytest.approx(peak, rel=2 / 501)
    np.testing.assert_allclose(done.normal[501:], np.where(broken[501:], max(normal, 0.0), normal), atol=1e-9)
    closes(done)


def test_unloads_and_reverses_before_and_after_failure():
    peak = CUT + MU * N
    whole, far = 0.9 * peak / POINT_KS, 2.0 * peak / POINT_KS
    done = along(ramp((CLOSED, 0.0), (CLOSED, whole), (CLOSED, -whole), (CLOSED, far), (CLOSED, -far), n=1000))
    np.testing.assert_allclose(done.shear[:3000, 0], -POINT_KS * done.path[:3000, 1], rtol=1e-9, atol=1e-6)
    assert done.lost[2999] == 0.0
    back = np.arange(1, 1001) / 1000 * 2 * far
    np.testing.assert_allclose(done.shear[4000:, 0], np.minimum(-MU * N + POINT_KS * back, MU * N), atol=1e-6)
    closes(done)


def test_tension_takes_the_cohesion_with_it():
    """Paper 001: if either fails both are gone, the friction angle is unchanged."""
    done = along(ramp((2 * BREAKS, 0.0), (CLOSED, 0.0), (CLOSED, 1.0e-3), n=100))
    assert done.shear[-1, 0] == pytest.approx(-MU * N, rel=1e-12)
    done = along(ramp((CLOSED, 0.0), (CLOSED, 1.0e-2), (0.5 * BREAKS, 1.0e-2), n=100))
    assert done.normal[-1] == 0.0


def test_points_that_meet_later_have_friction_only():
    path = ramp((CLOSED, 0.0), (CLOSED, 2.0e-3), (0.5 * BREAKS, 2.0e-3))
    strong = joint("mohr-coulomb", friction=MU, cohesion=C, tension=FT, cohesion_residual=C, tension_residual=FT)
    plain = along(path, joint("coulomb", friction=MU))
    later = along(path, strong, touches=False)
    assert np.array_equal(later.normal, plain.normal)
    assert np.array_equal(later.shear, plain.shear)
    assert along(path, strong).shear[-65, 0] == pytest.approx(-CUT - MU * N, rel=1e-12)


@pytest.mark.parametrize("d", [2, 3])
def test_without_bond_it_is_coulomb(d):
    path = ramp((CLOSED, *[0.0] * (d - 1)), (CLOSED, *[1e-3] * (d - 1)), (2 * CLOSED, *[-1e-3] * (d - 1)),
                (0.0, *[0.0] * (d - 1)), (-CLOSED, *[1e-3] * (d - 1)), (CLOSED, *[2e-3] * (d - 1)))  # fmt: skip
    plain, bare = along(path, joint("coulomb", friction=MU)), along(path, joint("mohr-coulomb", friction=MU))
    assert np.array_equal(plain.normal, bare.normal)
    assert np.array_equal(plain.shear, bare.shear)
    np.testing.assert_allclose(bare.lost, plain.lost, rtol=1e-9)


def test_residual_values():
    """After failure c A/2 + 0.6 N in shear; ft A/4 in tension, as a slack tie."""
    tough = joint("mohr-coulomb", friction=MU, cohesion=C, tension=FT,
                  cohesion_residual=0.5 * C, tension_residual=0.25 * FT, friction_residual=0.6)  # fmt: skip
    done = along(ramp((CLOSED, 0.0), (CLOSED, 2e-3), (0.0, 2e-3), (0.0, 0.0), n=500), tough)
    assert done.shear[999, 0] == pytest.approx(-(0.5 * CUT + 0.6 * N), rel=1e-12)
    assert done.shear[-1, 0] == pytest.approx(0.5 * CUT, rel=1e-12)
    closes(done)
    wide, left = 3 * BREAKS, 0.25 * PULL
    done = along(ramp((wide, 0.0), (wide / 2, 0.0), (wide, 0.0), (2 * wide, 0.0), n=600), tough)
    gap, slack = done.path[:, 0], wide - left / POINT_KN
    first, back = slice(0, 600), slice(600, 1800)
    expected = np.where(gap <= BREAKS, POINT_KN * gap, left)[first]
    # What opened at the peak is in the slack from the start: the tie carries its residual value at once.
    np.testing.assert_allclose(-done.normal[first], expected, rtol=1e-9)
    np.testing.assert_allclose(-done.normal[back], np.maximum(POINT_KN * (gap[back] - slack), 0.0), atol=1e-6)
    np.testing.assert_allclose(-done.normal[1800:], left, rtol=1e-9)
    # Where the tie gets slack or taut within a step the trapezoid rule is in error by half a step of its force.
    closes(done, abs=0.5 * left * wide / 1200)


PSI, REACH = math.radians(20.0), 4e-4
TAN = math.tan(PSI)
DILATING = joint("mohr-coulomb", friction=MU, dilation_deg=20.0, dilation_slip=REACH)
YIELD = MU * N / POINT_KS


def slipping(slide):
    """Plastic slip and normal force of a joint that dilates at constant gap, slipping one way from rest."""
    soft = MU * POINT_KN * TAN / POINT_KS
    slip = np.maximum((slide - YIELD) / (1.0 + soft), 0.0)
    slip = np.where(slip < REACH, slip, slide - MU * (N + POINT_KN * TAN * REACH) / POINT_KS)
    return slip, N + POINT_KN * TAN * np.minimum(slip, REACH)


def test_dilates_up_to_the_limiting_slip():
    """At constant gap N grows by kn tan ψ times the slip up to zdil, and the friction with it."""
    far = 6 * REACH
    done = along(ramp((CLOSED, 0.0), (CLOSED, far), n=1000), DILATING)
    slide = done.path[1000:, 1]
    slip, normal = slipping(slide)
    at_rest = slide < YIELD
    np.testing.assert_allclose(done.normal[1000:], normal, rtol=1e-10)
    force = np.where(at_rest, POINT_KS * slide, MU * normal)
    np.testing.assert_allclose(-done.shear[1000:, 0], force, rtol=1e-10)
    np.testing.assert_allclose(done.slip[1000:], slip, rtol=1e-9, atol=1e-15)
    assert done.normal[-1] == pytest.approx(N + POINT_KN * TAN * REACH, rel=1e-12)
    closes(done)


def test_dilation_goes_back_with_the_slip():
    """Paper 002: it decreases when the shear is in the opposite direction; the other way it grows again."""
    n, far = 4000, 0.5 * REACH
    total = YIELD + far * (1.0 + MU * POINT_KN * TAN / POINT_KS)  # slide at which the slip is `far`
    done = along(ramp((CLOSED, 0.0), (CLOSED, total), (CLOSED, -3 * total), n=n), DILATING)
    slip = done.path[:, 1] + done.shear[:, 0] / POINT_KS  # signed, what the spring does not hold
    assert slip[2 * n - 1] == pytest.approx(far, rel=1e-9)
    step = 4 * total / n
    expected = N + POINT_KN * TAN * np.minimum(np.abs(slip), REACH)
    np.testing.assert_allclose(done.normal[n:], expected[n:], rtol=1e-9)
    back = slip[2 * n :]
    assert back.min() < -REACH
    sliding = np.flatnonzero(np.abs(np.diff(slip)) > 1e-3 * step) + 1
    np.testing.assert_allclose(np.abs(done.shear[sliding, 0]), MU * done.normal[sliding], rtol=1e-12)
    closes(done)


def test_two_tangents_are_one_turned():
    """Dilating along (0.6, 0.8) is dilating along (1, 0), turned."""
    targets = [(CLOSED, 0.0), (CLOSED, 3e-4), (CLOSED, -2e-4), (CLOSED, 1e-4)]
    planar = along(ramp(*targets), DILATING)
    spatial = along(ramp(*[(gap, 0.6 * slide, 0.8 * slide) for gap, slide in targets]), DILATING)
    np.testing.assert_allclose(spatial.normal, planar.normal, rtol=1e-9)
    np.testing.assert_allclose(spatial.shear, planar.shear * [0.6, 0.8], rtol=1e-9, atol=1e-6)


def test_dilation_in_space_depends_on_the_distance():
    """Round a corner and back to the start: the opening is that of the signed slip, not of its path."""
    corner = [(CLOSED, 0.0, 0.0), (CLOSED, 3e-4, 0.0), (CLOSED, 3e-4, 3e-4), (CLOSED, 0.0, 3e-4)]
    done = along(ramp(*corner, n=2000), DILATING)
    slip = done.path[:, 1:] + done.shear / POINT_KS
    opened = TAN * np.minimum(np.linalg.norm(slip, axis=1), REACH)
    np.testing.assert_allclose(done.normal[2000:], N + POINT_KN * opened[2000:], rtol=1e-9)
    closes(done)


def test_shear_limit_by_state_of_the_point():
    tough = joint("mohr-coulomb", friction=MU, cohesion=C, tension=FT, cohesion_residual=0.5 * C, friction_residual=0.6)
    columns = np.tile(tough.law.columns(tough.table, KN), (4, 1))
    memory = np.zeros((4, tough.law.n_memory(2)))
    memory[:, 0] = [1.0, -1.0, 0.0, 1.0]
    normal = np.array([N, N, N, -0.5 * PULL])
    limit = tough.law.shear_limit(columns, normal, memory, np.full(4, POINT_KN))
    np.testing.assert_allclose(limit, [CUT + MU * N, 0.5 * CUT + 0.6 * N, 0.6 * N, CUT - MU * 0.5 * PULL])


@pytest.mark.parametrize(
    ("bad", "key"),
    [
        ({"tension": 0.6e6}, "tension"),
        ({"cohesion_residual": 0.5e6}, "cohesion_residual"),
        ({"tension_residual": 0.1e6}, "tension_residual"),
        ({"friction_residual": 0.8}, "friction_residual"),
        ({"dilation_deg": 40.0}, "dilation_deg"),
        ({"cohesion": -1.0}, "cohesion"),
    ],
)
def test_what_is_not_a_joint(bad, key):
    with pytest.raises(ValidationError) as caught:
        joint("mohr-coulomb", **{"friction": MU, "cohesion": C, "tension": FT} | bad)
    error = caught.value.errors()[0]
    assert key in (*error["loc"], *getattr(error.get("ctx", {}).get("error"), "keys", ()))
