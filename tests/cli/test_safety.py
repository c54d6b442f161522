"""`dem run`, `dem check`, `dem plot` and `dem new` of a safety analysis."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from casefiles import CASES
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.results.output.reader import read

COLUMN = CASES / "verification" / "least_thickness_column.toml"
INCLINE = CASES / "verification" / "safety_incline.toml"


def dem(*arguments: str | Path):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_an_answer_with_its_pictures(tmp_path):
    done = dem("run", INCLINE, "-o", tmp_path / "out", "-q")
    assert done.exit_code == 0, done.output
    for text in ("safety factor", "(fails at 2.4021)", "divided by F   friction", "'dry': friction 0.2502", "1 fail"):
        assert text in done.output
    assert "passed" in done.output
    drawn = dem("plot", tmp_path / "out")
    assert drawn.exit_code == 0, drawn.output
    assert {path.name for path in (tmp_path / "out").glob("*.png")} == {"safety.png", "collapse.png"}
    assert dem("run", INCLINE, "-o", tmp_path / "out", "-q").exit_code == 0  # replaces all that dem wrote


def test_a_load_that_is_varied_is_no_load_that_stays(tmp_path):
    words = ("--set", "analysis.vary=analysis.load", "--set", "analysis.between=[0.1, 2.0]")
    words += ("--set", "reference=[]", "--set", "analysis.load=0.2")
    done = dem("run", INCLINE, "-o", tmp_path / "out", "-q", *words)
    assert done.exit_code == 0, done.output
    assert "varied         analysis.load, stands below" in done.output
    assert "under" not in done.output


@pytest.mark.parametrize(
    ("between", "says"),
    [
        ("[3.0, 4.0]", "decides below analysis.between"),
        ("[1.0, 2.0]", "decides above analysis.between"),
    ],
)
def test_a_range_without_the_answer_says_nothing_of_strength(tmp_path, between, says):
    words = ("--set", f"analysis.between={between}", "--set", "reference=[]")
    done = dem("run", INCLINE, "-o", tmp_path / "out", "-q", *words)  # its factor is 2.4
    assert says in done.output
    assert "does not decide" not in done.output


def test_results_hold_the_structure_next_to_failure(tmp_path):
    done = dem("run", COLUMN, "-o", tmp_path / "out", "--json", "-q")
    summary, results = json.loads(done.stdout), read(tmp_path / "out")
    width = np.ptp(results.model.vertices[:, 0])
    assert width == pytest.approx(summary["fails_at"])
    assert summary["critical_value_bracket"] == [summary["fails_at"], summary["stands_at"]]
    assert [frame.stage for frame in results.frames][:2] == ["loading", "collapse"]
    again = dem("run", tmp_path / "out" / "case.toml", "-o", tmp_path / "again", "--json", "-q")
    assert json.loads(again.stdout)["critical_value_bracket"] == summary["critical_value_bracket"]


def test_check_says_what_is_varied():
    done = dem("check", COLUMN)
    assert done.exit_code == 0, done.output
    assert "structure.0.block.0 between 0.1 and 1" in done.output


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("0.block.0", "0.blok.0"), ":20:8: analysis.vary: 'structure.0.blok.0' is not in the case"),
        (("[0.1, 1.0]", "[1.0, 0.1]"), ":21:11: analysis.between: [1, 0.1] is not allowed"),
        (("[0.1, 1.0]", "[-0.1, 1.0]"), ":21:11: analysis.between: structure.0.block.0 = -0.1 is not possible"),
        (("between = [0.1, 1.0]", ""), "analysis.between: missing"),
        (('vary = "structure.0.block.0"', 'reduce = ["cohesion"]'), "analysis.reduce: no joint has any cohesion"),
    ],
)
def test_mistakes_have_their_line(tmp_path, change, message):
    path = tmp_path / "case.toml"
    path.write_text(COLUMN.read_text(encoding="utf-8").replace(*change), encoding="utf-8")
    for command in (("check", path), ("run", path, "-o", tmp_path / "out")):
        done = dem(*command)
        assert done.exit_code == 2
        assert message in done.output
    assert not (tmp_path / "out").exists()


def test_barton_has_no_factor(tmp_path):
    path = tmp_path / "case.toml"
    text = INCLINE.read_text(encoding="utf-8").replace('"coulomb"', '"barton"')
    path.write_text(text.replace("friction = 0.6", "jrc = 8.0\njcs = 1e8\nresidual_angle_deg = 30.0"), encoding="utf-8")
    done = dem("check", path)
    assert done.exit_code == 2
    assert "joints.dry.law: 'barton' has no friction, cohesion or tension that a factor divides" in done.output


def test_the_template_runs(tmp_path):
    done = dem("new", "safety", "-o", tmp_path / "arch.toml")
    assert done.exit_code == 0
    done = dem("run", tmp_path / "arch.toml", "-o", tmp_path / "out", "-q", "--set", "analysis.follow=0.0")
    assert done.exit_code == 0, done.output
    assert "safety factor  1.66" in done.output
