"""Joints that crack or are crushed: a run says what few points carry over a joint that goes bit by bit."""

from __future__ import annotations

import pytest
from engine import block, rectangle, solve
from engine import tables as plane_tables
from studies.space.structures import box, tables

JOINTS = {"friction": 0.7, "cohesion": 1e5, "law": "mohr-coulomb"}


@pytest.mark.parametrize(
    ("tension", "points", "said"),
    [
        (3e4, "vertices", "3 times"),
        (3e4, "vertices+centre", "2.33 times"),
        (3e4, 5, "1.26 times"),
        (3e4, 3, "1.35 times"),
        (3e4, "section", ""),
        (3e4, None, ""),
        (0.0, 5, ""),
    ],
)
def test_tension_at_few_points_is_said(tension, points, said):
    ground = box("ground", (-1.0, -1.0, -1.0), (2.0, 2.0, 0.0), fixed=True)
    block, joints = (
        box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 3.0)),
        {"dry": {**JOINTS, "tension": tension} | ({} if points is None else {"points": points})},
    )
    case = tables(ground, block, joints=joints)
    summary, _ = solve({**case, "analysis": {"kind": "gravity"}})
    found = [text for text in summary["warnings"] if "goes bit by bit" in text]
    assert [said in text for text in found] == ([True] if said else [])


def test_crushing_at_few_points_is_said():
    """In the plane: corners alone carry up to twice of a stress block."""
    base, stone = block("base", rectangle(-1.0, -1.0, 2.0, 0.0), fixed=True), block("b", rectangle(0.0, 0.0, 1.0, 1.0))
    joint = {"law": "crushing", "friction": 0.6, "compression": 1e6}
    for points, said in ((2, "crushed 1.06 to 2 times"), ("section", "")):
        case = plane_tables(base, stone, joints={"dry": {**joint, "points": points}}, analysis={"kind": "gravity"})
        summary, _ = solve(case)
        found = [text for text in summary["warnings"] if "goes bit by bit" in text]
        assert [said in text for text in found] == ([True] if said else [])
