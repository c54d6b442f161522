"""Benchmark page: benchmarks.json, benchmarks.md and benchmarks_*.png; all are made from the JSON alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bench import registry
from bench.machine import sentence
from bench.record import as_json, read, records_of

PAGE_NAME = "benchmarks"
PAGE_HEAD = """\
# Benchmarks

Written by `scripts/benchmark -o docs` from `docs/data/benchmarks.json`; do not edit. Times are CPU seconds of one core
(numerical libraries kept to one thread), without compilation. Everything is repeated in turn, each round measuring
each thing once, and the best counts, because other work only ever adds time; what takes longer than {long:g} s is
measured once. An error is that of the failure load against the exact or best-known load of the table below; a
negative one is on the safe side. Pictures show errors below 1e-5 at 1e-5.
"""


def render(groups: dict[str, dict[str, Any]]) -> str:
    """The page. groups: as in benchmarks.json."""
    from bench.timing import LONG

    lines = [PAGE_HEAD.format(long=LONG), *machines(groups), "", *references()]
    for name, title in registry.GROUPS.items():
        if name not in groups:
            continue
        group, records = groups[name], records_of(groups[name])
        lines += ["", f"## {title}", "", *registry.module(name).page(records)]
        for suffix in registry.module(name).PICTURES:
            lines += ["", f"![{title}]({PAGE_NAME}_{suffix}.png)"]
        lines += ["", *(f"* {note}" for note in group["notes"])] if group["notes"] else []
    return "\n".join(lines).rstrip() + "\n"


def machines(groups: dict[str, dict[str, Any]]) -> list[str]:
    """On what it was measured; groups measured elsewhere say so."""
    by_text: dict[str, list[str]] = {}
    for name, group in groups.items():
        plain = {key: value for key, value in group["machine"].items() if key != "load"}
        by_text.setdefault(sentence(plain), []).append(name)
    loads = [group["machine"]["load"] for group in groups.values() if group["machine"].get("load") is not None]
    if len(by_text) == 1:
        lines = [f"Machine: {next(iter(by_text))}."]
    else:
        lines = [f"* {', '.join(names)}: {text}" for text, names in by_text.items()]
        lines = ["Machines, by group:", "", *lines]
    if loads:
        lines += ["", f"Other work when the groups began: load {min(loads):g} to {max(loads):g}."]
    return lines


def references() -> list[str]:
    """The loads that errors are measured against."""
    from bench.cases import KNOWN_STRUCTURES, SIZES
    from bench.spatial.cases import KNOWN_IN_SPACE
    from bench.table import lines_of, percent

    rows, seen = [], set()
    for known in (*KNOWN_STRUCTURES.values(), *SIZES, *KNOWN_IN_SPACE.values()):
        if (known.file, known.overrides) not in seen and known.name != "wall 21":  # which is T21 μ 0.6
            upper = "" if known.upper is None else f"{known.upper:.6g} ({percent(known.error(known.upper))})"
            path = "" if known.path is None else f"{known.path:.6g}"
            rows.append((known.name, f"{known.load:.6g}", path, upper, known.source))
        seen.add((known.file, known.overrides))
    head = ("structure", "load", "zero-dilation", "associated", "source of the load")
    text = (
        "T21 is the wall of 21 blocks of Table 5-3 of the thesis, T231 its wall of 231 blocks; the walls by size have"
        " the same blocks and μ 0.6. Where head joints carry friction the load is not unique: loading from gravity"
        " ends between the load without that friction and that of the zero-dilation path of `dem limit`"
        " (docs/numerics.md), and between the two there is no error. The associated load is an upper bound; in brackets"
        " its distance from what is admissible. Those in space (`dimension = 3`) come last: the L wall has 42 blocks"
        " and μ 0.6; wall 205 is 20 m long, 10 m high and 0.8 m thick, pushed out of its plane against columns behind"
        " its ends."
    )
    return [text, "", *lines_of(head, rows)]


def data_file(folder: Path) -> Path:
    """The JSON of a page in a folder."""
    return folder / "data" / f"{PAGE_NAME}.json"


def keep(folder: Path, groups: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Write the JSON and return what it holds; groups that were in it and are not in `groups` stay."""
    data = data_file(folder)
    data.parent.mkdir(parents=True, exist_ok=True)
    merged = (read(data) if data.exists() else {}) | groups
    merged = {name: merged[name] for name in registry.GROUPS if name in merged}
    data.write_text(as_json(merged), encoding="utf-8", newline="\n")
    return merged


def write(folder: Path, groups: dict[str, dict[str, Any]]) -> list[Path]:
    """Write JSON (see `keep`), page and pictures."""
    merged = keep(folder, groups)
    written = [data_file(folder), folder / f"{PAGE_NAME}.md"]
    written[1].write_text(render(merged), encoding="utf-8", newline="\n")
    for name in merged:
        for suffix, draw in registry.module(name).PICTURES.items():
            path = folder / f"{PAGE_NAME}_{suffix}.png"
            draw(records_of(merged[name]), path)
            written.append(path)
    return written
