"""Hysteresis loops: which parts of a path are one, and energy and damping of a plastic one."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.statics.hysteresis import loops, pairs_of


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
    (found,) = loops(path, [0, 2, 4, 6], u, loads, force)
    assert (found.first, found.last) == (1, 3)
    assert found.energy == pytest.approx(force * 4.0 * load * (far - yields))
    assert found.damping == pytest.approx(2.0 / np.pi * (1.0 - yields / far))
    assert loops(path, [0, 2, 4], u, loads, force) == []
