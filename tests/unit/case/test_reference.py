"""[reference], alone or several of them."""

from __future__ import annotations

import pytest

from dem_cli.app.api import load_case
from dem_cli.case.writer import case_text
from dem_cli.errors import CaseError

WALL = """
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "wall"
block = [1.0, 0.5]
courses = 3
blocks_per_course = 2
"""
OLD = """
[reference]
failure_load = 0.5
tolerance = 0.01
source = "a book"
"""
SEVERAL = """
[[reference]]
quantity = "failure_load"
value = [0.4, 0.6]
relative = 0.05
kind = "experiment"
missed = "scale effects"
[[reference]]
quantity = "status"
value = "ok"
[[reference]]
quantity = "collapsed"
value = false
"""
BLIND = """
[[alternative]]
why = "friction is not given"
set = { "joints.dry.friction" = 0.5 }
[[reference]]
kind = "blind"
quantity = "failure_load"
model = [-0.1, 0.1]
reason = "walls like it"
"""
PREDICTED = """
[[prediction]]
quantity = "failure_load"
value = 0.5
numerical = [0.5, 0.5]
inputs = [0.4, 0.5]
band = [0.36, 0.55]
date = "2026-11-29"
version = "0.21.0"
sha256 = "0000000000000000000000000000000000000000000000000000000000000000"
"""


def load(tmp_path, text):
    file = tmp_path / "case.toml"
    file.write_text(WALL + text, encoding="utf-8")
    return load_case(file).case


def test_none(tmp_path):
    assert load(tmp_path, "").reference == ()


def test_the_old_form(tmp_path):
    (reference,) = load(tmp_path, OLD).reference
    assert (reference.path, reference.expected, reference.allowance) == ("failure_load", 0.5, 0.01)
    assert (reference.kind, reference.missed) == ("exact", None)


def test_several(tmp_path):
    interval, word, truth = load(tmp_path, SEVERAL).reference
    assert (interval.path, interval.expected) == ("failure_load", (0.4, 0.6))
    assert interval.allowance == 0.05 * 0.6
    assert (word.expected, word.allowance) == ("ok", None)
    assert (truth.expected, truth.allowance) == (False, None)


def test_written_and_read_again(tmp_path):
    for text in (OLD, SEVERAL, BLIND, BLIND + PREDICTED):
        case = load(tmp_path, text)
        written = case_text(case)
        file = tmp_path / "again.toml"
        file.write_text(written, encoding="utf-8")
        again = load_case(file).case
        assert again.reference == case.reference
        assert case_text(again) == written


def test_blind(tmp_path):
    case = load(tmp_path, BLIND + PREDICTED)
    assert (case.blind, case.compared) == (case.reference, ())
    assert (case.alternative[0].of, case.alternative[0].set) == ("input", {"joints.dry.friction": 0.5})
    assert case.prediction[0].band == (0.36, 0.55)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (
            'quantity = "failure_load"\nm',
            "m",
            "reference.0.quantity: missing; of kind 'blind' it says what is predicted",
        ),
        ('quantity = "failure_load"\nm', "failure_load = 0.5\nm", "reference.0.quantity: missing"),
        ("model = [-0.1, 0.1]\n", "", "reference.0.model: missing; 'model' is the error of the model"),
        ('reason = "walls like it"\n', "", "reference.0.reason: missing"),
        ("[-0.1, 0.1]", "[0.1, -0.1]", "reference.0.model: [0.1, -0.1] is not allowed; must be [lowest, highest]"),
        ("[-0.1, 0.1]", "[-1.0, 0.1]", "above -1"),
        ("model", "tolerance = 0.1\nmodel", "reference.0.tolerance: not allowed of kind 'blind'"),
        ("model", "value = 0.5\nmodel", "reference.0.measured_in: missing; a measured value has"),
        ("model", 'measured_in = "Table 1"\nmodel', "reference.0.value: missing; a measured value has"),
        ("model", 'value = [0.4, 0.5]\nmeasured_in = "a"\nmodel', "reference.0.value: [0.4, 0.5] is not allowed"),
        ('kind = "blind"', 'value = 0.5\nkind = "code"', "reference.0.model: only allowed of kind 'blind'"),
        ("value = 0.5", "", "prediction.0.value: missing"),
        ("[0.36, 0.55]", "[0.55, 0.36]", "prediction.0.band: [0.55, 0.36] is not allowed; must be [lowest, highest]"),
        (
            '[[prediction]]\nquantity = "failure_load',
            '[[prediction]]\nquantity = "status',
            "prediction.0.quantity: 'status'",
        ),
        ("2026-11-29", "29 November", "prediction.0.date"),
        ('why = "friction is not given"\n', "", "alternative.0.why: missing"),
        ('set = { "joints.dry.friction" = 0.5 }', "set = {}", "alternative.0.set"),
    ],
)
def test_what_blind_ones_may_not_say(tmp_path, old, new, says):
    assert old in BLIND + PREDICTED
    with pytest.raises(CaseError) as found:
        load(tmp_path, (BLIND + PREDICTED).replace(old, new, 1))
    assert says in str(found.value)


@pytest.mark.parametrize("text", [BLIND[: BLIND.index("[[reference]]")], PREDICTED])
def test_alternatives_and_predictions_are_of_blind_references(tmp_path, text):
    with pytest.raises(CaseError, match=r"only allowed beside a \[reference\] of kind 'blind'"):
        load(tmp_path, text)
