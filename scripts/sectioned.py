"""A page of docs that is made section by section: NAME.json, NAME.md and NAME_*.png, the last two from the JSON alone.

A section is a module with measure() -> JSON, page(JSON) -> lines, and PICTURES: suffix -> draw(JSON, path).
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

DOCS = Path(__file__).resolve().parents[1] / "docs"


@dataclass(frozen=True)
class Page:
    """name: of the files; package: of the sections; final: how the status of an answer begins."""

    name: str
    package: str
    sections: tuple[str, ...]
    head: str
    final: tuple[str, ...] = ("ok",)

    def section(self, name: str) -> ModuleType:
        return import_module(f"{self.package}.{name}")

    def render(self, table: Mapping[str, Any]) -> str:
        """The page of what is in the JSON."""
        there = [name for name in self.sections if name in table]
        return "\n".join([self.head] + ["\n".join(self.section(name).page(table[name])) + "\n" for name in there])

    def read(self, folder: Path) -> dict[str, Any]:
        """The JSON in a folder; empty where there is none."""
        file = folder / f"{self.name}.json"
        return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}

    def write(self, folder: Path, found: Mapping[str, Any]) -> None:
        """JSON and page with the sections found; the others stay. Pictures of those found."""
        table = self.read(folder) | dict(found)
        table = {name: table[name] for name in self.sections if name in table}
        text = json.dumps(table, indent=1, ensure_ascii=False)
        rows = re.sub(r"\[[^\[\]{}\"]*\]", lambda row: " ".join(row.group().split()), text)  # numbers on one line
        (folder / f"{self.name}.json").write_text(rows + "\n", encoding="utf-8")
        table = self.read(folder)
        (folder / f"{self.name}.md").write_text(self.render(table), encoding="utf-8")
        for name in found:
            for suffix, draw in self.section(name).PICTURES.items():
                draw(table[name], folder / f"{self.name}_{suffix}.png")

    def unanswered(self, found: Any) -> list[str]:
        """Commands of the runs that came to no answer."""
        return [one["command"] for one in runs_of(found) if not one["status"].startswith(self.final)]

    def main(self, about: str, words: Sequence[str] | None = None) -> int:
        """The command: 0 where every run came to an answer, 1 otherwise."""
        parser = argparse.ArgumentParser(prog=f"scripts/{self.name}", description=about)
        parser.add_argument("chosen", nargs="*", metavar="SECTION", help=f"{', '.join(self.sections)}; default: all")
        parser.add_argument("--write", action="store_true", help=f"write docs/{self.name}.json, .md and pictures")
        options = parser.parse_args(words)
        unknown = [name for name in options.chosen if name not in self.sections]
        if unknown:
            parser.error(f"no section '{unknown[0]}' (allowed: {', '.join(self.sections)})")

        from dem_cli.bench.machine import one_thread

        one_thread()
        from dem_cli.bench.cases import compiled

        compiled()
        unanswered = []
        for name in options.chosen or self.sections:
            found = self.section(name).measure()
            unanswered += self.unanswered(found)
            if options.write:
                self.write(DOCS, {name: found})
            print("\n".join(self.section(name).page(found)), flush=True)
        for command in unanswered:
            print(f"no answer: {command}", file=sys.stderr)
        return int(bool(unanswered))


def runs_of(found: Any) -> Iterator[dict[str, Any]]:
    """All runs anywhere in a section."""
    if isinstance(found, dict):
        if "command" in found:
            yield found
        else:
            for value in found.values():
                yield from runs_of(value)
    elif isinstance(found, list):
        for value in found:
            yield from runs_of(value)
