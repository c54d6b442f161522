"""Tuple algebra: the compiled functions give the bits of the plain ones, in every length."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from dem_cli.core.kernels import vec

RNG = np.random.default_rng(5)
ROWS = RNG.normal(size=(4, 18))
TUPLES = {n: tuple(map(float, RNG.normal(size=n))) for n in (1, 2, 3)}
OTHERS = {n: tuple(map(float, RNG.normal(size=n))) for n in (1, 2, 3)}
LIKE = {2: (0.0, 0.0), 3: (0.0, 0.0, 0.0)}


@numba.njit(error_model="numpy")
def algebra(x, y):
    return vec.axpy(0.3, x, y), vec.scale(-1.7, x), vec.dot(x, y), vec.norm(x)


@numba.njit(error_model="numpy")
def memory(array, x):
    found = vec.load(array, 1, 2, x)
    vec.add_at(array, 2, 1, x, -1.0)
    vec.store(array, 3, 4, x)
    return found


@numba.njit(error_model="numpy")
def frames(rows, vector, spin):
    frame = vec.load_frame(rows, 0, vector)
    levers = vec.load_levers(rows, 1, 0, vector), vec.load_levers(rows, 1, 1, vector)
    normal, tangents = vec.components(frame, vector)
    return (
        frame,
        levers,
        (normal, tangents),
        vec.compose(frame, normal, tangents, vector),
        vec.turn(levers[1], spin),
        vec.add_torques(levers[0], normal, tangents, spin),
    )


@pytest.mark.parametrize("n", [1, 2, 3])
def test_algebra(n):
    compiled = algebra(TUPLES[n], OTHERS[n])
    assert compiled == algebra.py_func(TUPLES[n], OTHERS[n])
    assert compiled[2] == pytest.approx(np.dot(TUPLES[n], OTHERS[n]), rel=1e-14)
    assert compiled[0] == pytest.approx(0.3 * np.array(TUPLES[n]) + OTHERS[n], rel=1e-14)
    assert compiled[3] == pytest.approx(np.linalg.norm(TUPLES[n]), rel=1e-14)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_arrays(n):
    one, two = ROWS.copy(), ROWS.copy()
    assert memory(one, TUPLES[n]) == memory.py_func(two, TUPLES[n]) == tuple(ROWS[1, 2 : 2 + n])
    assert np.array_equal(one, two)
    assert np.array_equal(one[3, 4 : 4 + n], TUPLES[n])
    assert np.count_nonzero(one != ROWS) == 2 * n


@pytest.mark.parametrize("d", [2, 3])
def test_frames_and_levers(d):
    spin = TUPLES[1 if d == 2 else 3]
    assert frames(ROWS, TUPLES[d], spin) == frames.py_func(ROWS, TUPLES[d], spin)


def test_frame_of_the_plane_is_a_frame():
    """Normal, then the normal turned by +90°; a vector is the sum of its components."""
    rows = np.zeros((2, 4))
    rows[0, :2] = 0.6, 0.8
    frame, _, (along, across), _, _, _ = frames(rows, (3.0, -2.0), (0.0,))
    assert frame == ((0.6, 0.8), (-0.8, 0.6))
    assert vec.compose(frame, along, across, LIKE[2]) == pytest.approx((3.0, -2.0), rel=1e-14)


def test_lever_is_the_cross_product():
    """lever · ω = direction · (ω × arm) in space, for every direction of the frame."""
    arm, frame, spin = RNG.normal(size=3), np.linalg.qr(RNG.normal(size=(3, 3)))[0], RNG.normal(size=3)
    row = np.array([[*np.cross(arm, frame).ravel(), *np.zeros(9)]])
    normal, tangents = vec.turn(vec.load_levers(row, 0, 0, LIKE[3]), tuple(spin))
    assert [normal, *tangents] == pytest.approx(frame @ np.cross(spin, arm), rel=1e-12)
    torque = vec.add_torques(vec.load_levers(row, 0, 0, LIKE[3]), 2.0, (3.0, -1.0), LIKE[3])
    assert torque == pytest.approx(np.cross(arm, np.array([2.0, 3.0, -1.0]) @ frame), rel=1e-12)
