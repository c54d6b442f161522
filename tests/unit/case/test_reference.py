"""[reference], alone or several of them."""

from __future__ import annotations

from dem_cli.app.api import load_case
from dem_cli.case.writer import case_text

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
    for text in (OLD, SEVERAL):
        case = load(tmp_path, text)
        written = case_text(case)
        file = tmp_path / "again.toml"
        file.write_text(written, encoding="utf-8")
        again = load_case(file).case
        assert again.reference == case.reference
        assert case_text(again) == written
