"""Blind references: predicted once, with their bands, shown as predicted, and judged when a value is measured."""

from __future__ import annotations

import json
import tomllib
import xml.etree.ElementTree as ET

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.app.verify.predictions import bands
from dem_cli.version import __version__

CASE = """# A block on a floor that slides; friction is not known well.
title = "A block on a floor"
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.4
[[structure]]
kind = "column"
block = [1.0, 1.0]
courses = 1
[analysis]
kind = "pushover"
[[alternative]]
why = "friction is not given"
set = { "joints.dry.friction" = 0.3 }
[[alternative]]
why = "friction is not given"
set = { "joints.dry.friction" = 0.6 }
[[alternative]]
of = "numerical"
why = "more contact points"
set = { "joints.dry.points" = 5 }
[[reference]]
kind = "blind"
quantity = "failure_load"
model = [-0.1, 0.2]
reason = "blocks like it: -10 to +20 %"
source = "a test that is not published"
"""
MEASURED = 'kind = "blind"\nvalue = {value}\nmeasured_in = "Table 1"'


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cases").mkdir()
    path = tmp_path / "cases" / "block.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def verify(*words, code=0):
    result = CliRunner().invoke(main, ["verify", *map(str, words), "-j", "1", "-q"])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert result.exit_code == code, result.stdout + result.stderr
    return result


def record():
    (found,) = json.loads(verify("--json").stdout)["cases"]
    return found["references"][0]


def edit(file, old, new):
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_a_prediction_stays(file):
    """Predicted, refused, judged inside and outside its band, and refused again when a key changed."""
    assert verify("--predict").stdout == "cases/block.toml: 1 prediction written\n"
    text = file.read_text(encoding="utf-8")
    assert text.startswith(CASE)
    (found,) = tomllib.loads(text)["prediction"]
    assert (found["quantity"], found["version"]) == ("failure_load", __version__)
    assert found["value"] == pytest.approx(0.4, rel=1e-3)
    assert found["inputs"] == pytest.approx([0.3, 0.6], rel=1e-3)
    assert found["numerical"] == pytest.approx([0.4, 0.4], rel=3e-3)
    assert found["band"] == pytest.approx([0.3 * 0.9, 0.6 * 1.2], rel=5e-3)

    refused = verify("--predict", code=2).stderr
    assert f"cases/block.toml: was predicted on {found['date']} with dem {__version__}; a prediction stays" in refused
    assert file.read_text(encoding="utf-8") == text

    shown = verify().stdout
    assert "1 case, 1 reference: 0 passed, 1 predicted; " in shown
    assert f"failure_load was predicted on {found['date']} as 0.4, " in shown.replace("0.39986", "0.4")
    assert "nothing is measured yet" in shown
    assert (record()["state"], record()["value"], record()["passed"]) == ("predicted", None, None)

    edit(file, 'kind = "blind"', MEASURED.format(value=0.5))
    inside = record()
    assert (inside["state"], inside["passed"], inside["measured_in"]) == ("passed", True, "Table 1")
    assert inside["error"] == pytest.approx(-0.1, abs=1e-3)
    edit(file, "value = 0.5", "value = 0.8")
    assert (record()["state"], record()["passed"]) == ("outside", False)
    assert "0 passed, 1 outside their bands; " in verify().stdout
    assert "measured 0.8, outside" in verify().stdout

    edit(file, "friction = 0.4", "friction = 0.5")
    assert "keys changed after the prediction of" in verify(code=2).stdout


def test_page_and_junit(file, tmp_path):
    verify("--predict")
    verify("--write", "docs/verification.md", "--junit", "found.xml")
    page = (tmp_path / "docs" / "verification.md").read_text(encoding="utf-8")
    assert "| [blind](#blind) | 1 | 1, 1 not measured | 0 | 0 | 0 | – | – |" in page
    (row,) = (line for line in page.splitlines() if "cases/block.toml" in line and line.startswith("|"))
    assert "+5.00\N{NO-BREAK SPACE}% ± 15.0\N{NO-BREAK SPACE}%" in row
    assert row.endswith("| – | predicted |")
    assert "<br>on 20" in row
    assert "Model errors:\n\n* [cases/block](../cases/block.toml), `failure_load`: blocks like it" in page
    (skipped,) = ET.parse(tmp_path / "found.xml").getroot().iter("skipped")
    assert skipped.get("message").endswith("nothing is measured yet")


def test_a_blind_case_without_prediction_is_refused(file):
    said = verify(code=2).stdout
    assert "'failure_load' is blind and has no prediction; `dem verify --predict cases/block.toml` writes it" in said


def test_run_ignores_what_is_blind(file):
    result = CliRunner().invoke(main, ["run", str(file), "--json", "-q"])
    assert result.exit_code == 0
    assert "reference" not in json.loads(result.stdout)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"joints.dry.friction" = 0.6', '"joints.dry.frictoin" = 0.6', "alternative.1: "),
        ('quantity = "failure_load"', 'quantity = "critical_value"', "'critical_value' is missing in the summary"),
        ('quantity = "failure_load"', 'quantity = "failure_mode"', "'failure_mode' is 'sliding'"),
    ],
)
def test_what_cannot_be_predicted_writes_nothing(file, old, new, says):
    edit(file, old, new)
    text = file.read_text(encoding="utf-8")
    result = CliRunner().invoke(main, ["verify", "--predict", "-j", "1", "-q"])
    assert result.exit_code in (2, 3)
    assert says in result.stderr
    assert file.read_text(encoding="utf-8") == text


@pytest.mark.parametrize(
    "words", [["--write", "p.md"], ["--junit", "f"], ["--changed"], ["--json"], ["--shelf", "blind"]]
)
def test_predict_stands_alone(file, words):
    assert f"{words[0]} is not allowed with --predict" in verify("--predict", *words, code=2).stderr


def test_nothing_to_predict(file):
    edit(file, 'kind = "blind"\n', 'kind = "experiment"\nvalue = 0.4\n')
    text = file.read_text(encoding="utf-8")
    file.write_text(text[: text.index("[[alternative]]")] + text[text.index("[[reference]]") :].replace(
        "model = [-0.1, 0.2]\nreason = ", "tolerance = 0.1\nreason = "), encoding="utf-8")  # fmt: skip
    assert "no case with a [reference] of kind 'blind'" in verify("--predict", code=2).stderr


def test_bands_add_up():
    found = bands([10.0, 9.0, 12.0, 10.5], ["input", "input", "numerical"], [10.0, 10.2], (-0.1, 0.2))
    assert found == {"numerical": [10.0, 10.5], "inputs": [9.0, 12.0], "band": [8.1, 15.0]}


def test_bands_of_loads_that_pull():
    found = bands([-10.0, -9.0], ["input"], [], (-0.1, 0.2))
    assert found == {"numerical": [-10.0, -10.0], "inputs": [-10.0, -9.0], "band": [-12.0, -8.1]}
