"""chapter6.json, chapter6.md and chapter6_*.png: the page and its pictures are made from the JSON alone."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

NAME = "chapter6"
SECTIONS = ("blocks", "column", "arch", "engines", "records", "failure")
HEAD = """\
# Thesis chapter 6: blocks, a column and an arch that are shaken

Written by `scripts/chapter6 --write` from `docs/chapter6.json`; do not edit. Cases are those of `cases/validation/`;
the numbers of the thesis come from the data book (`tests/reference/thesis_arch_shaking.toml`, `thesis_rocking.toml`),
which names their places. Seconds are CPU seconds of whole runs.

**Inferred, not given**: Figure 6-2, the only drawing of the arch with its sizes, is lost. The data book infers columns
of 0.16 m × 0.32 m from their restitution and from 180 Hz, and six voussoirs with an inner radius of 0.20 m and a ring
of 0.08 m from the static load of 0.325. Every figure on the arch below hangs on that; other geometries with the same
load are shown beside it. Nothing was fitted to what the thesis found under shaking.
"""


def section(name: str) -> ModuleType:
    """measure() -> JSON, page(JSON) -> lines, PICTURES: suffix -> draw(JSON, path)."""
    return import_module(f"thesis6.{name}")


def render(table: Mapping[str, Any]) -> str:
    """The page of what is in chapter6.json."""
    parts = [HEAD] + ["\n".join(section(name).page(table[name])) + "\n" for name in SECTIONS if name in table]
    return "\n".join(parts)


def read(folder: Path) -> dict[str, Any]:
    """chapter6.json of a folder; empty where there is none."""
    file = folder / f"{NAME}.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def write(folder: Path, found: Mapping[str, Any]) -> None:
    """JSON and page with the sections found; the others stay. Pictures of those found."""
    table = read(folder) | dict(found)
    table = {name: table[name] for name in SECTIONS if name in table}
    text = json.dumps(table, indent=1, ensure_ascii=False)
    rows = re.sub(r"\[[^\[\]{}\"]*\]", lambda row: " ".join(row.group().split()), text)  # numbers on one line
    (folder / f"{NAME}.json").write_text(rows + "\n", encoding="utf-8")
    table = read(folder)
    (folder / f"{NAME}.md").write_text(render(table), encoding="utf-8")
    for name in found:
        for suffix, draw in section(name).PICTURES.items():
            draw(table[name], folder / f"{NAME}_{suffix}.png")


def unanswered(found: Any) -> list[str]:
    """Commands of the runs that came to no answer."""
    if isinstance(found, dict):
        if "command" in found:
            return [] if found["status"] == "ok" else [found["command"]]
        return [command for value in found.values() for command in unanswered(value)]
    if isinstance(found, list):
        return [command for value in found for command in unanswered(value)]
    return []
