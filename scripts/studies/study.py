"""Runner of a study: measure its sections, keep them as docs/data/NAME.json, make docs/NAME.md and pictures of that."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from bench.cases import compiled
from bench.machine import describe, sentence

from studies import measured, storage
from studies.places import DOCS
from studies.template import filled

Draw = Callable[[Any, Path], None]


class StudyRunner:
    """One study: sections that are measured, and a page and pictures that are made from what is kept of them alone."""

    parts = "SECTION"  # what sections are called in the help
    solves = True  # compile first, so that nobody's seconds hold that

    def __init__(
        self,
        name: str,
        about: str,
        sections: Mapping[str, Any],
        values: Callable[[Mapping[str, Any]], Mapping[str, Any]] | None = None,
        pictures: Mapping[str, tuple[str, Draw]] | None = None,
        machine: bool = False,
    ) -> None:
        """values: what page.md.j2 shows of the data; pictures: suffix of docs/NAME_*.png to the section that it shows
        ("" for all data) and what draws it; machine: keep on which machine it was measured.
        """
        self.name, self.about, self.sections = name, about, sections
        self.values, self.pictures, self.machine = values, pictures or {}, machine

    # -- what a study may say for itself -------------------------------------------------------------------

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        """Options of its own."""

    def check(self, options: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
        """Ends the program where options do not fit each other."""
        unknown = [name for name in options.chosen if name not in self.sections]
        if unknown:
            parser.error(f"no {self.parts.lower()} '{unknown[0]}' (allowed: {', '.join(self.sections)})")

    def measure(self, section: str, options: argparse.Namespace) -> Any:
        """What is kept of a section, as JSON."""
        return self.sections[section]()

    def said(self, section: str, found: Any) -> str:
        """What is printed of a section that was measured."""
        return f"{section}: measured"

    def problems(self, section: str, found: Any) -> list[str]:
        """What is wrong with a section, a line each."""
        return []

    # -- files ---------------------------------------------------------------------------------------------

    def page(self, table: Mapping[str, Any]) -> str:
        """The page of what is kept, with the versions that it was measured with."""
        return measured.stamped(self.name, self.text(table))

    def text(self, table: Mapping[str, Any]) -> str:
        """The page without them."""
        machine = {"machine": sentence(table["machine"] | {"dem": None})} if "machine" in table else {}
        return filled(f"{self.name}/page.md.j2", **(self.values(table) if self.values else {}), **machine)

    def write(self, found: Mapping[str, Any]) -> None:
        """Data with the sections found, others stay; page, and pictures of those found."""
        table = storage.read(self.name) | dict(found)
        order = [*(["machine"] if "machine" in table else []), *self.sections]
        storage.write(self.name, {name: table[name] for name in order if name in table})
        measured.note(self.name, found)
        self.draw(found)

    def redraw(self) -> None:
        """Page and all pictures, from what is kept."""
        self.draw(self.sections)

    def draw(self, chosen: Mapping[str, Any]) -> None:
        """Page, and pictures of some sections, from what is kept."""
        table = storage.read(self.name)
        (DOCS / f"{self.name}.md").write_text(self.page(table), encoding="utf-8")
        for suffix, (section, draw) in self.pictures.items():
            if not section or section in chosen:
                draw(table[section] if section else table, DOCS / f"{'_'.join(filter(None, (self.name, suffix)))}.png")

    # -- command -------------------------------------------------------------------------------------------

    def main(self, words: Sequence[str] | None = None) -> int:
        """0 where nothing is wrong, 1 otherwise."""
        parser = argparse.ArgumentParser(prog=f"scripts/study {self.name}", description=self.about)
        named = ", ".join(self.sections) if len(self.sections) < 30 else f"{len(self.sections)} of them"
        parser.add_argument("chosen", nargs="*", metavar=self.parts, help=f"{named}; default: all")
        parser.add_argument("--write", action="store_true", help="write data, page and pictures in docs")
        parser.add_argument("--redraw", action="store_true", help="measure nothing: page and pictures from the data")
        self.arguments(parser)
        options = parser.parse_args(words)
        self.check(options, parser)
        if options.redraw:
            self.redraw()
            return 0
        if self.solves:
            compiled()
        problems = []
        for section in options.chosen or self.sections:
            found = self.measure(section, options)
            print(self.said(section, found), flush=True)
            problems += self.problems(section, found)
            if options.write:
                self.write({"machine": describe(), section: found} if self.machine else {section: found})
        for problem in problems:
            print(problem, file=sys.stderr)
        return int(bool(problems))


class SectionedStudy(StudyRunner):
    """A study whose sections are modules: measure() -> JSON, values(JSON) for SECTION.md.j2, PICTURES."""

    def __init__(self, name: str, about: str, sections: Sequence[ModuleType], final: Sequence[str] = ("ok",)) -> None:
        modules = {module.__name__.rpartition(".")[2]: module for module in sections}
        drawn = {suffix: (part, draw) for part, module in modules.items() for suffix, draw in module.PICTURES.items()}
        super().__init__(name, about, modules, pictures=drawn)
        self.final = tuple(final)  # how the status of an answer begins

    def measure(self, section: str, options: argparse.Namespace) -> Any:
        return self.sections[section].measure()

    def said(self, section: str, found: Any) -> str:
        return filled(f"{self.name}/{section}.md.j2", **self.sections[section].values(found))

    def problems(self, section: str, found: Any) -> list[str]:
        return [f"no answer: {run['command']}" for run in runs_of(found) if not run["status"].startswith(self.final)]

    def text(self, table: Mapping[str, Any]) -> str:
        there = [name for name in self.sections if name in table]
        return "\n".join([filled(f"{self.name}/head.md.j2"), *(self.said(name, table[name]) for name in there)])


def runs_of(found: Any) -> Iterator[dict[str, Any]]:
    """All runs anywhere in a section."""
    if isinstance(found, dict) and "command" in found:
        yield found
    elif isinstance(found, (dict, list)):
        for value in found.values() if isinstance(found, dict) else found:
            yield from runs_of(value)
