"""What a run says of its own answer, and how to get one where there is none."""

from __future__ import annotations

import pytest
from engine import block, rectangle, solve, tables

from dem_cli.core.engine import measures

GROUND = block("ground", rectangle(-3, -1, 6, 0), fixed=True)
CRATE = block("crate", rectangle(0, 0, 1, 1))


def said(*blocks: dict, **more) -> str:
    summary, _ = solve(tables(GROUND, *blocks, **more))
    return " | ".join(summary["warnings"])


@pytest.mark.parametrize(("ratio", "warns"), [(0.009, True), (0.01, False), (10.0, False), (11.0, True)])
def test_shear_stiffness_far_from_the_normal_one(ratio, warns):
    joints = {"dry": {"friction": 0.6, "kn": 1e11, "ks": ratio * 1e11}}
    assert ("ks/kn" in said(CRATE, joints=joints, analysis={"kind": "gravity"})) is warns


def test_a_block_without_weight_is_named():
    """A push from below that leaves nothing of the weight."""
    lift = [{"block": "crate", "force": [0.0, 2000.0 * 9.81 * (1 - 1e-13)]}]
    heavy = block("heavy", rectangle(2, 0, 3, 1))
    assert "'crate'" in said(CRATE, heavy, load=lift, analysis={"kind": "gravity", "max_steps": 20_000})
    assert "weight" not in said(CRATE, heavy, analysis={"kind": "gravity"})


def test_what_to_do_where_steps_end():
    """The bracket so far, the key to raise, and the blocks that make it slow."""
    light = block("light", rectangle(0, 1, 1, 1.2), material="cork")
    materials = {"stone": {"density": 2000.0}, "cork": {"density": 0.002}}
    blocks = [{**GROUND, "material": "stone"}, {**CRATE, "material": "stone"}, light]
    summary, _ = solve(tables(*blocks, materials=materials, analysis={"max_steps": 60_000}))
    advice = summary["warnings"][-1]
    assert summary["status"] == "not converged"
    assert f"the failure load was not found: it stands at {summary['failure_load_bracket'][0]:.5g}" in advice
    assert "fails at" not in advice  # which would read like a failure load
    assert "analysis.max_steps (60,000)" in advice
    assert "'light'" in advice
    assert "'crate'" in advice


def test_nothing_is_said_where_nothing_is_doubtful():
    assert said(CRATE) == ""


@pytest.mark.parametrize(
    ("softness", "points", "warns"), [(1e3, 2, True), (1e5, 2, False), (1e5, None, True), (1e8, None, False)]
)
def test_soft_given_joints_under_geometry_that_moves(softness, points, warns):
    """A slender block that leans on its joint.

    With points at its ends 1.8 and 0.06 % below the load on a stiff one; where its face presses in part 5 and 0.4 %.
    """
    needle = block("needle", rectangle(0, 0, 0.25, 1))
    joint = {"friction": 1.0, "kn": softness * 0.25 * 2000.0 * 9.81 / (0.5 * 0.25)}
    joint |= {} if points is None else {"points": points}
    text = said(needle, joints={"dry": joint}, analysis={"kinematics": "large", "follow": 0.0})
    assert ("of their width" in text) is warns


@pytest.mark.parametrize(
    ("share", "more", "warns"), [(0.002, {}, False), (0.004, {}, True), (0.004, {"kn": 1e11}, False)]
)
def test_rigid_blocks_that_overlap(share, more, warns, monkeypatch):
    """Joints of kn = "auto" show no closure at rest; those of a given stiffness sink in by what it gives."""
    monkeypatch.setattr(measures, "largest_overlap", lambda sim: share * sim.smallest)
    joints = {"dry": {"friction": 0.6} | more}
    warned = said(CRATE, joints=joints, analysis={"kind": "gravity", "kinematics": "large"})
    assert ("rigid blocks overlap by 0.4%" in warned) is warns
