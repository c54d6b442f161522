"""Starts next to failure: the explicit solver proves them, goes on from them, and believes nothing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from engine import solve

from dem_cli.analyses import bound_beside
from dem_cli.core import failure_search
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.statics import warm_start

CASES = Path(__file__).resolve().parents[2] / "cases" / "verification"
QUICK = "analysis.follow=0.0"


def run(name: str, *overrides: str, settings: Settings = DEFAULT) -> dict:
    return solve(CASES / f"{name}.toml", QUICK, *overrides, settings=settings)[0]


@pytest.mark.parametrize("name", ["wall_21", "wall_21_mu075", "wall_2", "column_14", "arch_21_mu040", "portal"])
def test_path_and_gravity_agree(name):
    by_path, by_hand = (run(name, f'analysis.start="{kind}"') for kind in ("path", "gravity"))
    assert by_path["status"] == by_hand["status"] == "ok"
    assert by_path["start"]["kind"] == "path"
    assert by_path["failure_load"] == pytest.approx(by_hand["failure_load"], rel=5e-3)
    assert by_path["search"][0]["state"] == "equilibrium"
    low, high = by_path["failure_load_bracket"]
    assert low < by_path["start"]["load"] < high <= low * 1.00201
    assert abs(by_path["energy_closure"]) < 1e-3


@pytest.mark.parametrize("blocks", [60, 10_000])
@pytest.mark.parametrize("name", ["wall_21", "wall_2"])
def test_structures_of_any_size_are_raised_from_gravity(name, blocks):
    """By the explicit solver, or in implicit steps from a size on; the load that the path ends at is the same."""
    settings = replace(DEFAULT, implicit_history=replace(DEFAULT.implicit_history, blocks=blocks))
    summary = run(name, "analysis.limit=true", settings=settings)
    implicit = name == "wall_2" and blocks == 60
    assert summary["start"]["kind"] == ("implicit history" if implicit else "gravity")
    assert summary["start"]["chosen"] == "automatically"
    others = {history["method"]: history["load"] for history in summary["histories"]}
    assert others["zero-dilation path"] == pytest.approx(summary["failure_load"], rel=4e-3)  # a second history
    assert summary["load_range"] is None


@pytest.mark.parametrize("steps", [150_000, 0])
def test_large_structures_go_on_from_where_their_smoothed_path_ends(steps):
    """Associated 0.56359, path under the exact law 0.55666; without steps for trials the load of the path is held."""
    search = replace(DEFAULT.load_search, effort_of_large=1e4 * steps)
    path = replace(DEFAULT.limit.path, large=50)
    settings = replace(DEFAULT, limit=replace(DEFAULT.limit, path=path), load_search=search)
    summary = run("wall_21", "structure.0.courses=10", "structure.0.blocks_per_course=10", settings=settings)
    assert summary["start"]["kind"] == "path"
    assert "smoothed" in summary["start"]["note"]
    low, high = summary["failure_load_bracket"]
    assert low == summary["failure_load"] == pytest.approx(0.55666, rel=3e-3)
    assert low < high <= 0.5636
    assert (summary["search"][0]["kind"], summary["search"][0]["state"]) == ("start", "equilibrium")
    said = any("reached from gravity by a smoothed path: at least 0.55" in text for text in summary["warnings"])
    assert said == (steps == 0) == (high > 0.5635)
    assert summary["histories"][0]["method"] == "zero-dilation path"


def test_a_large_structure_that_is_tried_at_its_bound():
    """A first step beyond the bound: limit analysis proves that failure, and says nothing of how long others take."""
    search = replace(DEFAULT.load_search, step_of_large=2.0)
    path = replace(DEFAULT.limit.path, large=50)
    settings = replace(DEFAULT, limit=replace(DEFAULT.limit, path=path), load_search=search)
    summary = run("wall_21", "structure.0.courses=10", "structure.0.blocks_per_course=10", settings=settings)
    assert [each["kind"] for each in summary["search"][:3]] == ["start", "impossible", "load"]
    low, high = summary["failure_load_bracket"]
    assert low == pytest.approx(0.55666, rel=3e-3)
    assert low < high <= 0.5637


def test_large_structures_in_space_go_on_from_where_their_path_ends():
    """The path is that under the exact law, as far as it came; raised from gravity 0.6460 to 0.6464."""
    path = replace(DEFAULT.limit.path, large_in_space=10)
    settings = replace(DEFAULT, limit=replace(DEFAULT.limit, path=path))
    in_space = ("dimension=3", "analysis.direction=[1.0, 0.0, 0.0]", "reference=[]")
    summary = run("wall_21_mu075", *in_space, settings=settings)
    assert (summary["start"]["kind"], summary["status"]) == ("path", "ok")
    assert "smooth" not in summary["start"]["note"]
    low, high = summary["failure_load_bracket"]
    assert low < 0.6460 < high < low * 1.0021
    assert (summary["search"][0]["kind"], summary["search"][0]["state"]) == ("start", "equilibrium")
    states = [each["state"] for each in summary["search"]]
    shown = states.index("failure")  # after so many steps; what is left for a lower load is less than that failure took
    assert len(states) > shown + 1
    steps = sum(each["steps"] for each in summary["search"][: shown + 1])
    short = replace(
        DEFAULT.load_search, effort_of_large=(steps + 0.9 * summary["search"][shown]["steps"]) * summary["contacts"]
    )
    ended = run("wall_21_mu075", *in_space, settings=replace(settings, load_search=short))
    assert ended["search"] == summary["search"][: shown + 1]
    assert ended["failure_load"] == ended["failure_load_bracket"][0] == ended["search"][0]["load"]
    assert any("is wider than" in text for text in ended["warnings"])


@pytest.mark.parametrize("factor", [1.3, 0.7])
def test_a_wrong_start_is_not_believed(factor, monkeypatch):
    """Its forces do not balance at the load that it claims: the load is raised from gravity or from what holds."""
    real = warm_start.find_start

    def wrong(job, sim, limits):
        found, report = real(job, sim, limits)
        return found._replace(load=factor * found.load), report

    monkeypatch.setattr(failure_search, "find_start", wrong)
    summary = run("wall_21", 'analysis.start="path"')
    assert summary["failure_load"] == pytest.approx(0.6, rel=4e-3)


def test_forces_out_of_the_air_are_not_believed(monkeypatch):
    """A start whose forces are nothing like equilibrium."""
    real = warm_start.find_start

    def wrong(job, sim, limits):
        found, report = real(job, sim, limits)
        return found._replace(normal=np.zeros_like(found.normal), shear=np.zeros_like(found.shear)), report

    monkeypatch.setattr(failure_search, "find_start", wrong)
    summary = run("wall_21", 'analysis.start="path"')
    assert summary["failure_load"] == pytest.approx(0.6, rel=4e-3)
    assert summary["start"]["kind"] == "gravity" or summary["search"][0]["state"] == "equilibrium"


def test_an_equilibrium_from_limit_analysis_is_no_failure_load():
    """WALL3: held a little below the load without head friction; nothing says that it is reached from gravity."""
    summary = run("wall_3", 'analysis.start="limit"', "analysis.resolution=0.03")
    assert summary["start"]["kind"] == "limit"
    assert summary["status"] == "an equilibrium exists at this load"
    assert summary["failure_load"] is None
    assert summary["equilibrium_load"] == pytest.approx(0.46648, rel=8e-3)
    assert summary["failure_load_bracket"] == [
        summary["equilibrium_load"], pytest.approx(summary["start"]["associated"], rel=1e-4)
    ]  # fmt: skip


def test_beyond_the_associated_load_nothing_has_to_be_waited_for():
    summary, records = solve(CASES / "wall_21.toml", QUICK)
    last = summary["search"][-1]
    assert (last["kind"], last["state"]) == ("impossible", "failure")
    assert summary["proof_of_failure"]["by"] == "limit analysis"
    assert summary["proof_of_failure"]["released_share_of_work"] > 0.0
    assert summary["failure_load_bracket"][1] == pytest.approx(summary["limit_analysis"]["associated"], rel=2e-4)
    assert all(row.energy.friction >= 0.0 for row in records.rows)
    assert abs(summary["energy_closure"]) < 1e-3


def test_geometry_that_moves_is_raised_from_gravity():
    assert run("wall_21", 'analysis.start="path"', 'analysis.kinematics="large"')["start"]["kind"] == "gravity"


def test_limit_analysis_beside_the_failure_load():
    summary = run("wall_21_mu100", "analysis.limit=true")
    limits = summary["limit_analysis"]
    assert limits["associated"] == pytest.approx(1.0, rel=1e-5)
    assert limits["non_associated"] == pytest.approx(0.645963, rel=1e-5)
    assert summary["failure_load"] == pytest.approx(limits["non_associated"], rel=5e-3)


def test_a_failure_load_above_the_bound_is_not_trusted(monkeypatch):
    """The bound is taken for a tenth lower than it is."""
    monkeypatch.setattr(bound_beside, "is_above", lambda load, bound, resolution: load > 0.9 * bound)
    summary = run("wall_21", "analysis.limit=true")
    assert any("do not trust this run" in text for text in summary["warnings"])
    assert summary["status"] == "above what this geometry can carry"


def test_a_path_whose_load_drops_is_no_start():
    """It may have gone into another mechanism: the load is raised from gravity, where the wall holds more."""
    summary = run("uneven_courses_mu050", 'analysis.start="path"')
    assert summary["start"]["kind"] == "gravity"
    assert "drops along the path" in summary["start"]["note"]
    assert summary["failure_load"] > 1.005 * summary["start"]["load"]


def test_without_weight_there_is_nothing_to_start_from():
    summary = run("wall_21", 'analysis.start="path"', "gravity=0.0")
    assert summary["start"]["kind"] == "gravity"
