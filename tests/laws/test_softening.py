"""Friction that falls with the slip, against the curve of thesis Figure 7-10 written out once more."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp
from pydantic import ValidationError

from dem_cli.core.laws.displacement_path import drive

KN, KS, N = 2.0e9, 1.0e9, 1.0e4
CLOSED = -N / KN
MU, BETA, START, LENGTH = 0.6, 0.8, 0.9e-3, 0.1e-3  # thesis 7.5.5
SOFT = joint("coulomb", friction=MU, softening={"residual": BETA, "slip_start": START, "slip_length": LENGTH})


def curve(slip):
    """tan φ over the accumulated slip: three straight lines."""
    return np.interp(slip, [0.0, START, START + LENGTH, 1.0], [MU, MU, BETA * MU, BETA * MU])


def along(path, law=SOFT):
    return drive(law.law, law.table, path, kn=KN, ks=KS)


def test_the_key_chooses_the_law():
    assert SOFT.law.name == "friction-softening"
    assert joint("coulomb", friction=MU).law.name == "coulomb"


def test_sliding_block_of_the_thesis():
    """Figure 7-71: 0.6 N up to 0.9 mm, 0.48 N from 1.0 mm on; the work is the area below the curve."""
    done = along(ramp((CLOSED, 0.0), (CLOSED, 2e-3), n=1000))
    force, slip = -done.shear[:, 0], done.slip
    sliding = slip > 0.0
    np.testing.assert_allclose(force[sliding], curve(slip[sliding]) * N, rtol=1e-12)
    np.testing.assert_allclose(slip, np.maximum(done.path[:, 1] - force / KS, 0.0), rtol=1e-9, atol=1e-15)
    assert force[1000 + 400] == pytest.approx(0.6 * N, rel=1e-12)
    assert force[-1] == pytest.approx(0.48 * N, rel=1e-12)
    area = N * (MU * START + 0.5 * (1 + BETA) * MU * LENGTH + BETA * MU * (slip[-1] - START - LENGTH))
    # Trapezoid rule over steps of 2 µm: only the two kinks within a step are in error.
    assert done.lost[-1] == pytest.approx(area, abs=2e-6 * 0.01 * N)


def test_unloading_is_elastic_and_reversed_slip_counts():
    """What softens is the path of the slip: to and fro it falls as it does one way."""
    there, back = 0.5e-3, -0.5e-3
    done = along(ramp((CLOSED, 0.0), (CLOSED, there), (CLOSED, back), (CLOSED, there), n=4000))
    elastic = np.flatnonzero(np.diff(done.slip) == 0.0)
    elastic = elastic[elastic >= 4000]
    stiffness = np.diff(done.shear[:, 0])[elastic] / np.diff(done.path[:, 1])[elastic]
    np.testing.assert_allclose(stiffness, -KS, rtol=1e-9)
    sliding = np.flatnonzero(np.diff(done.slip) > 0.0) + 1
    np.testing.assert_allclose(np.abs(done.shear[sliding, 0]), curve(done.slip[sliding]) * N, rtol=1e-12)
    assert done.shear[11999, 0] > 0.0 > done.shear[-1, 0]
    assert done.slip[-1] > START + LENGTH
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)


def test_softens_along_a_curve_in_space():
    """Slide round a circle: the force stays on the curve of the path, whichever way it points."""
    radius, angles = 1e-3, np.linspace(0.0, np.pi, 2001)[1:]
    circle = [(CLOSED, radius * np.sin(t), radius * (1 - np.cos(t))) for t in angles]
    done = along(np.concatenate([ramp((CLOSED, 0.0, 0.0)), circle]))
    size, sliding = np.linalg.norm(done.shear, axis=1), done.slip > 0.0
    np.testing.assert_allclose(size[sliding], curve(done.slip[sliding]) * N, rtol=1e-12)
    # The first microns, in which the spring turns from rest, are not slip; from then on it is the arc.
    assert done.slip[-1] == pytest.approx(np.pi * radius, rel=0.01)


@pytest.mark.parametrize("length", [0.0, 1e-7])
def test_a_fall_steeper_than_the_spring_jumps(length):
    """Unloading of the spring feeds the slip: the force drops to the last branch at once, and the books close."""
    soft = joint("coulomb", friction=MU, softening={"residual": 0.5, "slip_start": 2e-5, "slip_length": length})
    done = along(ramp((CLOSED, 0.0), (CLOSED, 1e-4), n=1000), soft)
    force = -done.shear[1064:, 0] / N
    assert set(np.round(force, 9)) <= {*np.round(-done.shear[done.slip == 0.0, 0] / N, 9), 0.6, 0.3}
    jump = np.flatnonzero(np.diff(-done.shear[:, 0]) < -0.1 * N)
    assert len(jump) == 1
    assert done.slip[jump[0]] <= 2e-5 < done.slip[jump[0] + 1]
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)


def test_slip_stays_when_the_joint_opens():
    done = along(ramp((CLOSED, 0.0), (CLOSED, 2e-3), (0.0, 2e-3), (-CLOSED, 4e-3), (0.0, 4e-3), (CLOSED, 4e-3),
                      (CLOSED, 4.1e-3)))  # fmt: skip
    assert done.shear[-1, 0] == pytest.approx(-BETA * MU * N, rel=1e-12)


def test_shear_limit_follows_the_slip():
    columns = np.tile(SOFT.columns, (4, 1))
    slips = np.array([0.0, START, START + 0.25 * LENGTH, 1.0])
    limit = SOFT.law.shear_limit(columns, np.full(4, N), slips[:, None], np.full(4, KN))
    np.testing.assert_allclose(limit, curve(slips) * N, rtol=1e-12)
    abrupt = np.array([[0.6, 0.3, 1e-3, 0.0]] * 2)
    limit = SOFT.law.shear_limit(abrupt, np.ones(2), np.array([[1e-3], [2e-3]]), np.ones(2))
    np.testing.assert_allclose(limit, [0.6, 0.3])


def test_no_softening_is_coulomb():
    plain = joint("coulomb", friction=MU)
    flat = joint("coulomb", friction=MU, softening={"residual": 1.0, "slip_start": 0.0, "slip_length": 0.0})
    path = ramp((CLOSED, 0.0), (CLOSED, 3e-5), (2 * CLOSED, -3e-5), (-CLOSED, 0.0))
    assert np.array_equal(along(path, flat).normal, along(path, plain).normal)
    np.testing.assert_allclose(along(path, flat).shear, along(path, plain).shear, rtol=1e-14)


@pytest.mark.parametrize("bad", [{"residual": 1.2}, {"slip_start": -1e-3}, {"slip_length": -1.0}, {"beta": 0.8}])
def test_wrong_keys(bad):
    with pytest.raises(ValidationError):
        joint("coulomb", friction=MU, softening={"residual": 0.8, "slip_start": 0.0, "slip_length": 0.0, **bad})
