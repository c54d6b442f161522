"""Peaks of slightly different structures: their spread over those that stand, whatever is monitored."""

from __future__ import annotations

from dem_cli.analyses.time_history import spread
from dem_cli.ensembles.shaken_run import ShakenRunResult


def run(collapsed: bool, *peaks: float) -> ShakenRunResult:
    return ShakenRunResult(collapsed, 1.0, "", peaks, 10, 0.0, 0.1, "collapsed" if collapsed else "rests")


def test_percentiles_of_those_that_stand():
    found = spread([run(False, 1.0, 5.0), run(True, 99.0, 99.0), run(False, 3.0, 5.0)], 2)
    assert (found["runs"], found["collapsed"]) == (3, 1)
    assert (found["peaks"][0]["median"], found["peaks"][1]["max"]) == (2.0, 5.0)


def test_where_none_stands_there_are_no_percentiles():
    assert spread([run(True, 99.0)], 1)["peaks"] == [None]


def test_nothing_monitored_is_nothing_to_spread():
    found = spread([run(False), run(True), run(False)], 0)
    assert (found["runs"], found["collapsed"], found["peaks"]) == (3, 1, [])
