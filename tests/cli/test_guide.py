"""Everything that the guide shows works: cases are valid, commands run, and say what the guide says they do."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from parsed import nodes
from shown import NOT_RUN, Reader, blocks

from dem_cli.app.cli.new import TEMPLATE_KINDS

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs" / "guide").glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_page(page, tmp_path, one_core, can_render):
    Reader(tmp_path, can_render).do(page)


def test_what_is_not_run_is_shown_and_named():
    """No line is left out unless NOT_RUN has it with its reason, and each of these is there."""
    lines = [line.partition("  #")[0].rstrip() for page in [*PAGES, ROOT / "README.md"] for block in blocks(page)
             if block.language == "bash" for line in block.text.splitlines()]  # fmt: skip
    assert set(NOT_RUN) <= set(lines)
    run = [line for line in lines if line and line not in NOT_RUN]
    assert {line.split()[0] for line in run} == {"dem", "scripts/run"}
    assert len(run) > 40


def test_errors_of_imperfections_fit_a_wall(tmp_path, one_core):
    """The pieces of docs/case_imperfections.md, in the wall that it draws."""
    reader = Reader(tmp_path)
    reader.read_case(next(block.text for block in blocks(ROOT / "docs" / "guide" / "joints.md")))
    pieces = [block.text for block in blocks(ROOT / "docs" / "case_imperfections.md") if block.language == "toml"]
    assert len(pieces) == 2
    for piece in pieces:
        reader.read_case(piece)


def test_the_first_page_shows_the_first_command():
    assert [block.text for block in blocks(ROOT / "docs" / "index.md") if block.language == "bash"] == [
        next(blocks(ROOT / "README.md")).text.splitlines()[0] + "\n"
    ]


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
        for node in nodes(path):
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
