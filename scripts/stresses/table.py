"""Records as text: one line each, counts, and docs/stress.md."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from stresses.records import HELD, REFUSED, WARNED, WRONG, Record

VERDICTS = (HELD, WARNED, REFUSED, WRONG)
HEAD = """\
# Stability stress test

Written by `scripts/stress --write`; do not edit. Structures with known failure loads (`cases/verification/`, closed
forms) are solved under conditions that break programs. A verdict is

* **held**: the load lies within its own bracket or 0.5 % of the exact one, or a measured figure below its limit;
* **warned**: outside, and the run says that it is not to be trusted; **refused**: no load is given, and why;
* **WRONG**: outside, without a word. `scripts/stress` then ends with exit code 1.

In the tables a number is the relative error of a load that held (for what must not matter: its difference from the
unstressed run; `=` not a bit differs), or the figure that was measured. *auto*, *fixed* and *large* are the
kinematics asked for. A run may spend 1,000,000 steps (fewer for stiffnesses and time steps), a quarter of what
`dem run` allows, before it is refused.
"""


def line(record: Record) -> str:
    """One record as people read it."""
    error = "" if record.error is None else f" ({record.error:+.1e})"
    said = f": {record.message}" if record.message else ""
    what = f"{record.verdict:<8} {record.axis} {record.value}, {record.structure}"
    return f"{what}: {record.found}{error} {record.how}{said}"


def count(records: Iterable[Record]) -> str:
    """How many of each verdict."""
    verdicts = [record.verdict for record in records]
    return ", ".join(f"{verdicts.count(v)} {v}" for v in VERDICTS if v in verdicts) or "nothing"


def document(records: Sequence[Record], about: Mapping[str, str]) -> str:
    """docs/stress.md; `about` says in a sentence what each axis is."""
    axes = {name: [r for r in records if r.axis == name] for name in dict.fromkeys(r.axis for r in records)}
    rows = [[name, *counts(found), worst(found)] for name, found in axes.items()]
    parts = [HEAD, f"In all: {count(records)}.\n", grid(["axis", *VERDICTS, "worst error held"], rows)]
    for name, found in axes.items():
        parts += [f"## {name[0].upper()}{name[1:]}\n", f"{about.get(name, '')}\n", pivot(found), *messages(found)]
    return "\n".join(parts)


def counts(records: Sequence[Record]) -> list[str]:
    verdicts = [record.verdict for record in records]
    return [str(verdicts.count(v)) if v in verdicts else "" for v in VERDICTS]


def worst(records: Sequence[Record]) -> str:
    """Largest error among what held."""
    errors = [abs(r.error) for r in records if r.verdict == HELD and r.error is not None]
    return f"{max(errors):.1e}" if errors and max(errors) > 0.0 else "="


def pivot(records: Sequence[Record]) -> str:
    """Structures downwards, values of the axis across."""
    values = list(dict.fromkeys(r.value for r in records))
    cells: dict[str, dict[str, str]] = {}
    for record in records:
        cells.setdefault(record.structure, {})[record.value] = cell(record)
    rows = [[name, *(found.get(value, "") for value in values)] for name, found in cells.items()]
    return grid(["structure", *values], rows)


def cell(record: Record) -> str:
    """What came out, in a few characters."""
    if record.verdict == HELD:
        return {"bit-identical": "=", "exactly zero": "="}.get(record.how, record.how)
    off = "" if record.error is None else f" {100 * record.error:+.2g} %"
    word = f"**{WRONG}**" if record.verdict == WRONG else record.verdict
    return f"{word}{off}"


def grid(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [" | ".join(row) for row in (head, ["---"] * len(head), *rows)]
    return "\n".join(f"| {text} |" for text in lines) + "\n"


def messages(records: Sequence[Record]) -> list[str]:
    """What was said where something did not hold, alike messages together."""
    alike: dict[tuple[str, str], list[Record]] = {}
    for record in records:
        if record.verdict != HELD and record.message:
            key = re.sub(r"'[^']*'|[-+]?\d[\d.,e+%-]*", "#", record.message)
            alike.setdefault((record.verdict, key), []).append(record)
    lines = [f"* {verdict}, {len(found)} ×: “{found[0].message}”" for (verdict, _), found in alike.items()]
    return ["\n".join(lines) + "\n"] if lines else []
