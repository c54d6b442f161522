"""The bound of limit analysis beside the loads of a path to and fro, and what is said of a load above it."""

from __future__ import annotations

import pytest
from engine import block, rectangle, solve, tables

from dem_cli.analyses import bound_beside
from dem_cli.core.records.statuses import ABOVE
from dem_cli.results.output.summary import exit_code

BASE = block("base", rectangle(-2, -1, 3, 0), fixed=True)
# A right-angled triangle of 0.3 × 1 m, upright side on the left, its centroid 0.1 m from there, a third of 1 m up:
# about its right foot it rocks at 0.2 / (1/3) = 0.6, about its left one at 0.1 / (1/3) = 0.3.
TRIANGLE = [[0.0, 0.0], [0.3, 0.0], [0.0, 1.0]]


def path(values: list[float], step: float, **more) -> dict:
    analysis = {"kind": "cycle", "path": values, "step": step, "kinematics": "fixed"} | more
    return tables(BASE, block("b", TRIANGLE), friction=0.9, analysis=analysis)


def prism(case: dict, depth: float = 1.0) -> dict:
    """The same in space."""
    blocks = [
        one | {"vertices": [[x, y, z] for y in (0.0, depth) for x, z in one["vertices"]]} for one in case["block"]
    ]
    case["analysis"]["direction"] = [1.0, 0.0, 0.0]
    return case | {"dimension": 3, "block": blocks}


@pytest.mark.parametrize("space", [False, True])
def test_both_senses_have_a_bound_of_their_own(space):
    case = path([0.25, -0.25, 0.0], 0.05)
    summary, _ = solve(prism(case) if space else case)
    assert summary["status"] == "ok"
    assert summary["limit_analysis"] == pytest.approx({"associated": 0.6, "associated_back": -0.3}, rel=1e-6)
    assert not {"no_bound", "above_the_bound"} & summary.keys()


def test_a_path_that_goes_one_way_has_one():
    summary, _ = solve(path([0.25, 0.0], 0.05))
    assert summary["limit_analysis"] == pytest.approx({"associated": 0.6}, rel=1e-6)


def test_a_load_that_nothing_explains_is_not_ok(monkeypatch):
    """The path is made to have carried −0.31, where −0.3 is the most; in the other sense 0.25 is far below 0.6."""
    found = bound_beside.beside_path

    def too_much(job, sim, highest, lowest, resolution):
        return found(job, sim, highest, lowest._replace(load=-0.31), resolution)

    monkeypatch.setattr("dem_cli.analyses.cycle.beside_path", too_much)
    summary, _ = solve(path([0.25, -0.25, 0.0], 0.05))
    assert summary["status"] == ABOVE
    assert exit_code(summary) == 1
    above = summary["above_the_bound"]
    assert above["bound"] == pytest.approx(-0.3, rel=1e-6)
    assert above["bound_where_it_rests"] == pytest.approx(-0.3, rel=1e-6)
    assert above["explained"] is False
    assert any("the load 0.31 against its direction lies above 0.3" in text for text in summary["warnings"])


def test_a_stop_that_closes_explains_a_higher_load():
    """A block slides at 0.3 until a gap of 1 mm closes, and pushes a rougher one along: 0.6 on both."""
    base, first = ({**one, "material": "stone"} for one in (BASE, block("b", rectangle(0, 0, 1, 1))))
    stop = block("stop", rectangle(1.001, 0, 2.001, 1), material="rough")
    analysis = {"kind": "cycle", "path": [0.4, 0.0], "step": 0.1, "kinematics": "large"}
    case = tables(base, first, stop, analysis=analysis)
    case["materials"]["rough"] = {"density": 2000.0}
    case["joints"] = {"dry": {"friction": 0.3}, "held": {"friction": 0.9}}
    case["interface"] = [{"between": ["rough", "stone"], "joint": "held"}]
    summary, _ = solve(case)
    assert summary["status"] == "ok"
    above = summary["above_the_bound"]
    assert above["bound"] == pytest.approx(0.3, rel=1e-3)
    assert above["displacement"] == pytest.approx(1e-3, rel=0.2)
    assert above["explained"]
