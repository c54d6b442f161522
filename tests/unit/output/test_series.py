"""Time histories on disk: results.h5, history.csv, peaks, and what a killed run leaves."""

from __future__ import annotations

import csv

import h5py
import numpy as np
import pytest
from synthetic import wall_model, wall_summary
from synthetic.shaking import shaken, write_shaking

from dem_cli.core.records.history_rows import Samples
from dem_cli.results.output.paraview.vtk import export_pvd
from dem_cli.results.output.reader import read
from dem_cli.results.output.store import ResultWriter

NAMES, QUANTITIES = ("top, left", "hinge"), ("acceleration", "opening")


def writer_in(folder) -> ResultWriter:
    return ResultWriter(folder, wall_model(), "", {}, NAMES, "time-history", quantities=QUANTITIES)


def stretches(n: int = 3000, each: int = 700) -> list[Samples]:
    """A history cut into pieces of different lengths."""
    whole = shaken(n, len(NAMES))
    return [Samples(*(column[i : i + each] for column in whole[:3])) for i in range(0, n, each)]


def test_what_goes_in_comes_out(tmp_path):
    writer = writer_in(tmp_path)
    for samples in stretches():
        writer.samples(samples)
    writer.close({**wall_summary(), "kind": "time-history"})
    whole, found = shaken(3000, 2), read(tmp_path).series
    np.testing.assert_array_equal(found.time, whole.times)
    np.testing.assert_array_equal(found.base, whole.base)
    np.testing.assert_array_equal(np.stack(list(found.monitors.values()), axis=1), whole.monitors)
    assert list(found.monitors) == list(NAMES)
    assert found.quantities == dict(zip(NAMES, QUANTITIES, strict=True))


def test_the_text_has_the_same_numbers_and_says_their_units(tmp_path):
    writer = writer_in(tmp_path)
    for samples in stretches():
        writer.samples(samples)
    writer.close(wall_summary())
    rows = list(csv.reader((tmp_path / "history.csv").read_text(encoding="utf-8").splitlines()))
    assert rows[0] == [
        "time [s]", "base acceleration x [m/s2]", "base acceleration y [m/s2]", "base velocity x [m/s]",
        "base velocity y [m/s]", "base displacement x [m]", "base displacement y [m]",
        "top, left [m/s2]", "hinge [m]",
    ]  # fmt: skip
    whole = shaken(3000, 2)
    expected = np.column_stack([whole.times, whole.base.reshape(3000, -1), whole.monitors])
    np.testing.assert_allclose(np.array(rows[1:], float), expected, rtol=1e-8)


def test_peaks_keep_their_sign_over_all_stretches(tmp_path):
    writer = writer_in(tmp_path)
    times = np.linspace(0.0, 1.0, 11)
    values = np.zeros((11, 2))
    values[3, 0], values[8, 0], values[-1, 1] = 2.0, -5.0, 0.25
    for part in (slice(0, 5), slice(5, 11), slice(11, 11)):
        writer.samples(Samples(times[part], np.zeros((11, 3, 2))[part], values[part]))
    assert writer.measured({})["peaks"] == {
        "top, left": {
            "peak": -5.0, "time": 0.8, "max": 2.0, "max_time": pytest.approx(0.3), "min": -5.0, "min_time": 0.8,
            "residual": 0.0, "during_motion": -5.0, "during_motion_time": 0.8, "unit": "m/s2",
        },
        "hinge": {
            "peak": 0.25, "time": 1.0, "max": 0.25, "max_time": 1.0, "min": 0.0, "min_time": 0.0,
            "residual": 0.25, "during_motion": 0.25, "during_motion_time": 1.0, "unit": "m",
        },
    }  # fmt: skip
    writer.abandon()


def test_a_killed_run_has_all_up_to_the_last_flush(tmp_path, monkeypatch):
    monkeypatch.setattr("dem_cli.results.output.store._BUFFERED_SAMPLES", 1024)
    writer = writer_in(tmp_path)
    for samples in stretches():
        writer.samples(samples)
    found = read(tmp_path)  # while it runs, as after a kill
    assert found.status == "running"
    assert 3000 - 1024 - 700 < len(found.series.time) <= 3000
    np.testing.assert_array_equal(found.series.time, shaken(3000, 2).times[: len(found.series.time)])
    assert not (tmp_path / "history.csv").exists()
    writer.abandon()
    assert len(read(tmp_path).series.time) == len(found.series.time)


def test_one_value_per_monitor(tmp_path):
    writer = writer_in(tmp_path)
    with pytest.raises(ValueError, match="3 values of 2 monitors"):
        writer.samples(shaken(10, 3))
    writer.abandon()


def test_other_runs_have_no_series(tmp_path):
    ResultWriter(tmp_path, wall_model(), "", {}).close(wall_summary())
    assert read(tmp_path).series is None
    assert not (tmp_path / "history.csv").exists()


def test_frames_are_counted_in_seconds(tmp_path):
    results = read(write_shaking(tmp_path))
    times = [frame.time for frame in results.frames]
    assert times[1] > 0.0 == times[0]
    with h5py.File(tmp_path / "results.h5") as file:
        np.testing.assert_array_equal(file["VTKHDF/Steps/Values"][:], times)
    text = export_pvd(results, tmp_path / "pvd")[0].read_text(encoding="utf-8")
    assert f'timestep="{times[1]:.9g}"' in text
    np.testing.assert_array_equal(results.history["time"][-1], times[-1])
