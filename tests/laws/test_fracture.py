"""Fracture-energy softening, against its closed form by Lambert's W: tension, shear, both, and what they take."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp
from pydantic import ValidationError
from scipy.special import lambertw

from dem_cli.core.laws.displacement_path import drive

KN, KS, AREA = 8.0e10, 3.6e10, 0.01
FT, C, G1, G2, MU = 0.25e6, 0.35e6, 18.0, 125.0, 0.75  # a brick and mortar joint
KEYS = {"friction": MU, "tension": FT, "cohesion": C, "fracture_energy_tension": G1, "fracture_energy_shear": G2}
CRACK = joint("fracture", **KEYS)
PEAK, CUT = FT * AREA, C * AREA
STIFF_N, STIFF_S = KN * AREA, KS * AREA
TOP = PEAK / STIFF_N  # opening at the peak [m]


def along(path, law=CRACK, **options):
    return drive(law.law, law.table, path, **{"kn": KN, "ks": KS, "area": AREA} | options)


def on_decay(far, stiffness, drop, rate):
    """Force of a spring in series with a decay: stiffness (far − w) = drop exp(−rate w), by Lambert's W."""
    return -stiffness / rate * lambertw(-rate * drop / stiffness * np.exp(-rate * far)).real


def tension(opening):
    """Tension of a joint that opens for the first time [N]."""
    return np.where(opening <= TOP, STIFF_N * opening, on_decay(opening, STIFF_N, PEAK, FT / G1))


def sheared(slide, normal, residual=MU):
    """Shear force of a joint that slides for the first time under a constant normal force [N]."""
    drop = CUT + (MU - residual) * normal
    rest = slide - residual * normal / STIFF_S
    soft = residual * normal + on_decay(rest, STIFF_S, drop, C / G2)
    return np.where(STIFF_S * slide <= CUT + MU * normal, STIFF_S * slide, soft)


def test_tension_softens_to_its_energy():
    far, n = 12 * G1 / FT, 4000
    done = along(np.concatenate([[(TOP, 0.0)], ramp((far, 0.0), n=n, start=(TOP, 0.0))]))
    np.testing.assert_allclose(-done.normal, tension(done.path[:, 0]), rtol=1e-9)
    left = np.exp(-FT / G1 * (far + done.normal[-1] / STIFF_N))
    np.testing.assert_allclose(done.memory[-1, 0], left, rtol=1e-9)
    # The energy of the crack: trapezoid rule of an exponential in steps of 0.003 G_I/ft, 0.003² / 12.
    assert done.lost[-1] == pytest.approx(G1 * AREA * (1 - left), rel=1.1 * 0.003**2 / 12)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)


def test_tension_energy_converges_with_the_square_of_the_step():
    far, errors = 3 * G1 / FT, []
    for n in (100, 200, 400):
        done = along(np.concatenate([[(TOP, 0.0)], ramp((far, 0.0), n=n, start=(TOP, 0.0))]))
        errors.append(done.lost[-1] / (G1 * AREA * (1 - done.memory[-1, 0])) - 1.0)
    assert errors[0] == pytest.approx((3 / 100) ** 2 / 12, rel=0.1)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize(("normal", "residual"), [(0.0, MU), (2.0 * CUT, MU), (2.0 * CUT, 0.5)])
def test_shear_softens_to_its_energy_and_friction(normal, residual):
    law, far, n = joint("fracture", **KEYS, friction_residual=residual), 12 * G2 / C, 8000
    closed = -normal / STIFF_N
    done = along(ramp((closed, 0.0), (closed, far), n=n), law)
    np.testing.assert_allclose(-done.shear[n:, 0], sheared(done.path[n:, 1], normal, residual), rtol=1e-9)
    slip = done.path[-1, 1] + done.shear[-1, 0] / STIFF_S
    energy = (G2 * AREA + (MU - residual) * normal * G2 / C) * (1 - np.exp(-C / G2 * slip)) + residual * normal * slip
    assert done.lost[-1] == pytest.approx(energy, rel=2e-5)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)


def test_tension_unloads_and_reloads_by_the_secant():
    wide, n = 5 * TOP, 1000
    done = along(ramp((wide, 0.0), (0.0, 0.0), (-TOP, 0.0), (0.0, 0.0), (2 * wide, 0.0), n=n))
    gap, peak = done.path[:, 0], tension(wide)
    np.testing.assert_allclose(-done.normal[n : 2 * n], peak * gap[n : 2 * n] / wide, rtol=1e-9, atol=1e-9 * PEAK)
    # Pressed it is as stiff as ever, whatever the damage.
    np.testing.assert_allclose(done.normal[2 * n : 4 * n], -STIFF_N * gap[2 * n : 4 * n], rtol=1e-9, atol=1e-9 * PEAK)
    again, first = gap[4 * n :], gap[4 * n :] <= wide
    np.testing.assert_allclose(-done.normal[4 * n :][first], peak * again[first] / wide, rtol=1e-9)
    np.testing.assert_allclose(-done.normal[4 * n :][~first], tension(again[~first]), rtol=1e-9)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)
    # The books hold what the secant gives back for lost until it does; in the end it is the energy of the crack.
    back = done.lost[n - 1] - done.lost[2 * n - 1]
    assert back == pytest.approx(0.5 * peak * (wide - peak / STIFF_N), rel=1e-9)


def test_unloading_between_steps_changes_nothing():
    """Opened in one go or with a hundred detours down the secant: the same curve."""
    straight = along(ramp((6 * TOP, 0.0), n=600))
    detours = np.concatenate([[(g, 0.0), (0.3 * g, 0.0)] for g in straight.path[:, 0]])
    done = along(detours)
    np.testing.assert_allclose(done.normal[::2], straight.normal, rtol=1e-9)


def test_shear_reverses_on_the_softened_limit():
    n, normal, far = 2000, CUT, G2 / C
    closed = -normal / STIFF_N
    done = along(ramp((closed, 0.0), (closed, far), (closed, -far), n=n))
    sliding = np.flatnonzero(np.diff(done.slip) > 0.0) + 1
    limit = CUT * np.exp(-C / G2 * done.slip[sliding]) + MU * normal
    np.testing.assert_allclose(np.abs(done.shear[sliding, 0]), limit, rtol=1e-9)
    assert done.shear[-1, 0] > 0.0
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)


def test_one_strength_for_both():
    """Opened until 40 % of the strength is left, the joint has 40 % of its cohesion, and the other way round."""
    w = G1 / FT * np.log(1 / 0.4)
    wide = w + 0.4 * PEAK / STIFF_N
    for share, slips in ((0.999, False), (1.001, True)):
        slide = share * (0.4 * CUT + MU * PEAK) / STIFF_S
        done = along(ramp((wide, 0.0), (-TOP, 0.0), (-TOP, slide), n=500))
        assert done.memory[499, 0] == pytest.approx(0.4, rel=1e-9)
        assert (done.memory[-1, 0] < 0.4 * (1 - 1e-6)) == slips
    slid = G2 / C * np.log(1 / 0.4)
    slide = slid + 0.4 * CUT / STIFF_S
    done = along(ramp((0.0, slide), (2 * TOP, slide), n=2000))
    # Pulled, it slips a little further; what it carries is what is left.
    assert np.all(-done.normal <= done.memory[:, 0] * PEAK * (1 + 1e-12))
    assert -done.normal.min() == pytest.approx(0.4 * PEAK, rel=0.1)


def test_never_beyond_the_limit_in_mixed_mode():
    t = np.linspace(0.0, 1.0, 4001)[1:]
    path = np.column_stack([3 * TOP * np.sin(9 * t) * t, 2 * G2 / C * t * np.cos(13 * t), G2 / C * t * np.sin(17 * t)])
    law = joint("fracture", **KEYS, friction_residual=0.5)
    done = along(path, law)
    s = done.memory[:, 0]
    limit = np.maximum(s * CUT + (0.5 + (MU - 0.5) * s) * done.normal, 0.0)
    assert np.all(np.linalg.norm(done.shear, axis=1) <= limit * (1 + 1e-9) + 1e-9 * CUT)
    assert np.all(-done.normal <= s * PEAK * (1 + 1e-9))
    assert np.all(np.diff(s) <= 0.0)
    assert s[-1] < 0.2
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-9)
    columns = np.tile(law.law.columns(law.table, KN), (len(s), 1))
    np.testing.assert_allclose(law.law.shear_limit(columns, done.normal, done.memory, np.full(len(s), STIFF_N)), limit)


def test_a_crack_is_a_coulomb_joint():
    """Points that meet later have the friction of the crack; so has a joint that was pulled right apart."""
    path = ramp((-TOP, 0.0), (-TOP, 1e-4), (TOP, 1e-4), (0.0, 0.0), (-TOP, 0.0), (-TOP, -1e-4))
    plain, later = along(path, joint("coulomb", friction=MU)), along(path, touches=False)
    np.testing.assert_allclose(later.normal, plain.normal, rtol=1e-12)
    np.testing.assert_allclose(later.shear, plain.shear, rtol=1e-12)
    apart = np.concatenate([ramp((30 * G1 / FT, 0.0), (0.0, 0.0)), path])
    done = along(apart)
    assert done.memory[-1, 0] == 0.0
    np.testing.assert_allclose(done.shear[128:], plain.shear, rtol=1e-12)


def test_a_spring_that_holds_more_than_the_crack_takes_jumps():
    """Softer than ft²/G_I: from the peak straight to the lower branch, and the books close."""
    soft = 0.3 * FT**2 / G1
    done = along(ramp((4 * FT / soft, 0.0), n=1000), kn=soft)
    steepest = -np.diff(-done.normal).min()
    assert -done.normal.min() == pytest.approx(PEAK, rel=0.01)
    assert steepest > 0.5 * PEAK
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)


@pytest.mark.parametrize(
    ("bad", "key"),
    [
        ({"tension": 0.6e6}, "tension"),
        ({"friction_residual": 0.8}, "friction_residual"),
        ({"kn": 3.0e9}, "kn"),
        ({"ks": 0.9e9}, "ks"),
        ({"fracture_energy_tension": 0.0}, "fracture_energy_tension"),
    ],
)
def test_what_is_not_a_joint(bad, key):
    with pytest.raises(ValidationError) as caught:
        joint("fracture", **KEYS | bad)
    error = caught.value.errors()[0]
    assert key in (*error["loc"], *getattr(error.get("ctx", {}).get("error"), "keys", ()))
