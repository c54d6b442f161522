"""Pages about the code are true: the tree and the table of docs/modules.md, and every file that any page names."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from house.test_imports import ALLOWED

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs" / "modules.md").read_text(encoding="utf-8")
# The changelog is left out: it names what is gone.
PAGES = ["README.md", "CONTRIBUTING.md", *sorted(str(p.relative_to(ROOT)) for p in (ROOT / "docs").rglob("*.md"))]
PLACEHOLDER = re.compile(r"\b(NAME|KIND|SECTION|test_NAME|test_KIND)\b")  # of recipes
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
    assert not present() - drawn(), "run scripts/draw_tree"


def test_nothing_is_drawn_that_is_gone():
    assert not {name for name in drawn() - present() if not (ROOT / "dem_cli" / name).exists()}


@pytest.mark.parametrize("page", PAGES)
def test_paths_in_the_text_exist(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    named = re.findall(r"`((?:dem_cli|tests|scripts|cases|docs)/[\w./-]+|[\w/]+/\w+\.py)\b[^`]*`", text)
    missing = [path for path in named if not any((home / path).exists() for home in (ROOT, ROOT / "dem_cli"))]
    assert not [path for path in missing if not PLACEHOLDER.search(path)]


def test_the_architecture_can_be_read_in_one_go():
    assert len((ROOT / "docs" / "ARCHITECTURE.md").read_bytes()) <= 15_000, "what is drawn belongs into docs/modules.md"


def test_names_in_files_exist():
    """`file.py`: `NAME` of a recipe."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    places = re.findall(r"`([\w/]+\.py)`:\s+`(\w+)`", text)
    assert len(places) > 8
    texts = {path: (ROOT / path).read_text(encoding="utf-8") for path, _ in places}
    assert not [name for path, name in places if not re.search(rf"\b{name}\b", texts[path])]


def test_links_at_the_root_lead_somewhere():
    for page in ("CONTRIBUTING.md", "CHANGELOG.md"):
        links = re.findall(r"\]\(([\w./-]+)(?:#[\w-]+)?\)", (ROOT / page).read_text(encoding="utf-8"))
        assert not [link for link in links if not (ROOT / link).exists()]


def test_the_table_of_imports_is_that_of_the_test():
    drawn = re.search(r"\| package \| may import \|\n\|---\|---\|\n((?:\|.*\n)+)", TEXT)
    assert drawn, "run scripts/draw_tree"
    rows = dict(re.findall(r"\| (\S+) \| (.*) \|", drawn[1]))
    words = {None: "everything", (): "nothing"}
    names = {package: allowed if allowed is None else tuple(sorted(allowed)) for package, allowed in ALLOWED.items()}
    wanted = {package: words.get(allowed) or ", ".join(allowed) for package, allowed in names.items()}
    assert rows == wanted, "run scripts/draw_tree"


def test_every_module_has_a_docstring():
    for path in (ROOT / "dem_cli").rglob("*.py"):
        text = path.read_text(encoding="utf-8").lstrip()
        assert not text or text.startswith('"""'), path
