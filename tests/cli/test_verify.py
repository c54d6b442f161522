"""`dem verify`: cases with references run and compared; what fails, what is missed as declared, what cannot be read."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.app.verify.page import page
from dem_cli.app.verify.records import load

BLOCK = """
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
kind = "{kind}"
"""
SLIDES = (
    BLOCK.format(kind="pushover")
    + """
[reference]
failure_load = {load}
tolerance = 0.001
source = "friction"
{more}
"""
)
GOOD = SLIDES.format(load=0.4, more="")
WRONG = SLIDES.format(load=0.5, more="")
MISSED = SLIDES.format(load=0.5, more='kind = "experiment"\nmissed = "the floor was wet"')
MET = SLIDES.format(load=0.4, more='kind = "experiment"\nmissed = "the floor was wet"')
STANDS = (
    BLOCK.format(kind="gravity")
    + """
[[reference]]
quantity = "status"
value = "ok"
kind = "code"
source = "another code"
[[reference]]
quantity = "blocks"
value = [1, 3]
"""
)
BAD = GOOD.replace("density", "denstiy")
BROKEN = "[reference\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cases").mkdir()
    return tmp_path


def write(folder, **texts):
    for name, text in texts.items():
        (folder / "cases" / f"{name}.toml").write_text(text, encoding="utf-8")


def verify(*words, code=0):
    result = CliRunner().invoke(main, ["verify", *map(str, words), "-j", "1"])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert result.exit_code == code, result.stdout + result.stderr
    return result


def answers(*words, code=0):
    found = json.loads(verify(*words, "--json", code=code).stdout)
    return found, {case["case"].removeprefix("cases/").removesuffix(".toml"): case for case in found["cases"]}


def test_all_well(folder):
    write(folder, good=GOOD, missed=MISSED, stands=STANDS, none=GOOD[: GOOD.index("[reference]")])
    found, cases = answers()
    assert set(cases) == {"good", "missed", "stands"}
    assert found["counts"] == {
        "cases": 3, "references": 4, "passed": 3, "missed": 1, "failed": 0, "met": 0, "not solved": 0,
    }  # fmt: skip
    (load,) = cases["good"]["references"]
    assert (load["state"], load["found"]) == ("passed", pytest.approx(0.4, abs=0.001))
    assert load["error"] == pytest.approx(load["found"] - 0.4)
    assert cases["missed"]["references"][0]["state"] == "missed"
    assert [answer["kind"] for answer in cases["stands"]["references"]] == ["code", "bounded"]


def test_table(folder):
    write(folder, good=GOOD, missed=MISSED, stands=STANDS)
    result = verify()
    lines = result.stdout.splitlines()
    assert [line.strip() for line in lines if line.strip() in ("verification", "validation", "cross-code")] == [
        "verification", "validation", "cross-code",
    ]  # fmt: skip
    (row,) = (line for line in lines if "cases/good" in line)
    assert row.split()[1] == "failure_load"
    assert " 0.4 " in row
    assert "passed" in row
    assert any("expected 0.5 ± 0.001: missed, as known: the floor was wet" in line for line in lines)
    assert lines[-1].startswith("3 cases, 4 references: 3 passed, 1 missed, as known; ")


@pytest.mark.parametrize(("text", "says"), [(WRONG, "expected 0.5 ± 0.001"), (MET, "met, but [reference] says")])
def test_one_that_fails(folder, text, says):
    write(folder, good=GOOD, other=text)
    found = verify(code=1).stdout
    assert says in found
    assert "1 passed, 1 FAILED" in found


def test_an_unknown_quantity_fails(folder):
    write(folder, other=STANDS.replace('"blocks"', '"blokcs"'))
    assert "the summary has no 'blokcs', did you mean 'blocks'?" in verify(code=1).stdout


def test_a_wrong_case_file_does_not_stop_the_others(folder):
    write(folder, bad=BAD, broken=BROKEN, good=GOOD)
    result = verify(code=2)
    assert "cases/bad.toml:4:1: materials.stone.denstiy: unknown key, did you mean 'density'?" in result.stdout
    assert "cases/broken.toml:1:" in result.stdout
    assert "1 passed; 2 cases NOT SOLVED" in result.stdout


def test_a_solver_that_gives_up_is_a_failure(folder):
    write(folder, other=GOOD.replace('kind = "pushover"', 'kind = "pushover"\nmax_steps = 1000'))
    found, cases = answers(code=1)
    assert found["counts"]["not solved"] == 1
    assert cases["other"]["error"].startswith("not converged")


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ([], ["good", "missed", "stands"]),
        (["-k", "MISS"], ["missed"]),
        (["-k", "g*d.toml"], ["good"]),
        (["--shelf", "validation"], ["missed"]),
        (["--shelf", "cross-code"], ["stands"]),
        (["cases/good.toml"], ["good"]),
        (["cases/good.toml", "cases", "-k", "good"], ["good"]),
    ],
)
def test_which_cases(folder, words, names):
    write(folder, good=GOOD, missed=MISSED, stands=STANDS)
    found, cases = answers(*words)
    assert sorted(cases) == names
    if "cross-code" in words:
        assert [answer["kind"] for answer in cases["stands"]["references"]] == ["code"]
        assert found["counts"]["references"] == 1


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["nowhere"], "nowhere: no such file or folder"),
        (["cases/godo.toml"], "did you mean 'cases/good.toml'?"),
        (["-k", "zzz"], "no case with a [reference] (none matches 'zzz')"),
        (["--shelf", "validation"], "no case with a [reference] (on the shelf validation)"),
        (["--shelf", "verification", "--write", "page.md"], "leave out --shelf"),
        (["--shelf", "all"], "'all' is not one of"),
    ],
)
def test_wrong_arguments(folder, words, says):
    write(folder, good=GOOD)
    result = verify(*words, code=2)
    assert says in result.stderr
    assert sorted(path.name for path in folder.iterdir()) == ["cases"]


def test_junit(folder):
    write(folder, good=GOOD, missed=MISSED, stands=STANDS, wrong=WRONG, bad=BAD)
    verify("--junit", "out/junit.xml", code=2)
    root = ET.parse(folder / "out" / "junit.xml").getroot()
    suites = {suite.get("name"): suite for suite in root}
    counts = {
        name: tuple(int(suite.get(key)) for key in ("tests", "failures", "errors", "skipped"))
        for name, suite in suites.items()
    }
    assert counts.pop("not solved") == (1, 0, 1, 0)
    assert counts.pop("bounds") == (1, 0, 0, 0)
    assert counts == {"verification": (2, 1, 0, 0), "validation": (1, 0, 0, 1), "cross-code": (1, 0, 0, 0)}
    tests = {(test.get("classname"), test.get("name")): test for test in root.iter("testcase")}
    assert tests["cases/stands.toml", "blocks"].get("time") == "0.000"
    assert "expected 0.5" in tests["cases/wrong.toml", "failure_load"].find("failure").get("message")
    assert "the floor was wet" in tests["cases/missed.toml", "failure_load"].find("skipped").get("message")
    assert "denstiy" in tests["cases/bad.toml", "run"].find("error").get("message")


def test_answers_are_shown_even_where_no_file_can_be_written(folder):
    write(folder, good=GOOD)
    (folder / "file").write_text("")
    result = verify("--junit", "file/junit.xml", code=2)
    assert "1 passed" in result.stdout
    assert "cannot write results" in result.stderr


def test_page_and_its_record(folder):
    write(folder, good=GOOD, missed=MISSED, stands=STANDS)
    verify("--write", "docs/verification.md")
    text = (folder / "docs" / "verification.md").read_text(encoding="utf-8")
    kept = json.loads((folder / "docs" / "data" / "verification.json").read_text(encoding="utf-8"))
    assert page(kept["cases"], kept["version"]) == text
    assert "[cases/good](../cases/good.toml)<br>A block on a floor | `failure_load` | 0.4 | 0.4 |" in text
    assert "* [cases/missed](../cases/missed.toml), `failure_load`: the floor was wet." in text
    assert [record["case"] for record in load(folder / "docs" / "data" / "verification.json")] == [
        "cases/good.toml", "cases/missed.toml", "cases/stands.toml",
    ]  # fmt: skip


INFERRED = GOOD.replace("tolerance = 0.001", 'kind = "inference"')
OWN = GOOD.replace("tolerance = 0.001", 'tolerance = 0.02\nreason = "the floor is soft"')


def test_what_an_input_was_inferred_from_is_counted_by_itself(folder):
    write(folder, good=GOOD, inferred=INFERRED)
    result = verify("--write", "docs/verification.md")
    assert "2 cases, 1 reference: 1 passed; besides, of inference: 1 reference: 1 passed; " in result.stdout
    text = (folder / "docs" / "verification.md").read_text(encoding="utf-8")
    summary, _, shelves = text.partition("## Verification")
    assert "Not counted: 1 references of [arithmetic of inference](#arithmetic-of-inference)." in summary
    assert "| [verification](#verification) | 1 | 1 | 1 | 0 | 0 |" in summary
    assert "## Arithmetic of inference" in shelves
    found, _ = answers()
    assert (found["counts"]["references"], found["counts"]["inference"]) == (1, 1)
    assert answers("--shelf", "inference")[1].keys() == {"inferred"}


def test_the_page_says_the_rules_and_why_a_tolerance_is_another(folder):
    write(folder, own=OWN, ruled=GOOD.replace("tolerance = 0.001\n", ""))
    verify("--write", "docs/verification.md")
    text = (folder / "docs" / "verification.md").read_text(encoding="utf-8")
    assert "* **code** (cross-code): 5 %, of a bracket beyond its ends." in text
    own, ruled = (line for line in text.splitlines() if line.startswith("| [cases/"))
    assert "±\N{NO-BREAK SPACE}0.02\\*" in own
    assert "±\N{NO-BREAK SPACE}0.0012 |" in ruled
    assert "* [cases/own](../cases/own.toml), `failure_load`: the floor is soft." in text


def test_a_part_of_the_page_written_again(folder):
    write(folder, good=GOOD, missed=MISSED, stands=STANDS)
    verify("--write", "docs/verification.md")
    (folder / "cases" / "missed.toml").unlink()
    write(folder, good=WRONG)
    verify("-k", "good", "--write", "docs/verification.md", code=1)
    records = {record["case"]: record for record in load(folder / "docs" / "data" / "verification.json")}
    assert set(records) == {"cases/good.toml", "cases/stands.toml"}
    assert records["cases/good.toml"]["references"][0]["state"] == "failed"


def test_only_what_changed(folder):
    write(folder, good=GOOD, stands=STANDS)
    verify("--write", "docs/verification.md")
    write(folder, good=f"# a comment\n{GOOD}")
    assert "nothing changed" in verify("--changed").stderr
    write(folder, good=GOOD.replace("0.001", "0.002"), missed=MISSED)
    _, cases = answers("--changed", "--write", "docs/verification.md")
    assert sorted(cases) == ["good", "missed"]
    assert "nothing changed" in verify("--changed").stderr


def test_those_known_to_take_long_are_left_out(folder):
    write(folder, good=GOOD, stands=STANDS)
    verify("--write", "docs/verification.md")
    file = folder / "docs" / "data" / "verification.json"
    kept = json.loads(file.read_text(encoding="utf-8"))
    kept["cases"][1]["seconds"] = 100.0
    file.write_text(json.dumps(kept), encoding="utf-8")
    result = verify("--at-most", "10")
    assert "left out as too long: stands" in result.stderr
    assert "1 case, 1 reference: 1 passed" in result.stdout
    verify("cases/stands.toml", "--at-most", "10", code=2)


def test_a_spoilt_record_is_said(folder):
    write(folder, good=GOOD)
    (folder / "docs" / "data").mkdir(parents=True)
    (folder / "docs" / "data" / "verification.json").write_text("[]", encoding="utf-8")
    assert "docs/data/verification.json: is not what `dem verify --write` left" in verify(code=2).stderr


def test_side_by_side(folder):
    write(folder, good=GOOD, stands=STANDS)
    result = CliRunner().invoke(main, ["verify", "-j", "2", "--json", "-q"])
    assert result.exit_code == 0, result.output
    assert [case["case"] for case in json.loads(result.stdout)["cases"]] == ["cases/good.toml", "cases/stands.toml"]
