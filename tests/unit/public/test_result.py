"""Result: arrays by name with their units, frames when they are asked for."""

from __future__ import annotations

import shutil
from html import unescape

import h5py
import numpy as np
import pytest

import dem_cli
from dem_cli.core.records.frames import OPTIONAL_ARRAYS, ContactRecord, Frame
from dem_cli.errors import UsageError

WALL = {
    "title": "A small wall",
    "materials": {"stone": {"density": 2400.0}},
    "joints": {"dry": {"friction": 0.6}},
    "structure": [{"kind": "wall", "block": [0.6, 0.3], "courses": 3, "blocks_per_course": 2}],
    "analysis": {"kind": "pushover", "follow": 0.02},
    "output": {"frames": 6},
    "monitor": [
        {"name": "top", "block": "top-right", "component": "x"},
        {"block": "top-right", "quantity": "rotation"},
    ],
}
SHAKEN = WALL | {
    "motion": {"kind": "pulse", "amplitude": 1.0, "frequency": 2.0},
    "damping": {"restitution": "housner"},
    "analysis": {"kind": "time-history", "duration": 0.3},
    "monitor": [{"name": "top", "block": "top-right", "quantity": "acceleration", "component": "x", "absolute": True}],
}


@pytest.fixture(scope="module")
def wall(tmp_path_factory):
    with dem_cli.run(WALL, out=tmp_path_factory.mktemp("results") / "wall") as result:
        yield result


@pytest.fixture(scope="module")
def shaken():
    with dem_cli.run(SHAKEN) as result:
        yield result


def test_summary(wall):
    assert (wall.status, wall.kind) == ("ok", "pushover")
    assert wall.failure_load == wall.summary["failure_load"]
    assert repr(wall) == f"<Result of 'A small wall': pushover, ok, failure load {wall.failure_load:.6g}>"
    assert 'title = "A small wall"' in wall.case
    assert wall.provenance["dem"] == dem_cli.__version__
    assert wall.model.block_ids[-1] in wall.model.block_ids


def test_a_notebook_shows_the_answer_and_a_player_until_the_results_are_closed(wall):
    shown = unescape(wall._repr_html_())
    assert shown.startswith('<iframe srcdoc="<!doctype html>')
    assert f"<strong>{wall.failure_load:.4f}</strong>" in shown
    assert 'id="view"' in shown
    assert "How to run it again" not in shown
    with dem_cli.open(wall.path) as again:
        pass
    shown = again._repr_html_()
    assert f"{wall.failure_load:.4f}" in shown
    assert 'id="view"' not in unescape(shown)


def test_history(wall):
    history = wall.history
    assert {len(values) for values in history.values()} == {len(history["load"])}
    assert history.units == {
        "step": "", "load": "", "displacement": "m", "unbalanced": "", "overlap": "m", "time": "s",
        "live_displacement": "m", "stage": "",
    }  # fmt: skip
    assert {"gravity", "loading", "collapse"} >= set(history["stage"].tolist())
    assert set(wall.energy.units.values()) == {"J"}
    assert len(wall.energy["friction"]) == len(history["load"])
    assert "displacement [m]" in repr(history)
    with pytest.raises(KeyError, match="no 'lod', did you mean 'load'"):
        history["lod"]


def test_monitors(wall):
    assert list(wall.monitors) == ["top", "top-right rotation"]
    top, rotation = wall.monitors["top"], wall.monitors["top-right rotation"]
    assert (top.unit, top.quantity, top.absolute, top.time) == ("m", "displacement", False, None)
    assert (rotation.unit, rotation.quantity) == ("rad", "rotation")
    np.testing.assert_array_equal(top.load, wall.history["load"])
    assert len(top.values) == len(top.load)
    assert repr(top) == f"<{len(top.values)} values of displacement [m]>"
    with pytest.raises(KeyError, match="no 'tpo', did you mean 'top'"):
        wall.monitors["tpo"]
    with pytest.raises(KeyError, match="no 'histor', did you mean 'history'"):
        wall.tables["histor"]


def test_monitors_of_a_time_history(shaken):
    top = shaken.monitors["top"]
    assert (top.unit, top.quantity, top.absolute, top.load) == ("m/s2", "acceleration", True, None)
    assert len(top.time) == len(top.values)
    assert top.time[-1] == pytest.approx(0.3, rel=0.05)
    assert np.abs(top.values).max() == pytest.approx(abs(shaken.summary["peaks"]["top"]["peak"]))
    ground = shaken.tables["time history"]
    assert ground.units["base acceleration x"] == "m/s2"
    np.testing.assert_array_equal(ground["time"], top.time)
    assert {"time history", "response spectra", "history"} <= set(shaken.tables)
    assert len(shaken.tables["response spectra"]["period"]) > 10
    assert shaken.failure_load is None


def test_frames(wall):
    frames = wall.frames
    assert isinstance(frames[0], Frame)
    assert repr(frames) == f"<{len(frames)} frames>"
    assert frames[-1].positions.shape == (wall.model.n_blocks, 2)
    assert [frame.load for frame in frames[1:3]] == [frames[1].load, frames[2].load]
    assert {"positions", "displacement", "time"} <= set(frames.units)
    of_rigid = {name: unit for name, unit in frames.units.items() if name not in OPTIONAL_ARRAYS}
    assert of_rigid == {"positions": "m", "orientations": "rad", "displacement": "m", "time": "s"}
    with pytest.raises(UsageError, match=f"frame 99: these results have {len(frames)} frames"):
        wall.contacts(99)


def test_contacts(wall):
    contacts = wall.contacts(0)
    assert set(contacts) == {*ContactRecord._fields, "force"} - {"tangents"}  # which are of space alone
    units = {name: unit for name, unit in contacts.units.items() if unit}
    assert units == dict.fromkeys(("points", "gap", "slip"), "m") | dict.fromkeys(
        ("normal_force", "shear_force", "force"), "N"
    )
    assert contacts.units["normal_force"] == "N"
    assert set(contacts["state"].tolist()) <= {"open", "sticking", "sliding"}
    weight = 9.81 * wall.model.masses[~wall.model.fixed].sum()
    on_base = wall.model.fixed[contacts["blocks"]]
    lifted = np.where(on_base[:, 0], 1.0, -1.0)[on_base.any(axis=1)] @ contacts["force"][on_base.any(axis=1), 1]
    assert lifted == pytest.approx(weight, rel=1e-3)
    same = wall.contacts(wall.frames[0])
    np.testing.assert_array_equal(same["gap"], contacts["gap"])


def test_corners(wall):
    corners = wall.corners(0)
    assert len(corners) == wall.model.n_parts
    assert all(part.shape == (4, 2) for part in corners)
    np.testing.assert_allclose(corners[0].mean(axis=0), wall.frames[0].positions[wall.model.part_blocks[0]], atol=1e-9)


def test_closed(tmp_path):
    result = dem_cli.run(WALL, {"analysis.follow": 0.0}, tmp_path / "out")
    loads = result.history["load"]
    assert not result.closed
    result.close()
    result.close()
    assert result.closed
    assert result.history["load"] is loads
    assert result.monitors["top"].unit == "m"
    with pytest.raises(UsageError, match="are closed; ask for frames before that"):
        result.frames  # noqa: B018
    with pytest.raises(UsageError, match="are closed"):
        result.contacts()


def test_results_can_be_replaced_while_they_are_open(tmp_path):
    with dem_cli.run(WALL, out=tmp_path / "out") as first:
        with dem_cli.run(WALL, {"analysis.follow": 0.0}, tmp_path / "out") as second:
            assert len(second.history["load"]) < len(first.history["load"])
        assert first.frames[-1].stage == "collapse"


def test_results_without_a_summary(wall, tmp_path):
    shutil.copytree(wall.path, tmp_path / "killed")
    (tmp_path / "killed" / "summary.json").unlink()
    with dem_cli.open(tmp_path / "killed") as result:
        assert result.summary == {}
        assert result.failure_load is None
        assert len(result.frames) == len(wall.frames)
        assert "killed" in repr(result)


def test_a_run_killed_before_its_first_row(wall, tmp_path):
    shutil.copytree(wall.path, tmp_path / "killed")
    (tmp_path / "killed" / "summary.json").unlink()
    with h5py.File(tmp_path / "killed" / "results.h5", "r+") as file:
        for name in list(file["dem/history"]):
            del file["dem/history"][name]
    with dem_cli.open(tmp_path / "killed") as result:
        top = result.monitors["top"]
        assert len(top.values) == len(top.load) == 0
        assert top.unit == "m"
