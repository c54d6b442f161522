"""The cap in compression, and joints that never fail."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp

from dem_cli.core.laws.displacement_path import drive
from dem_cli.core.laws.mixed import mixed

KN, KS, AREA = 1.0e10, 5.0e9, 0.02
FC, MU = 8.0e6, 0.6
CAP = FC * AREA
YIELD = CAP / (KN * AREA)  # closing at which it crushes [m]
CRUSHING = joint("crushing", friction=MU, compression=FC)


def along(path, law=CRUSHING, **options):
    return drive(law.law, law.table, path, kn=KN, ks=KS, area=AREA, **options)


def test_crushes_unloads_and_is_crushed_further():
    """N = kn closing up to fc A; unloading with kn, open at the crushed depth, loaded again up the same line."""
    deep, deeper, n = 3 * YIELD, 4 * YIELD, 600
    done = along(ramp((-deep, 0.0), (0.0, 0.0), (YIELD, 0.0), (0.0, 0.0), (-deeper, 0.0), n=n))
    closing = -done.path[:, 0]
    np.testing.assert_allclose(done.normal[:n], np.minimum(KN * AREA * closing[:n], CAP), rtol=1e-12)
    later = np.clip(KN * AREA * (closing[n:] - 2 * YIELD), 0.0, CAP)
    np.testing.assert_allclose(done.normal[n:], later, rtol=1e-9, atol=1e-9 * CAP)
    assert done.memory[-1, 0] == pytest.approx(deeper - YIELD, rel=1e-12)
    # To crush 2 and then one more yield depth takes fc A each; a step holds each kink.
    assert done.lost[-1] == pytest.approx(3 * CAP * YIELD, rel=2 * 4 / n)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=4 / n)
    assert np.diff(done.lost).min() >= 0.0


def test_books_close_exactly_while_it_is_pressed():
    path = ramp((-3 * YIELD, 0.0), (-2.5 * YIELD, 5e-3), (-4 * YIELD, -5e-3), (-3.2 * YIELD, 0.0), n=300)
    done = along(path)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)
    assert np.all(np.abs(done.shear[:, 0]) <= MU * done.normal * (1 + 1e-12))
    sliding = np.diff(done.slip) > 0.0
    np.testing.assert_allclose(np.abs(done.shear[1:, 0])[sliding], MU * done.normal[1:][sliding], rtol=1e-12)


@pytest.mark.parametrize("d", [2, 3])
def test_below_the_cap_it_is_coulomb(d):
    targets = [(-0.9, 0.0), (-0.9, 8.0), (-0.3, -8.0), (0.5, 0.0), (-0.7, 3.0)]
    path = YIELD * ramp(*[(gap, *[slide] * (d - 1)) for gap, slide in targets], n=100)
    plain, capped = along(path, joint("coulomb", friction=MU)), along(path)
    np.testing.assert_allclose(capped.normal, plain.normal, rtol=1e-12)
    np.testing.assert_allclose(capped.shear, plain.shear, rtol=1e-12, atol=1e-12 * CAP)


def test_points_that_come_to_be_in_crushed_stone():
    """Their overlap is a spring beyond the crushed depth alone, up to fc A; of other laws, and mixed, all of it."""
    kn = np.full(4, KN * AREA)
    overlaps, memory = np.array([0.5, 1.5, 2.5, 90.0]) * YIELD, np.array([[0.0], [1.0], [2.0], [3.0]]) * YIELD
    rows = np.tile(CRUSHING.law.columns(CRUSHING.table, KN), (4, 1))
    expected = np.array([0.5, 0.5, 0.5, 1.0]) * CAP
    np.testing.assert_allclose(CRUSHING.law.pressed(rows, overlaps, memory, kn), expected, rtol=1e-12)
    coulomb = joint("coulomb", friction=MU).law
    both = mixed((coulomb, CRUSHING.law))
    numbered = np.column_stack([rows, [0.0, 1.0, 1.0, 0.0]])
    expected[[0, 3]] = kn[0] * overlaps[[0, 3]]
    np.testing.assert_allclose(both.pressed(numbered, overlaps, memory, kn), expected, rtol=1e-12)


def test_elastic_carries_everything():
    """No limit in tension or shear, nothing is lost, and all forces come back."""
    tied = joint("elastic")
    path = ramp((-1e-3, 5e-3), (2e-3, -5e-3), (-1e-3, 1.0), (0.0, 0.0), n=100)
    done = along(path, tied)
    np.testing.assert_allclose(done.normal, -KN * AREA * path[:, 0], rtol=1e-12, atol=1e-3)
    np.testing.assert_allclose(done.shear, -KS * AREA * path[:, 1:], rtol=1e-9, atol=1e-3)
    assert done.lost[-1] == 0.0
    assert abs(done.external[-1]) < 1e-9 * done.external.max()


def test_elastic_points_that_meet_later_come_apart():
    done = along(ramp((-1e-3, 0.0), (-1e-3, 1.0), (0.0, 1.0), (1e-3, 1.0), (0.0, 0.0), (-1e-3, 0.0)), joint("elastic"),
                 touches=False)  # fmt: skip
    assert done.shear[127, 0] == pytest.approx(-KS * AREA * 1.0)
    assert not done.normal[191:320].any()
    assert not done.shear[191:, 0].any()
    assert done.normal[-1] == pytest.approx(KN * AREA * 1e-3)


def test_elastic_has_no_shear_limit():
    tied = joint("elastic")
    limit = tied.law.shear_limit(np.zeros((2, 1)), np.array([0.0, 1.0]), np.ones((2, 1)), np.ones(2))
    assert np.all(np.isinf(limit))
