"""dem_cli.run, load and open: the same as `dem run`, with values of Python, and nothing left behind."""

from __future__ import annotations

import gc
import json
import os
import pickle
import signal
import tempfile

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

import dem_cli
from dem_cli.app.cli.main import main
from dem_cli.core.records.frames import Frame
from dem_cli.errors import CaseError, UsageError

SAME_IN_FILES = tuple(name for name in Frame._fields if name not in ("contacts", "stresses", "links"))
COLUMN = {
    "title": "Two blocks",
    "materials": {"stone": {"density": 2400.0}},
    "joints": {"dry": {"friction": 0.7}},
    "structure": [{"kind": "column", "block": [1.0, 1.0], "courses": 2}],
    "analysis": {"kind": "pushover", "follow": 0.02},
    "output": {"frames": 5},
    "monitor": [{"block": "column-2", "component": "x"}],
}
TIMES = ("wall_seconds", "solve_seconds", "solve_cpu_seconds", "compile_seconds")


@pytest.fixture(autouse=True)
def temporary(tmp_path, monkeypatch):
    """Where temporary folders are made."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def timeless(summary):
    return {key: value for key, value in summary.items() if key not in TIMES}


def names(folder):
    """Of the files in a folder."""
    return sorted(path.name for path in folder.iterdir())


def datasets(folder):
    """Type, shape and bytes of all that is stored, with attributes."""
    found = {}

    def collect(name, item):
        if isinstance(item, h5py.Dataset):
            value = np.asarray(item[()])
            found[name] = (str(item.dtype), item.shape, value.tolist() if value.dtype == object else value.tobytes())
        found[name, "attributes"] = {key: str(value) for key, value in item.attrs.items()}

    with h5py.File(folder / "results.h5", "r") as file:
        file.visititems(collect)
    return found


def test_the_command_line_gives_the_same_bytes(tmp_path):
    path = tmp_path / "column.toml"
    path.write_text(dem_cli.load(COLUMN).text, encoding="utf-8")
    changes = {"joints.dry.friction": 0.65, "structure.0.courses": 3}
    words = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
    said = CliRunner().invoke(main, ["run", str(path), "-q", "-o", str(tmp_path / "a"), *words])
    assert said.exit_code == 0, said.output
    result = dem_cli.run(path, changes, out=tmp_path / "b")
    one, two = datasets(tmp_path / "a"), datasets(tmp_path / "b")
    assert len(one) > 40
    assert one == two
    assert timeless(json.loads((tmp_path / "a" / "summary.json").read_text())) == timeless(result.summary)
    for name in ("case.toml", "contacts.vtkhdf"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert names(tmp_path / "a") == names(tmp_path / "b")
    result.close()
    assert (tmp_path / "b" / "summary.json").is_file()


def test_values_change_the_answer():
    loads = []
    for friction in (0.2, np.float64(0.3), 0.7):
        with dem_cli.run(COLUMN, {"joints.dry.friction": friction, "analysis.follow": 0.0}) as result:
            loads.append(result.failure_load)
    assert loads == pytest.approx([0.2, 0.3, 0.5], rel=3e-3)


def test_a_loaded_case_keeps_its_changes(tmp_path):
    path = tmp_path / "column.toml"
    path.write_text(dem_cli.load(COLUMN).text, encoding="utf-8")
    case = dem_cli.load(path, {"joints.dry.friction": 0.3, "structure.0.block": np.array([1.0, 1.5])})
    assert "Two blocks" in repr(case)
    path.unlink()  # its text is remembered
    again = dem_cli.load(case, {"analysis.follow": 0.0})
    assert again.case.joints["dry"].friction == 0.3
    assert again.case.structure[0].block == (1.0, 1.5)
    assert case.case.analysis.follow == 0.02
    with dem_cli.run(case, {"analysis.follow": 0.0}) as result:
        assert result.failure_load == pytest.approx(0.3, rel=3e-3)


def test_open_gives_what_run_gave(tmp_path):
    with dem_cli.run(COLUMN, out=tmp_path / "out") as made, dem_cli.open(tmp_path / "out") as opened:
        assert made.path == opened.path == tmp_path / "out"
        assert (made.summary, made.case, made.kind, made.status) == (
            opened.summary, opened.case, opened.kind, opened.status)  # fmt: skip
        for name, values in made.history.items():
            np.testing.assert_array_equal(values, opened.history[name])
        for name, monitor in made.monitors.items():
            np.testing.assert_array_equal(monitor.values, opened.monitors[name].values)
        assert len(made.frames) == len(opened.frames) > 3
        for one, two in zip(made.frames, opened.frames, strict=True):
            assert all(np.array_equal(getattr(one, name), getattr(two, name)) for name in SAME_IN_FILES)
            assert all(np.array_equal(a, b) for a, b in zip(one.contacts, two.contacts, strict=True))


def test_nothing_is_kept_unless_it_is_asked_for(temporary):
    with dem_cli.run(COLUMN, {"analysis.follow": 0.0}) as result:
        assert (result.path / "results.h5").is_file()
        assert result.path.is_relative_to(temporary)
    assert list(temporary.iterdir()) == []
    assert result.failure_load == pytest.approx(0.5, rel=3e-3)  # the summary stays
    result = dem_cli.run(COLUMN, {"analysis.follow": 0.0})
    assert len(list(temporary.iterdir())) == 1
    del result
    gc.collect()
    assert list(temporary.iterdir()) == []


def test_a_mistake_comes_from_another_process():
    """A pool of processes breaks where it cannot read what a worker raised."""
    with pytest.raises(CaseError) as raised:
        dem_cli.load(COLUMN, {"joints.dry.friction": -1.0})
    again = pickle.loads(pickle.dumps(raised.value))
    assert type(again) is CaseError
    assert str(again) == str(raised.value) != ""
    assert again.problems == raised.value.problems


@pytest.mark.parametrize(
    ("case", "changes", "error", "message"),
    [
        (COLUMN, {"joints.dry.frcition": 0.5}, CaseError,
         "set joints.dry.frcition: unknown key, did you mean 'friction'?"),
        (COLUMN, {"joints.dry.friction": -1.0}, CaseError,
         "set joints.dry.friction: -1 is not allowed; must be a number ≥ 0 and ≤ 1000"),
        (COLUMN, {"structure.4.courses": 2}, CaseError, "set structure.4: no such [[structure]] (allowed: 0)"),
        (COLUMN, {"joints dry": 1}, UsageError, "set: 'joints dry' is not a key path, such as"),
        (COLUMN, {"seed": None}, UsageError, "set seed: None is no value of a case file"),
        (COLUMN | {"gravty": 9.81}, {}, CaseError, "gravty: unknown key, did you mean 'gravity'?"),
        ("no_such.toml", {}, UsageError, "no_such.toml: no such file"),
        ({}, {}, UsageError, "case: a dict without tables; `dem new wall` prints a case to start from"),
        ([1], {}, UsageError, "case: [1] is not allowed; must be the path of a case file, a case that was loaded, or"),
        (None, {}, UsageError, "case: None is not allowed"),
        ("title = 'x'\n[materials]\n", {}, UsageError, "case: a text of several lines is not allowed; must be"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_message(case, changes, error, message, temporary):
    with pytest.raises(error) as caught:
        dem_cli.run(case, changes)
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1
    assert list(temporary.iterdir()) == []


def test_a_notebook_shows_what_was_asked_for_and_the_message():
    """IPython asks an exception for its own words before it prints forty lines of traceback."""
    with pytest.raises(CaseError) as caught:
        dem_cli.load(COLUMN, {"joints.dry.friction": -1.0})
    assert caught.value._render_traceback_() == [
        'in: dem_cli.load(COLUMN, {"joints.dry.friction": -1.0})',
        "CaseError: set joints.dry.friction: -1 is not allowed; must be a number ≥ 0 and ≤ 1000",
    ]
    assert UsageError("a\nb")._render_traceback_() == ["UsageError: a", "b"]


@pytest.mark.parametrize("threads", [0, -1, 1.5, "2"])
def test_threads_are_counted_from_one(threads):
    with pytest.raises(UsageError, match=r"threads: .* must be an integer ≥ 1"):
        dem_cli.run(COLUMN, threads=threads)


@pytest.mark.parametrize("changes", [["joints.dry.friction=0.5"], "joints.dry.friction=0.5"])
def test_changes_are_a_dict(changes):
    with pytest.raises(UsageError, match=r"set: .* must be a dict"):
        dem_cli.load(COLUMN, changes)


def test_folders_of_others_are_left_alone(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    changes = {"analysis.follow": 0.0}
    with pytest.raises(UsageError, match="holds files that dem did not write"):
        dem_cli.run(COLUMN, changes, tmp_path / "mine")
    dem_cli.run(COLUMN, changes, tmp_path / "mine", force=True).close()
    assert {"letter.txt", "summary.json", "results.h5"} <= set(names(tmp_path / "mine"))
    with pytest.raises(UsageError, match="holds no results"):
        dem_cli.open(tmp_path)


def test_resume_needs_something_to_go_on_with():
    with pytest.raises(UsageError, match="needs the folder"):
        dem_cli.run(COLUMN, resume=True)


def test_a_sweep_is_solved_once_and_says_so():
    case = COLUMN | {"sweep": {"joints.dry.friction": [0.5, 0.6]}}
    with dem_cli.run(case, {"analysis.follow": 0.0}) as result:
        assert any("sweep: not used here" in line for line in result.summary["warnings"])


def test_a_solver_that_gives_up_raises_nothing():
    with dem_cli.run(COLUMN, {"analysis.max_steps": 1000}) as result:
        assert result.status.startswith("not converged")
        assert result.failure_load is None
        assert result.summary["warnings"]


def told(stage, load, displacement, fraction):
    """Ctrl-C, once the collapse is followed."""
    if stage == "following the collapse":
        os.kill(os.getpid(), signal.SIGINT)


@pytest.mark.parametrize("keep", [True, False])
def test_interrupted(keep, tmp_path, temporary):
    before = signal.getsignal(signal.SIGINT)
    out = tmp_path / "out" if keep else None
    with pytest.raises(KeyboardInterrupt):
        dem_cli.run(COLUMN, {"analysis.follow": 0.5}, out, progress=told)
    assert signal.getsignal(signal.SIGINT) is before
    assert list(temporary.iterdir()) == []
    if keep:
        with dem_cli.open(tmp_path / "out") as result:
            assert result.status == "interrupted"
            assert len(result.frames) > 0
        dem_cli.run(COLUMN, {"analysis.follow": 0.0}, out).close()
        with pytest.raises(KeyboardInterrupt):
            dem_cli.run(COLUMN, {"analysis.follow": 0.5}, out, progress=told)
        assert dem_cli.open(tmp_path / "out").status == "ok"
        assert dem_cli.open(tmp_path / "out.interrupted").status == "interrupted"


SHAKEN = COLUMN | {
    "motion": {"kind": "pulse", "amplitude": 2.0, "frequency": 2.0},
    "damping": {"restitution": "housner"},
    "analysis": {"kind": "time-history", "duration": 0.3, "repeats": 4},
}


def impatient(stage, load, displacement, fraction):
    """Ctrl-C, once two runs of four are done."""
    if stage.startswith(("repeats 2", "repeats 3")):
        os.kill(os.getpid(), signal.SIGINT)


def test_many_runs_go_on_where_they_were_stopped(tmp_path):
    with dem_cli.run(SHAKEN, threads=2) as result:
        straight = result.summary["repeats"]
        assert (result.path / "repeats.csv").is_file()
    assert straight["runs"] == 4
    with pytest.raises(KeyboardInterrupt):
        dem_cli.run(SHAKEN, out=tmp_path / "out", threads=1, progress=impatient)
    assert list(tmp_path.glob(".out.dem-runs"))
    with dem_cli.run(SHAKEN, out=tmp_path / "out", threads=1, resume=True) as result:
        assert result.summary["repeats"] | {"seconds": 0.0} == straight | {"seconds": 0.0}
    assert not list(tmp_path.glob(".out.dem-runs"))
