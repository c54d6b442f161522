"""Joints in space that crack: a run says that their few points carry more than a joint that cracks bit by bit."""

from __future__ import annotations

import pytest
from engine import solve
from studies.space.structures import box, tables

JOINTS = {"friction": 0.7, "cohesion": 1e5, "law": "mohr-coulomb"}


@pytest.mark.parametrize(
    ("tension", "points", "said"),
    [
        (3e4, "vertices", "3 times"),
        (3e4, "vertices+centre", "2 times"),
        (3e4, 5, "1.19 times"),
        (3e4, 3, ""),
        (0.0, 5, ""),
    ],
)
def test_tension_at_few_points_is_said(tension, points, said):
    ground = box("ground", (-1.0, -1.0, -1.0), (2.0, 2.0, 0.0), fixed=True)
    block, joints = (
        box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 3.0)),
        {"dry": {**JOINTS, "tension": tension, "points": points}},
    )
    case = tables(ground, block, joints=joints)
    summary, _ = solve({**case, "analysis": {"kind": "gravity"}})
    found = [text for text in summary["warnings"] if "cracks bit by bit" in text]
    assert [said in text for text in found] == ([True] if said else [])
