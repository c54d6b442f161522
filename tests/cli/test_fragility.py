"""A fragility study as a user sees it: files, words, and what becomes of one that is killed."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
import time

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main

CASE = """\
title = "Two drums"
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.7
kn = 1e9
[[structure]]
kind = "column"
id = "c"
courses = 2
block = [0.4, 0.8]
[analysis]
kind = "fragility"
intensities = [0.15, 0.3, 0.45, 0.6, 0.9]
unit_acceleration = 9.81
coda = 1.0
[[motion]]
kind = "artificial"
spectrum = "EC8-1"
soil = "B"
ag = 3.0
duration = 4.0
rise = 0.5
plateau = 2.5
count = 3
[[motion]]
kind = "pulse"
amplitude = 1.0
frequency = 1.0
[[monitor]]
name = "turn"
block = "c-1"
quantity = "rotation"
"""
RUNS = 20
QUAKE = "{kind='artificial', spectrum='EC8-1', soil='B', ag=2.0, duration=4.0, rise=0.5, plateau=2.5}"


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = tmp_path_factory.mktemp("fragility") / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def dem(*words):
    return CliRunner().invoke(main, [*map(str, words)])


@pytest.fixture(scope="module")
def straight(case):
    """A study that nothing interrupted: its folder and what was printed."""
    done = dem("run", case, "-o", case.parent / "straight", "-q", "--threads", 1)
    assert done.exit_code == 0, done.output
    return case.parent / "straight", done.output


def table(folder):
    with (folder / "fragility.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def journal(folder):
    return folder.parent / f".{folder.name}.dem-runs"


def test_files_and_keys(straight):
    folder, _ = straight
    summary, rows = json.loads((folder / "summary.json").read_text(encoding="utf-8")), table(folder)
    assert {path.name for path in folder.iterdir()} == {"summary.json", "case.toml", "fragility.csv", "results.h5"}
    assert summary["kind"] == "fragility"
    assert summary["runs"] == len(rows) == RUNS
    assert summary["records"] == ["artificial 1", "artificial 2", "artificial 3", "sine"]
    assert [row["record"] for row in rows[::5]] == summary["records"]
    for key in ("collapse_intensities", "median", "dispersion", "confidence", "share", "non_monotone", "seconds"):
        assert key in summary
    assert 0.0 < summary["median"] < 0.9
    assert abs(summary["energy_closure"]) < 0.01
    assert abs(summary["energy_closure_of_collapses"]) < 0.1
    fell = [row for row in rows if row["collapsed"] == "1"]
    assert fell
    assert all(row["collapse_time"] and row["what"] for row in fell)
    assert float(fell[0]["peak turn"]) > 0.0
    known = [[row["collapsed"] for row in rows[k::5] if row["collapsed"]] for k in range(5)]
    shares = [sum(one == "1" for one in level) / len(level) for level in known]
    assert summary["still_moving"] == RUNS - sum(map(len, known))
    assert summary["share"] == shares
    assert not journal(folder).exists()


def test_one_record_is_one_draw(case):
    """No curve is fitted to it: it stood at one level and fell at the next."""
    folder = case.parent / "one"
    done = dem("run", case, "-o", folder, "-q", "--set", f"motion=[{QUAKE}]", "--plot")
    assert done.exit_code == 0, done.output
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert (summary["median"], summary["dispersion"], summary["curve"]) == (None, None, None)
    assert "one record is one draw; more are needed" in done.output
    fell, stood = summary["collapse_intensities"][0], summary["stood_up_to"][0]
    assert f"collapse at    {fell:.4g}, and it stood at {stood:.4g}; 1 record" in done.output


def test_words(straight):
    _, printed = straight
    assert "peak ground acceleration over 9.81 m/s²" in printed
    assert "median" in printed
    assert "90 % confidence" in printed
    assert f"runs           {RUNS};" in printed
    assert "rocking is ill-conditioned" in printed


def test_plot(straight, tmp_path):
    folder, _ = straight
    done = dem("plot", folder, "-o", tmp_path)
    assert done.exit_code == 0, done.output
    assert (tmp_path / "fragility.png").stat().st_size > 20_000


def test_check_counts_runs(case):
    done = dem("check", case)
    assert done.exit_code == 0, done.output
    assert f"4 records × 5 intensities: {RUNS}" in done.output


def started(case, folder, *words, **how):
    command = [sys.executable, "-m", "dem_cli", "run", str(case), "-o", str(folder), *words]
    return subprocess.Popen(command, **how)


def killed(process, folder, at_least):
    """Kills a run once its journal has so many runs; returns how many it has then."""
    wait_for(lambda: lines(folder) > at_least or process.poll() is not None)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert not folder.exists(), "it was done before it could be killed"
    return lines(folder) - 1


def test_killed_again_and_again(case, straight, tmp_path):
    """Nothing is lost, nothing is computed twice, and the table is the same, byte by byte."""
    folder = tmp_path / "killed"
    kept = killed(started(case, folder, "-q", "--threads", "2"), folder, 2)
    for _ in range(2):
        before = whole_lines(folder)
        kept = killed(started(case, folder, "-q", "--threads", "2", "--resume"), folder, kept + 2)
        assert whole_lines(folder)[: len(before)] == before
    refused = dem("run", case, "-o", folder, "-q")
    assert refused.exit_code == 2
    assert "go on with --resume" in refused.output
    keys = [tuple(json.loads(line)[0]) for line in whole_lines(folder)[1:]]
    assert len(keys) == len(set(keys)) == kept < RUNS
    done = dem("run", case, "-o", folder, "-q", "--resume")
    assert done.exit_code == 0, done.output
    assert (folder / "fragility.csv").read_bytes() == (straight[0] / "fragility.csv").read_bytes()
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["runs_done_before"] == kept
    assert summary["runs"] == RUNS
    assert not journal(folder).exists()


def test_ctrl_c_keeps_what_is_done(case, tmp_path):
    folder = tmp_path / "stopped"
    process = started(case, folder, "--threads", "1", stderr=subprocess.PIPE, text=True)
    wait_for(lambda: lines(folder) > 3 or process.poll() is not None)
    process.send_signal(signal.SIGINT)
    said = process.communicate()[1]
    assert process.returncode == 130
    assert "go on with --resume" in said
    assert not folder.exists()
    assert [path.name for path in tmp_path.iterdir()] == [journal(folder).name]


def test_a_changed_case_is_not_resumed(case, tmp_path):
    folder = tmp_path / "changed"
    killed(started(case, folder, "-q", "--threads", "1"), folder, 2)
    kept = whole_lines(folder)
    changed = dem("run", case, "-o", folder, "-q", "--resume", "--set", "joints.dry.friction=0.8")
    assert changed.exit_code == 2
    assert "cannot resume: the case changed" in changed.output
    assert whole_lines(folder) == kept


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("motion=[]", "kind = 'fragility' needs a [[motion]]"),
        ("analysis={kind='fragility'}", "give intensities, or lowest, highest and resolution"),
        ("analysis.intensities=[0.3, 0.2]", "intensities increase"),
        ("analysis.perturb={frictoin=0.1}", "friction"),
    ],
)
def test_mistakes(case, change, words):
    done = dem("run", case, "-q", "--set", change)
    assert done.exit_code == 2, done.output
    assert words in done.output


def test_nothing_collapses(case, tmp_path):
    done = dem("run", case, "-o", tmp_path / "out", "-q", "--set", "analysis.intensities=[0.01, 0.02]")
    assert done.exit_code == 0, done.output
    assert "nothing collapsed; higher intensities are needed" in done.output
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["median"] is None
    assert summary["collapse_intensities"] == [None] * 4
    assert summary["never_collapsed"] == 4


def test_repeats_beside_the_run_itself(case, tmp_path):
    words = ["--set", "analysis={kind='time-history', repeats=4, duration=3.0}", "--set", f"motion={QUAKE}"]
    done = dem("run", case, "-o", tmp_path / "out", "-q", *words)
    assert done.exit_code == 0, done.output
    assert "of 4 perturbed structures collapsed" in done.output
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    spread = summary["repeats"]["peaks"]["turn"]
    assert spread["min"] <= spread["p16"] <= spread["median"] <= spread["p84"] <= spread["max"]
    assert spread["unit"] == "rad"
    assert len((tmp_path / "out" / "repeats.csv").read_text(encoding="utf-8").splitlines()) == 5
    assert summary["peaks"]["turn"]["peak"] != 0.0


def test_a_record_without_repeats_says_what_it_is_worth(case, tmp_path):
    strong = QUAKE.replace("ag=2.0", "ag=6.0")
    words = ["--set", "analysis={kind='time-history', duration=2.0}", "--set", f"motion={strong}"]
    done = dem("run", case, "-o", tmp_path / "out", "-q", *words)
    assert "repeats = 20 shows their spread" in done.output


def whole_lines(folder):
    path = journal(folder)
    return path.read_bytes().split(b"\n")[:-1] if path.exists() else []


def lines(folder):
    return len(whole_lines(folder))


def wait_for(reached, seconds=60.0):
    end = time.monotonic() + seconds
    while not reached() and time.monotonic() < end:
        time.sleep(0.005)
