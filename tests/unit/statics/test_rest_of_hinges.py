"""Loads on structures in which nothing slides come to rest the fast way, and fail along a mechanism that is known."""

import pytest
from bench.cases import KNOWN_STRUCTURES

from dem_cli.analyses.solve import solve
from dem_cli.core.records.ports import Observer
from dem_cli.core.statics import failure_load
from dem_cli.core.statics.equilibrium import Verdict


def solved(name, *overrides):
    case, model = KNOWN_STRUCTURES[name].build(*overrides)
    return solve(case, model, Observer()).summary


def steps(found, kind):
    return sum(way["steps"] for way in found["search"] if way["kind"] == kind)


@pytest.mark.parametrize("name", ["COL14", "ARCH μ 0.6"])
def test_the_fast_way_leads_to_the_same_bracket(name, monkeypatch):
    soon = solved(name)
    monkeypatch.setattr(failure_load, "relax", lambda sim, *_, **__: Verdict("unknown", sim.unbalanced))
    damped = solved(name)
    assert soon["failure_load_bracket"] == pytest.approx(damped["failure_load_bracket"], rel=1e-6)
    assert soon["unique"]
    assert soon["failure_mode"] == damped["failure_mode"] == "rocking"
    assert 3 * steps(soon, "load") < steps(damped, "load")


def test_joints_that_slide_do_not_take_it(monkeypatch):
    monkeypatch.setattr(failure_load, "relax", lambda *_, **__: pytest.fail("a way that sliding joints remember"))
    assert not solved("ARCH μ 0.4", "analysis.resolution=0.01")["unique"]


def test_a_path_that_ends_at_the_bound_knows_the_mechanism(monkeypatch):
    known = solved("ARCH μ 0.4")
    monkeypatch.setattr(failure_load, "follows", lambda *_: False)  # as if another mechanism had set in
    found = solved("ARCH μ 0.4")
    assert known["failure_load_bracket"] == found["failure_load_bracket"]
    assert known["failure_mode"] == found["failure_mode"] == "mixed"
    assert known["mechanism"] == found["mechanism"]
    assert 2 * steps(known, "impossible") < steps(found, "impossible")
