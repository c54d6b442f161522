"""Hysteresis loops: which parts of a path are one, and energy and damping of a plastic one."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.statics.hysteresis import PathState, energy_between, loops, pairs_of, residual_of


@pytest.mark.parametrize(
    ("path", "pairs"),
    [
        ([1.0, -1.0, 1.0], [(1, 3)]),
        ([1.0, -1.0, 0.0], [(0, 3)]),
        ([1.0, -1.0, 0.0, 2.0, -2.0, 0.0], [(0, 3), (3, 6)]),
        ([1.0, -1.0, 1.0, 2.0, -2.0, 2.0, 0.0], [(1, 3), (4, 6)]),
        ([1.0, 0.0, -1.0, 0.0], [(0, 2), (2, 4)]),
        ([1.0, -1.0], []),
        ([1.0], []),
    ],
)
def test_pairs(path, pairs):
    assert pairs_of(path) == pairs


def test_a_plastic_loop():
    """4 F (u − u_y), damping 2/π (1 − 1/μ); what was not reached makes no loop."""
    load, yields, far = 0.5, 0.01, 0.04
    u = np.array([0.0, yields, far, far - 2 * yields, -far, -far + 2 * yields, far])
    loads = np.array([0.0, load, load, -load, -load, load, load])
    path, force = [far, -far, far, -far], 3000.0
    works = force * np.concatenate([[0.0], np.cumsum(0.5 * (loads[1:] + loads[:-1]) * np.diff(u))])
    states = [PathState(*values, 1.0, work, 0.0) for *values, work in zip(u, loads, works, strict=True)]
    (found,) = loops(path, [0, 2, 4, 6], states, force)
    assert (found.first, found.last) == (1, 3)
    assert found.energy == pytest.approx(force * 4.0 * load * (far - yields))
    assert found.damping == pytest.approx(2.0 / np.pi * (1.0 - yields / far))
    assert found.filled == pytest.approx(1.0 - yields / far)
    assert found.residual == pytest.approx(far - yields)
    assert loops(path, [0, 2, 4], states[:5], force) == []


@pytest.mark.parametrize(
    ("u", "loads", "residual"),
    [
        ([3.0, 1.0, -3.0, -1.0, 3.0], [2.0, 0.0, -2.0, 0.0, 2.0], 1.0),
        ([2.0, -2.0, 2.0], [1.0, -1.0, 1.0], 0.0),
        ([2.0, 1.0, 2.0], [1.0, 0.5, 1.0], None),
        ([2.0, 1.0, 0.0, 1.0, 2.0], [1.0, -1.0, -1.0, -1.0, 1.0], 0.0),
    ],
)
def test_what_a_loop_keeps_without_load(u, loads, residual):
    assert residual_of(np.array(u), np.array(loads)) == residual


@pytest.mark.parametrize(("damped", "energy"), [(0.0, 9.0), (1.5, 7.5), (7.0, 2.0 * 3.0)])
def test_energy_is_that_of_straight_lines_within_what_the_books_say(damped, energy):
    """The live load gave 9 J, of which the run damped so much; by a straight line it is 6 J, which misses a corner."""
    states = [PathState(0.0, 1.0, 1.0, 1.0, 0.0), PathState(3.0, 1.0, 1.0, 10.0, damped)]
    assert energy_between(states, 2.0) == pytest.approx(energy)
