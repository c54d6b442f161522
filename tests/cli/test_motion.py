"""`dem motion`: what it says, what it leaves, and that what it wrote is read again as it was."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

from dem_cli.app.api import load_case, make_case_model
from dem_cli.app.cli.main import main
from dem_cli.app.cli.motion import draw_spectra_of_case
from dem_cli.masonry.assembly.ground_motions import motions_of

CASE = """
title = "Two drums"

[materials.stone]
density = 2000.0

[joints.dry]
friction = 0.6

[[structure]]
kind = "column"
block = [0.5, 0.25]
courses = 2
base = true
"""
SUITE = """
[motion]
kind = "artificial"
spectrum = "EC8-1"
soil = "B"
ag = 2.0
count = 7
number = 3
"""
RECORD = """
[motion]
kind = "record"
file = "{}"
column = 2
unit = "m/s2"
"""


def dem(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.fixture(scope="module")
def suite(tmp_path_factory):
    folder = tmp_path_factory.mktemp("motion")
    (folder / "drums.toml").write_text(CASE + SUITE)
    return dem("motion", folder / "drums.toml", "-o", folder / "out"), folder


def test_the_table_of_a_suite(suite):
    answer, folder = suite
    assert answer.exit_code == 0, answer.output
    lines = answer.stdout.splitlines()
    assert lines[0] == "Two drums"
    assert sum(line.startswith("  artificial ") for line in lines) == 7
    assert "meets EN 1998-1 3.2.3.1.2 (3), (4)a, (4)b, (4)c" in answer.stdout
    assert {path.name for path in (folder / "out").iterdir()} == {
        "summary.json", "spectra.png", "motion.png", "records",
    }  # fmt: skip
    for name in ("spectra.png", "motion.png"):
        assert (folder / "out" / name).read_bytes()[:4] == b"\x89PNG"


def test_the_summary(suite):
    summary = json.loads((suite[1] / "out" / "summary.json").read_text())
    assert (summary["kind"], summary["status"], len(summary["motions"])) == ("motion", "ok", 7)
    first = summary["motions"][0]
    assert first["duration"] == 20.0
    assert first["acceleration"] >= 2.4 * (1 - 1e-12)
    assert 0 < first["least_ratio"] <= first["mean_ratio"]
    (found,) = summary["suites"]
    assert found["meets_eurocode_8"] is True
    assert found["clauses"] == {"(3)": True, "(4)a": True, "(4)b": True, "(4)c": True}
    assert found["least_mean_ratio"] >= 0.9
    assert found["mean_peak_ratio"] >= 1.0


def test_a_suite_of_two_says_what_eurocode_8_asks_for(tmp_path):
    (tmp_path / "drums.toml").write_text(CASE + SUITE.replace("count = 7\nnumber = 3", "count = 2\nplateau = 6.0"))
    answer = dem("motion", tmp_path / "drums.toml", "-o", tmp_path / "out")
    assert (
        "DOES NOT MEET EN 1998-1 3.2.3.1.2 (3), (4)a, (4)b, (4)c: (3): strong for 6 s, 10 s are required"
        in answer.stdout
    )
    assert "(4)a: 2 records, at least 3 are required" in answer.stdout
    (found,) = json.loads((tmp_path / "out" / "summary.json").read_text())["suites"]
    assert found["meets_eurocode_8"] is False


def test_a_written_record_is_read_again_as_it_was(suite, tmp_path):
    folder = suite[1]
    (made,) = motions_of(load_case(folder / "drums.toml").case)
    (tmp_path / "case.toml").write_text(CASE + RECORD.format(folder / "out" / "records" / "artificial-3.csv"))
    (read,) = motions_of(load_case(tmp_path / "case.toml").case)
    times = np.linspace(0, 21, 5000)
    assert (read.acceleration(times) == made.acceleration(times)).all()
    assert (read.displacement(times) == made.displacement(times)).all()


def test_strength_by_hand(tmp_path):
    """A rectangle of 1 m/s2 for 2 s: Arias π/(2g) · 2 s, 90 % of it in 1.8 s, end velocity 2 m/s, 2 m of way."""
    pulse = '[motion]\nkind = "pulse"\nshape = "impulse"\namplitude = 1.0\nduration = 2.0'
    (tmp_path / "case.toml").write_text(CASE + pulse)
    answer = dem("motion", tmp_path / "case.toml", "-o", tmp_path / "out", "--json")
    (row,) = json.loads(answer.stdout)["motions"]
    assert row["arias"] == pytest.approx(np.pi / 2 / 9.80665 * 2.0)
    assert row["significant"] == pytest.approx(1.8)
    assert (row["acceleration"], row["velocity"], row["displacement"]) == pytest.approx((1.0, 2.0, 2.0))


def test_two_tables(tmp_path):
    wave = '[[motion]]\nkind = "harmonic"\namplitude = 1.0\nfrequency = 2.0\ncycles = 5\n'
    (tmp_path / "case.toml").write_text(CASE + wave + wave + "direction = [0.0, 1.0]\nstart = 0.5")
    answer = dem("motion", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert answer.exit_code == 0, answer.output
    assert sorted(p.name for p in (tmp_path / "out" / "records").iterdir()) == ["1-2-Hz.csv", "2-2-Hz.csv"]
    assert dem("motion", tmp_path / "case.toml", "-o", tmp_path / "out").exit_code == 0  # replaces its own


@pytest.mark.parametrize("text", ["", '[motion]\nkind = "none"'])
def test_a_case_without_motion(tmp_path, text):
    (tmp_path / "case.toml").write_text(CASE + text)
    answer = dem("motion", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert answer.exit_code == 2
    assert "has no [motion] that moves anything" in answer.stderr
    assert not (tmp_path / "out").exists()


def test_a_bad_record_is_exit_code_2(tmp_path):
    (tmp_path / "east.csv").write_text("0,0\n0.1,nan\n")
    (tmp_path / "case.toml").write_text(CASE + RECORD.format("east.csv"))
    answer = dem("motion", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert answer.exit_code == 2
    assert "motion.file: east.csv:2: 'nan' is not allowed" in answer.stderr
    assert dem("check", tmp_path / "case.toml").exit_code == 2


def test_spectra_of_what_shook_a_run(tmp_path):
    """A record that is gone, and a case without motion, leave a remark or nothing."""
    case = tmp_path / "case.toml"
    case.write_text(CASE + SUITE)
    pictures = []
    for kind in ("time-history", "fragility"):
        (tmp_path / kind).mkdir()
        assert draw_spectra_of_case(case, kind, tmp_path / kind) == [tmp_path / kind / "spectra.png"]
        pictures.append((tmp_path / kind / "spectra.png").read_bytes())
    assert pictures[0] != pictures[1]  # the record that is used; all seven
    case.write_text(CASE + RECORD.format("gone.csv"))
    assert draw_spectra_of_case(case, "time-history", tmp_path) == []
    case.write_text(CASE)
    assert draw_spectra_of_case(case, "time-history", tmp_path) == []


def test_editors_may_write_one_table_or_several():
    schema = make_case_model().model_json_schema()["properties"]["motion"]
    one, several = schema["anyOf"]
    assert several["type"] == "array"
    assert several["items"] == one
    assert set(one["discriminator"]["mapping"]) == {"pulse", "harmonic", "record", "artificial", "none"}
