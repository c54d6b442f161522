"""Tolerances of references that give none: by the kind of the reference, and for exact ones by the analysis."""

from __future__ import annotations

import pytest

from dem_cli.app.api import load_case
from dem_cli.app.verify.case_selection import SHELVES
from dem_cli.case.reference import Reference
from dem_cli.case.tolerance_rules import KINDS, RULES
from dem_cli.errors import CaseError

CASE = """
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "column"
block = [1.0, 0.5]
courses = 1
[analysis]
"""


def allowed(tmp_path, analysis: str, reference: str) -> float | None:
    """Of the only reference of a case."""
    file = tmp_path / "case.toml"
    file.write_text(f"{CASE}{analysis}\n[reference]\n{reference}\n", encoding="utf-8")
    (one,) = load_case(file).case.reference
    return one.allowance


@pytest.mark.parametrize(
    ("analysis", "reference", "share"),
    [
        ('kind = "pushover"', "failure_load = 0.5", 0.003),
        ('kind = "pushover"\nresolution = 0.02', "failure_load = 0.5", 0.03),
        ('kind = "safety"', 'quantity = "safety_factor"\nvalue = 0.5', 0.002),
        ('kind = "gravity"', 'quantity = "monitors.x.value"\nvalue = -0.5', 0.001),
        ('kind = "pushover"', 'failure_load = 0.5\nkind = "code"', 0.05),
        ('kind = "pushover"', 'failure_load = 0.5\nkind = "experiment"', 0.05),
        ('kind = "pushover"', 'failure_load = 0.5\nkind = "inference"', 0.05),
        ('kind = "pushover"', 'failure_load = 0.5\nkind = "experiment"\nscatter = 0.01', 0.05),
        ('kind = "pushover"', 'failure_load = 0.5\nkind = "experiment"\nscatter = 0.01\nspecimens = 3', 0.05),
        ('kind = "pushover"', 'failure_load = 0.5\nkind = "experiment"\nscatter = 0.01\nspecimens = 4', 0.04),
        ('kind = "pushover"', 'failure_load = 0.5\nkind = "experiment"\nrelative = 0.1\nreason = "why"', 0.1),
        ('kind = "pushover"', "failure_load = 0.5\ntolerance = 0.1", 0.2),
        ('kind = "pushover"', 'quantity = "failure_load"\nvalue = [0.4, 0.5]\nkind = "code"', 0.05),
        ('kind = "pushover"', 'quantity = "failure_load"\nvalue = [0.4, 0.5]\nkind = "experiment"', 0.0),
        ('kind = "pushover"', 'quantity = "failure_load"\nvalue = [0.4, 0.5]', 0.0),
    ],
)
def test_rule(tmp_path, analysis, reference, share):
    """A share of 0.5, which all of them have, or of the higher end."""
    reference = reference.replace("monitors.x", "largest_displacement")
    assert allowed(tmp_path, analysis, reference) == pytest.approx(share * 0.5)


def test_words_have_none(tmp_path):
    assert allowed(tmp_path, 'kind = "gravity"', 'quantity = "status"\nvalue = "ok"\nkind = "code"') is None


@pytest.mark.parametrize(
    ("reference", "says"),
    [
        ('quantity = "x"\nvalue = 0.0', "a share of 0 is nothing"),
        ('quantity = "x"\nvalue = 0.0\nrelative = 0.1', "a share of 0 is nothing"),
        ("failure_load = 0.5\nscatter = 0.1", "only an experiment has a scatter"),
        ('failure_load = 0.5\nkind = "experiment"\nscatter = 0.1\ntolerance = 0.1', "not allowed beside 'tolerance'"),
        ('failure_load = 0.5\nreason = "why"', "not allowed without 'tolerance' or 'relative'"),
        ("failure_load = 0.5\nspecimens = 4", "not allowed without 'scatter'"),
        ('failure_load = 0.5\nkind = "bounded"', "not allowed of one value"),
        ('quantity = "status"\nvalue = "ok"\nkind = "experiment"\nscatter = 0.1', "words and truths have none"),
    ],
)
def test_what_makes_no_sense(tmp_path, reference, says):
    with pytest.raises(CaseError, match=says):
        allowed(tmp_path, 'kind = "pushover"', reference)


def test_every_kind_has_a_rule_and_a_shelf():
    assert set(KINDS) == set(RULES) == set(SHELVES)
    assert all(Reference(failure_load=1.0, kind=kind).allowance for kind in KINDS if kind not in ("bounded", "blind"))


@pytest.mark.parametrize(("given", "kind"), [("exact", "bounded"), ("bounded", "bounded"), ("code", "code")])
def test_an_exact_interval_is_bounded(given, kind):
    assert Reference(quantity="failure_load", value=(0.4, 0.5), kind=given).kind == kind
