"""docs/laws is what scripts/study laws writes: every law has its page, with the keys that it has now."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from studies.laws import page as page_module
from studies.laws.diagrams import PAGES

from dem_cli.case.tables.declared import table_of
from dem_cli.core.laws.registry import LAWS

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "laws"


def test_every_law_has_a_page():
    assert set(LAWS) <= {page.name for page in PAGES}
    written = {path.stem for path in FOLDER.glob("*.md")} - {"README"}
    assert written == {page.name for page in PAGES}, "run scripts/study laws"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_page_is_the_current_one(page):
    found = (FOLDER / f"{page.name}.md").read_text(encoding="utf-8")
    assert found == page_module.text(page), "run scripts/study laws"
    for key in page.law.parameters.declared.keys() - {"law"}:
        assert f"| `{key}` |" in found
    for name in re.findall(r"\]\(([\w./-]+)\)", found):
        assert (FOLDER / name).exists(), name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_example_is_a_joint(page):
    table = table_of(LAWS[page.key].parameters).model_validate({"law": page.key, **page.keys})
    assert LAWS[page.key].of(table) is page.law


def test_the_index_is_the_current_one():
    assert (FOLDER / "README.md").read_text(encoding="utf-8") == page_module.index(), "run scripts/study laws"
