"""Fragility against Housner's block: where it falls, where it stands again, whatever the threads and the search."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracle.base_motion import pulse
from oracle.housner import Block, overturns

from dem_cli.analyses.ensembles import shaken_run
from dem_cli.analyses.ensembles.batch import Batch
from dem_cli.analyses.fragility import run
from dem_cli.analyses.time_history import run as repeated
from dem_cli.app import api
from dem_cli.app.cli.words.fragility import fragility_rows
from dem_cli.core.records.ports import Observer
from dem_cli.errors import SolverError

BLOCK = Path(__file__).resolve().parents[2] / "cases" / "verification" / "rocking_pulse_falls.toml"
EXACT = Block(0.5, 2.0)
FREQUENCY, LENGTH = 1.7, 5.0
GRID = [4.2, 4.3, 4.45, 8.0, 12.6, 13.2]  # of pulses [m/s2]; 12.6 is in the gap where the block stands again
SMALL = ["analysis.duration=3.0", "analysis.coda=4.0"]


class Kept(Observer):
    """An observer that keeps the table of all runs."""

    def runs(self, rows):
        self.rows = rows


def study(*overrides, threads=1, kind="fragility", solve=run):
    """Summary and table of a study of the block of the case file under its pulse and others."""
    loaded = api.load_case(BLOCK, [f"analysis.kind={kind}", *overrides])
    kept = Kept()
    summary = solve(loaded.case, api.build_model(loaded), kept, batch=Batch(threads)).summary
    return summary, kept.rows


@pytest.fixture(scope="module")
def grid():
    return study(f"analysis.intensities={GRID}", *SMALL)


def test_the_oracle_falls_and_stands_as_the_case_file_says():
    assert [overturns(EXACT, pulse(a, FREQUENCY), LENGTH) for a in GRID] == [False, False, True, True, False, True]


def test_every_run_of_the_grid_ends_as_the_exact_block(grid):
    _, rows = grid
    assert [row.intensity for row in rows] == GRID
    assert [row.collapsed for row in rows] == [overturns(EXACT, pulse(a, FREQUENCY), LENGTH) for a in GRID]
    assert [row.acceleration for row in rows] == pytest.approx(GRID)
    assert all((row.time is not None) == row.collapsed for row in rows)


def test_what_stood_above_a_collapse_is_told(grid):
    summary, _ = grid
    assert summary["non_monotone"] == [{"record": "sine", "structure": 0, "collapsed": 4.45, "survived": [12.6]}]
    assert summary["collapse_intensities"] == [4.45]
    assert summary["stood_up_to"] == [4.3]
    assert summary["share"] == [0.0, 0.0, 1.0, 1.0, 0.0, 1.0]
    assert summary["runs"] == len(GRID)


def test_bisection_finds_the_exact_overturning_acceleration():
    low, high = 4.0, 5.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if overturns(EXACT, pulse(middle, FREQUENCY), LENGTH) else (middle, high)
    summary, rows = study("analysis.lowest=4.0", "analysis.highest=5.0", "analysis.resolution=0.02", *SMALL)
    assert summary["collapse_intensities"][0] - summary["stood_up_to"][0] <= 0.02
    assert summary["collapse_intensities"] == [pytest.approx(high, rel=0.01)]
    assert len(rows) == summary["runs"] <= 8
    assert any("lower collapse may be missed" in text for text in summary["warnings"])


def test_two_levels_give_no_median_to_four_digits():
    """Three structures stand at 4.2 m/s² and fall at 4.6 m/s²: half of them in between, and no more is known."""
    summary, _ = study("analysis.intensities=[4.2, 4.6]", "analysis.repeats=2", *SMALL)
    assert [summary[key] for key in ("median", "dispersion", "confidence", "curve")] == [None] * 4
    assert summary["median_between"] == [4.2, 4.6]
    rows = dict(fragility_rows(summary | {"kind": "fragility"}))
    assert rows["median"] == "between 4.2 and 4.6: the levels do not resolve it"
    assert any("lie in 1 interval between levels" in text for text in summary["warnings"])


def test_intensity_is_peak_acceleration_over_the_unit():
    _, rows = study("analysis.intensities=[2.225]", "analysis.unit_acceleration=2.0", *SMALL)
    assert rows[0].acceleration == pytest.approx(4.45)
    assert rows[0].collapsed


def test_a_block_that_is_falling_when_the_motion_ends_has_fallen():
    """The pulse lasts 0.59 s; without `duration` only the time after it shows the fall."""
    given = ["analysis.intensities=[4.45]", "analysis.kind=fragility"]
    loaded = api.load_case(BLOCK, given)
    short = loaded.case.analysis.model_copy(update={"duration": None})
    case = loaded.case.model_copy(update={"analysis": short})
    kept = Kept()
    assert run(case, api.build_model(loaded), kept, batch=Batch()).summary["collapse_intensities"] == [4.45]
    assert kept.rows[0].time > 1.0 / FREQUENCY


def test_the_same_bytes_whatever_the_threads():
    overrides = ["analysis.intensities=[4.2, 4.4, 4.6]", "analysis.repeats=2", *SMALL]
    one, rows = study(*overrides, threads=1)
    many, rows_of_many = study(*overrides, threads=4)
    assert rows == rows_of_many
    for key in ("collapse_intensities", "median", "dispersion", "repeats", "share", "steps"):
        assert one[key] == many[key]
    assert one["confidence"] == many["confidence"]
    assert len({row.peaks for row in rows if row.intensity == 4.2}) == 3  # each structure is another one


def test_repeats_of_a_time_history_spread_as_their_perturbation():
    """Without any perturbation all are the same; with the default one the run itself lies among them."""
    base = ["motion.amplitude=3.0", "analysis.repeats=6", "analysis.duration=1.5"]
    none = study(*base, "analysis.perturb={friction=0.0, geometry=0.0, motion=0.0}", kind="time-history",
                 solve=repeated)[1]  # fmt: skip
    assert len({row.peaks for row in none}) == 1
    summary, rows = study(*base, kind="time-history", solve=repeated)
    spread = summary["repeats"]["peaks"][0]
    peaks = np.array([row.peaks[0] for row in rows])
    assert spread["min"] == peaks.min() < spread["median"] == np.median(peaks) < spread["max"] == peaks.max()
    assert summary["repeats"]["collapsed"] == 0
    assert spread["min"] < none[0].peaks[0] < spread["max"]
    assert spread["max"] / spread["min"] < 1.2


def failing(n_runs):
    """A look at the motion that finds it broken as often as said; each run ends with the first such look."""
    left = [n_runs]

    def check(sim):
        if left[0] > 0:
            left[0] -= 1
            raise SolverError("the motion of block 'block' is not a number at 1 s")

    return check


def test_a_run_that_fails_is_told_and_left_out(monkeypatch):
    monkeypatch.setattr(shaken_run, "check_finite", failing(1))
    summary, rows = study("analysis.intensities=[4.2, 4.3, 4.45]", *SMALL)
    assert [row.collapsed for row in rows] == [None, False, True]
    assert "not a number" in rows[0].how
    assert summary["collapse_intensities"] == [4.45]
    assert "sine at 4.2: the motion of block 'block' is not a number at 1 s" in summary["warnings"]
    assert "1 of 3 runs failed and are left out" in summary["warnings"]


def test_a_study_whose_runs_all_fail_has_no_answer(monkeypatch):
    monkeypatch.setattr(shaken_run, "check_finite", failing(9))
    with pytest.raises(SolverError, match="no record has a result; the first: the motion of block"):
        study("analysis.intensities=[4.2, 4.3]", *SMALL)
