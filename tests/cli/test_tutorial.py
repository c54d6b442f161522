"""The lesson of docs/tutorial.md is done line by line in a fresh folder; what it prints and says is what runs say."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest
from shown import Reader

PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorial.md"


def test_every_line_and_figure(tmp_path, one_core, can_render):
    Reader(tmp_path, can_render).do(PAGE)
    summaries = {
        name: json.loads((tmp_path / "results" / name / "summary.json").read_text(encoding="utf-8"))
        for name in ("house", "tied", "shaken", "shaken_tied")
    }
    text = " ".join(PAGE.read_text(encoding="utf-8").split())
    pushed, tied = summaries["house"]["failure_load"], summaries["tied"]["failure_load"]
    tie = summaries["tied"]["joint_state"]["ties"]["head"]
    friction = tomllib.loads((tmp_path / "house.toml").read_text(encoding="utf-8"))["joints"]["dry"]["friction"]
    ground = summaries["shaken"]["peak_ground_acceleration"]
    for said in (
        f"carries {tied:.3f} instead of {pushed:.3f}: {tied / pushed - 1:.0%}".replace("%", " %") + " more",
        f"That is {pushed * 96.7501:.1f} kN",
        f"the tie pulls with {tie['force'] / 1e3:.1f} kN",
        f"yields at {3.14e-4 * 2.35e8 / 1e3:.1f} kN",
        f"the failure load beyond {friction:g}",
        f"or {ground / 9.81:.2f} g",
    ):
        assert said in text, said
    assert not tie["yielded"]
    bound = summaries["house"]["limit_analysis"]["associated"]
    assert bound / pushed - 1 == pytest.approx(0.05, abs=0.005)
    assert (tmp_path / "results" / "shaken_tied" / "report.html").is_file()
