"""Verdicts in words, the order of cases, and what is kept of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from dem_cli.app.verify.case_selection import longest_first
from dem_cli.app.verify.records import counts, merged, moved, on_shelves, rounded, state
from dem_cli.app.verify.verdict_words import allowed, judgement, off, share, shown


def answer(value, found, error, **more):
    answer = {"quantity": "failure_load", "kind": "exact", "value": value, "found": found, "error": error}
    return {**answer, "tolerance": 0.01, "passed": False, **more}


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.123456789, "0.12346"),
        (-1e-5, "−1e−05"),
        (106396.9, "106400"),
        (2.5e12, "2.5e+12"),
        ("ok", "ok"),
        (True, "true"),
        (None, "–"),
        ([0.1, 0.2], "0.1 to 0.2"),
    ],
)
def test_shown(value, text):
    assert shown(value) == text


@pytest.mark.parametrize(
    ("given", "text", "part"),
    [
        (answer(0.5, 0.51, 0.01), "+0.01", 0.02),
        (answer(-0.5, -0.51, -0.01), "−0.01", -0.02),
        (answer(0.5, 0.5, 0.0), "0", 0.0),
        (answer(0.0, 0.1, 0.1), "+0.1", None),
        (answer([0.4, 0.5], 0.45, 0.0), "inside", 0.0),
        (answer([0.4, 0.5], 0.3, -0.1), "−0.1", -0.25),
        (answer([0.4, 0.5], 0.6, 0.1), "+0.1", 0.2),
        (answer(0.5, None, None), "–", None),
        (answer("ok", "falls", None), "", None),
        (answer(True, False, None), "", None),
    ],
)
def test_how_far_off(given, text, part):
    assert off(given) == text
    assert share(given) == (part if part is None else pytest.approx(part))


def test_allowed():
    assert allowed(answer(0.5, 0.5, 0.0)) == "± 0.01"
    assert allowed(answer("ok", "ok", None, tolerance=None)) == ""


@pytest.mark.parametrize(
    ("more", "name", "says"),
    [
        ({"passed": True}, "passed", "failure_load is 0.51, expected 0.5 ± 0.01"),
        ({}, "failed", "failure_load is 0.51, expected 0.5 ± 0.01"),
        ({"missed": "why"}, "missed", "failure_load is 0.51, expected 0.5 ± 0.01: missed, as known: why"),
        ({"missed": "why", "passed": True}, "met", "met, but [reference] says that it is missed: why"),
        ({"problem": "nothing there"}, "failed", "nothing there"),
        ({"problem": "nothing there", "missed": "why"}, "failed", "nothing there"),
    ],
)
def test_state_and_judgement(more, name, says):
    given = answer(0.5, 0.51, 0.01, **more)
    assert state(given) == name
    assert judgement(given).endswith(says)


def test_the_longest_first_and_before_them_those_that_nobody_knows():
    costs = {"a": 1.0, "b": 9.0, "d": 3.0}
    order = longest_first([Path(name) for name in "abcd"], lambda path: costs.get(path.name))
    assert [path.name for path in order] == ["c", "b", "d", "a"]


def test_shelves_and_counts():
    both = {"case": "x", "references": [{"kind": "exact", "state": "passed"}, {"kind": "code", "state": "met"}]}
    wrong = {"case": "y", "references": [], "error": "no such key"}
    assert [one["case"] for one in on_shelves([both, wrong], ["cross-code"])] == ["x", "y"]
    assert [one["case"] for one in on_shelves([both], ["validation"])] == []
    assert counts([both, wrong]) == {
        "cases": 2, "references": 2, "passed": 1, "missed": 0, "failed": 0, "met": 1, "not solved": 1,
    }  # fmt: skip


def test_records_of_cases_that_are_gone_are_dropped(tmp_path):
    kept = tmp_path / "kept.toml"
    kept.write_text("")
    old = [{"case": str(kept), "seconds": 1.0}, {"case": str(tmp_path / "gone.toml"), "seconds": 1.0}]
    assert merged(old, []) == [old[0]]
    assert merged(old, [{"case": str(kept), "seconds": 2.0}]) == [{"case": str(kept), "seconds": 2.0}]


def test_paths_and_digits():
    assert moved("cases/x.toml", Path(), Path("docs")) == "../cases/x.toml"
    assert moved("../cases/x.toml", Path("docs"), Path()) == "cases/x.toml"
    assert rounded(0.12345) == 0.12
