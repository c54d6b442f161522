"""What runs at several intensities say."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dem_cli.analyses.ensembles.batch import ShakingTrial
from dem_cli.analyses.ensembles.capacities import between, bounds_of, outcomes, split, survived_above
from dem_cli.analyses.ensembles.record_search import bisection, runs_per_record
from dem_cli.analyses.ensembles.shaken_run import ShakenRunResult
from dem_cli.case.tables.analysis import FragilityAnalysis
from dem_cli.errors import CaseError
from dem_cli.results.output.distinct_names import distinct
from dem_cli.results.output.ending import median_words


def run_of(collapsed):
    return ShakenRunResult(collapsed, None, "", (), 1, 0.0, 0.0)


def test_the_lowest_collapse_counts_and_what_survived_above_it_is_told():
    fell = {1.0: False, 2.0: True, 3.0: False, 4.0: True}
    assert bounds_of(fell) == (1.0, 2.0)
    assert survived_above(fell) == [3.0]
    assert bounds_of({1.0: False}) == (1.0, math.inf)
    assert bounds_of({1.0: True}) == (0.0, 1.0)
    assert bounds_of({}) is None
    assert survived_above({1.0: False, 2.0: False}) == []


def test_failed_runs_are_left_out():
    done = {
        ShakingTrial(0, 1, 2.0): run_of(True),
        ShakingTrial(0, 1, 1.0): run_of(None),
        ShakingTrial(1, 1, 1.0): run_of(False),
    }
    assert outcomes(done, 0, 1) == {2.0: True}


def test_half_of_the_capacities_lie_between_the_middle_bounds():
    low, high, never = [1.0, 2.0], [2.0, 3.0], [3.0, math.inf]
    assert between(np.array([[low], [low], [low]])) == (1.0, 2.0)
    assert between(np.array([[low], [high]])) == (1.0, 3.0)
    assert between(np.array([[low], [high], [high]])) == (2.0, 3.0)
    assert between(np.array([[low, never], [never, never]])) == (3.0, math.inf)


def test_words_of_a_median_that_levels_do_not_resolve():
    assert median_words({"median": 1.23456}) == "1.235"
    assert median_words({"median": None, "median_between": [0.4, 0.7]}) == "between 0.4 and 0.7"
    assert median_words({"median": None, "median_between": [0.4, None]}) == "above 0.4"
    assert median_words({"median": None, "median_between": [0.0, 0.4]}) == "below 0.4"
    assert median_words({"median": None, "median_between": None}) == ""


def test_dispersion_is_split_as_the_numbers_were_made():
    generator = np.random.default_rng(3)
    records, within = generator.normal(0.0, 0.3, (400, 1)), generator.normal(0.0, 0.1, (400, 5))
    values = np.exp(records + within)
    found = split(np.stack([0.999 * values, 1.001 * values], axis=2))
    assert found["records"] == pytest.approx(0.3, rel=0.1)
    assert found["perturbation"] == pytest.approx(0.1, rel=0.1)
    assert split(np.ones((5, 1, 2))) is None


@pytest.mark.parametrize("capacity", [0.5, 1.0, 1.37, 2.96, 3.0, 9.0])
@pytest.mark.parametrize(
    "keys", [{"intensities": (1.0, 1.5, 2.0, 2.5, 3.0)}, {"lowest": 1.0, "highest": 3.0, "resolution": 0.1}]
)
def test_bisection_brackets_a_capacity_with_few_runs(capacity, keys):
    analysis = FragilityAnalysis(search="bisection", **keys)
    done = {}

    def answer(trial):
        assert trial not in done
        done[trial] = run_of(trial.intensity >= capacity)
        return done[trial]

    bisection(analysis, 2, 3)(answer)
    found = bounds_of(outcomes(done, 2, 3))
    assert len(done) <= runs_per_record(analysis)
    assert found.lower < capacity <= found.upper
    if 1.0 < capacity <= 3.0:
        assert found.upper - found.lower <= 0.5 + 1e-12 if "intensities" in keys else 0.1 + 1e-12
    else:
        assert found == ((0.0, 1.0) if capacity <= 1.0 else (3.0, math.inf))


def test_names_that_come_again_get_a_number():
    assert distinct(["a", "b", "a", "a"]) == ["a", "b", "a #2", "a #3"]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({}, "give intensities, or lowest"),
        ({"intensities": (1.0, 1.0)}, "intensities increase"),
        ({"intensities": (1.0,), "lowest": 1.0}, "not allowed beside intensities"),
        ({"lowest": 1.0, "highest": 2.0}, "missing"),
        ({"lowest": 2.0, "highest": 1.0, "resolution": 0.1}, "more than lowest"),
        ({"lowest": 1.0, "highest": 2.0, "resolution": 0.1, "search": "grid"}, "needs intensities"),
    ],
)
def test_levels_or_a_range(keys, words):
    with pytest.raises((ValueError, CaseError), match=words):
        FragilityAnalysis(**keys)
