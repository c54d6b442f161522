"""docs/chapter7.md is made from its JSON, names its cases, and its figures keep what is promised of them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from studies import storage
from studies.chapter7 import block, heights, shapes
from studies.chapter7.study import STUDY
from studies.study import runs_of

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
TABLE, TEXT = storage.read("chapter7"), (DOCS / "chapter7.md").read_text(encoding="utf-8")


def test_the_page_is_made_from_its_json():
    assert list(TABLE) == list(STUDY.sections)
    assert STUDY.page(TABLE) == TEXT


def test_pictures_are_there():
    named = set(re.findall(r"\]\((chapter7_\w+\.png)\)", TEXT))
    drawn = {f"chapter7_{suffix}.png" for suffix in STUDY.pictures}
    assert named == drawn
    assert all((DOCS / name).stat().st_size > 10_000 for name in named)


def test_every_case_is_there_and_named():
    commands = [one["command"] for one in runs_of(TABLE)]
    cases = {command.split()[2] for command in commands}
    assert all((ROOT / case).exists() for case in cases)
    assert all(Path(case).name in TEXT for case in cases)
    assert STUDY.problems("", TABLE) == []


def test_table_7_2_keeps_the_promise():
    rows = shapes.rows_of(TABLE["shapes"])
    assert len(rows) == 20
    assert shapes.mean([abs(row.error) for row in rows]) < 0.03
    for row in rows:
        assert row.ours == pytest.approx(row.statics, rel=0.005)
        assert row.top == pytest.approx(row.top_statics, rel=0.02)
        assert row.ours > row.closed * 0.995
    assert len(shapes.beneath(rows)) == 4  # of the thesis; not of dem


def test_tables_7_4_and_7_5_keep_the_promise():
    for row in heights.rows_of(TABLE["heights"]):
        assert 1 - row.ours == pytest.approx(1 - row.statics, rel=0.005)
        assert 1 - row.ours == pytest.approx(1 - row.thesis, rel=0.02)
        if row.two_sides is not None:
            assert 1 - row.two_sides == pytest.approx(1 - row.formula, rel=0.01)


def test_table_7_1_keeps_the_promise():
    found, exact = TABLE["block"], block.rolling()["loads"]
    for bracket, load in zip([*found["turns"], found["runs"]["raised"]["bracket"]], exact):
        assert bracket[1] - bracket[0] <= 1e-3 * bracket[1]
        assert sum(bracket) / 2 == pytest.approx(load, rel=1e-3)
    assert len(block.events(found["runs"]["cycle"]["curve"])) == 8
