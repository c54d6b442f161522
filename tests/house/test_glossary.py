"""docs/glossary.md: in order, each term with where it stands; every registered kind and law is in it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from dem_cli.analyses.registry import ANALYSES
from dem_cli.case.tables.base_motion import MOTIONS
from dem_cli.core.laws.registry import LAWS
from dem_cli.masonry.structures.registry import GENERATORS

ROOT = Path(__file__).resolve().parents[2]
LINES = [line for line in (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").splitlines() if line[:1] == "*"]
TERMS = re.compile(r"\* \*\*(.+?)\*\*: \S.* (`[\w/]+\.py`(?:, `[\w/]+\.py`)*) · (\[[^]]+\]\([^)]+\)(?:, )?)+$")


@pytest.mark.parametrize("line", LINES, ids=lambda line: line[4:20])
def test_a_term_says_where_it_stands(line):
    found = TERMS.match(line)
    assert found, "* **term, synonym**: meaning. `file.py` · [page](link)"
    files = re.findall(r"`([\w/]+\.py)`", found[2])
    assert not [path for path in files if not any((home / path).is_file() for home in (ROOT, ROOT / "dem_cli"))]


def test_terms_are_in_order():
    terms = [re.sub(r"[^\w ]", " ", line[4:].split("**")[0].casefold()) for line in LINES]
    assert terms == sorted(terms)


@pytest.mark.parametrize("name", [*ANALYSES, *GENERATORS, *LAWS, *(kind for kind in MOTIONS if kind != "none")])
def test_registered_names_are_in_it(name):
    assert any(f"`{name}`" in line or f'"{name}"' in line for line in LINES)
