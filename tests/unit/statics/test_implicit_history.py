"""The implicit history under load: exact loads, and what it holds is in equilibrium; what it cannot find it leaves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from engine import block, rectangle, scene, solve, tables

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.static_settings import ImplicitHistorySettings
from dem_cli.core.limit.analysis import start_structure
from dem_cli.core.limit.cone import friction_of
from dem_cli.core.limit.elastic import Elastic
from dem_cli.core.statics.implicit_history import FAILS, HOLDS, ImplicitHistory
from dem_cli.core.statics.warm_start import GRAVITY, IMPLICIT

CASES = Path(__file__).resolve().parents[3] / "cases" / "verification"
RESOLUTION = 0.002
BASE = block("base", rectangle(-2, -1, 3, 0), fixed=True)


def history_of(case, stop=lambda: False) -> ImplicitHistory:
    made = scene(case)
    structure = start_structure(made.model, joint_properties(made.request, made.model))
    problem = Elastic(structure, friction_of(structure.joints, law_of(made.request)))
    return ImplicitHistory(problem, ImplicitHistorySettings(), stop)


@pytest.mark.parametrize(
    ("name", "load", "bound"),
    [
        ("wall_21", 0.6, 0.6),  # slides at its bound
        ("column_14", 8 / 49, 8 / 49),
        ("arch_21", 0.1483, 0.1484),
        ("arch_21_mu040", 0.0522, 0.06),  # the bound is not reached: joints do not dilate
        ("portal", 0.3247, 0.33),
    ],
)
def test_exact_loads(name, load, bound):
    history = history_of(CASES / f"{name}.toml")
    held = history.search(bound, RESOLUTION)
    assert held is not None
    assert held.low == pytest.approx(load, rel=RESOLUTION)
    assert held.low < held.high <= (1.0 + RESOLUTION) * held.low
    assert {level.verdict for level in held.levels} <= {HOLDS, FAILS}
    assert max(level.load for level in held.levels if level.verdict == HOLDS) == held.low


@pytest.mark.parametrize("yields", [2e3, 6e3, 2e4])
def test_ties_stretch_until_they_yield(yields):
    """A block of 0.5 × 2 m on an anchor at its top: λ W h/2 = W b/2 + N h, long after the joint has opened."""
    tie = {"ends": [[0.0, 2.0], [-4.0, 2.0]], "anchored": True, "stiffness": 1e6, "yield_force": yields}
    history = history_of(tables(BASE, block("b", rectangle(0, 0, 0.5, 2)), friction=3.0, tie=[tie]))
    weight = 2000.0 * 9.81
    load = 0.25 + 2.0 * yields / weight
    held = history.search(1.05 * load, RESOLUTION)
    assert held.low == pytest.approx(load, rel=RESOLUTION)
    assert held.high == pytest.approx(load, rel=RESOLUTION)
    assert held.held[-1].normal.shape == (2,)  # of joints alone


def test_what_is_held_is_in_equilibrium_under_the_law():
    history = history_of(CASES / "arch_21_mu040.toml")
    held = history.search(0.06, RESOLUTION)
    problem, state = history.problem, history.state
    normal, shear = state.normal, state.shear
    unbalanced = problem.imbalance(normal, shear, held.low / problem.live_scale)
    assert (np.abs(unbalanced) / problem.own).max() < 2e-4  # the force of the viscosity that is left
    assert normal.min() >= 0.0
    assert (np.abs(shear) - problem.friction * normal).max() < 1e-4
    gaps = problem.opened(state.displacements)
    assert np.abs(np.minimum(normal / problem.kn, gaps + normal / problem.kn)).max() < 1e-3 * normal.max()


def test_resistance_grows_to_the_load_that_fails():
    """A block of 0.2 × 1 m that rocks: what it resists with is below each load, and ends at 0.2."""
    history = history_of(tables(BASE, block("b", rectangle(0, 0, 0.2, 1))))
    held = history.search(0.25, RESOLUTION)
    assert held.low == pytest.approx(0.2, rel=RESOLUTION)
    failed = [level for level in held.levels if level.verdict == FAILS]
    assert failed
    assert all(level.resisted == pytest.approx(0.2, rel=1e-3) for level in failed)
    assert all(level.resisted <= level.load for level in held.levels)


def test_work_is_that_of_the_loads_on_the_way():
    """A block at rest on friction: each load moves it by its elastic displacement alone, W = Σ λ Δq."""
    history = history_of(tables(BASE, block("b", rectangle(0, 0, 1, 0.2)), friction=0.4))
    held = history.search(0.5, RESOLUTION)
    loads = [level.load for level in held.levels if level.verdict == HOLDS]
    assert held.low == pytest.approx(0.4, rel=RESOLUTION)
    compliance = held.held[-1].work / sum(load * (load - before) for before, load in zip([0.0, *loads], loads))
    displacement = np.abs(held.held[-1].displacements[0])
    weight = 2000.0 * 9.81 * 0.2
    assert compliance == pytest.approx(weight * displacement / held.low, rel=0.05)


def test_what_does_not_stand_has_no_history():
    cantilever = block("b", rectangle(2.0, 0, 5.0, 0.2))  # its centroid is beyond the edge of the base
    assert history_of(tables(BASE, cantilever)).search(0.5, RESOLUTION) is None


def test_a_search_that_is_stopped_says_nothing():
    assert history_of(CASES / "wall_21.toml", stop=lambda: True).search(0.6, RESOLUTION) is None


def test_a_wall_that_fails_sooner_step_by_step_is_raised_so():
    """113 Voronoi cells: implicit steps of any size and the path come to 0.284, loads raised in small steps to 0.2684.

    The first two agree, and "a second history agrees" was said of 0.2836.
    """
    cells = {"kind": "voronoi-wall", "cells": 113, "relax": 3, "stretch": 2.14, "size": [3.37, 1.63], "seed": 7040}
    analysis = {"kind": "pushover", "follow": 0.0}
    case = {"materials": {"stone": {"density": 2100.0}}, "joints": {"dry": {"friction": 0.596}}, "analysis": analysis}
    settings = replace(DEFAULT, implicit_history=replace(DEFAULT.implicit_history, blocks=60))
    summary = solve(case | {"structure": [{"id": "w", "thickness": 0.5, **cells}]}, settings=settings)[0]
    assert summary["start"]["kind"] == GRAVITY
    assert summary["failure_load"] < 0.27
    assert summary["load_range"]["highest"] > 0.28


def test_the_explicit_solver_shows_both_ends():
    """A wall by the implicit history, and raised from gravity beside the path."""
    found = {}
    for blocks in (60, 10_000):
        settings = replace(DEFAULT, implicit_history=replace(DEFAULT.implicit_history, blocks=blocks))
        found[blocks] = summary = solve(CASES / "wall_2.toml", "analysis.follow=0", settings=settings)[0]
        assert summary["status"] == "ok"
    implicit, raised = found[60], found[10_000]
    assert implicit["start"]["kind"] == IMPLICIT
    assert raised["start"]["kind"] == GRAVITY
    assert implicit["failure_load"] == pytest.approx(raised["failure_load"], rel=2.0 * RESOLUTION)
    low, high = implicit["failure_load_bracket"]
    assert low <= implicit["start"]["load"] * 1.0001
    assert high <= low * (1.0 + 1.001 * RESOLUTION)
    assert implicit["proof_of_failure"]["by"] == "motion"
    assert [one["state"] for one in implicit["search"]] == 6 * ["equilibrium"] + ["failure"]
    assert [one["kind"] for one in implicit["search"]] == 5 * ["load"] + ["start", "load"]
    first, beside = implicit["histories"][:2]
    assert first["method"] == "implicit steps under load"
    assert beside == {
        "method": "raised from gravity",
        "load": pytest.approx(0.98 * first["load"], rel=1e-3),
        "finished": False,
    }
    assert abs(implicit["energy_closure"]) < 1e-3


def test_a_bracket_that_stays_wider_is_narrowed_by_the_explicit_solver(monkeypatch):
    """Loads in the bracket that an implicit history leaves undecided are tried explicitly; all began again before."""
    settings = replace(DEFAULT, implicit_history=replace(DEFAULT.implicit_history, blocks=60))
    monkeypatch.setattr(ImplicitHistory, "_narrowed", lambda self, resolution: False)
    found = solve(CASES / "wall_2.toml", "analysis.follow=0", settings=settings)[0]
    assert found["status"] == "ok"
    assert found["start"]["kind"] == IMPLICIT
    held, fails = found["start"]["load"], found["start"]["fails"]
    assert (1.0 + 2.0 * RESOLUTION) * held < fails
    low, high = found["failure_load_bracket"]
    assert 0.999 * held <= low < high <= (1.0 + 1.001 * RESOLUTION) * low
    assert high <= fails
    assert found["proof_of_failure"]["by"] == "motion"
    assert found["failure_load"] == pytest.approx(0.5561, rel=2.0 * RESOLUTION)  # as raised from gravity
