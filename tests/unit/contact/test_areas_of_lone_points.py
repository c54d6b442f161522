"""Areas of contact points outside of face joints: those of the stones, whatever they stand on."""

from __future__ import annotations

import pytest
from engine import block, simulation, tables
from scipy.spatial.transform import Rotation


def box(name: str, x, y, z, **more) -> dict:
    return block(name, [(a, b, c) for a in x for b in y for c in z], **more)


def stiffness(stone: dict, reach: float) -> float:
    """Of all points of a stone on a base of so many metres, over kn [m²]."""
    base = box("base", (-reach, reach), (-reach, reach), (-1, 0), fixed=True)
    joints = {"dry": {"friction": 0.6, "kn": 1e9, "ks": 1e9}}
    return simulation({"dimension": 3, **tables(base, stone, joints=joints)}, "large").joints.kn.sum() / 1e9


@pytest.mark.parametrize("reach", [0.2, 2.0, 100.0])
def test_a_corner_has_a_quarter_of_a_face_of_its_stone(reach):
    """By all faces a cube of 0.1 m on a base of 20 m had 125 times its face at a corner: it blew up when it landed."""
    turn = Rotation.align_vectors([[0, 0, 1]], [[1, 1, 1]])[0]
    corners = turn.apply([(x, y, z) for x in (0, 0.1) for y in (0, 0.1) for z in (0, 0.1)])
    assert stiffness(block("c", corners.tolist()), reach) == pytest.approx(0.25 * 0.01, rel=1e-9)


@pytest.mark.parametrize("reach", [2.0, 100.0])
def test_a_face_on_a_large_base_keeps_its_area(reach):
    """It was taken for a sliver and raised to a quarter of the median of all faces."""
    assert stiffness(box("c", (0, 0.5), (0, 0.8), (0, 1.5)), reach) == pytest.approx(0.4, rel=1e-9)
