"""One contact point driven along displacement paths through the contact loop, plain and compiled.

Asserted: the closed form, the uncompiled law bit by bit, and external work = elastic + friction.
"""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp, through_loop

from dem_cli.core.laws.displacement_path import drive

KN, KS, MU = 2.0e6, 1.0e6, 0.5
CLOSED = -(2.0**-16)  # gap [m]
LIMIT = MU * KN * -CLOSED  # of the shear force [N]
YIELD = LIMIT / KS  # slide at which a point starts to slip [m]
JOINT = joint("coulomb", {"kn": KN, "ks": KS}, friction=MU)


def through(path, compiled=True, start=0.0):
    """The point moved through the loop: normal (n,), shear (n, d − 1), and sums over the path."""
    return through_loop([JOINT], path, compiled=compiled, start=start)


U = 2.0**-15
PATHS = {
    "closing": ramp((CLOSED, 0.0)),
    "sliding": ramp((CLOSED, 0.0), (CLOSED, 4 * U)),
    "unloading": ramp((CLOSED, 0.0), (CLOSED, 4 * U), (CLOSED, 3.75 * U)),
    "to and fro": ramp((CLOSED, 0.0), (CLOSED, 4 * U), (CLOSED, -4 * U), (CLOSED, 4 * U)),
    "opening": ramp((CLOSED, 0.0), (CLOSED, U / 8), (0.0, U / 8), (-CLOSED, U), (0.0, U), (CLOSED, U)),
    "pressing while sliding": ramp((CLOSED, 0.0), (8 * CLOSED, 4 * U), (CLOSED, 8 * U)),
    "around a corner": ramp((CLOSED, 0.0, 0.0), (CLOSED, 4 * U, 0.0), (CLOSED, 4 * U, 4 * U)),
    "opening in space": ramp((CLOSED, 0.0, 0.0), (CLOSED, U / 8, U / 4), (0.0, U, U), (-CLOSED, U, U)),
}
each_path = pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)


@each_path
def test_loop_law_and_compiled_loop_agree(path):
    compiled, plain, alone = (
        through(path),
        through(path, compiled=False),
        drive(JOINT.law, JOINT.table, path, kn=KN, ks=KS),
    )
    assert np.array_equal(compiled.normal, plain.normal)
    assert np.array_equal(compiled.shear, plain.shear)
    assert np.array_equal(compiled.slip, plain.slip)
    assert np.array_equal(compiled.lost, plain.lost)
    assert np.array_equal(compiled.normal[:, 0], alone.normal)
    assert np.array_equal(compiled.shear[:, 0], alone.shear)


@each_path
def test_work_is_elastic_energy_and_friction(path):
    """To round-off: the loop books the mean of the forces really applied."""
    done = through(path)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-12)
    assert done.lost[-1] >= 0.0


@each_path
def test_never_beyond_the_limit_and_never_in_tension(path):
    done = through(path)
    assert np.all(done.normal >= 0.0)
    assert np.all(np.linalg.norm(done.shear, axis=2) <= MU * done.normal * (1 + 1e-14))


def test_slides_and_comes_back():
    """Slide u, back until it slips the other way at u − 2 μN/ks; the loop's area is the friction work."""
    there, back = 2 * U, -2 * U
    done = through(ramp((CLOSED, 0.0), (CLOSED, there), (CLOSED, back), (CLOSED, there), n=256))
    steps = np.arange(1, 257) / 256
    first = -np.minimum(KS * there * steps, LIMIT)
    second = np.minimum(-LIMIT + KS * 4 * U * steps, LIMIT)
    np.testing.assert_allclose(done.shear[256:, 0, 0], [*first, *second, *-second], rtol=0, atol=1e-12 * LIMIT)
    slipped = (there - YIELD) + 2 * (4 * U - 2 * YIELD)
    assert done.slip[-1, 0] == pytest.approx(slipped, rel=1e-12)
    assert done.lost[-1] == pytest.approx(LIMIT * slipped, rel=1e-12)


def test_elastic_below_the_limit():
    """No work is lost in a thousand cycles, and the force comes back to zero."""
    cycle = ramp((CLOSED, 0.9 * YIELD), (CLOSED, -0.9 * YIELD), n=8)
    done = through(np.concatenate([ramp((CLOSED, 0.0)), *[cycle] * 1000, [(CLOSED, 0.0)]]))
    assert done.lost[-1] == 0.0
    assert done.slip[-1, 0] == 0.0
    assert abs(done.shear[-1, 0, 0]) < 1e-9 * LIMIT


def test_opening_gives_the_stored_shear_to_friction():
    done = through(ramp((CLOSED, 0.0), (CLOSED, 0.5 * YIELD), (0.0, 0.5 * YIELD), (-CLOSED, 0.5 * YIELD)))
    assert done.normal[-1, 0] == 0.0
    assert done.elastic[-1] == 0.0
    assert done.lost[-1] == pytest.approx(0.5 * KS * (0.5 * YIELD) ** 2, rel=1e-12)
    # While it unloads the limit falls below the shear force; the path of the slip is the lost stretch
    # of the spring but for the last step, in which the point opens.
    assert 0.45 * YIELD < done.slip[-1, 0] <= 0.5 * YIELD


def test_a_point_that_closes_again_starts_from_nothing():
    path = ramp((CLOSED, U / 8), (-CLOSED, U / 8), (-CLOSED, U), (CLOSED, U), (CLOSED, U + U / 16))
    done = through(path)
    assert done.shear[-1, 0, 0] == pytest.approx(-KS * U / 16, rel=1e-9)
    assert done.normal[-1, 0] == pytest.approx(-KN * CLOSED, rel=1e-12)


def test_starts_open():
    """A point with a gap carries nothing until the gap is used up."""
    done = through([(-CLOSED * (1 - t), 0.0) for t in np.arange(1, 17) / 8], start=-CLOSED)
    assert not done.normal[:8].any()
    assert np.all(np.diff(done.normal[7:, 0]) > 0.0)
    assert done.normal[-1, 0] == pytest.approx(-KN * CLOSED, rel=1e-12)


def test_lag_behind_a_turning_slide():
    """Slide along a circle of radius R: the force trails the motion by asin(μN/(ks R)), of size μN."""
    radius, n = 5 * YIELD, 4000
    angles = np.linspace(0.0, 6 * np.pi, 3 * n + 1)[1:]
    circle = [(CLOSED, radius * np.sin(t), radius * (1 - np.cos(t))) for t in angles]
    done = through(np.concatenate([ramp((CLOSED, 0.0, 0.0)), circle]))
    force = -done.shear[-1, 0]
    lag = angles[-1] - np.arctan2(force[1], force[0])
    lag = (lag + np.pi) % (2 * np.pi) - np.pi
    assert np.hypot(*force) == pytest.approx(LIMIT, rel=1e-14)
    assert lag == pytest.approx(np.arcsin(YIELD / radius), abs=1.5 * np.pi / n)
    last_turn = done.lost[-1] - through(np.concatenate([ramp((CLOSED, 0.0, 0.0)), circle[: 2 * n]])).lost[-1]
    expected = LIMIT * np.sqrt(1 - (YIELD / radius) ** 2) * 2 * np.pi * radius
    assert last_turn == pytest.approx(expected, rel=1e-3)
