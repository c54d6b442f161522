"""What is recorded changes nothing, and what a scene does not need is not made."""

from __future__ import annotations

import numpy as np
from casefiles import CASES
from engine import block, rectangle, solve, tables

from dem_cli.core.engine import simulation as engine

GROUND = block("ground", rectangle(-2, -1, 6, 0), fixed=True)


def test_frames_change_nothing():
    """A frame measures the joints; measuring must not ask for detections."""
    case = CASES / "verification" / "portal.toml"
    (some, many), (none, few) = (solve(case, f"output.frames={n}") for n in (200, 0))
    assert len(many.frames) > 100
    assert few.frames == []
    assert [row[:7] for row in many.rows] == [row[:7] for row in few.rows]
    assert some["failure_load"] == none["failure_load"]


def test_a_scene_with_gaps_makes_no_fixed_geometry(monkeypatch):
    made = []
    real = engine.compiled_advance
    monkeypatch.setattr(engine, "compiled_advance", lambda *which: made.append(which[0]) or real(*which))
    gap = 2e-4
    blocks = [GROUND, block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(1 + gap, 0, 2, 1))]
    summary, _ = solve(tables(*blocks, friction=0.6))
    assert set(made) == {"large"}
    assert np.isclose(summary["failure_load"], 0.6, rtol=2e-3)


def test_falls_at_the_first_push_and_is_followed():
    """A block on the verge of toppling: a failure load of nearly nothing, and its collapse."""
    leaning = [[0.0, 0.0], [0.5, 0.0], [0.9999, 1.0], [0.4999, 1.0]]
    summary, _ = solve(tables(GROUND, block("b", leaning), analysis={"follow": 0.1}))
    assert summary["status"] == "ok"
    assert 0.0 <= summary["failure_load"] < 1e-3
