"""Results of the seeds: every one that a data book has is on the page, and every row leads to what it says."""

from __future__ import annotations

from pathlib import Path

import pytest
from casefiles import CASES, FILES, read, references
from reference import book, results
from studies.seeds.computed import COMPUTED, data, shape_top, table_tests
from studies.seeds.rows import (
    INPUT,
    KINDS,
    MET,
    MISSED,
    UNKNOWN,
    asked,
    ids_of,
    printed_by_seeds,
    result_of,
    rows,
    told,
)

BOOKS = sorted(path.stem for path in (Path(__file__).parents[1] / "reference").glob("*.toml"))
OF_SEEDS = [name for name in BOOKS if "seed" in book(name)["source"]]
WHYS = {"3D", "deformable", "lost", "words", "statement", "not yet"}
POINTERS = [(name, key) for name in told() for key in told()[name] if "case" in told()[name][key]]


@pytest.mark.parametrize("name", OF_SEEDS)
def test_every_printed_result_has_a_row(name):
    """And no row is of a number that no seed prints."""
    printed = set(printed_by_seeds(name))
    assert {one for key in told()[name] for one in ids_of(name, key)} == printed


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
            assert len({"case", "study", "input", "no", "repeats"} & set(said)) == 1
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


KEYS = ("inferred_from", "chosen_by")
ORIGINS = {path.stem: [name for key in KEYS for name in read(path).get(key, ())] for path in FILES}
NAMED = sorted({name for names in ORIGINS.values() for name in names})


@pytest.mark.parametrize("name", NAMED)
def test_every_origin_is_a_printed_result_that_counts_as_input(name):
    """By its book and id; none is compared."""
    where, _, key = name.partition(".")
    verdicts = {row.verdict for row in rows() if (row.book, row.name) == (where, key)}
    assert verdicts == {INPUT}


def test_no_number_from_which_an_input_came_is_a_reference_of_its_case():
    """A case names the numbers that its inputs came from, and of its references only those of inference have one."""
    found = {
        (path.stem, name)
        for path in FILES
        for name in ORIGINS[path.stem]
        for one in references(path)
        if one.get("kind", "exact") in ("code", "experiment")
        and one.get("quantity", "failure_load") == "failure_load"
        and one.get("value", one.get("failure_load")) == result_of(*name.split(".", 1))[1]
    }
    assert found == set()


def test_every_reference_of_inference_says_what_was_inferred_from():
    silent = [
        path.stem
        for path in FILES
        if not ORIGINS[path.stem] and any(one.get("kind") == "inference" for one in references(path))
    ]
    assert silent == []


def test_a_repeat_names_a_row_that_is_none():
    verdicts = {f"{row.book}.{row.name}": row.verdict for row in rows()}
    repeats = [said["repeats"] for table in told().values() for said in table.values() if "repeats" in said]
    assert {verdicts[name] for name in repeats} <= {MET, MISSED, INPUT}


def test_the_shaking_table_says_what_never_falls_meets():
    (right, baseline), tests = table_tests({})
    assert (right, baseline, tests) == (16, 22, 31)


def test_the_trend_of_table_7_7_is_missed_at_any_width():
    """Open joints of walls a to d: they fall as printed, 25, 21, 19, 12; of ours none do, whatever counts as open."""
    widths = [[width for layer in data("chapter7")["band"][wall]["widths"] for width in layer] for wall in "abcd"]
    printed = [results("thesis_231_block")[f"T77_{wall}"]["top_total"] for wall in "abcd"]
    assert printed == sorted(set(printed), reverse=True)
    for limit in sorted({width for wall in widths for width in wall}):
        counts = [sum(width > limit for width in wall) for wall in widths]
        assert counts != sorted(set(counts), reverse=True), limit


@pytest.mark.parametrize(("aperture", "within"), [("0.34", 0.012), ("0.46", 0.012), ("0.57", 0.012), ("0.69", 0.031)])
def test_shape_a_is_the_sum_of_closed_joints_without_one_lever(aperture, within):
    """Joint i of 14 turns what is i heights of a block below the top: 1 + 2 + ... + 14 = 105, less one of 14: 91."""
    row = results("thesis_14_block_column")[f"T72_A_{aperture}"]
    found, printed = shape_top(row)
    assert printed == pytest.approx(found * 91.0 / 105.0, rel=within)


def test_one_reading_of_the_walls_of_table_7_8():
    readings = [read(CASES / f"validation/wall_{n}_profile.toml")["joints"]["rough"]["profile"] for n in (21, 110, 231)]
    assert readings[0] == readings[1] == readings[2]


def test_no_excuse_outlives_its_reason():
    excused = {(name, key) for name, table in told().items() for key, said in table.items() if "missed" in said}
    assert excused == {
        (row.book, row.name) for row in rows() if row.verdict == MISSED and "study" in told()[row.book][row.name]
    }
