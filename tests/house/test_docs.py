"""docs/ARCHITECTURE.md is a true picture: it names every module of the package, and none that is gone."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs" / "ARCHITECTURE.md").read_text(encoding="utf-8")
SILENT = {"__init__.py"}  # not drawn where they hold only a docstring


def drawn() -> set[str]:
    """Paths in the tree of the document: `folder/` lines hold the indented `module.py` lines below them."""
    block = re.search(r"```text\ndem_cli/\n(.*?)```", TEXT, re.DOTALL)
    assert block, "the tree starts with ```text and dem_cli/"
    names, folder = set(), ""
    for line in block.group(1).splitlines():
        if match := re.match(r"  ([\w/]+)/", line):
            folder = match.group(1) + "/"
        elif match := re.match(r"(  |    )(\w+\.py)\b", line):
            names.add((folder if len(match.group(1)) == 4 else "") + match.group(2))
    return names


def present() -> set[str]:
    files = (ROOT / "dem_cli").rglob("*.py")
    return {str(p.relative_to(ROOT / "dem_cli")) for p in files if p.name not in SILENT}


def test_every_module_is_drawn():
    assert not present() - drawn(), "add to docs/ARCHITECTURE.md"


def test_nothing_is_drawn_that_is_gone():
    assert not {name for name in drawn() - present() if not (ROOT / "dem_cli" / name).exists()}


def test_paths_in_the_text_exist():
    for document in ("docs/ARCHITECTURE.md", "README.md"):
        text = (ROOT / document).read_text(encoding="utf-8")
        for path in re.findall(r"`((?:dem_cli|tests|scripts|cases|docs)/[\w./-]+)`", text):
            assert (ROOT / path).exists(), f"{document} names {path}"


def test_every_module_has_a_docstring():
    for path in (ROOT / "dem_cli").rglob("*.py"):
        text = path.read_text(encoding="utf-8").lstrip()
        assert not text or text.startswith('"""'), path
