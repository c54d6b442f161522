"""A kind of analysis is known everywhere: what people read of it never falls back to another kind without a word."""

from __future__ import annotations

import pytest

from dem_cli.analyses import estimate, estimate_cost
from dem_cli.analyses.registry import ANALYSES
from dem_cli.case.plausibility import SHAKES
from dem_cli.results.report import facts


@pytest.mark.parametrize("kind", ANALYSES)
def test_a_report_says_what_kind_it_is_and_what_came_out(kind):
    assert kind in facts.KIND_TITLES
    assert kind in {*facts._ANSWERS, *facts._ENDS}


@pytest.mark.parametrize("kind", ANALYSES)
def test_the_cost_of_a_run_is_estimated(kind):
    assert kind in {*estimate_cost.STEPS, *estimate.IN_SECONDS}


def test_tables_by_kind_name_no_kind_that_is_gone():
    named = {*facts._ENDS, *estimate_cost.STEPS, *estimate.IN_SECONDS, *estimate.VISIBLE, *SHAKES}
    assert named <= set(ANALYSES)
    assert {*facts.KIND_TITLES, *facts._ANSWERS} - set(ANALYSES) == {"limit"}  # of `dem limit`
    assert set(estimate.IN_SECONDS) == set(SHAKES)
