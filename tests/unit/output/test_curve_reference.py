"""[reference] of a curve: mean error over it, tolerance by its kind, what is said of it."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from dem_cli.app.api import load_case
from dem_cli.app.cli.words.reference import one_line
from dem_cli.app.verify.records import record
from dem_cli.app.verify.verdict_words import allowed, expected, found, off, share
from dem_cli.case.reference import Reference
from dem_cli.errors import CaseError
from dem_cli.results.output.reference import error_of, in_summary, verdicts

CURVE = {"displacements": [0.0, 0.01, 0.03], "loads": [0.0, 100.0, 100.0]}
SUMMARY = {"status": "ok", "kind": "pushover", "capacity_curve": CURVE}


def reference(**more):
    table = {"quantity": "capacity_curve", "kind": "experiment", "displacements": [0.005, 0.02], "value": [50.0, 96.0]}
    return Reference.model_validate(table | more)


def judge(**more):
    (answer,) = verdicts(SUMMARY, [reference(**more)])
    return answer


def test_mean_and_largest_error():
    answer = judge()
    assert answer["found"] == [50.0, 100.0]
    assert (answer["mean_error"], answer["largest_error"]) == (2.0, 4.0)
    assert answer["tolerance"] == pytest.approx(0.05 * 96.0)
    assert answer["passed"]
    assert error_of(answer) == 2.0
    assert in_summary([answer]) == answer
    words = "curve of 2 points, peak 96: 2.1 % of that off on average, at most +4.2 %, 5 % allowed: passed"
    assert one_line(answer) == words


@pytest.mark.parametrize(
    ("more", "tolerance", "passed"),
    [
        ({"tolerance": 1.9}, 1.9, False),
        ({"relative": 0.03}, 0.03 * 96.0, True),
        ({"scatter": 1.1, "specimens": 4}, 2.2, True),
        ({"scatter": 1.1, "specimens": 3}, 0.05 * 96.0, True),
        ({"kind": "code"}, 0.05 * 96.0, True),
        ({"kind": "exact"}, 1e-3 * 96.0, False),
        ({"value": [50.0, 80.0]}, 4.0, False),
    ],
)
def test_tolerances(more, tolerance, passed):
    answer = judge(**more)
    assert answer["tolerance"] == pytest.approx(tolerance)
    assert answer["passed"] == passed


def test_a_curve_that_ends_before_says_so():
    answer = judge(displacements=[0.005, 0.04])
    assert not answer["passed"]
    assert answer["problem"] == "the curve ends at 0.03 m, before 0.04 m of the reference"
    (without,) = verdicts({"status": "ok"}, [reference()])
    assert "only control = 'displacement' finds one" in without["problem"]


def test_the_page_of_verification(tmp_path):
    file = tmp_path / "case.toml"
    file.write_text("", encoding="utf-8")
    case = SimpleNamespace(compared=(reference(),), blind=(), prediction=())
    (answer,) = record(file, "a wall", SUMMARY, case, 1.0)["references"]
    said = (found(answer), expected(answer), off(answer), allowed(answer))
    assert said == ("up to 100", "up to 96 in 2 points", "2 on average", "± 4.8")
    assert share(answer) == pytest.approx(2.0 / 96.0)
    assert answer["state"] == "passed"


CASE = """
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "wall"
block = [1.0, 0.5]
courses = 3
blocks_per_course = 2
[[reference]]
quantity = "{quantity}"
{keys}
"""


@pytest.mark.parametrize(
    ("quantity", "keys", "words"),
    [
        ("capacity_curve", "value = [1.0, 2.0]", "displacements: missing"),
        ("failure_load", "value = 1.0\ndisplacements = [0.1, 0.2]", "only allowed with quantity = 'capacity_curve'"),
        ("failure_load", "value = [1.0, 2.0, 3.0]", "3 numbers are not allowed; must be [lowest, highest]"),
        ("capacity_curve", "value = [1.0]\ndisplacements = [0.1, 0.2]", "must be a list of 2 numbers"),
        ("capacity_curve", "value = 1.0\ndisplacements = [0.1, 0.2]", "must be a list of 2 numbers"),
        ("capacity_curve", "value = [1.0, 2.0]\ndisplacements = [0.2, 0.1]", "displacements increase"),
        ("capacity_curve", "value = [0.0, 0.0]\ndisplacements = [0.1, 0.2]", "loads above 0 are missing"),
    ],
)
def test_what_is_refused(tmp_path, quantity, keys, words):
    file = tmp_path / "case.toml"
    file.write_text(CASE.format(quantity=quantity, keys=keys), encoding="utf-8")
    with pytest.raises(CaseError) as refused:
        load_case(file)
    assert words in str(refused.value)
