"""Verdicts: what was computed beside the [reference] of a case."""

from __future__ import annotations

import pytest

from dem_cli.app.cli.words.reference import one_line
from dem_cli.case.reference import Reference
from dem_cli.results.output.reference import as_declared, error, from_summary, in_summary, verdicts
from dem_cli.results.output.summary import exit_code

SUMMARY = {
    "status": "ok",
    "failure_load": 0.64,
    "collapsed": False,
    "steps": 12,
    "frequencies": [10.0, 20.0],
    "peaks": {"top displacement": {"peak": -0.012, "time": 0.5}},
}


def judge(summary=SUMMARY, **table):
    (answer,) = verdicts(summary, [Reference.model_validate(table)])
    return answer


def of(quantity, value, **more):
    return judge(quantity=quantity, value=value, **more)


@pytest.mark.parametrize(
    ("table", "passed"),
    [
        ({"failure_load": 0.63, "tolerance": 0.011}, True),
        ({"failure_load": 0.62, "tolerance": 0.01}, False),
        ({"failure_load": 0.63, "relative": 0.02}, True),
        ({"failure_load": 0.63, "relative": 0.01}, False),
        ({"quantity": "failure_load", "value": [0.6, 0.64]}, True),
        ({"quantity": "failure_load", "value": [0.65, 0.7]}, False),
        ({"quantity": "failure_load", "value": [0.65, 0.7], "tolerance": 0.02}, True),
        ({"quantity": "failure_load", "value": [0.65, 0.7], "relative": 0.01}, False),
        ({"quantity": "failure_load", "value": [0.65, 0.7], "relative": 0.02}, True),
        ({"quantity": "peaks.top displacement.peak", "value": -0.0121, "relative": 0.01}, True),
        ({"quantity": "frequencies.1", "value": 20, "tolerance": 1}, True),
        ({"quantity": "steps", "value": 12, "tolerance": 0.5}, True),
        ({"quantity": "status", "value": "ok"}, True),
        ({"quantity": "status", "value": "OK"}, False),
        ({"quantity": "collapsed", "value": False}, True),
        ({"quantity": "collapsed", "value": True}, False),
    ],
)
def test_verdict(table, passed):
    answer = judge(**table)
    assert answer["passed"] is passed
    assert "problem" not in answer
    assert as_declared(answer) is passed


@pytest.mark.parametrize(
    "table", [{"failure_load": 0.0, "tolerance": 1.0}, {"quantity": "failure_load", "value": [0, 9]}]
)
def test_no_failure_load_never_passes(table):
    answer = judge({**SUMMARY, "failure_load": None}, **table)
    assert answer["passed"] is False
    assert "problem" not in answer


@pytest.mark.parametrize(
    ("quantity", "value", "says"),
    [
        ("peeks.top displacement.peak", 1.0, "the summary has no 'peeks.top displacement.peak', did you mean 'peaks."),
        ("frequencies", 10.0, "the summary has no 'frequencies', but 'frequencies.0', 'frequencies.1'"),
        ("zzz", 1.0, "the summary has no 'zzz'"),
        ("status", 1.0, "'status' is a word, not a number"),
        ("collapsed", 0.0, "'collapsed' is true or false, not a number"),
        ("failure_load", "0.64", "'failure_load' is a number, not a word"),
        ("steps", True, "'steps' is a number, not true or false"),
    ],
)
@pytest.mark.parametrize("missed", [{}, {"missed": "known"}])
def test_nothing_to_compare_is_always_a_failure(quantity, value, says, missed):
    tolerance = {"tolerance": 1.0} if type(value) is float else {}
    answer = of(quantity, value, **tolerance, **missed)
    assert answer["problem"].startswith(says)
    assert not answer["passed"]
    assert not as_declared(answer)
    assert f"FAILED, {says}" in one_line(answer)


def test_no_failure_load_in_another_analysis():
    summary = {key: value for key, value in SUMMARY.items() if key != "failure_load"}
    answer = judge(summary, failure_load=0.6, tolerance=0.1)
    assert answer["problem"] == "this kind of analysis has no failure load"


def test_a_known_miss_is_missed_or_fails():
    missed = judge(failure_load=0.5, tolerance=0.01, missed="joints too stiff")
    assert (missed["passed"], as_declared(missed)) == (False, True)
    assert one_line(missed) == "0.5 ± 0.01: missed, as known: joints too stiff"
    met = judge(failure_load=0.64, tolerance=0.01, missed="joints too stiff")
    assert (met["passed"], as_declared(met)) == (True, False)
    assert one_line(met) == "0.64 ± 0.01: FAILED, met but declared as missed"


@pytest.mark.parametrize(
    ("found", "expected", "off"),
    [(2.0, 1.5, 0.5), (1.0, 1.5, -0.5), (2.0, (1.0, 3.0), 0.0), (0.5, (1.0, 3.0), -0.5), (4.0, (1.0, 3.0), 1.0)],
)
def test_error(found, expected, off):
    assert error(found, expected) == off


@pytest.mark.parametrize("pair", [(None, 1.0), ("ok", "ok"), (True, 1.0), (1.0, "ok")])
def test_error_of_what_is_no_number(pair):
    assert error(*pair) is None


def test_in_summary():
    plain = Reference(failure_load=0.64, tolerance=0.001)
    stands = Reference(quantity="collapsed", value=False, kind="experiment")
    wrong = Reference(quantity="status", value="not ok")
    for references, code in (([plain], 0), ([stands], 0), ([plain, stands], 0), ([plain, wrong], 1), ([wrong], 1)):
        answers = verdicts(SUMMARY, references)
        kept = in_summary(answers)
        assert exit_code({**SUMMARY, "reference": kept}) == code
        assert [answer["quantity"] for answer in from_summary(kept)] == [one.path for one in references]
    assert in_summary(verdicts(SUMMARY, [plain])) == {"value": 0.64, "tolerance": 0.001, "passed": True}
    assert in_summary(verdicts(SUMMARY, [stands]))["kind"] == "experiment"
    assert from_summary(None) == []


@pytest.mark.parametrize(
    ("table", "line"),
    [
        ({"failure_load": 0.64, "tolerance": 0.001}, "0.64 ± 0.001: passed"),
        ({"quantity": "collapsed", "value": False}, "collapsed is false, expected false: passed"),
        (
            {"quantity": "peaks.top displacement.peak", "value": [0.01, 0.02]},
            "peaks.top displacement.peak is -0.012, expected [0.01, 0.02]: FAILED",
        ),
    ],
)
def test_line(table, line):
    assert one_line(judge(**table)) == line
