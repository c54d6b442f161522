"""chapter7.json, chapter7.md and chapter7_*.png: the page and its pictures are made from the JSON alone."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

NAME = "chapter7"
SECTIONS = ("block", "shapes", "heights", "walls", "softening", "band")
FINAL = ("ok", "fails on the way", "does not stand", "no failure")  # how the status of an answer begins
HEAD = """\
# Thesis chapter 7: joints that are not plane

Written by `scripts/chapter7 --write` from `docs/chapter7.json`; do not edit. Cases are those of `cases/validation/`;
the numbers of the thesis and the closed forms come from the data book (`tests/reference/`), which names their places.
A profile is geometry: the corners of the polygon are contact points with gaps, and the ordinary law does the rest
(`dem_cli/kernels/planar_profiles.py`). Seconds are those of solving, beside what else the
machine did.
"""


def section(name: str) -> ModuleType:
    """measure() -> JSON, page(JSON) -> lines, PICTURES: suffix -> draw(JSON, path)."""
    return import_module(f"thesis7.{name}")


def render(table: Mapping[str, Any]) -> str:
    """The page of what is in chapter7.json."""
    parts = [HEAD] + ["\n".join(section(name).page(table[name])) + "\n" for name in SECTIONS if name in table]
    return "\n".join(parts)


def read(folder: Path) -> dict[str, Any]:
    """chapter7.json of a folder; empty where there is none."""
    file = folder / f"{NAME}.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def write(folder: Path, found: Mapping[str, Any]) -> None:
    """JSON and page with the sections found; the others stay. Pictures of those found."""
    table = read(folder) | dict(found)
    table = {name: table[name] for name in SECTIONS if name in table}
    (folder / f"{NAME}.json").write_text(_as_json(table) + "\n", encoding="utf-8")
    (folder / f"{NAME}.md").write_text(render(table), encoding="utf-8")
    for name in found:
        for suffix, draw in section(name).PICTURES.items():
            draw(table[name], folder / f"{NAME}_{suffix}.png")


def runs_of(found: Any) -> Iterator[dict[str, Any]]:
    """All runs anywhere in a section."""
    if isinstance(found, dict):
        if "command" in found:
            yield found
        else:
            for value in found.values():
                yield from runs_of(value)


def unanswered(found: Any) -> list[str]:
    """Commands of the runs that came to no answer."""
    return [one["command"] for one in runs_of(found) if not one["status"].startswith(FINAL)]


def _as_json(table: Mapping[str, Any]) -> str:
    """Indented, but every row of a curve on one line."""
    text = json.dumps(table, indent=1, ensure_ascii=False)
    lines, row = [], None
    for line in text.split("\n"):
        bare = line.strip()
        if bare == "[" and row is None:
            row = [line]
        elif row is not None and bare in ("[", '"', "{"):
            lines += row
            row = [line]
        elif row is not None:
            row.append(bare)
            if bare in ("]", "],"):
                lines.append(row[0] + " ".join(row[1:-1]) + row[-1])
                row = None
        else:
            lines.append(line)
    return "\n".join(lines)
