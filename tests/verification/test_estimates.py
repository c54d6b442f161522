"""The failure load of an irregular wall is the same, whatever estimate of it the search begins with."""

from __future__ import annotations

from dataclasses import replace

import pytest

import dem_cli
from dem_cli.core.engine.static_settings import LoadSearchSettings
from dem_cli.core.limit.path import Path
from dem_cli.core.statics.failure_load import LoadSearch

WALL = """
[materials.stone]
density = 2100.0
[joints.dry]
friction = 0.65
[[structure]]
id = "w"
kind = "voronoi-wall"
cells = 14
relax = 6
stretch = 1.6
size = [1.6, 1.6]
thickness = 0.5
seed = 123
[analysis]
kind = "pushover"
follow = 0
"""


@pytest.mark.parametrize("wrong", [-0.15, 0.07])
def test_wrong_estimates(tmp_path, monkeypatch, wrong):
    """Larger steps come to 0.4130 to 0.4219, by the estimate; what is stated does not."""
    case = tmp_path / "wall.toml"
    case.write_text(WALL)
    right, expected = dem_cli.run(case).summary, LoadSearch._expected

    def wrongly(self, estimate):
        load, failing = expected(self, estimate)
        self.plateau *= 1.0 + wrong
        return (1.0 + wrong) * load, failing

    monkeypatch.setattr(LoadSearch, "_expected", wrongly)
    found = dem_cli.run(case).summary
    assert found["search"][1]["load"] == pytest.approx((1.0 + wrong) * right["search"][1]["load"])
    assert found["failure_load_bracket"] == right["failure_load_bracket"]
    assert found["load_range"]["lowest"] < found["failure_load"]
    assert found["warnings"][0].startswith("methods differ by")


@pytest.mark.parametrize("seen", [0.0, LoadSearchSettings.least_of_fewest])
def test_small_steps_that_cost_too_much_leave_the_load_of_larger_ones(tmp_path, monkeypatch, seen):
    """A wall of 520 blocks in space had a load, and was "not converged" as its small steps ended at a quarter of it.

    They are cut short here after half of the steps that were taken before, or not begun, as that is seen beforehand.
    """
    case = tmp_path / "wall.toml"
    case.write_text(WALL)
    again = LoadSearch.run_again_in_small_steps

    def cut_short(self, most):
        assert self.answer.found
        steps = self.sim.steps - self.first_step
        effort = 1.5 * steps * len(self.sim.joints.kn)
        self.settings = replace(self.settings, effort=effort, least_of_fewest=seen)
        found.append((self.answer.carried, self.answer.failed))
        again(self, most)
        tried.append((self.sim.steps - self.first_step) / steps)

    found: list[tuple[float, float]] = []
    tried: list[float] = []
    monkeypatch.setattr(LoadSearch, "run_again_in_small_steps", cut_short)
    summary = dem_cli.run(case).summary
    assert summary["status"] == "ok"
    assert tuple(summary["failure_load_bracket"]) == found[0]
    assert "the load again in small steps: not finished; it is that of larger steps" in summary["skipped"]
    assert tried[0] == 1.0 if seen else tried[0] > 1.5


@pytest.mark.parametrize("ends", [True, False])
def test_a_load_says_that_it_stands_alone_where_small_steps_and_path_have_no_end(tmp_path, monkeypatch, ends):
    """Until 0.21 the load of larger steps had no word on it, but under `skipped`."""
    case = tmp_path / "wall.toml"
    case.write_text(WALL)
    monkeypatch.setattr(LoadSearch, "run_again_in_small_steps", lambda self, most: None)
    monkeypatch.setattr(Path, "finished", ends)
    summary = dem_cli.run(case).summary
    assert summary["status"] == "ok"
    alone = [text for text in summary["warnings"] if text.startswith("no second history says")]
    assert len(alone) == (0 if ends else 1)
