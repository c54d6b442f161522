"""`dem limit`: what it prints, what it leaves, and its exit codes."""

from __future__ import annotations

import json

import numpy as np
import pytest
from casefiles import CASES
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.results.output.reader import read

WALL = CASES / "verification" / "wall_21_mu075.toml"
WEDGED = CASES / "verification" / "wedged_block.toml"
FALLING = CASES / "verification" / "leaning_column.toml"


def dem(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def test_the_answer_in_a_few_lines():
    answer = dem("limit", WALL)
    assert answer.exit_code == 0
    lines = dict(line.split(maxsplit=1) for line in answer.stdout.splitlines()[1:] if "check" not in line)
    assert lines["associated"].startswith("0.6812")
    assert "hand check     0.5714  (a rigid part turns about the toe; no bound)" in answer.stdout
    assert answer.stderr == ""


def test_json_is_one_object_with_bounds_around_the_load():
    summary = json.loads(dem("limit", WALL, "--json").stdout)
    limits = summary["limit_analysis"]
    low, high = limits["associated_bounds"]
    assert summary["kind"] == "limit"
    assert summary["status"] == limits["associated_status"] == "ok"
    assert low <= limits["associated"] <= high
    assert limits["residual"] < 1e-6
    assert summary["blocks"] == 22


def test_the_load_of_joints_that_do_not_dilate():
    """Lower here, and the thesis's own: 0.646 (Table 5-3)."""
    both, one = (json.loads(dem("limit", WALL, "--json", *more).stdout) for more in ([], ["--associated-only"]))
    limits = both["limit_analysis"]
    assert limits["non_associated"] == pytest.approx(0.646, abs=5e-4)
    assert limits["non_associated"] < limits["associated"]
    assert limits["non_associated_status"] == "ok"
    assert not any("non_associated" in key for key in one["limit_analysis"])


def test_heads_without_friction():
    rough, smooth = (
        json.loads(dem("limit", WALL, "--json", "--heads", heads).stdout)["limit_analysis"]
        for heads in ("frictional", "frictionless")
    )
    assert smooth["heads"] == "frictionless"
    assert smooth["associated"] < rough["associated"] - 0.03


def test_results_hold_the_mechanism_and_its_forces(tmp_path):
    folder = tmp_path / "out"
    assert dem("limit", WALL, "-o", folder).exit_code == 0
    names = {"summary.json", "results.h5", "blocks.vtkhdf", "contacts.vtkhdf", "joints.vtkhdf", "case.toml"}
    assert {path.name for path in folder.iterdir()} == names
    results = read(folder)
    limits = results.summary["limit_analysis"]
    for frame, stage in zip(results.frames, ("associated", "non-associated"), strict=True):
        assert frame.stage == stage
        assert frame.load == limits[stage.replace("-", "_")]
        live = (results.model.live_loads * frame.velocities).sum()
        assert live == pytest.approx(1.0)
        assert np.abs(frame.positions - results.model.centroids).max() > 0.0
    assert dem("plot", folder).output.splitlines() == [str(folder / "collapse.png")]


def test_a_case_that_never_fails_says_so(tmp_path):
    answer = dem("limit", WEDGED, "-o", tmp_path / "out")
    assert answer.exit_code == 0
    assert "no load of this direction makes it fail" in answer.stdout
    assert "\n  associated" not in answer.stdout
    assert dem("plot", tmp_path / "out").exit_code == 0


def test_a_case_that_does_not_stand_says_so():
    answer = dem("limit", FALLING, "--json")
    assert answer.exit_code == 0  # as its [reference] expects
    assert dem("limit", FALLING, "--json", "--set", "reference=[]").exit_code == 1
    summary = json.loads(answer.stdout)
    assert summary["status"] == "does not stand under its dead loads"
    assert summary["limit_analysis"]["associated"] is None


def test_an_answer_that_fails_its_checks_is_no_answer(monkeypatch):
    from dem_cli.core.limit import associated

    monkeypatch.setattr(associated, "TRIES", ({"max_iter": 3},))
    answer = dem("limit", WALL)
    assert answer.exit_code == 3
    assert "not converged: residual" in answer.stdout
    assert "\n  associated" not in answer.stdout


@pytest.mark.parametrize("name", ["overhang_stands", "settlement_portal"])
def test_kinds_without_live_loads(name):
    path = CASES / "verification" / f"{name}.toml"
    answer = dem("limit", path, "--set", "analysis={kind='gravity'}")
    assert answer.exit_code == 2
    assert "analysis.kind = 'gravity' has none" in answer.stderr
    assert answer.stdout == ""


def test_pattern_live_is_the_multiplier_of_the_live_loads():
    summary = json.loads(dem("limit", CASES / "verification" / "arch_point_load.toml", "--json").stdout)
    assert summary["limit_analysis"]["associated"] == pytest.approx(8.48487, rel=1e-5)


def test_a_profile_is_ignored_aloud():
    """Limit analysis knows plane joints, and says so."""
    case = WALL.parents[1] / "validation" / "wall_21_profile.toml"
    answer = dem("limit", case, "--associated-only", "--json")
    assert any("takes joint 'rough' as plane" in line for line in json.loads(answer.stdout)["warnings"])


def test_each_load_says_what_it_bounds():
    """An arch whose bounds meet, in lines and in JSON."""
    small = (CASES / "verification" / "arch_21_mu040.toml", "--lower", "--least")
    lines = dict(line.split(maxsplit=1) for line in dem("limit", *small).stdout.splitlines()[1:])
    assert "(upper bound, between 0.05216" in lines["associated"]
    assert "of all collapse states of joints that do not dilate" in lines["least"]
    assert "collapse at no lower load" in lines["lower"]
    limits = json.loads(dem("limit", *small, "--json").stdout)["limit_analysis"]
    assert limits["lower_bound_status"] == "ok"
    assert limits["lower_bound"] <= limits["least"] <= limits["associated_bounds"][1]
    assert (limits["least_of"], limits["least_changed"], limits["least_forces_bounded"]) == ("all", None, True)
    assert limits["reduced_domain"] is None  # without cohesion it does not even carry the dead loads


def test_joints_with_strength_have_bounds_and_no_path():
    glued = (CASES / "verification" / "cohesion_block.toml", "--lower", "--least")
    answer = dem("limit", *glued)
    assert answer.exit_code == 0
    assert "non-associated not looked for: the path knows friction alone, and law 'mohr-coulomb' more" in answer.stdout
    assert "reduced        0.1699  (reduced domain: lower bound of joints that keep their cohesion" in answer.stdout
    assert dem("limit", *glued, "--associated-only").stdout.count("non-associated") == 0


def test_a_least_load_of_joints_that_lose_strength_is_refused():
    answer = dem("limit", CASES / "verification" / "tension_block.toml", "--least")
    assert answer.exit_code == 2
    assert "residual strengths" in answer.stderr
    assert "leave --least out" in answer.stderr


def test_barton_s_joints_are_refused_in_words():
    answer = dem("limit", CASES / "verification" / "barton_block.toml")
    assert answer.exit_code == 2
    assert "that of law 'barton' is curved" in answer.stderr


OUT_OF_PLANE = """
title = "Wall in space"
dimension = 3
[materials.stone]
density = 2200.0
[joints.dry]
friction = 0.7
[[structure]]
kind = "wall"
block = [1.0, 0.5]
courses = 4
blocks_per_course = 4
thickness = 0.4
sides = [{ face = "-y", strip = 0.5 }]
[analysis]
kind = "pushover"
direction = [0.0, -1.0, 0.0]
"""


@pytest.fixture
def out_of_plane(tmp_path):
    path = tmp_path / "wall.toml"
    path.write_text(OUT_OF_PLANE, encoding="utf-8")
    return path


def test_a_wall_out_of_its_plane_is_not_taken_at_its_bound(out_of_plane, tmp_path):
    """Its head joints wedge between the posts, as no joint does that does not dilate: 1.415 against 0.819."""
    answer = dem("limit", out_of_plane, "--set", "joints.dry.friction=0.5", "-o", tmp_path / "out")
    assert answer.exit_code == 0
    assert (
        "head joints dilate in it and wedge: out of plane such a bound can be several times too high" in answer.stdout
    )
    results = read(tmp_path / "out")
    limits = results.summary["limit_analysis"]
    assert limits["associated"] > 1.5 * limits["non_associated"]
    assert limits["associated_head_friction"] > 0.1
    for frame in results.frames:
        assert np.linalg.norm(frame.orientations, axis=1) == pytest.approx(1.0)
        assert (results.model.live_loads * frame.velocities).sum() == pytest.approx(1.0)
    assert "wedge" not in dem("limit", out_of_plane, "--heads", "frictionless", "--associated-only").stdout


def test_joints_that_lock_because_they_dilate_fail_all_the_same(out_of_plane):
    """At μ = 0.7 no load makes dilating joints fail; others do at 1.64 with friction at their corners, between posts
    that hold the ends, and with that of a spread pressure at 1.335 in a run that raises the load from gravity.
    """
    answer = dem("limit", out_of_plane)
    assert "associated     no load of this direction makes it fail, if joints dilate as they slide" in answer.stdout
    assert "\n  status" not in answer.stdout
    limits = json.loads(dem("limit", out_of_plane, "--json").stdout)["limit_analysis"]
    assert limits["associated"] is limits["associated_head_friction"] is None
    assert limits["non_associated"] == pytest.approx(1.335, rel=0.04)
    corners = dem("limit", out_of_plane, "--set", "joints.dry.points='vertices'", "--json").stdout
    assert json.loads(corners)["limit_analysis"]["non_associated"] == pytest.approx(1.64, rel=0.03)


@pytest.mark.parametrize("bound", ["--lower", "--least"])
def test_bounds_that_are_known_in_2d_only(out_of_plane, bound):
    answer = dem("limit", out_of_plane, bound)
    assert answer.exit_code == 2
    assert f"{bound}: bounds of joints that do not dilate are known in 2D only" in answer.stderr
    assert answer.stdout == ""


def test_tables_that_tilt_joints_with_strength_are_refused():
    """The weight of the blocks falls with the cosine of the angle, and cohesion does not."""
    glued = (CASES / "verification" / "cohesion_block.toml", "--set", "analysis.pattern=tilt")
    answer = dem("limit", *glued)
    assert answer.exit_code == 2
    assert "those of a tilting table fall" in answer.stderr
    answer = dem("run", *glued, "--set", "analysis.limit=true", "--json")
    summary = json.loads(answer.stdout)
    assert "limit_analysis" not in summary or summary["limit_analysis"] == {}
    assert [line.split(":")[0] for line in summary["warnings"]] == ["no limit analysis"]
    wall = dem("limit", WALL, "--associated-only", "--set", "analysis.pattern=tilt", "--json")
    assert json.loads(wall.stdout)["limit_analysis"]["associated"] == pytest.approx(0.6812, abs=1e-4)


TIERS = """
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.3
[[structure]]
kind = "column"
id = "lower"
block = [1.0, 0.5]
courses = 2
[[structure]]
kind = "column"
id = "upper"
block = [1.0, 0.5]
courses = 1
base = false
origin = [0.0, HEIGHT]
[analysis]
kind = "pushover"
"""


def test_a_tier_drawn_to_a_few_digits_rests_on_the_one_below(tmp_path):
    """A gap of 2.5 µm: such structures "did not stand". The upper block slides at its friction."""
    case = tmp_path / "tiers.toml"
    case.write_text(TIERS.replace("HEIGHT", "1.0000025"), encoding="utf-8")
    answer = dem("limit", case, "--json", "-o", tmp_path / "out")
    said = json.loads(answer.stdout)
    assert answer.exit_code == 0
    assert said["limit_analysis"]["associated"] == pytest.approx(0.3, rel=1e-6)
    assert "takes as closed a gap of 2.5e-06 m between 'lower-2' and 'upper-1'" in " ".join(said["warnings"])
    assert read(tmp_path / "out").summary["status"] == "ok"
