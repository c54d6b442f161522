"""Friction that wears off with the slip, against the curve solved by Lambert's W."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp
from scipy.special import lambertw

from dem_cli.core.laws.displacement_path import drive

KN, KS, N = 2.0e8, 1.0e8, 1.0e3
CLOSED = -N / KN
MU, R, S0 = 0.6, 0.483, 0.02
WORN = joint("slip-degrading", friction=MU, residual=R, slip_scale=S0)


def curve(slip):
    return MU * (R + (1.0 - R) * np.exp(-slip / S0))


def along(path, law=WORN):
    return drive(law.law, law.table, path, kn=KN, ks=KS)


def one_way(slide):
    """Slip at a slide u one way from rest: ks (u − S) = N μ (r + (1 − r) exp(−S / S0)), by Lambert's W."""
    rest = slide - R * MU * N / KS
    x = -lambertw(-(1 - R) * MU * N / (KS * S0) * np.exp(-rest / S0)).real * S0
    return rest - x


def test_slides_down_the_curve():
    peak = MU * N / KS
    path = np.concatenate([[(CLOSED, 0.0), (CLOSED, peak)], ramp((CLOSED, 5 * S0), n=2000, start=(CLOSED, peak))])
    done = along(path)
    slide, slip, sliding = done.path[:, 1], done.slip, done.slip > 0.0
    np.testing.assert_allclose(slip[sliding], one_way(slide[sliding]), rtol=1e-12)
    np.testing.assert_allclose(-done.shear[:, 0][sliding], curve(slip[sliding]) * N, rtol=1e-12)
    end = slip[-1]
    work = N * MU * (R * end + (1 - R) * S0 * (1 - np.exp(-end / S0)))
    # Trapezoid rule of an exponential: (h / S0)² / 12.
    assert done.lost[-1] == pytest.approx(work, rel=(5 / 2000) ** 2 / 12)


def test_reversed_and_in_a_circle_it_is_the_path_that_counts():
    done = along(ramp((CLOSED, 0.0), (CLOSED, S0), (CLOSED, 0.0), (CLOSED, S0), n=1000))
    sliding = np.flatnonzero(np.diff(done.slip) > 0.0) + 1
    np.testing.assert_allclose(np.abs(done.shear[sliding, 0]), curve(done.slip[sliding]) * N, rtol=1e-12)
    assert done.slip[-1] > 2.9 * S0
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)
    t = np.linspace(0.0, 2 * np.pi, 2001)[1:]
    ring = np.column_stack([np.full(2000, CLOSED), S0 * np.sin(t), S0 * (1 - np.cos(t))])
    done = along(np.concatenate([ramp((CLOSED, 0.0, 0.0)), ring]))
    assert np.linalg.norm(done.shear[-1]) == pytest.approx(curve(done.slip[-1]) * N, rel=1e-12)
    assert done.slip[-1] == pytest.approx(2 * np.pi * S0, rel=1e-3)


def test_unloads_with_the_spring():
    done = along(ramp((CLOSED, 0.0), (CLOSED, S0), (CLOSED, S0 - 1e-6)))
    np.testing.assert_allclose(np.diff(done.shear[128:, 0]), KS * 1e-6 / 64, rtol=1e-6)


def test_wears_off_faster_than_the_spring_unloads():
    """S0 of a nanometre: the first slip takes it all, and the books close."""
    soft = joint("slip-degrading", friction=MU, residual=R, slip_scale=1e-9)
    done = along(ramp((CLOSED, 0.0), (CLOSED, 1e-4), n=1000), soft)
    force = -done.shear[1000:, 0] / N
    np.testing.assert_allclose(force[done.slip[1000:] > 0.0], R * MU, rtol=1e-12)
    assert force.max() == pytest.approx(MU, rel=0.02)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)


def test_shear_limit_is_the_curve():
    slips = np.array([0.0, 0.5 * S0, 10 * S0])
    limit = WORN.law.shear_limit(np.tile(WORN.columns, (3, 1)), np.full(3, N), slips[:, None], np.full(3, KN))
    np.testing.assert_allclose(limit, curve(slips) * N, rtol=1e-12)


def test_thirteen_tests_of_the_thesis():
    """With r = 0.483 and S0 = 0.124 m the friction has lost 32 % after the 12 cm before the thirteenth test."""
    stone = joint("slip-degrading", friction=0.6, residual=0.483, slip_scale=0.1243)
    done = along(ramp((CLOSED, 0.0), (CLOSED, 0.12), n=4000), stone)
    assert -done.shear[-1, 0] / N / 0.6 == pytest.approx(0.68, abs=5e-4)
