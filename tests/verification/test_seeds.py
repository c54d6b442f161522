"""Results of the seeds: every one that a data book has is on the page, and every row leads to what it says."""

from __future__ import annotations

from pathlib import Path

import pytest
from casefiles import CASES, FILES, read, references
from reference import book
from studies.seeds.computed import COMPUTED
from studies.seeds.rows import KINDS, MISSED, UNKNOWN, asked, printed_by_seeds, result_of, rows, told

BOOKS = sorted(path.stem for path in (Path(__file__).parents[1] / "reference").glob("*.toml"))
OF_SEEDS = [name for name in BOOKS if "seed" in book(name)["source"]]
WHYS = {"3D", "deformable", "lost", "words", "statement", "not yet"}
POINTERS = [(name, key) for name in told() for key in told()[name] if "case" in told()[name][key]]


@pytest.mark.parametrize("name", OF_SEEDS)
def test_every_printed_result_has_a_row(name):
    """And no row is of a number that no seed prints."""
    printed = set(printed_by_seeds(name))
    assert printed - set(told()[name]) == set()
    assert {result_of(name, key)[0]["id"] for key in told()[name]} == printed


def test_every_seed_is_there():
    assert {book(name)["source"]["seed"] for name in OF_SEEDS} == {"000", "001", "002"}
    assert set(told()) == set(OF_SEEDS)


@pytest.mark.parametrize(("name", "key"), POINTERS)
def test_a_row_leads_to_a_reference(name, key):
    """Of that quantity, value and kind, or to one of inference."""
    result, value = result_of(name, key)
    said = told()[name][key]
    tables = references(CASES / f"{said['case']}.toml")
    found = [
        one
        for one in tables
        if (one.get("quantity", "failure_load"), one.get("value", one.get("failure_load"))) == asked(value, said)
        and one.get("kind", "exact") in (KINDS[result["kind"]], "inference")
    ]
    assert len(found) == 1, (name, key)
    assert "value" not in said or said["value"] == value or said["how"]


def test_every_row_says_one_thing():
    for table in told().values():
        for said in table.values():
            assert len({"case", "study", "input", "no"} & set(said)) == 1
            assert said.get("study", "deep") in COMPUTED
            assert "no" not in said or said["no"].partition(": ")[0] in WHYS
    assert {said["study"] for table in told().values() for said in table.values() if "study" in said} == set(COMPUTED)


def test_every_miss_says_what_is_known_of_it():
    silent = [(row.book, row.name) for row in rows() if row.verdict == MISSED and not row.why]
    assert silent == []
    assert [row.name for row in rows() if row.verdict == UNKNOWN] == [], (
        "dem verify cases --changed --write docs/verification.md"
    )


def test_tolerances_of_cases_are_those_of_the_rule_or_have_a_reason():
    own = [one for path in FILES for one in references(path) if {"tolerance", "relative"} & set(one)]
    assert [one["source"] for one in own if "reason" not in one] == []


INFERRED_FROM = {  # case: numbers from which an input of it was inferred (data book, [geometry.inferred] and notes)
    "church_wall_a": [0.062], "church_wall_b": [0.0305], "church_wall_c": [0.034], "church_wall_d": [0.139],
    "church_wall_d_before": [0.115], "church_buttress": [0.165],
    "top_load_b2": [[0.32, 0.34]], "top_load_b5": [[0.3, 0.33]], "top_load_b8": [[0.32, 0.34]],
    "top_load_b10": [[0.49, 0.51]], "top_load_b11": [[0.56, 0.58]],
    "column_14_profile": [0.132], "column_arch_rocking": [-0.0978], "arch_8_static": [0.325],
}  # fmt: skip


def test_no_number_from_which_an_input_was_inferred_is_a_reference():
    found = {path.stem: references(path) for path in FILES}
    kinds = {
        name: [one.get("value", one.get("failure_load")) for one in found[name] if one.get("kind") == "inference"]
        for name in INFERRED_FROM
    }
    assert kinds == INFERRED_FROM


def test_one_reading_of_the_walls_of_table_7_8():
    readings = [read(CASES / f"validation/wall_{n}_profile.toml")["joints"]["rough"]["profile"] for n in (21, 110, 231)]
    assert readings[0] == readings[1] == readings[2]


def test_no_excuse_outlives_its_reason():
    excused = {(name, key) for name, table in told().items() for key, said in table.items() if "missed" in said}
    assert excused == {
        (row.book, row.name) for row in rows() if row.verdict == MISSED and "study" in told()[row.book][row.name]
    }
