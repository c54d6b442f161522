"""Ctrl-C during a pushover: what is known by then is kept."""

from __future__ import annotations

import pytest
from casefiles import CASES

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.core.records.ports import Observer


class ImpatientObserver(Observer):
    """Presses Ctrl-C at the third report of a stage."""

    def __init__(self, stage: str):
        self.stage, self.reports = stage, 0

    def progress(self, stage, load, displacement, fraction):
        self.reports += stage == self.stage
        if self.reports == 3:
            raise KeyboardInterrupt


@pytest.fixture(scope="module")
def wall():
    loaded = api.load_case(CASES / "verification" / "wall_21.toml")
    return loaded.case, api.build_model(loaded)


def test_in_the_collapse(wall):
    summary = solve(*wall, ImpatientObserver("following the collapse")).summary
    assert summary["status"] == "interrupted"
    assert summary["failure_load"] == pytest.approx(0.6, abs=0.0018)
    assert summary["failure_mode"] == "sliding"


def test_in_the_search(wall):
    summary = solve(*wall, ImpatientObserver("raising the load")).summary
    assert summary["status"] == "interrupted"
    assert summary["failure_load"] is None
    low, high = summary["failure_load_bracket"]
    assert 0.0 < low < 0.6
    assert high is None
