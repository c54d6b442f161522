"""`dem calibrate`: every shape with every aperture, the closest of them, and what it leaves."""

from __future__ import annotations

import csv
import json
import math
import tomllib

import pytest
from click.testing import CliRunner
from oracle.rolling_column import fall, foot

from dem_cli.app import api
from dem_cli.app.calibrate.comparison import TrialAnswer, closest, distance, rows
from dem_cli.app.calibrate.table import Calibration, NamedShape
from dem_cli.app.calibrate.trials import trials
from dem_cli.app.cli.main import main
from dem_cli.app.cli.workers import side_by_side
from dem_cli.errors import SolverError

CASE = """
title = "Column of three"

[materials.stone]
density = 2000.0

[joints.dry]
friction = 5.0

[[structure]]
kind = "column"
block = [0.04, 0.02]
courses = 3
base_extension = 0.02

[analysis]
kind = "pushover"
resolution = 0.005

[[monitor]]
block = "top"

[calibration]
failure_load = 0.55
displacement = 0.0006
point = [0.0, 0.06]
component = "x"
apertures = [1e-4, 4e-4]
shapes = [{ name = "narrow", sides = 3, central = 0.1 }, { name = "equal", lengths = [1.0, 1.0, 1.0] }]
"""


def dem(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    """The command as a user calls it, two runs side by side."""
    folder = tmp_path_factory.mktemp("calibration")
    (folder / "column.toml").write_text(CASE)
    return dem("calibrate", folder / "column.toml", "-o", folder / "out", "--jobs", 2, "-q"), folder


def test_the_table_and_the_files(calibrated):
    answer, folder = calibrated
    assert answer.exit_code == 0, answer.output
    assert answer.stderr == ""
    lines = answer.stdout.splitlines()
    assert lines[0] == "Column of three: profiles of joint 'dry'"
    assert [line.split()[0] for line in lines[1:8]] == ["shape", "plane", *["narrow"] * 2, *["equal"] * 2, "measured"]
    assert sum(line.endswith("closest") for line in lines) == 1
    out = folder / "out"
    names = ["calibrated.toml", "calibration.csv", "calibration.png", "summary.json"]
    assert sorted(path.name for path in out.iterdir()) == names
    assert (out / "calibration.png").read_bytes()[:4] == b"\x89PNG"
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["kind"], summary["status"], summary["joint"]) == ("calibration", "ok", "dry")
    table = list(csv.DictReader((out / "calibration.csv").read_text().splitlines()))
    assert [(row["shape"], row["aperture"]) for row in table[1:]] == [
        ("narrow", "0.0001"), ("narrow", "0.0004"), ("equal", "0.0001"), ("equal", "0.0004"),
    ]  # fmt: skip
    assert [float(row["failure_load"]) for row in table] == [row["failure_load"] for row in summary["trials"]]


def test_loads_fall_with_the_aperture_and_top_displacements_rise(calibrated):
    """Plane joints turn over at b/H; the more a joint gapes, the less the column carries (thesis 7.4.1)."""
    trial = json.loads((calibrated[1] / "out" / "summary.json").read_text())["trials"]
    assert [row["status"] for row in trial] == ["ok"] * 5
    assert trial[0]["failure_load"] == pytest.approx(0.04 / 0.06, rel=0.005)
    for small, large in ((1, 2), (3, 4)):
        assert trial[0]["failure_load"] > trial[small]["failure_load"] > trial[large]["failure_load"]
        assert trial[small]["displacement"] < trial[large]["displacement"]
        assert trial[small]["share_of_plane"] == trial[small]["failure_load"] / trial[0]["failure_load"]
    for row in trial[1:]:
        expected = math.hypot(row["failure_load"] / 0.55 - 1.0, row["displacement"] / 0.0006 - 1.0)
        assert row["distance"] == pytest.approx(expected)


def test_loads_and_displacements_of_rigid_blocks_that_roll(calibrated):
    """Against statics of rigid blocks on polygons in a circle, with finite rotations (oracle.rolling_column).

    Joints are stiff but not rigid, and loads are known to 0.5 %. Friction is high: shocks of blocks that roll over make
    joints slip otherwise, which adds to the displacement.
    """
    for row in json.loads((calibrated[1] / "out" / "summary.json").read_text())["trials"][1:]:
        middle = 0.04 * row["central"]
        exact = fall(3, 0.02, foot([(0.04 - middle) / 2, middle, (0.04 - middle) / 2], row["aperture"]))
        assert row["failure_load"] == pytest.approx(exact.load, rel=0.005)
        assert row["displacement"] == pytest.approx(exact.top, rel=0.01)


def test_the_closest_case_gives_its_load_again(calibrated):
    """calibrated.toml is a case of its own: `dem run` finds the same failure load and the same displacement."""
    _, folder = calibrated
    best = json.loads((folder / "out" / "summary.json").read_text())["closest"]
    text = (folder / "out" / "calibrated.toml").read_text()
    tables = tomllib.loads(text)
    assert "calibration" not in tables
    assert tables["joints"]["dry"]["profile"]["aperture"] == best["aperture"]
    assert [monitor.get("block") for monitor in tables["monitor"]] == ["top", None]
    run = dem("run", folder / "out" / "calibrated.toml", "-o", folder / "run", "--json", "-q")
    assert run.exit_code == 0
    again = json.loads(run.stdout)
    assert again["failure_load"] == best["failure_load"]
    assert again["failure_load_bracket"] == best["failure_load_bracket"]


def test_one_process_finds_the_same(calibrated, tmp_path):
    _, folder = calibrated
    answer = dem("calibrate", folder / "column.toml", "-o", tmp_path / "one", "-j", 1, "-q", "--json")
    assert answer.exit_code == 0
    assert (tmp_path / "one" / "calibration.csv").read_text() == (folder / "out" / "calibration.csv").read_text()
    assert json.loads(answer.stdout)["closest"]["distance"] > 0.0


MEASURED = Calibration(
    failure_load=0.132,
    displacement=0.0115,
    point=(0.0, 0.245),
    apertures=(1e-4,),
    shapes=(NamedShape(name="C", sides=3),),
)


def test_distance_is_relative_to_what_was_measured():
    assert distance(MEASURED, TrialAnswer("ok", 0.132, displacement=0.0115)) == 0.0
    assert distance(MEASURED, TrialAnswer("ok", 0.132 * 1.03, displacement=0.0115 * 0.96)) == pytest.approx(0.05)
    assert distance(MEASURED, TrialAnswer("not converged", None)) is None


def test_trials_without_an_answer_are_never_the_closest(tmp_path):
    (tmp_path / "column.toml").write_text(CASE)
    plan = trials(api.load_case(tmp_path / "column.toml").case)
    assert [trial.name for trial in plan][:2] == ["plane joints", "shape narrow, aperture 0.1 mm"]
    far, near, none = (
        TrialAnswer("ok", 0.1, displacement=1.0),
        TrialAnswer("ok", 0.13, displacement=0.01),
        TrialAnswer("does not stand"),
    )
    table = rows(MEASURED, plan, [TrialAnswer("ok", 0.132, displacement=0.0115), none, far, near, none])
    assert closest(table) == 3
    assert closest(rows(MEASURED, plan, [near, none, none, none, none])) is None
    assert [row["share_of_plane"] for row in rows(MEASURED, plan, [none, near, far, near, none])] == [None] * 5


def test_shares_in_the_middle():
    shares = [
        NamedShape(name="x", **table).share_in_the_middle
        for table in (
            {"sides": 3, "central": 0.2}, {"sides": 5}, {"sides": 4}, {"lengths": [16, 8, 16]},
            {"sides": 3, "central": [0.1, 0.3]}, {"lengths": [16, [7, 8], 16]}, {"sides": [3, 5]},
            {"sides": 3, "lengths": [[1, 2]]},
        )
    ]  # fmt: skip
    assert shares == [(0.2, 0.2), (0.2, 0.2), None, (0.2, 0.2), (0.1, 0.3), None, None, None]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("[calibration]", "[calibrations]"), "did you mean 'calibration'?"),
        (("point = [0.0, 0.06]", "block = 'topp'"), "calibration.block: unknown block 'topp', did you mean 'top'?"),
        (("point = [0.0, 0.06]", "point = [0.0, 9.0]"), "calibration.point: there is no block at [0.0, 9.0]"),
        (("point = [0.0, 0.06]", ""), "neither 'block' nor 'point' is given"),
        (("failure_load = 0.55", "joint = 'wet'\nfailure_load = 0.55"), "calibration.joint: unknown joint 'wet'"),
        (('"equal"', '"narrow"'), "'narrow' is used twice"),
        (("central = 0.1", "central = 1.1"), "calibration.shapes.0.central: 1.1 is not allowed"),
        (("apertures = [1e-4, 4e-4]", "apertures = []"), "calibration.apertures"),
        (
            ("apertures = [1e-4, 4e-4]", "apertures = [1e-4, 4e-2]"),
            "apertures.1: with shape 'narrow', too large for the joint of",
        ),
        (('kind = "pushover"\nresolution = 0.005', 'kind = "gravity"'), "analysis.kind = 'gravity' has none"),
        ((CASE[CASE.index("[calibration]") :], ""), "has no [calibration]"),
    ],
)
def test_mistakes_are_said_before_anything_is_solved(tmp_path, change, message):
    assert change[0] in CASE
    (tmp_path / "column.toml").write_text(CASE.replace(*change))
    answer = dem("calibrate", tmp_path / "column.toml", "-o", tmp_path / "out")
    assert answer.exit_code == 2
    assert message in answer.stderr
    assert answer.stdout == ""
    assert not (tmp_path / "out").exists()


def test_other_commands_leave_the_calibration_alone(tmp_path):
    (tmp_path / "column.toml").write_text(CASE)
    answer = dem("check", tmp_path / "column.toml")
    assert answer.exit_code == 0
    assert answer.stderr == ""


def double(number: int) -> int:
    if number < 0:
        import os

        os._exit(1)
    return 2 * number


@pytest.mark.parametrize("jobs", [1, 2])
def test_runs_side_by_side(jobs):
    assert dict(side_by_side(double, [1, 2, 3], jobs)) == {0: 2, 1: 4, 2: 6}


def test_a_process_that_dies_is_said():
    with pytest.raises(SolverError, match="died"):
        dict(side_by_side(double, [1, -1, 3], 2))
