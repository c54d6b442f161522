"""Everything that the guide shows works: cases are valid, commands run, and say what the guide says they do."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from shown import Reader, blocks

from dem_cli.cli.new import TEMPLATE_KINDS

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs" / "guide").glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_page(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    Reader(tmp_path).do(page)


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md"], ids=lambda page: page.stem)
def test_paths_that_are_named_exist(page):
    for path in re.findall(r"`((?:dem_cli|tests|scripts|cases|docs)/[\w./-]+)`", page.read_text(encoding="utf-8")):
        assert (ROOT / path).exists(), path


def test_all_templates_are_named():
    text = (ROOT / "docs" / "guide" / "install.md").read_text(encoding="utf-8")
    assert not [kind for kind in TEMPLATE_KINDS if f"`{kind}`" not in text]


def test_the_guide_shows_something():
    shown = [block.language for page in PAGES for block in blocks(page)]
    assert shown.count("bash") > 15
    assert shown.count("toml") >= 20


def messages() -> list[str]:
    """Every string of the package, with … where an f-string has values."""
    found = []
    for path in (ROOT / "dem_cli").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                parts = [part.value if isinstance(part, ast.Constant) else "…" for part in node.values]
                found.append("".join(map(str, parts)))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                found.append(node.value)
    return found


def test_messages_that_are_explained_exist():
    text, known = (ROOT / "docs" / "guide" / "warnings.md").read_text(encoding="utf-8"), messages()
    rows = [row.split(" | ")[0] for row in re.findall(r"^\| (`.*) \|$", text, re.MULTILINE)]
    explained = [message for row in rows for message in re.findall(r"`([^`]+)`", row)]
    assert len(explained) > 20
    pieces = [piece.strip() for message in explained for piece in message.split("…") if len(piece.strip()) > 3]
    assert not [piece for piece in pieces if not any(piece in one for one in known)]
