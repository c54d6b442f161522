"""results.h5 and summary.json: what goes in comes out."""

from __future__ import annotations

import json
from pathlib import Path

import engine
import h5py
import numpy as np
import pytest
from synthetic import history_rows, wall_frames, wall_model, wall_summary

from dem_cli.core.contact.drawn_joints import DrawnJoints
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import ContactRecord, Frame
from dem_cli.core.records.history_rows import Energy, Samples
from dem_cli.errors import UsageError
from dem_cli.results.output.reader import read
from dem_cli.results.output.store import ResultWriter
from dem_cli.results.output.summary import ordered, to_json


def write(folder, frames, rows, model, monitors=("top",)):
    writer = ResultWriter(folder, model, "title = 'é'\n", {"dem": "0.1.0", "numpy": "2"}, monitors)
    for row in rows:
        writer.row(row)
    for frame in frames:
        writer.frame(frame)
    writer.close(wall_summary())


def assert_same_frame(found: Frame, expected: Frame) -> None:
    for name in ("stage", "step", "load", "displacement"):
        assert getattr(found, name) == getattr(expected, name)
    for name in ("positions", "orientations", "velocities"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    for a, b in zip(found.contacts, expected.contacts, strict=True):
        np.testing.assert_array_equal(a, b)
        assert a.dtype == b.dtype


def test_everything_comes_back(tmp_path):
    model = wall_model()
    frames = wall_frames(model)
    rows = history_rows(frames, n_monitors=2)
    write(tmp_path, frames, rows, model, ("top", "middle"))
    results = read(tmp_path)
    assert results.status == "ok"
    assert results.summary == ordered(wall_summary())
    assert results.case_text == (tmp_path / "case.toml").read_text(encoding="utf-8") == "title = 'é'\n"
    assert results.provenance == {"dem": "0.1.0", "numpy": "2"}
    for a, b in zip(results.model, model, strict=True):
        np.testing.assert_array_equal(a, b)
    assert len(results.frames) == len(frames)
    for found, expected in zip(results.frames, frames, strict=True):
        assert_same_frame(found, expected)
    assert_same_frame(results.frames[-1], frames[-1])
    for name in ("stage", "step", "load", "displacement", "unbalanced", "overlap"):
        assert results.history[name].tolist() == [getattr(row, name) for row in rows]
    for i, name in enumerate(Energy._fields):
        assert results.energy[name].tolist() == [row.energy[i] for row in rows]
    assert results.monitors["middle"].tolist() == [row.monitors[1] for row in rows]


def test_a_run_without_frames_is_readable(tmp_path):
    model = wall_model()
    write(tmp_path, [], [], model, ())
    results = read(tmp_path)
    assert len(results.frames) == 0
    assert list(results.frames) == []
    assert results.energy == results.monitors == {}
    assert not (tmp_path / "contacts.vtkhdf").exists()


def test_runs_of_equal_sizes_share_a_skeleton_and_no_numbers(tmp_path):
    model = wall_model()
    heavy = model._replace(masses=2.0 * model.masses, dead_loads=2.0 * model.dead_loads)
    rows = history_rows(wall_frames(model))
    for name, drawn, kept in (("a", model, rows), ("b", heavy, rows[:2]), ("c", model, [])):
        (tmp_path / name).mkdir()
        write(tmp_path / name, [], kept, drawn)
        found = read(tmp_path / name)
        assert found.model.masses.tolist() == drawn.masses.tolist()
        assert found.history.get("step", np.zeros(0)).tolist() == [row.step for row in kept]
    with h5py.File(tmp_path / "c" / "results.h5") as file:
        assert list(file["dem/history"]) == []


def test_rows_without_monitors(tmp_path):
    model = wall_model()
    frames = wall_frames(model)
    write(tmp_path, frames, history_rows(frames, n_monitors=0), model, ())
    assert len(read(tmp_path).history["load"]) == 120
    assert read(tmp_path).monitors == {}


def test_the_same_run_gives_the_same_bytes(tmp_path):
    model = wall_model()
    frames = wall_frames(model)
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        write(tmp_path / name, frames, history_rows(frames), model)
    for name in ("results.h5", "contacts.vtkhdf", "summary.json"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_readable_while_it_is_written(tmp_path):
    model = wall_model()
    frames = wall_frames(model)
    writer = ResultWriter(tmp_path, model, "", {}, ["top"])
    writer.row(history_rows(frames)[0])
    writer.frame(frames[0])
    results = read(tmp_path)
    assert (results.status, results.summary, len(results.frames)) == ("running", {}, 1)
    assert len(results.history["load"]) == 1
    writer.abandon()


def test_rows_are_flushed_without_frames_too(tmp_path, monkeypatch):
    monkeypatch.setattr("dem_cli.results.output.store._BUFFERED_ROWS", 10)
    rows = history_rows(wall_frames(wall_model()))
    writer = ResultWriter(tmp_path, wall_model(), "", {}, ["top"])
    for row in rows[:25]:
        writer.row(row)
    assert len(read(tmp_path).history["load"]) == 20
    writer.abandon()


def test_a_row_has_one_value_per_monitor(tmp_path):
    writer = ResultWriter(tmp_path, wall_model(), "", {}, [])
    with pytest.raises(ValueError, match="1 monitor values for 0 monitors"):
        writer.row(history_rows(wall_frames(wall_model()))[0])
    writer.abandon()


@pytest.mark.parametrize("name", ["missing", "empty"])
def test_no_results_is_the_users_mistake(tmp_path, name):
    (tmp_path / "empty").mkdir()
    with pytest.raises(UsageError, match=name):
        read(tmp_path / name)


def test_a_damaged_file_is_reported(tmp_path):
    (tmp_path / "results.h5").write_bytes(b"nothing")
    with pytest.raises(UsageError, match=r"damaged: results\.h5 is not a whole file of HDF5"):
        read(tmp_path)


def test_summary_is_strict_json_in_a_fixed_order():
    numbers = {
        "extra": np.array([np.nan, 1.0]),
        "warnings": (),
        "title": "x",
        "failure_load": np.float64(0.1) + 0.2,
    }
    text = to_json({**numbers, "time_step": float("inf"), "blocks": np.int64(3)})
    found = json.loads(text, parse_constant=pytest.fail)
    assert list(found) == ["title", "failure_load", "blocks", "time_step", "warnings", "extra"]
    assert found["failure_load"] == 0.1 + 0.2
    assert found["time_step"] is None
    assert found["extra"] == [None, 1.0]


@pytest.mark.parametrize(("kind", "steps", "on_disk"), [
    ("pushover", 1, 3), ("time-history", 1, 1), ("time-history", 30_000_000, 3),
])  # fmt: skip
def test_frames_of_a_history_wait_for_each_other(tmp_path, kind, steps, on_disk):
    """Putting each on disk took a quarter of a short history; one that many steps lead to goes at once."""
    model = wall_model()
    writer = ResultWriter(tmp_path, model, "", {"dem": "0.1.0", "numpy": "2"}, (), kind)
    for k, frame in enumerate(wall_frames(model)[:3]):
        writer.frame(frame._replace(step=steps * k))
    with h5py.File(tmp_path / "results.h5") as file:
        assert len(file["dem/frames/step"]) == on_disk
    writer.close(wall_summary())
    with h5py.File(tmp_path / "results.h5") as file:
        assert len(file["dem/frames/step"]) == 3


def test_rows_and_samples_of_a_history_without_frames_reach_the_disk_with_the_work(tmp_path):
    """What a kill leaves is of the last seconds, also where no frame is wanted and samples are few."""
    writer = ResultWriter(tmp_path, wall_model(), "", {}, ["top"], "time-history")
    rows = [row._replace(step=10_000 * k) for k, row in enumerate(history_rows(wall_frames(wall_model()))[:100])]
    known = 0
    for k, row in enumerate(rows):
        writer.samples(Samples(np.array([0.1 * k]), np.zeros((1, 3, 2)), np.zeros((1, 1))))
        writer.row(row)
        with h5py.File(tmp_path / "results.h5") as file:
            steps = len(file["dem/history/step"])
            assert len(file["dem/series/time"]) == steps if steps else True
        known = max(known, steps)
        assert k - known < 60  # 600,000 steps of some contact points: two seconds
    assert known > 50
    writer.abandon()


def everything(path: Path) -> dict[str, bytes]:
    """Raw bytes of all numbers of a file."""
    found = {}
    with h5py.File(path) as file:
        for top in ("dem", "VTKHDF") if path.name == "results.h5" else ("VTKHDF",):
            if not isinstance(file.get(top, getlink=True), h5py.ExternalLink):
                file[top].visititems(lambda name, item: found.__setitem__(f"/{name}", raw_of(item)))
    return found


def raw_of(item: h5py.Dataset | h5py.Group) -> bytes:
    if isinstance(item, h5py.Group) or item.dtype == object:
        return b""
    return str((item.dtype, item.shape)).encode() + item[()].tobytes()


def prism_frames() -> tuple[Model, list[Frame]]:
    """Two prisms on each other in space, tumbling; from frame to frame there are more contact points."""
    tables = [
        {"id": "below", "polygon": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], "y": [0.0, 0.5], "fixed": True},
        {"id": "above", "polygon": [[0.1, 1.0], [0.9, 1.0], [0.5, 1.8]], "y": [0.0, 0.4]},
    ]
    made = {"dimension": 3, "joints": {"j": {"friction": 0.7}}, "analysis": {"kind": "gravity"}}
    model = engine.scene({**engine.tables(*tables), **made}).model
    random, frames = np.random.default_rng(5), []
    for k in range(5):
        turns = random.normal(size=(2, 4))
        n = 2 + k
        contacts = ContactRecord(
            np.zeros(n, np.int64), np.tile([0, 1], (n, 1)), random.normal(size=(n, 3)), random.normal(size=(n, 3)),
            random.normal(size=n), random.normal(size=(n, 2)), random.normal(size=n), random.normal(size=n),
            np.ones(n, np.int8), random.normal(size=(n, 3)),
        )  # fmt: skip
        frames.append(Frame(
            "shaking", k, 0.1 * k, 0.2, random.normal(size=(2, 3)), turns / np.linalg.norm(turns, axis=1)[:, None],
            random.normal(size=(2, 6)), contacts, 0.01 * k,
        ))  # fmt: skip
    return model, frames


@pytest.mark.parametrize("spatial", [False, True])
def test_frames_that_waited_are_those_written_one_by_one(tmp_path, monkeypatch, spatial):
    """In every file, to the last bit: they are worked out together as copies of one structure."""
    model, frames = prism_frames() if spatial else (wall_model(), wall_frames(wall_model())[:9])
    stored = []
    for name, work in (("together", 10**12), ("alone", 0)):
        monkeypatch.setattr("dem_cli.results.output.store._UNFLUSHED", work)
        folder = tmp_path / name
        folder.mkdir()
        writer = ResultWriter(folder, model, "", {}, (), "time-history")
        writer.follow(DrawnJoints)
        for k, frame in enumerate(frames):
            writer.frame(frame._replace(step=k))
        writer.close(wall_summary())
        files = [folder / "results.h5", *sorted(folder.glob("*.vtkhdf"))]
        stored.append({f"{path.name}{name}": raw for path in files for name, raw in everything(path).items()})
    assert stored[0].keys() == stored[1].keys()
    assert [name for name in stored[0] if stored[0][name] != stored[1][name]] == []
    assert sum("joints.vtkhdf" in name for name in stored[0]) > 5
