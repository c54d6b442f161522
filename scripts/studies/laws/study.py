"""Study of the joint laws: one page and one picture per law in docs/laws, from the laws themselves."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any

from studies.laws.diagrams import PAGES
from studies.laws.page import index, text
from studies.laws.pictures import draw
from studies.places import DOCS
from studies.study import StudyRunner

FOLDER = DOCS / "laws"


class LawStudy(StudyRunner):
    """One section per law; nothing is kept but the pages."""

    parts, solves = "LAW", False

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--text", action="store_true", help="with --write: pages only, no pictures")

    def measure(self, section: str, options: argparse.Namespace) -> bool:
        return not options.text

    def said(self, section: str, found: Any) -> str:
        return text(self.sections[section])

    def write(self, found: Mapping[str, Any]) -> None:
        FOLDER.mkdir(exist_ok=True)
        for name, pictures in found.items():
            (FOLDER / f"{name}.md").write_text(text(self.sections[name]), encoding="utf-8")
            if pictures:
                draw(self.sections[name], FOLDER / f"{name}.png")
        (FOLDER / "README.md").write_text(index(), encoding="utf-8")

    def redraw(self) -> None:
        self.write(dict.fromkeys(self.sections, True))


STUDY = LawStudy("laws", "A page and a picture of every joint law", {page.name: page for page in PAGES})
