"""Static and dynamic friction, against its closed form: sticks at μs, slips at μ(v)."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp
from pydantic import ValidationError

from dem_cli.core.laws.displacement_path import drive

KN, KS, N = 2.0e8, 1.0e8, 1.0e3
CLOSED = -N / KN
STATIC, DYNAMIC, VC = 0.6, 0.4, 0.01
STEP = 1e-4  # [s]
RATE = joint("rate-dependent", friction=STATIC, friction_dynamic=DYNAMIC, velocity=VC)


def curve(speed):
    return DYNAMIC + (STATIC - DYNAMIC) * np.exp(-np.abs(speed) / VC)


def along(path, law=RATE, step=STEP):
    return drive(law.law, law.table, path, kn=KN, ks=KS, step=step)


@pytest.mark.parametrize("speed", [0.01 * VC, 0.3 * VC, VC, 30.0 * VC])
def test_steady_slip_has_the_friction_of_its_speed(speed):
    """It sticks up to the static value, then falls to that of the speed; backwards the same."""
    n = 3 + int(4 * STATIC * N / KS / (speed * STEP))
    there = speed * STEP * n
    done = along(ramp((CLOSED, 0.0), (CLOSED, there), (CLOSED, -there / 2), n=n))
    assert -done.shear[2 * n - 1, 0] == pytest.approx(curve(speed) * N, rel=1e-12)
    assert done.shear[-1, 0] == pytest.approx(curve(1.5 * speed) * N, rel=1e-12)
    sticks = done.slip[n : 2 * n] == 0.0
    np.testing.assert_allclose(done.shear[n : 2 * n, 0][sticks], -KS * done.path[n : 2 * n, 1][sticks], rtol=1e-9)
    step = KS * speed * STEP / N
    if step < STATIC:
        assert STATIC - step < -done.shear.min() / N <= STATIC
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)


def test_follows_the_curve_up_and_down():
    """A block that is sped up and slowed down goes down the curve and up again."""
    speeds = VC * np.concatenate([np.linspace(0.0, 3.0, 300), np.linspace(3.0, 0.02, 300)])
    slides = np.concatenate([[0.0], np.cumsum(speeds * STEP)])
    done = along([(CLOSED, slide) for slide in slides])
    slips = np.diff(done.slip) > 0.0
    assert slips.sum() > 550
    np.testing.assert_allclose(-done.shear[1:, 0][slips], curve(speeds[slips]) * N, rtol=1e-9)
    limit = RATE.law.shear_limit(np.tile(RATE.columns, (600, 1)), done.normal[1:], done.memory[1:], np.ones(600))
    np.testing.assert_allclose(limit, np.where(slips, -done.shear[1:, 0], STATIC * N), rtol=1e-12)


def test_sticks_again_and_then_needs_the_static_force():
    """Stopped, unloaded by a micron and pushed on: it holds up to μs N."""
    fast, slow = 10 * VC * STEP, 1e-3 * VC * STEP
    slides = np.cumsum([0.0, *[fast] * 10, *[-slow] * 1000, *[slow] * 5000])
    done = along([(CLOSED, slide) for slide in slides])
    assert -done.shear[10, 0] == pytest.approx(curve(10 * VC) * N, rel=1e-12)
    held = np.flatnonzero(np.diff(done.slip[10:]) > 0.0)[0] + 10
    assert held > 1010
    assert -done.shear[held, 0] == pytest.approx(STATIC * N, rel=KS * slow / N / STATIC)
    assert -done.shear[-1, 0] == pytest.approx(curve(1e-3 * VC) * N, rel=1e-12)


def test_without_time_it_is_static_friction():
    path = ramp((CLOSED, 0.0), (CLOSED, 1e-3), (CLOSED, -1e-3), (2 * CLOSED, 1e-3))
    done, plain = along(path, step=np.inf), along(path, joint("coulomb", friction=STATIC))
    np.testing.assert_allclose(done.shear, plain.shear, rtol=1e-12)
    np.testing.assert_allclose(done.lost, plain.lost, rtol=1e-12)


def test_speed_in_space():
    planar = along(ramp((CLOSED, 0.0), (CLOSED, 1e-4), (CLOSED, -1e-4), n=200))
    space = along(ramp((CLOSED, 0.0, 0.0), (CLOSED, 0.6e-4, 0.8e-4), (CLOSED, -0.6e-4, -0.8e-4), n=200))
    np.testing.assert_allclose(space.shear, planar.shear * [0.6, 0.8], rtol=1e-9, atol=1e-9 * N)


def test_dynamic_is_at_most_static():
    with pytest.raises(ValidationError, match="more than the static friction"):
        joint("rate-dependent", friction=0.4, friction_dynamic=0.6, velocity=VC)
