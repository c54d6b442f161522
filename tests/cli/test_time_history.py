"""A time history as a user sees it: what is printed, written and drawn, and what is left of a run that was stopped."""

from __future__ import annotations

import csv
import json
import time

import numpy as np
import pytest
from click.testing import CliRunner
from synthetic import wall_model
from synthetic.runs import load
from synthetic.shaking import COLLAPSE, shaken, shaking_frames, shaking_rows, shaking_summary

from dem_cli.app.api import load_case
from dem_cli.app.cli.main import main
from dem_cli.app.cli.run import execute
from dem_cli.app.cli.words import console
from dem_cli.errors import SolverError
from dem_cli.results.output.reader import read
from dem_cli.results.output.summary import exit_code

CASE = """\
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.8
[[structure]]
kind = "column"
id = "c"
courses = 1
block = [0.5, 1.5]
[analysis]
kind = "time-history"
duration = 2.0
[motion]
kind = "pulse"
shape = "sine"
amplitude = 4.0
frequency = 1.0
[output]
frames = 20
rate = 100
[[monitor]]
name = "turn"
block = "c-1"
quantity = "rotation"
[[monitor]]
point = [-0.25, 1.5]
component = "x"
[[monitor]]
point = [-0.25, 1.5]
quantity = "velocity"
component = "x"
[[monitor]]
point = [-0.25, 1.5]
quantity = "acceleration"
component = "x"
[[monitor]]
point = [-0.25, 1.5]
quantity = "acceleration"
component = "x"
absolute = true
[[monitor]]
between = ["c-base", "c-1"]
quantity = "opening"
"""
NAMES = ["turn", "(-0.25, 1.5) displacement x", "(-0.25, 1.5) velocity x", "(-0.25, 1.5) acceleration x",
         "(-0.25, 1.5) absolute acceleration x", "c-base | c-1 opening"]  # fmt: skip


@pytest.fixture(scope="module")
def rocked(tmp_path_factory):
    """Folder and printed text of a rocking block, run as a user runs it."""
    folder = tmp_path_factory.mktemp("rocking")
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    result = CliRunner().invoke(main, ["run", str(folder / "case.toml"), "-o", str(folder / "out"), "-q"])
    assert result.exit_code == 0, result.output
    return folder / "out", result.output


def test_the_answer(rocked):
    folder, text = rocked
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert list(summary)[:12] == ["title", "kind", "version", "status", "collapsed", "collapse_time", "ending",
                                  "at_rest", "followed", "contradictions", "peaks", "joint_state"]  # fmt: skip
    assert list(summary["peaks"]) == NAMES
    series = read(folder).series
    turn, peak = series.monitors["turn"], summary["peaks"]["turn"]
    assert abs(peak["peak"]) >= np.abs(turn).max() - 1e-15  # of all steps
    assert peak["peak"] == pytest.approx(turn[np.abs(turn).argmax()], rel=1e-3)
    assert peak["residual"] == turn[series.time < summary["duration"]][-1]
    assert series.time[-1] == pytest.approx(summary["duration"] + summary["followed"], abs=0.011)
    assert "  result         stood, still rocking\n" in text
    assert f", {peak['residual']:.3g} rad at the end, still moving\n" in text
    assert f"  peak           turn: {peak['peak']:.3g} rad at {peak['time']:.4g} s, " in text
    assert "  energy went to dashpots " in text
    assert "history.csv" in text
    assert read(folder).series.quantities[NAMES[4]] == "absolute acceleration"  # a panel of its own


def test_histories_agree_with_each_other(rocked):
    """While the block turns about one corner all monitors follow from its rotation."""
    series = read(rocked[0]).series
    turn, moved, speed, change, absolute, opening = (series.monitors[name] for name in NAMES)
    assert (np.diff(series.time) > 0.0).all()
    assert 95.0 < 1.0 / np.diff(series.time).mean() < 105.0
    np.testing.assert_allclose(absolute - change, series.base[:, 0, 0], atol=1e-9)
    rocking = (series.time > 1.1) & (series.time < 1.7)  # after the pulse, about the right corner
    assert (turn[rocking] < -0.02).all()
    np.testing.assert_allclose(opening[rocking], 0.5 * np.sin(-turn[rocking]), atol=1e-4)
    each = series.time[1]
    np.testing.assert_allclose(np.gradient(moved, each)[rocking], speed[rocking], atol=2e-3)
    np.testing.assert_allclose(np.gradient(speed, each)[rocking], change[rocking], atol=2e-2)


def test_the_pulse_is_what_was_asked_for(rocked):
    series = read(rocked[0]).series
    t = series.time
    asked = np.where(t <= 1.0, 4.0 * np.sin(2.0 * np.pi * t), 0.0)
    np.testing.assert_allclose(series.base[:, 0, 0], asked, atol=1e-9)
    np.testing.assert_allclose(series.base[:, 0, 1], 0.0, atol=1e-15)


def test_the_text_file(rocked):
    rows = list(csv.reader((rocked[0] / "history.csv").read_text(encoding="utf-8").splitlines()))
    assert rows[0][-6:] == [f"{name} [{unit}]" for name, unit in
                            zip(NAMES, ("rad", "m", "m/s", "m/s2", "m/s2", "m"), strict=True)]  # fmt: skip
    series = read(rocked[0]).series
    np.testing.assert_allclose(np.array(rows[1:], float)[:, -6], series.monitors["turn"], rtol=1e-8, atol=1e-30)


def test_pictures_and_export(rocked, tmp_path):
    pytest.importorskip("matplotlib")
    folder = rocked[0]
    result = CliRunner().invoke(main, ["plot", str(folder), "-o", str(tmp_path), "--animate"])
    assert result.exit_code == 0, result.output
    names = {path.name for path in tmp_path.iterdir()}
    assert names >= {"collapse.gif", "collapse.png", "energy.png", "histories.png"}
    assert "capacity.png" not in names
    result = CliRunner().invoke(main, ["export", str(folder), "--pvd", "-o", str(tmp_path / "pvd")])
    assert result.exit_code == 0, result.output
    frames = read(folder).frames
    text = (tmp_path / "pvd" / "blocks.pvd").read_text(encoding="utf-8")
    assert f'timestep="{frames[-1].time:.9g}"' in text


@pytest.mark.parametrize(
    ("error", "status", "code"),
    [(KeyboardInterrupt(), "interrupted", 130), (SolverError("blew up at 2.5 s"), "not converged", 3)],
)
def test_stopped_half_way(tmp_path, error, status, code):
    def solve(case, model, observer):
        frames, whole = shaking_frames(model, 10), shaken(1001, 1)
        for row in shaking_rows(frames):
            if row.time < 2.5:
                observer.row(row._replace(monitors=(0.0,)))
        observer.samples(type(whole)(*(column[:500] for column in whole[:3])))
        observer.frame(frames[0])
        raise error

    loaded = load(tmp_path / "case.toml")
    kind = loaded.case.analysis.model_copy(update={"kind": "time-history"})
    loaded.case = loaded.case.model_copy(update={"analysis": kind, "reference": ()})
    summary, folder = execute(loaded, wall_model(), tmp_path / "out", time.perf_counter(), solve=solve, quiet=True)
    assert (summary["status"], exit_code(summary)) == (status, code)
    assert (summary["collapsed"], summary["collapse_time"]) == (None, None)
    assert "failure_load" not in summary
    assert summary["reached"]["stage"] == "shaking"
    assert 2.0 < summary["reached"]["time"] < 2.5
    assert summary["peaks"]["base displacement"]["residual"] == shaken(1001, 1).monitors[499, 0]
    assert len(read(folder).series.time) == 500
    assert len((folder / "history.csv").read_text(encoding="utf-8").splitlines()) == 501
    text = console.answer(summary, folder, ["summary.json"])
    assert f"status         {status}" in text
    assert "reached        shaking, 2.4" in text
    assert "base displacement: " in text


def test_a_collapse_is_an_answer(tmp_path):
    text = console.answer(shaking_summary(), tmp_path, [])
    assert f"result         collapsed at {COLLAPSE:g} s" in text
    assert "energy went to dashpots 45 %, friction 40 %, mass damping 10 %, damping 5 %" in text


def test_names_of_monitors(tmp_path):
    from dem_cli.app.pipeline.monitor_names import monitor_names

    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    assert monitor_names(load_case(tmp_path / "case.toml").case.monitor) == NAMES


def test_a_peak_has_the_spread_of_its_repeats_beside_it(tmp_path):
    peak = {"peak": 0.628, "time": 8.25, "residual": 0.35, "unit": "m"}
    spread = {"min": 0.149, "p16": 0.15, "median": 0.153, "p84": 0.2, "max": 0.259, "unit": "m"}
    repeats = {"runs": 6, "collapsed": 1, "still_moving": 2, "peaks": {"roof": spread}}
    summary = shaking_summary() | {"collapsed": None, "ending": "still moving", "at_rest": False}
    text = console.answer(summary | {"peaks": {"roof": peak}, "repeats": repeats}, tmp_path, [])
    assert (
        "  result         still moving at the end: whether it falls is not known, and a larger peak may follow\n"
        in text
    )
    assert "roof: 628 mm at 8.25 s, 350 mm at the end, still moving\n" in text
    assert "of its repeats 149 mm to 259 mm\n" in text
    assert "1 of 6 perturbed structures collapsed, 2 still moved in the end\n" in text
