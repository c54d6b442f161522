"""Joints in space that crack: a run says that their few points carry more than a joint that cracks bit by bit."""

from __future__ import annotations

import pytest
from engine import solve
from studies.space.structures import box, tables

JOINTS = {"friction": 0.7, "cohesion": 1e5, "law": "mohr-coulomb"}


@pytest.mark.parametrize(("tension", "said"), [(3e4, 1), (0.0, 0)])
def test_tension_at_few_points_is_said(tension, said):
    ground = box("ground", (-1.0, -1.0, -1.0), (2.0, 2.0, 0.0), fixed=True)
    block, joints = box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 3.0)), {"dry": {**JOINTS, "tension": tension}}
    case = tables(ground, block, joints=joints)
    summary, _ = solve({**case, "analysis": {"kind": "gravity"}})
    assert sum("crack bit by bit" in text for text in summary["warnings"]) == said
