"""The pages that are made from code and data, and which of them are not as they would be made now."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from studies.places import ROOT
from studies.seeds import page as seeds_page
from studies.site import blind_page, case_keys, commands, gallery_page, limits, readme, results_files

PAGES: dict[str, Callable[[], str]] = {
    "docs/blind.md": blind_page.text,
    "docs/case.md": case_keys.text,
    "docs/commands.md": commands.text,
    "docs/gallery.md": gallery_page.text,
    "docs/guide/limits.md": limits.text,
    "docs/results.md": results_files.text,
    "docs/seeds.md": seeds_page.text,
    "README.md": readme.text,
}


def stale() -> list[str]:
    """Pages that differ from what would be written."""
    return [path for path, text in PAGES.items() if read(ROOT / path) != text()]


def read(path: Path) -> str:
    """The text of a file; empty where there is none."""
    return path.read_text(encoding="utf-8") if path.exists() else ""
