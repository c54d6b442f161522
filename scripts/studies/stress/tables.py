"""Records as text: one line each, counts, and docs/stress.md."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from studies.stress.verdicts import HELD, REFUSED, WARNED, WRONG, StressRecord
from studies.template import table as markdown

VERDICTS = (HELD, WARNED, REFUSED, WRONG)


def line(record: StressRecord) -> str:
    """One record as people read it."""
    error = "" if record.error is None else f" ({record.error:+.1e})"
    said = f": {record.message}" if record.message else ""
    what = f"{record.verdict:<8} {record.axis} {record.value}, {record.structure}"
    return f"{what}: {record.found}{error} {record.how}{said}"


def count(records: Iterable[StressRecord]) -> str:
    """How many of each verdict."""
    verdicts = [record.verdict for record in records]
    return ", ".join(f"{verdicts.count(v)} {v}" for v in VERDICTS if v in verdicts) or "nothing"


def values(records: Sequence[StressRecord], about: Mapping[str, str]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows; `about` says in a sentence what each axis is."""
    axes = {name: [r for r in records if r.axis == name] for name in dict.fromkeys(r.axis for r in records)}
    rows = [[name, *counts(found), worst(found)] for name, found in axes.items()]
    return {
        "count": count(records),
        "verdicts": markdown(["axis", *VERDICTS, "worst error held"], rows),
        "axes": [
            {"title": f"{name[0].upper()}{name[1:]}", "about": about.get(name, ""), "table": pivot(found),
             "messages": messages(found)}
            for name, found in axes.items()
        ],
    }  # fmt: skip


def counts(records: Sequence[StressRecord]) -> list[str]:
    verdicts = [record.verdict for record in records]
    return [str(verdicts.count(v)) if v in verdicts else "" for v in VERDICTS]


def worst(records: Sequence[StressRecord]) -> str:
    """Largest error among what held."""
    errors = [abs(r.error) for r in records if r.verdict == HELD and r.error is not None]
    return f"{max(errors):.1e}" if errors and max(errors) > 0.0 else "="


def pivot(records: Sequence[StressRecord]) -> str:
    """Structures downwards, values of the axis across."""
    values = list(dict.fromkeys(r.value for r in records))
    cells: dict[str, dict[str, str]] = {}
    for record in records:
        cells.setdefault(record.structure, {})[record.value] = cell(record)
    rows = [[name, *(found.get(value, "") for value in values)] for name, found in cells.items()]
    return markdown(["structure", *values], rows)


def cell(record: StressRecord) -> str:
    """What came out, in a few characters."""
    if record.verdict == HELD:
        return {"bit-identical": "=", "exactly zero": "="}.get(record.how, record.how)
    off = "" if record.error is None else f" {100 * record.error:+.2g} %"
    word = f"**{WRONG}**" if record.verdict == WRONG else record.verdict
    return f"{word}{off}"


def messages(records: Sequence[StressRecord]) -> str:
    """What was said where something did not hold, alike messages together."""
    alike: dict[tuple[str, str], list[StressRecord]] = {}
    for record in records:
        if record.verdict != HELD and record.message:
            key = re.sub(r"'[^']*'|[-+]?\d[\d.,e+%-]*", "#", record.message)
            alike.setdefault((record.verdict, key), []).append(record)
    return "\n".join(f"* {verdict}, {len(found)} ×: “{found[0].message}”" for (verdict, _), found in alike.items())
