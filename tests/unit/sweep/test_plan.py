"""Which runs a [sweep] asks for, and in which order."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem_cli.app.sweep import plan
from dem_cli.app.sweep.distributions import drawn, even, latin_hypercube
from dem_cli.app.sweep.plan import plan_of
from dem_cli.case.sweep import Sweep
from dem_cli.errors import CaseError

FRICTION, COURSES = "joints.dry.friction", "structure.0.courses"


def values(seed: int = 1, **table) -> list[dict]:
    return [run.values for run in plan_of(Sweep.model_validate(table), seed).runs]


def problem(**table) -> str:
    with pytest.raises(CaseError) as caught:
        values(**table)
    return str(caught.value)


def test_a_grid_has_every_combination_the_last_key_fastest():
    assert values(**{FRICTION: [0.5, 0.6], COURSES: [2, 3]}) == [
        {FRICTION: 0.5, COURSES: 2},
        {FRICTION: 0.5, COURSES: 3},
        {FRICTION: 0.6, COURSES: 2},
        {FRICTION: 0.6, COURSES: 3},
    ]


def test_keys_without_quotes_are_the_same_keys():
    assert values(joints={"dry": {"friction": [0.5, 0.6]}}) == values(**{FRICTION: [0.5, 0.6]})


def test_zip_takes_lists_side_by_side():
    assert values(zip=True, **{FRICTION: [0.5, 0.6], COURSES: [2, 3]}) == [
        {FRICTION: 0.5, COURSES: 2},
        {FRICTION: 0.6, COURSES: 3},
    ]
    assert "one length; joints.dry.friction has 2, structure.0.courses has 1" in problem(
        zip=True, **{FRICTION: [0.5, 0.6], COURSES: [2]}
    )


def test_rows_have_keys_of_their_own_and_are_combined_with_the_grid():
    rows = [{"name": "low", COURSES: 2}, {"name": "rough", FRICTION: 0.9}]
    assert values(run=rows, **{FRICTION: [0.5, 0.6]}) == [
        {"name": "low", COURSES: 2, FRICTION: 0.5},
        {"name": "low", COURSES: 2, FRICTION: 0.6},
        {"name": "rough", FRICTION: 0.9},  # what a row says counts
    ]
    plan = plan_of(Sweep.model_validate({"run": rows}), 1)
    assert plan.keys == ("name", COURSES, FRICTION)
    assert [override.text for override in plan.runs[0].overrides] == [COURSES, "sweep"]  # a name is no key of a case


def test_a_bundle_changes_several_keys_and_is_combined_over_its_names():
    bundles = {"brick": {"small": {"structure.0.block": [0.2, 0.1], COURSES: 8}, "big": {COURSES: 4}}}
    table = Sweep.model_validate({"bundle": bundles, FRICTION: [0.5, 0.6]})
    plan = plan_of(table, 1)
    assert [run.values for run in plan.runs] == [
        {FRICTION: f, "brick": name} for f in (0.5, 0.6) for name in ("small", "big")
    ]
    texts = [override.text for override in plan.runs[0].overrides]
    assert texts == ["structure.0.block", COURSES, FRICTION, "sweep"]  # single keys may change what a bundle brought
    assert [override.value for override in plan.runs[0].overrides][:2] == [[0.2, 0.1], 8]
    chosen = values(bundle=bundles, run=[{"brick": "big"}])
    assert chosen == [{"brick": "big"}]
    assert "did you mean 'small'" in problem(bundle=bundles, run=[{"brick": "smal"}])
    for nested in ({"x": 1}, [["small"]]):  # no name can be one
        assert "unknown bundle" in problem(bundle=bundles, run=[{"brick": nested}])


@settings(deadline=None)  # the first one imports scipy
@given(count=st.integers(1, 40), keys=st.integers(1, 4), seed=st.integers(0, 2**32))
def test_a_latin_hypercube_has_one_point_in_every_slice(count, keys, seed):
    points = latin_hypercube(keys, count, seed)
    assert (np.sort(np.floor(points * count), axis=0) == np.arange(count)[:, np.newaxis]).all()


def test_drawn_values_come_from_the_seed():
    table = {"samples": 5, FRICTION: {"uniform": [0.5, 0.7]}, COURSES: {"integers": [2, 9]}}
    assert values(**table) == values(**table) != values(seed=2, **table)
    assert all(0.5 < run[FRICTION] < 0.7 and run[COURSES] in range(2, 10) for run in values(**table))
    assert len(values(run=[{"name": "a"}, {"name": "b"}], **table)) == 10


@pytest.mark.parametrize(
    ("form", "at_half", "at_84"),
    [
        ({"uniform": [1.0, 3.0]}, 2.0, 1.0 + 2.0 * 0.8413447460685429),
        ({"loguniform": [1.0, 100.0]}, 10.0, 100.0**0.8413447460685429),
        ({"normal": [5.0, 2.0]}, 5.0, 7.0),
        ({"lognormal": [5.0, 0.3]}, 5.0, 5.0 * math.exp(0.3)),
        ({"integers": [3, 6]}, 5, 6),
    ],
)
def test_quantiles_of_the_distributions(form, at_half, at_84):
    assert drawn(("sweep", "x"), form, np.array([0.5, 0.8413447460685429])) == pytest.approx([at_half, at_84])


def test_every_integer_is_as_likely():
    found = drawn(("sweep", "x"), {"integers": [3, 6]}, (np.arange(400) + 0.5) / 400)
    assert [found.count(n) for n in range(2, 8)] == [0, 100, 100, 100, 100, 0]


def test_even_distances():
    assert even((), {"from": 0.1, "to": 0.5, "count": 5}) == [0.1, 0.2, 0.3, 0.4, 0.5]
    assert even((), {"from": 1, "to": 1000, "count": 4, "log": True}) == [1.0, 10.0, 100.0, 1000.0]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({}, "nothing to be changed"),
        ({FRICTION: []}, "an empty list"),
        ({FRICTION: 0.5}, "must be a list of values"),
        ({FRICTION: {"uniform": [0.5, 0.7]}}, "samples = 100"),
        ({"samples": 3, FRICTION: [0.5]}, "nothing to be drawn"),
        ({"samples": 3, FRICTION: {"uniform": [0.7, 0.5]}}, "larger than the first"),
        ({"samples": 3, FRICTION: {"loguniform": [0.0, 0.5]}}, "both > 0"),
        ({"samples": 3, FRICTION: {"normal": [0.7, 0.0]}}, "deviation"),
        ({"samples": 3, FRICTION: {"uniform": [0.7]}}, "two numbers"),
        ({"samples": 3, FRICTION: {"integers": [1, 2.5]}}, "whole numbers"),
        ({"samples": 3, FRICTION: {"uniform": [1, 2], "normal": [1, 2]}}, "one distribution"),
        ({FRICTION: {"from": 0.1, "to": 0.5}}, "'count'"),
        ({FRICTION: {"from": 0.1, "count": 5}}, "'to' is missing"),
        ({FRICTION: {"from": 0.0, "to": 0.5, "count": 5, "log": True}}, "positive ends"),
        ({FRICTION: {"from": 0.1, "to": 0.5, "count": 5, "step": 2}}, "unknown key"),
        ({"a b": [1]}, "is not a key of a case"),
        ({"sweep.zip": [True]}, "does not change itself"),
    ],
)
def test_mistakes(table, message):
    assert message in problem(**table)


def test_a_change_that_undoes_another_is_refused():
    assert "has its values already" in problem(**{FRICTION: [0.5], "joints": {"dry": {"friction": [0.6]}}})
    lost = "joints.dry.friction is changed here, and joints.dry.friction before: that would be lost"
    assert lost in problem(**{FRICTION: [0.5, 0.6], 'joints."dry".friction': [0.3]})
    assert "structure.0 is changed here, and structure.0.courses before" in problem(
        **{COURSES: [2], "structure.0": [{"kind": "column"}]}
    )
    bundles = {"wall": {"low": {COURSES: 2}}, "soil": {"soft": {COURSES: 3}}}
    assert "structure.0.courses before" in problem(bundle=bundles)
    parts = {"structure.0": [{"kind": "column"}], COURSES: [2, 3]}  # first the whole, then a part of it
    assert len(values(**parts)) == 2
    assert len(values(bundle={"wall": {"low": {COURSES: 2}}}, **{COURSES: [4, 5]})) == 2


@pytest.mark.parametrize("axis", ["run", "status", "reason", "name"])
def test_columns_of_the_table_are_no_axes(axis):
    assert "is a column of the table already" in problem(bundle={axis: {"low": {COURSES: 2}}})


def test_too_many_runs_are_refused_before_they_fill_the_memory(monkeypatch):
    many = {"from": 0.0, "to": 1.0, "count": 1000}
    monkeypatch.delattr(plan, "_change")  # nothing is made for the values
    assert "asks for 1,000,000,000 runs" in problem(**{FRICTION: many, COURSES: many, "title": many})
    assert "at most 1,000,000" in problem(**{FRICTION: many | {"count": 10**9}})
    assert "asks for 1,000,000,000 runs" in problem(samples=10**9, **{FRICTION: {"uniform": [0.1, 0.2]}})
