"""`dem sweep` as a user calls it: tables, failures, kill and resume, shards, a cluster."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.errors import OutputError
from dem_cli.results.post.sweep_table import read_sweep

ROOT = Path(__file__).resolve().parents[2]


def test_capacity_curves_go_as_far_as_the_case_says(tmp_path):
    path, curve = tmp_path / "curve.toml", 'follow = 1e-4\nincrements = 10\ncontrol = "displacement"'
    text = SMALL.replace("follow = 0.01", curve).replace("courses = 2", "courses = 1")
    path.write_text(text + '[sweep]\n"joints.dry.friction" = [0.3]\n', encoding="utf-8")
    code, _, words = dem("sweep", path, "-o", tmp_path / "out", "-j", 1)
    assert code == 0, words
    (row,) = table(tmp_path / "out")
    assert float(row["failure_load"]) == pytest.approx(0.3, rel=3e-3)
    assert "follow = 0.0001" in (tmp_path / "out" / "runs" / row["run"] / "case.toml").read_text(encoding="utf-8")


DEM = [sys.executable, "-m", "dem_cli"]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
SMALL = """
[materials.stone]
density = 2000.0

[joints.dry]
friction = 0.6

[[structure]]
kind = "column"
block = [1.0, 0.5]
courses = 2

[analysis]
follow = 0.01

[[monitor]]
block = "top"
"""
GRID = SMALL + '[sweep]\n"joints.dry.friction" = [0.3, 0.4]\n"structure.0.courses" = [1, 2, 3]\n'


def dem(*words: object) -> tuple[int, str, str]:
    result = CliRunner().invoke(main, [str(word) for word in words])
    return result.exit_code, result.stdout, result.stderr


def table(folder: Path) -> list[dict[str, str]]:
    with (folder / "sweep.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def tables(folder: Path) -> tuple[bytes, bytes]:
    return (folder / "sweep.csv").read_bytes(), (folder / "sweep.sqlite").read_bytes()


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "column.toml"
    path.write_text(GRID, encoding="utf-8")
    return path


def test_a_grid_in_one_table(case, tmp_path):
    code, out, _ = dem("sweep", case, "-o", tmp_path / "out", "-j", 1)
    assert code == 0
    assert "6: 6 solved, 0 failed" in out
    rows = table(tmp_path / "out")
    keys = [(row["joints.dry.friction"], row["structure.0.courses"]) for row in rows]
    assert keys == [(f, c) for f in ("0.3", "0.4") for c in "123"]
    for row in rows:  # a column of cubes slides before it turns over
        assert float(row["failure_load"]) == pytest.approx(float(row["joints.dry.friction"]), rel=3e-3)
        assert row["failure_mode"] == "sliding"
        summary = json.loads((tmp_path / "out" / "runs" / row["run"] / "summary.json").read_text())
        assert repr(summary["failure_load"]) == row["failure_load"]
    again = tmp_path / "again"
    code, out, _ = dem("run", tmp_path / "out" / "runs" / rows[0]["run"] / "case.toml", "-o", again, "--json")
    assert (code, repr(json.loads(out)["failure_load"])) == (0, rows[0]["failure_load"])
    with sqlite3.connect(tmp_path / "out" / "sweep.sqlite") as base:
        found = base.execute('SELECT run, "joints.dry.friction", failure_load FROM runs').fetchall()
    base.close()
    assert [(run, str(f), repr(load)) for run, f, load in found] == [
        (row["run"], row["joints.dry.friction"], row["failure_load"]) for row in rows
    ]


def test_it_computes_no_more_than_the_table_needs_unless_asked(case, tmp_path):
    dem("sweep", case, "-o", tmp_path / "light", "-j", 1)
    run = table(tmp_path / "light")[0]["run"]
    text = (tmp_path / "light" / "runs" / run / "case.toml").read_text(encoding="utf-8")
    assert "frames = 0" in text
    assert "follow = 0.0" in text
    one = tmp_path / "one.toml"
    one.write_text(SMALL + '[sweep]\n"joints.dry.friction" = [0.3]\n', encoding="utf-8")
    dem("sweep", one, "-o", tmp_path / "full", "-j", 1, "--keep", "all")
    run = table(tmp_path / "full")[0]["run"]
    assert "follow = 0.01" in (tmp_path / "full" / "runs" / run / "case.toml").read_text(encoding="utf-8")


def test_names_are_no_formulas_and_break_no_row(tmp_path):
    names = ["=1+1", "+20 %", "two\nlines", "@x", "-0.5"]
    key = '"joints.dry.friction"'
    runs = [f"[[sweep.run]]\nname = {json.dumps(name)}\n{key} = 0.{5 + i}\n" for i, name in enumerate(names)]
    path = tmp_path / "named.toml"
    path.write_text(SMALL + "".join(runs), encoding="utf-8")
    assert dem("sweep", path, "--dry-run")[0] == 0
    assert dem("sweep", path, "-o", tmp_path / "out", "-j", 1, "-q")[0] == 0
    lines = (tmp_path / "out" / "sweep.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 1 + len(names)
    assert [line.split(",")[1] for line in lines[1:]] == ["'=1+1", "'+20 %", "two lines", "'@x", "-0.5"]
    read = read_sweep(tmp_path / "out")
    assert read.columns["name"] == ["=1+1", "+20 %", "two lines", "@x", -0.5]


def test_processes_make_no_difference_and_nothing_is_done_twice(case, tmp_path):
    dem("sweep", case, "-o", tmp_path / "one", "-j", 1)
    code, _, _ = dem("sweep", case, "-o", tmp_path / "two", "-j", 2)
    assert code == 0
    assert tables(tmp_path / "one") == tables(tmp_path / "two")
    written = {path: path.stat().st_mtime_ns for path in (tmp_path / "two" / "runs").rglob("*")}
    code, _, err = dem("sweep", case, "-o", tmp_path / "two", "-j", 2)
    assert (code, "6 of 6 runs are there already" in err) == (0, True)
    assert written == {path: path.stat().st_mtime_ns for path in (tmp_path / "two" / "runs").rglob("*")}


def test_more_values_leave_the_runs_that_are_there(case, tmp_path):
    dem("sweep", case, "-o", tmp_path / "out", "-j", 1)
    before = {row["run"] for row in table(tmp_path / "out")}
    case.write_text(GRID.replace("[0.3, 0.4]", "[0.3, 0.35, 0.4]"), encoding="utf-8")
    _, _, err = dem("sweep", case, "-o", tmp_path / "out", "-j", 1)
    assert "6 of 9 runs are there already" in err
    assert before < {row["run"] for row in table(tmp_path / "out")}


def test_a_run_that_fails_is_recorded_with_its_reason(case, tmp_path):
    rows = '[[sweep.run]]\nname = "fine"\n[[sweep.run]]\nname = "overlap"\n' \
           'block = [{id = "b", vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]}]\n'  # fmt: skip
    case.write_text(SMALL + rows, encoding="utf-8")
    code, out, _ = dem("sweep", case, "-o", tmp_path / "out", "-j", 1)
    assert code == 1
    assert "2: 1 solved, 1 failed" in out
    fine, bad = table(tmp_path / "out")
    assert (fine["name"], fine["status"], fine["reason"]) == ("fine", "ok", "")
    assert (bad["name"], bad["status"], bad["failure_load"]) == ("overlap", "failed", "")
    assert "overlap" in bad["reason"]
    assert bad["reason"].startswith("column.toml:")  # wherever the case lies
    code, _, err = dem("sweep", case, "-o", tmp_path / "out", "-j", 1)  # known to fail: not tried again
    assert (code, "2 of 2 runs are there already" in err) == (1, True)
    code, _, err = dem("sweep", case, "-o", tmp_path / "out", "-j", 1, "--retry")
    assert (code, "1 of 2 runs are there already" in err) == (1, True)


def test_a_fault_of_the_program_in_one_run_stops_nobody(case, tmp_path, monkeypatch):
    import dem_cli.analyses.solve

    solve = dem_cli.analyses.solve.solve

    def sometimes(case, *rest, **more):
        if case.joints["dry"].friction == 0.4:
            raise ZeroDivisionError("of one run")
        return solve(case, *rest, **more)

    monkeypatch.setattr(dem_cli.analyses.solve, "solve", sometimes)
    assert dem("sweep", case, "-o", tmp_path / "out", "-j", 1)[0] == 1
    rows = table(tmp_path / "out")
    assert [row["status"] for row in rows] == ["ok"] * 3 + ["failed"] * 3
    assert rows[3]["reason"] == "internal error: ZeroDivisionError: of one run"
    kept = json.loads((tmp_path / "out" / "runs" / rows[3]["run"] / "summary.json").read_text())
    assert "sometimes" in kept["traceback"]


@pytest.mark.parametrize("left", ["", "[]", "{}", '{"status": 5}', '{"status": "not converged", "warnings": {"a": 1}}'])
def test_a_run_whose_summary_is_broken_is_done_again(case, tmp_path, left):
    case.write_text(SMALL + '[sweep]\n"joints.dry.friction" = [0.3, 0.4]\n', encoding="utf-8")
    dem("sweep", case, "-o", tmp_path / "out", "-j", 1)
    before = tables(tmp_path / "out")
    (tmp_path / "out" / "runs" / table(tmp_path / "out")[1]["run"] / "summary.json").write_text(left)
    code, out, _ = dem("sweep", case, "-o", tmp_path / "out", "-j", 1)
    assert (code, "2 solved" in out) == (0, True)
    assert tables(tmp_path / "out") == before


def test_a_full_disk_is_no_fault_of_a_run(case, tmp_path, monkeypatch):
    from dem_cli.results.output.store import ResultWriter

    def full(*_, **__):
        raise OutputError("cannot write results to here: no space left on the device")

    dem("sweep", case, "-o", tmp_path / "whole", "-j", 1)
    with monkeypatch.context() as patch:
        patch.setattr(ResultWriter, "close", full)
        code, _, err = dem("sweep", case, "-o", tmp_path / "out", "-j", 1)
    assert (code, "no space left" in err) == (3, True)
    assert {row["status"] for row in table(tmp_path / "out")} == {"waiting"}
    assert dem("sweep", case, "-o", tmp_path / "out", "-j", 1)[0] == 0
    assert tables(tmp_path / "whole") == tables(tmp_path / "out")


@pytest.mark.parametrize(
    ("sweep", "message"),
    [
        ('[sweep]\n"joints.dry.frcition" = [0.5]\n', "did you mean 'friction'?"),
        ('[sweep]\n"joints.dry.friction" = [0.5, -1.0]\n', ":19:31: sweep: joints.dry.friction: -1 is not allowed"),
        ('[sweep]\n"structure.3.courses" = [4]\n', ":19:26: sweep: structure.3: no such [[structure]]"),
        ('[sweep]\n"joints.dry.friction" = 0.5\n', ':19:25: sweep."joints.dry.friction": 0.5 is not allowed'),
        ("", "has no [sweep]"),
    ],
)
def test_mistakes_are_found_before_anything_runs(case, tmp_path, sweep, message):
    case.write_text(SMALL + sweep, encoding="utf-8")
    code, _, err = dem("sweep", case, "-o", tmp_path / "out")
    assert code == 2
    assert message in err
    assert not (tmp_path / "out").exists()


def test_a_case_without_a_model_is_refused_at_once(case, tmp_path):
    block = '[[block]]\nid = "b"\nvertices = [[0, 0], [1, 0], [1, 1], [0, 1]]\n'  # in the foot of the column
    case.write_text(SMALL + block + '[sweep]\n"joints.dry.friction" = [0.4, 0.5]\n', encoding="utf-8")
    code, _, err = dem("sweep", case, "-o", tmp_path / "out")
    assert (code, "overlap" in err) == (2, True)
    assert not (tmp_path / "out").exists()


def test_what_every_run_changes_cannot_be_set(case, tmp_path):
    code, _, err = dem("sweep", case, "--dry-run", "--set", "joints.dry.friction=0.5")
    assert (code, "every run of the sweep changes it" in err) == (2, True)
    code, out, _ = dem("sweep", case, "--dry-run", "--set", "gravity=9.8")
    assert (code, len(out.splitlines())) == (0, 7)


def test_a_folder_of_something_else_is_refused(case, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    code, _, err = dem("sweep", case, "-o", tmp_path)
    assert (code, "did not write" in err) == (2, True)
    code, _, err = dem("sweep", case, "-o", tmp_path / "notes.txt")
    assert (code, "a file of that name" in err) == (2, True)


def test_dry_run_prints_the_plan(case, tmp_path):
    code, out, _ = dem("sweep", case, "-o", tmp_path / "out", "--dry-run")
    assert (code, len(out.splitlines())) == (0, 7)
    assert out.startswith("run,joints.dry.friction,structure.0.courses\n")
    assert not (tmp_path / "out").exists()


def test_run_says_that_it_is_one_case(case, tmp_path):
    code, out, _ = dem("run", case, "-o", tmp_path / "out")
    assert code == 0
    assert "column.toml:18:1: sweep: not used here: one case is solved" in out


def test_check_says_how_many_runs_there_are(case):
    code, out, err = dem("check", case)
    assert (code, err) == (0, "")
    assert "6 runs of `dem sweep` over joints.dry.friction, structure.0.courses" in out


def test_the_template_is_a_sweep(tmp_path):
    assert dem("new", "sweep", "-o", tmp_path / "new.toml")[0] == 0
    code, out, _ = dem("sweep", tmp_path / "new.toml", "--dry-run")
    assert (code, len(out.splitlines())) == (0, 11)


def test_shards_share_a_folder(case, tmp_path):
    dem("sweep", case, "-o", tmp_path / "whole", "-j", 1)
    code, out, _ = dem("sweep", case, "-o", tmp_path / "parts", "-j", 1, "--shard", "2/2")
    assert (code, "3 not done yet" in out) == (0, True)
    assert [row["status"] for row in table(tmp_path / "parts")] == ["waiting", "ok"] * 3
    code, out, _ = dem("sweep", case, "-o", tmp_path / "parts", "-j", 1, "--shard", "1/2")
    assert code == 0
    assert tables(tmp_path / "whole") == tables(tmp_path / "parts")
    assert dem("sweep", case, "--shard", "3/2")[0] == 2
    code, _, err = dem("sweep", case, "-o", tmp_path / "parts", "--shard", "1/2", "--fresh")
    assert (code, "the other shards" in err) == (2, True)


def test_shards_that_end_at_one_time(case, tmp_path):
    """Each writes the tables of all; the last one has all runs."""
    dem("sweep", case, "-o", tmp_path / "whole", "-j", 1)
    every = [start(case, tmp_path / "parts", "-j", "1", "--shard", f"{i}/3") for i in (1, 2, 3)]
    assert [shard.wait() for shard in every] == [0, 0, 0]
    assert tables(tmp_path / "whole") == tables(tmp_path / "parts")


def test_a_whole_sweep_waits_for_no_shard(case, tmp_path):
    from dem_cli.app.sweep.folder import opened

    with opened(tmp_path / "out", False, False, "-1of2"), opened(tmp_path / "out", False, False, "-2of2"):
        code, _, err = dem("sweep", case, "-o", tmp_path / "out", "--fresh")
    assert (code, "another sweep is writing" in err) == (2, True)


def test_files_of_several_writers_are_whole(tmp_path):
    from dem_cli.results.output.atomic_file import whole

    with whole(tmp_path / "table.csv") as one, whole(tmp_path / "table.csv") as other:
        one.write_text("one")
        other.write_text("other")
    assert (tmp_path / "table.csv").read_text() == "one"
    assert [path.name for path in tmp_path.iterdir()] == ["table.csv"]


def test_two_sweeps_do_not_write_to_one_folder(case, tmp_path):
    from dem_cli.app.sweep.folder import opened

    with opened(tmp_path / "out", fresh=False, force=False):
        code, _, err = dem("sweep", case, "-o", tmp_path / "out")
    assert (code, "another sweep is writing" in err) == (2, True)


def start(case: Path, folder: Path, *words: str) -> subprocess.Popen:
    return subprocess.Popen([*DEM, "sweep", str(case), "-o", str(folder), "-q", *words], env=ENVIRONMENT)


def finished_runs(folder: Path) -> int:
    return len(list((folder / "runs").glob("*/summary.json")))


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kills as POSIX does")
def test_50_runs_killed_three_times_give_the_same_bytes(tmp_path):
    case = tmp_path / "many.toml"
    one = SMALL.replace("courses = 2", "courses = 1").replace("follow = 0.01", "resolution = 0.02")
    case.write_text(one + '[sweep]\n"joints.dry.friction" = { from = 0.2, to = 0.7, count = 50 }\n', encoding="utf-8")
    whole = start(case, tmp_path / "whole", "-j", "2")
    assert whole.wait() == 0
    left = []
    for share in (8, 20, 35):
        run = start(case, tmp_path / "killed", "-j", "2")
        while finished_runs(tmp_path / "killed") < share:
            assert run.poll() is None
            time.sleep(0.02)
        run.kill()
        run.wait()
        left.append(finished_runs(tmp_path / "killed"))
    assert left == sorted(left)
    assert 8 <= left[0] < left[-1] < 50
    written = {path: path.stat().st_mtime_ns for path in (tmp_path / "killed" / "runs").glob("[!.]*/summary.json")}
    assert start(case, tmp_path / "killed", "-j", "2").wait() == 0
    assert tables(tmp_path / "whole") == tables(tmp_path / "killed")
    assert len(table(tmp_path / "killed")) == finished_runs(tmp_path / "killed") == 50
    assert all(path.stat().st_mtime_ns == at for path, at in written.items())  # nothing was computed twice
    hidden = [path.name for path in (tmp_path / "killed" / "runs").iterdir() if path.name.startswith(".")]
    assert not hidden


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="signals as POSIX has them")
def test_ctrl_c_keeps_what_is_done(case, tmp_path):
    case.write_text(GRID.replace("[1, 2, 3]", "{ integers = [1, 40] }").replace("[sweep]", "[sweep]\nsamples = 200"))
    run = start(case, tmp_path / "out", "-j", "2")
    while finished_runs(tmp_path / "out") < 5:
        assert run.poll() is None
        time.sleep(0.02)
    run.send_signal(signal.SIGINT)
    assert run.wait() == 130
    rows = table(tmp_path / "out")
    done = [row for row in rows if row["status"] == "ok"]
    assert len(rows) == 400
    assert len(done) >= 5
    assert all(row["failure_load"] for row in done)
    assert not [path for path in (tmp_path / "out" / "runs").iterdir() if path.name.startswith(".")]


SHAKEN = """
[motion]
kind = "pulse"
shape = "sine"
amplitude = 4.0
frequency = 4.0

[damping]
contact_fraction = 0.3
"""


def test_many_runs_in_a_run_are_taken_up_too(case, tmp_path, monkeypatch):
    """A killed fragility study leaves its journal; the sweep goes on with it."""
    from dem_cli.analyses.ensembles.batch import Batcher

    study = 'kind = "fragility"\nintensities = [0.2, 0.4, 0.6]\n'
    text = SMALL.replace("follow = 0.01\n", study).replace("courses = 2", "courses = 2\nbase_extension = 1.0")
    case.write_text(text + SHAKEN + '[sweep]\n"joints.dry.friction" = [0.5]\n', encoding="utf-8")
    answer, count = Batcher.answer, [0]

    def twice(self, trial):
        count[0] += 1
        if count[0] > 2:
            raise KeyboardInterrupt
        return answer(self, trial)

    with monkeypatch.context() as patch:
        patch.setattr(Batcher, "answer", twice)
        assert dem("sweep", case, "-o", tmp_path / "out", "-j", 1)[0] == 130
    code, out, err = dem("sweep", case, "-o", tmp_path / "out", "-j", 1)
    assert code == 0, out + err
    run = table(tmp_path / "out")[0]["run"]
    summary = json.loads((tmp_path / "out" / "runs" / run / "summary.json").read_text())
    assert (summary["runs"], summary["runs_done_before"]) == (3, 2)


@contextmanager
def cluster(tmp_path, workers: int = 2):
    """A scheduler and workers as processes of their own, as on a SLURM machine; gives the address."""
    place = tmp_path / "scheduler.json"
    module, file = [sys.executable, "-m"], ["--no-dashboard", "--scheduler-file", str(place)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": ENVIRONMENT, "cwd": tmp_path}
    running = [
        subprocess.Popen(
            [*module, "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", *file], **quiet
        )
    ]
    running += [
        subprocess.Popen([*module, "distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny", *file], **quiet)
        for _ in range(workers)
    ]
    try:
        while not place.exists():
            assert running[0].poll() is None
            time.sleep(0.05)
        yield json.loads(place.read_text())["address"], running
    finally:
        for process in reversed(running):
            process.kill()
            process.wait()


def test_a_cluster_gives_the_same_table(case, tmp_path):
    pytest.importorskip("distributed")
    dem("sweep", case, "-o", tmp_path / "here", "-j", 1)
    with cluster(tmp_path) as (address, running):
        code, out, err = dem("sweep", case, "-o", tmp_path / "there", "--scheduler", address)
        assert (code, err) == (0, "")
        assert "6 solved" in out
        assert tables(tmp_path / "here") == tables(tmp_path / "there")
        shutil.rmtree(tmp_path / "there" / "runs")
        running[1].kill()  # a worker less: the other one does it all
        assert dem("sweep", case, "-o", tmp_path / "there", "--scheduler", address)[0] == 0
        assert tables(tmp_path / "here") == tables(tmp_path / "there")


def test_a_scheduler_that_is_not_there(case, tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("dem_cli.app.sweep.cluster.PATIENCE", 0.5)
    code, _, err = dem("sweep", case, "-o", tmp_path / "out", "--scheduler", "tcp://127.0.0.1:9")
    assert (code, "no Dask scheduler answers" in err) == (2, True)
