"""A kind of analysis is known everywhere: what people read of it never falls back to another kind without a word."""

from __future__ import annotations

import pytest

from dem_cli.analyses import estimate_cost
from dem_cli.analyses.registry import ANALYSES
from dem_cli.analysis_kinds import KINDS
from dem_cli.results.report import facts


@pytest.mark.parametrize("kind", ANALYSES)
def test_a_report_says_what_kind_it_is_and_what_came_out(kind):
    assert kind in KINDS
    assert kind in {*facts._ANSWERS, *facts._ENDS}


@pytest.mark.parametrize("kind", ANALYSES)
def test_the_cost_of_a_run_is_estimated(kind):
    assert KINDS[kind].shakes != (kind in estimate_cost.STEPS)


def test_tables_by_kind_name_no_kind_that_is_gone():
    assert {*facts._ENDS, *estimate_cost.STEPS} <= set(ANALYSES)
    assert {*KINDS, *facts._ANSWERS} - set(ANALYSES) == {"limit"}  # of `dem limit`
