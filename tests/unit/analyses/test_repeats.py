"""Peaks of slightly different structures: their spread over those that stand, whatever is monitored."""

from __future__ import annotations

from dem_cli.analyses.ensembles.shaken_run import ShakenRunResult
from dem_cli.analyses.time_history import otherwise, spread
from dem_cli.core.records.statuses import MOVES


def run(collapsed: bool, *peaks: float) -> ShakenRunResult:
    return ShakenRunResult(collapsed, 1.0, "", peaks, 10, 0.0, 0.1, "collapsed" if collapsed else "rests")


def test_percentiles_of_those_that_stand():
    found = spread([run(False, 1.0, 5.0), run(True, 99.0, 99.0), run(False, 3.0, 5.0)], 2)
    assert (found["runs"], found["collapsed"]) == (3, 1)
    assert (found["peaks"][0]["median"], found["peaks"][1]["max"]) == (2.0, 5.0)


def test_those_that_still_move_are_neither_standing_nor_fallen():
    moving = run(False, 9.0)._replace(collapsed=None, ending=MOVES)
    found = spread([run(False, 1.0), moving, run(True, 99.0)], 1)
    assert (found["runs"], found["collapsed"], found["still_moving"], found["share_collapsed"]) == (3, 1, 1, 0.5)
    assert found["peaks"][0]["max"] == 1.0


def test_repeats_that_end_otherwise_contradict_the_run():
    found = spread([run(False), run(True), run(True), run(True)._replace(collapsed=None, ending=MOVES)], 0)
    assert otherwise(False, found) == ["2 of 4 perturbed structures collapsed"]
    assert otherwise(True, found) == ["1 of 4 perturbed structures stood"]
    assert otherwise(None, found) == []
    assert otherwise(False, spread([run(False)], 0)) == otherwise(True, spread([run(True)], 0)) == []


def test_where_none_stands_there_are_no_percentiles():
    assert spread([run(True, 99.0)], 1)["peaks"] == [None]


def test_nothing_monitored_is_nothing_to_spread():
    found = spread([run(False), run(True), run(False)], 0)
    assert (found["runs"], found["collapsed"], found["peaks"]) == (3, 1, [])
