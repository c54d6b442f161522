"""The bound of limit analysis beside every failure load, and what is said of a load above it."""

from __future__ import annotations

import json

import numpy as np
import pytest
from engine import block, rectangle, solve, tables
from oracle.no_tension_joint import Panel

from dem_cli.analyses import bound_beside
from dem_cli.analyses.bound_beside import Moved, in_words, is_above, status_beside
from dem_cli.app.cli.words.console import answer_rows
from dem_cli.core.records.statuses import ABOVE
from dem_cli.core.statics.failure_load import LoadSearch
from dem_cli.results.output.summary import exit_code

BASE = block("base", rectangle(-2, -1, 3, 0), fixed=True)


def pier(**more) -> dict:
    """A block of 0.2 × 1 m, which rocks at 0.2, and slides at the friction."""
    return tables(BASE, block("b", rectangle(0, 0, 0.2, 1)), **more)


WAYS = {
    "fixed": {"kinematics": "fixed"},
    "moving": {"kinematics": "large"},
    "curve": {"control": "displacement", "follow": 0.002, "increments": 20},
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kn", ["auto", 1e10])
def test_the_bound_stands_beside_a_load_of_any_kinematics_control_and_stiffness(way, kn):
    joints = {"dry": {"friction": 0.6, "kn": kn, "ks": kn} | ({} if kn == "auto" else {"points": 5})}
    summary, _ = solve(pier(joints=joints, analysis={"kind": "pushover", **WAYS[way]}))
    assert summary["status"] == "ok"
    assert summary["limit_analysis"]["associated"] == pytest.approx(0.2, rel=1e-6)
    assert 0.95 * 0.2 < summary["failure_load"] <= 0.2 * 1.002
    assert not {"no_bound", "above_the_bound"} & summary.keys()


@pytest.mark.parametrize("way", ["moving", "curve"])
def test_a_face_that_presses_in_part_fails_before_its_bound(way):
    panel = Panel(0.2, 1.0, 2000.0 * 9.81 * 0.2, 1e10, pushed_at=0.5)
    joints = {"dry": {"friction": 0.6, "kn": panel.kn, "ks": panel.kn}}
    summary, _ = solve(pier(joints=joints, analysis={"kind": "pushover", **WAYS[way]}))
    assert summary["status"] == "ok"
    assert summary["limit_analysis"]["associated"] == pytest.approx(0.2, rel=1e-6)
    assert summary["failure_load"] == pytest.approx(panel.strength / panel.weight, rel=2e-3)
    assert not {"no_bound", "above_the_bound"} & summary.keys()


def test_bonded_joints_have_a_bound():
    """Two points at its ends: turning about one, tension of half the face acts at the other: 0.2 + f_t b / W."""
    law = {"law": "mohr-coulomb", "friction": 0.9, "cohesion": 1e5, "tension": 1e3, "points": 2}
    summary, _ = solve(pier(joints={"dry": law}))
    weight = 2000.0 * 9.81 * 0.2
    exact = (weight * 0.1 + 0.5 * 1e3 * 0.2 * 0.2) / (weight * 0.5)
    assert summary["limit_analysis"]["associated"] == pytest.approx(exact, rel=1e-6)
    assert summary["failure_load"] <= exact * 1.002


def test_no_bound_is_said_once_and_is_no_warning():
    law = {"law": "barton", "jrc": 5.0, "jcs": 5e7, "residual_angle_deg": 30.0}
    summary, _ = solve(pier(joints={"dry": law}))
    assert summary["failure_load"] > 0.19
    assert "limit_analysis" not in summary
    assert "barton" in summary["no_bound"]
    assert not any("limit analysis" in text or "bound" in text for text in summary["warnings"])
    assert [text for label, text in answer_rows(summary) if label == "no bound"] == [summary["no_bound"]]


def columns(kinematics: str, number: int = 2) -> dict:
    """Columns of 0.4 × 1.25 m side by side: one turns over at 0.32, all of them together hold on to each other."""
    height = [0.25 * k for k in range(6)]
    blocks = [
        block(f"b{i}{k}", rectangle(0.4 * i, height[k], 0.4 * (i + 1), height[k + 1]))
        for i in range(number)
        for k in range(5)
    ]
    return tables(BASE, *blocks, friction=0.4, analysis={"kind": "pushover", "kinematics": kinematics})


def test_blocks_that_move_are_beside_the_zero_dilation_path_of_the_start():
    """As they turn the columns wedge by θ² b / 2, and friction holds them: another history, up to the bound."""
    summary, _ = solve(columns("large"))
    lowest = 0.4 / 1.25
    assert summary["limit_analysis"]["non_associated"] == pytest.approx(lowest, rel=1e-3)
    assert lowest < summary["failure_load"] <= 1.002 * summary["limit_analysis"]["associated"]
    assert summary["load_range"]["lowest"] == pytest.approx(lowest, rel=1e-3)
    assert any("in the geometry of the start" in text for text in summary["warnings"])


@pytest.mark.parametrize("more", [{"kinematics": "fixed"}, {"number": 1, "kinematics": "large"}])
def test_no_second_history_is_looked_for_where_there_is_one_or_nothing_slides(more):
    summary, _ = solve(columns(**more))
    assert summary["failure_load"] == pytest.approx(0.32, rel=2e-3)
    assert summary["load_range"] is None
    assert not any("in the geometry of the start" in text for text in summary["warnings"])


@pytest.mark.parametrize("limit", [False, True])
def test_a_load_of_blocks_that_hardly_move_stands_beside_the_path_that_lies_above_it(limit):
    """Out of plane between two strips the bound is 7.07 and says little: run and path lie 2.3 % apart."""
    wall = {"kind": "wall", "block": [0.4, 0.2, 0.2], "courses": 4, "blocks_per_course": 3}
    analysis = {"kind": "pushover", "kinematics": "large", "direction": [0.0, 1.0, 0.0], "limit": limit}
    sides = {"sides": [{"face": "+y", "strip": 0.3}]}
    summary, _ = solve(tables(friction=0.5, dimension=3, structure=[wall | sides], analysis=analysis))
    path = summary["limit_analysis"]["non_associated"]
    assert path > 1.01 * summary["failure_load"]
    assert summary["load_range"]["highest"] == pytest.approx(path, rel=1e-9)
    assert any("in the geometry of the start" in text for text in summary["warnings"])


def test_a_load_above_its_bound_is_by_more_than_the_resolution():
    assert not is_above(0.2411, 0.2410757, 0.002)
    assert is_above(0.2420, 0.2410757, 0.002)
    assert is_above(0.3, 0.0, 0.002)


def test_words_and_status_of_a_load_above():
    nothing, far = Moved(1e-5, 0.24106), Moved(0.012, 0.48)
    text = in_words(0.47286, 0.24108, nothing, explained=False)
    assert text.startswith("the failure load 0.47286 lies above 0.24108, which no structure of this geometry can carry")
    assert "0.012 m" in in_words(0.47286, 0.24108, far, explained=True)
    above = {"bound": 0.24108, "displacement": 0.012, "bound_where_it_rests": 0.48}
    assert status_beside("ok", {"above_the_bound": above | {"explained": False}}) == ABOVE
    assert status_beside("ok", {"above_the_bound": above | {"explained": True}}) == "ok"
    assert status_beside("not converged", {"above_the_bound": above | {"explained": False}}) == "not converged"
    assert status_beside("ok", {}) == "ok"


def test_the_first_motion_comes_before_a_load_that_moved_blocks_carry():
    above = {"bound": 0.24, "displacement": 0.012, "bound_where_it_rests": 0.48, "explained": True}
    summary = {"status": "ok", "failure_load": 0.47, "failure_load_bracket": [0.47, 0.471], "above_the_bound": above}
    rows = answer_rows(summary | {"onset_of_displacements": 0.21})
    assert rows[0] == ("first motion", "0.2100; then blocks move, by 12 mm until the failure load")
    assert [label for label, _ in rows].count("first motion") == 1
    assert rows[1][0] == "failure load"


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_a_load_that_nothing_explains_is_not_ok(kinematics, monkeypatch):
    """The search is made to say 1 % more than it found; blocks have not moved."""
    found = LoadSearch.run

    def too_much(search, *given):
        found(search, *given)
        search.answer.low, search.answer.high = 1.01 * search.answer.low, 1.01 * search.answer.high

    monkeypatch.setattr(LoadSearch, "run", too_much)
    summary, _ = solve(pier(analysis={"kind": "pushover", "kinematics": kinematics}))
    assert summary["status"] == ABOVE
    assert exit_code(summary) == 1
    assert summary["above_the_bound"]["explained"] is False
    assert summary["above_the_bound"]["bound"] == pytest.approx(0.2, rel=1e-6)
    assert summary["above_the_bound"]["displacement"] < 1e-3
    assert any("which no structure of this geometry can carry" in text for text in summary["warnings"])
    json.dumps(summary["above_the_bound"])


def test_a_stop_that_closes_explains_a_higher_load():
    """A block slides at 0.3 until a gap of 1 mm closes; then it pushes a rougher one along: both slide at 0.6, or at a
    little more where friction between them puts weight on the rougher one."""
    base, first = ({**one, "material": "stone"} for one in (BASE, block("b", rectangle(0, 0, 1, 1))))
    stop = block("stop", rectangle(1.001, 0, 2.001, 1), material="rough")
    case = tables(base, first, stop, analysis={"kind": "pushover", "kinematics": "large"})
    case["materials"]["rough"] = {"density": 2000.0}
    case["joints"] = {"dry": {"friction": 0.3}, "held": {"friction": 0.9}}
    case["interface"] = [{"between": ["rough", "stone"], "joint": "held"}]
    summary, _ = solve(case)
    above = summary["above_the_bound"]
    assert above["bound"] == pytest.approx(0.3, rel=1e-3)
    assert above["explained"]
    assert above["displacement"] == pytest.approx(1e-3, rel=0.2)
    assert 0.6 * 0.998 < summary["failure_load"] < 0.75
    assert summary["status"] == "ok"
    assert np.isfinite(above["bound_where_it_rests"])


def over_a_gap() -> dict:
    """The pier 0.1 mm above its base, on which it comes to rest: nothing stands in the geometry of the start."""
    moving = {"kind": "pushover", "kinematics": "large"}
    return tables(BASE, block("b", rectangle(0, 1e-4, 0.2, 1.0001)), analysis=moving)


def test_blocks_that_rest_after_gaps_have_closed_have_the_bound_of_where_they_rest():
    summary, _ = solve(over_a_gap())
    assert summary["status"] == "ok"
    assert summary["failure_load"] == pytest.approx(0.2, rel=2e-3)
    assert summary["bound_where_it_rests"]["bound"] == pytest.approx(0.2, rel=2e-3)
    assert not {"no_bound", "above_the_bound"} & summary.keys()
    assert ("limit analysis", "0.2000 associated, where blocks rest at this load") in answer_rows(summary)


def test_stones_that_came_to_rest_askew_carry_in_the_bound_of_where_they_rest():
    """Stones up to 0.3 mm too high or too low turn until each rests: farther than any live load moves them then."""

    def wall(error: float, kinematics: str) -> dict:
        case = tables(friction=0.715, analysis={"kind": "pushover", "kinematics": kinematics}, seed=40020)
        wall = {"kind": "wall", "id": "s", "block": [0.5, 0.35], "courses": 4, "blocks_per_course": 1}
        case["structure"] = [wall | {"bond": "flemish", "gable": {"height": 0.5}}]
        return case | {"imperfection": [{"height": [-error, error]}]}

    as_drawn, askew = (solve(wall(*of))[0] for of in ((0.0, "fixed"), (3e-4, "large")))
    assert askew["status"] == "ok"
    assert askew["bound_where_it_rests"]["bound"] == pytest.approx(as_drawn["limit_analysis"]["associated"], rel=5e-3)
    assert "no_bound" not in askew


def test_a_load_above_the_bound_of_where_blocks_rest_is_not_ok(monkeypatch):
    """The search is made to say 2 % more than it found."""
    found = LoadSearch.run

    def too_much(search, *given):
        found(search, *given)
        search.answer.low, search.answer.high = 1.02 * search.answer.low, 1.02 * search.answer.high

    monkeypatch.setattr(LoadSearch, "run", too_much)
    summary, _ = solve(over_a_gap())
    assert summary["status"] == ABOVE
    assert summary["above_the_bound"]["explained"] is False
    assert any("which no structure of this geometry can carry" in text for text in summary["warnings"])


def test_restored_after_it_looked(monkeypatch):
    """The state that the run ends with is not that of the look."""
    seen = []
    look = bound_beside._moved

    def watched(job, search, sim):
        before = sim.bodies.positions.copy()
        moved = look(job, search, sim)
        seen.append(np.array_equal(before, sim.bodies.positions))
        return moved

    monkeypatch.setattr(bound_beside, "_moved", watched)
    monkeypatch.setattr(bound_beside, "is_above", lambda *values: True)
    solve(pier(analysis={"kind": "pushover", "kinematics": "large"}))
    assert seen == [True]


@pytest.mark.parametrize(("friction", "expected"), [(0.199, False), (0.2, False), (0.21, True), (0.6, True)])
def test_one_load_is_possible_where_no_mechanism_slides(friction, expected):
    """At μ = 0.2 the block of 0.2 × 1 m slides and rocks at the same load, whatever mechanism is found."""
    summary, _ = solve(pier(friction=friction, analysis={"kind": "pushover", "kinematics": "fixed"}))
    assert summary["failure_load"] == pytest.approx(min(friction, 0.2), rel=2e-3)
    assert summary["unique"] is expected
    assert ("no other load is possible" in dict(answer_rows(summary))["how sure"]) is expected


def test_one_of_two_blocks_that_slides_at_the_load_of_the_other_leaves_it_open():
    """One rocks at 0.2, the other, on a smoother joint, slides at 0.2: mechanisms of the same load."""
    base, rocks = ({**one, "material": "stone"} for one in (BASE, block("a", rectangle(0, 0, 0.2, 1))))
    case = tables(base, rocks, block("b", rectangle(1, 0, 2, 1), material="smooth"), friction=0.7)
    case["materials"]["smooth"] = {"density": 2000.0}
    case["joints"]["slips"] = {"friction": 0.2}
    case["interface"] = [{"between": ["smooth", "stone"], "joint": "slips"}]
    summary, _ = solve(case)
    assert summary["limit_analysis"]["associated"] == pytest.approx(0.2, rel=1e-6)
    assert not summary["unique"]
