"""The bound of limit analysis beside a safety factor: friction divided by F, in closed form."""

from __future__ import annotations

import pytest
from engine import block, rectangle, solve, tables

from dem_cli.analyses.ensembles.static_bound import Bound
from dem_cli.core.records.statuses import ABOVE
from dem_cli.results.output.summary import exit_code

BASE = block("base", rectangle(-2, -1, 4, 0), fixed=True)
SAFETY = {"kind": "safety", "load": 0.2, "direction": [1.0, 0.0]}


def test_a_factor_that_nothing_explains_is_not_ok(monkeypatch):
    """A block pushed by a fifth of its weight slides at F = 0.6/0.2 = 3; limit analysis is made to say 2.4."""
    case = tables(BASE, block("b", rectangle(0, 0, 1, 1)), friction=0.6, analysis=SAFETY | {"kinematics": "fixed"})
    summary, _ = solve(case)
    assert summary["status"] == "ok"
    assert summary["safety_factor"] == pytest.approx(3.0, rel=2e-3)
    assert "above_the_bound" not in summary
    monkeypatch.setattr("dem_cli.analyses.safety.bound", lambda *given: Bound(2.39, 2.4, 1, 0.0))
    summary, _ = solve(case)
    assert summary["safety_factor"] == pytest.approx(3.0, rel=2e-3)
    assert summary["above_the_bound"]["bound"] == 2.4
    assert summary["above_the_bound"]["explained"] is False
    assert (summary["status"], exit_code(summary)) == (ABOVE, 1)


def test_a_gap_that_closes_explains_a_larger_factor():
    """Alone a block slides at F = 0.3/0.2; with one of friction 0.9 behind a gap of 1 mm both slide at 0.6/0.2."""
    base, first = ({**one, "material": "stone"} for one in (BASE, block("b", rectangle(0, 0, 1, 1))))
    stop = block("stop", rectangle(1.001, 0, 2.001, 1), material="rough")
    case = tables(base, first, stop, analysis=SAFETY)
    case["materials"]["rough"] = {"density": 2000.0}
    case["joints"] = {"dry": {"friction": 0.3}, "held": {"friction": 0.9}}
    case["interface"] = [{"between": ["rough", "stone"], "joint": "held"}]
    summary, _ = solve(case)
    assert summary["limit_analysis"]["impossible_at"] == pytest.approx(1.5, rel=2e-3)
    above = summary["above_the_bound"]
    assert above["displacement"] == pytest.approx(1e-3, rel=0.2)
    assert above["explained"]
    assert summary["status"] == "ok"
    assert 3.0 * 0.998 < summary["safety_factor"] < 3.75


@pytest.mark.parametrize("dimension", [2, 3])
def test_strength_beside_friction_has_a_bound(dimension):
    """A glued block pushed by 0.8 of its weight slides at F = (c A + μ N)/H, c A being half of the weight: 1.375.

    Strength stays after failure, so that points of the joint that reach it first lose nothing.
    """
    weight = 2000.0 * 9.81
    drawn = [BASE, block("b", rectangle(0, 0, 1, 1))]
    if dimension == 3:
        drawn = [{**one, "vertices": [[x, y, z] for x, z in one["vertices"] for y in (0.0, 1.0)]} for one in drawn]
    push = SAFETY | {"load": 0.8, "direction": [1.0] + [0.0] * (dimension - 1)}
    case = tables(*drawn, dimension=dimension, analysis=push)
    strength = {name: share * weight for name, share in (("cohesion", 0.5), ("tension", 0.8))}
    left = {f"{name}_residual": value for name, value in strength.items()}
    case["joints"] = {"glue": {"law": "mohr-coulomb", "friction": 0.6, "points": 2} | strength | left}
    summary, _ = solve(case)
    assert summary["limit_analysis"]["impossible_at"] == pytest.approx(1.375, rel=2e-3)
    assert summary["safety_factor"] == pytest.approx(1.375, rel=4e-3)
    assert summary["status"] == "ok"
