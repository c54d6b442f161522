"""Search for keys and tables of the case file: `joints.dry.friction`, `structure.arch`, `friction`."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from difflib import get_close_matches
from functools import cache
from typing import Any, NamedTuple

from pydantic import BaseModel

from dem_cli.case import retired_keys
from dem_cli.case.keys import NAME_PLACEHOLDER, CaseKey, CaseTable, tables
from dem_cli.errors import UsageError

CLOSE = 0.75  # a name that is so near to a key is a slip, not a material or a joint of that name
DOC_PAGES = {  # beside docs/case.md, which has them all; {kind} is replaced
    "joints": "docs/laws/{kind}.md",
    "joints.NAME.profile": "docs/profile.md",
    "joints.NAME.softening": "docs/laws/friction-softening.md",
    "imperfection": "docs/case_imperfections.md",
    "load": "docs/guide/loads.md",
    "pressure": "docs/guide/loads.md",
    "fill": "docs/guide/loads.md",
    "ground": "docs/guide/loads.md",
    "groups": "docs/guide/loads.md",
    "damping": "docs/numerics.md",
    "motion": "docs/motion.md",
    "calibration": "docs/profile.md",
    "reference": "docs/guide/verify.md",
    "sweep": "docs/guide/sweeps.md",
    "analysis.fragility": "docs/fragility.md",
    "analysis.modes": "docs/modes.md",
    "analysis.safety": "docs/safety.md",
    "analysis.time-history": "docs/guide/shaking.md",
    "analysis": "docs/numerics.md",
}

EVERYDAY_WORDS = {  # what people look for -> the table or key that they write
    "lineload axle axleload pointload weight": "load",
    "thrust earthpressure waterpressure water distributedload areaload hydrostatic backfill": "pressure",
    "overburden spandrelfill ballast": "fill",
    "selection subset": "groups",
    "window windows door gate opening": "structure.wall.openings",
    "earthquake groundmotion accelerogram shaking quake pga": "motion",
    "mortar": "joints.mohr-coulomb.cohesion",
    "cracking tensilestrength": "joints.mohr-coulomb.tension",
    "normalstiffness springs": "joints.kn",
    "overturning failureload seismiccapacity": "analysis.pushover",
    "dome crossvault barrelvault cupola": "structure.vault",
    "viaduct aqueduct": "structure.bridge",
    "house church room plan": "structure.building",
    "rubble irregular polygonal": "structure.voronoi-wall",
    "pier pillar tower": "structure.column",
    "foundation subsidence": "settlement",
    "depth outofplane": "structure.thickness",
    "drawn elevation polyline": "structure.wall.outline",
}


class CaseEntry(NamedTuple):
    """Key of a table of the case file, for one or several kinds; without a key, the table itself."""

    table: CaseTable
    key: CaseKey | None
    kinds: tuple[str, ...]

    @property
    def path(self) -> str:
        """Key path of the entry."""
        return self.key.path if self.key else ".".join(self.table.path)

    @property
    def page(self) -> str:
        """Documentation page that describes the entry best."""
        steps, page = list(self.table.path), ""
        while steps and not page:
            page = DOC_PAGES.get(".".join((steps[0], *self.kinds)), "") if len(self.kinds) == 1 else ""
            page = page or DOC_PAGES.get(".".join(steps), "")
            steps.pop()
        if "{kind}" in page:
            return page.format(kind=self.kinds[0]) if len(self.kinds) == 1 else "docs/laws/README.md"
        return page or "docs/case.md"


def find(model: type[BaseModel], query: str) -> list[CaseEntry]:
    """Find every key or table that `query` may mean, alike ones together. Raises UsageError where there is none."""
    words = [word for word in re.sub(r"[\[\]\"' ]", "", query).split(".") if word and not word.isdigit()]
    names: dict[tuple[str, ...], set[str]] = {}
    for table in tables(model):
        names.setdefault(table.path, set()).update(table.declared.model_fields)
    found = [(rank, one) for one in entries(model) if (rank := _rank(words, one, names[one.table.path])) is not None]
    if not words or not found:
        meant = _everyday(query)
        if meant is not None:
            return find(model, meant)
        raise UsageError(unknown(model, query, words))
    best = min(rank for rank, _ in found)
    return _together(entry for rank, entry in found if rank == best)


def _everyday(query: str) -> str | None:
    """Look up the key path for an everyday word; None: not known."""
    plain = re.sub(r"[^a-z]", "", query.lower())
    return next((path for words, path in EVERYDAY_WORDS.items() if plain in words.split()), None)


@cache
def entries(model: type[BaseModel]) -> tuple[CaseEntry, ...]:
    """List all tables and all keys of the case file, one entry per kind."""
    found: list[CaseEntry] = []
    for table in tables(model):
        if table.path:
            found.append(CaseEntry(table, None, table.kinds))
        found += [CaseEntry(table, key, table.kinds) for key in table.keys if not key.only_tables]
    return tuple(found)


def _rank(words: Sequence[str], entry: CaseEntry, names: Collection[str]) -> tuple[int, int] | None:
    """Rank how well the words of a query match an entry, lower being better; None: no match."""
    steps: list[Any] = list(entry.table.path)
    if entry.kinds:
        steps.insert(2 if steps[1:2] == [NAME_PLACEHOLDER] else 1, set(entry.kinds))
    if entry.key:
        steps.append(entry.key.name)
    own = _own_names(words, steps, names)
    if own is not None:
        return 0, own
    for left_out in range(1, len(steps)):
        if isinstance(steps[left_out], str) and steps[left_out] != NAME_PLACEHOLDER:
            own = _own_names(words, steps[left_out:], names)
            if own is not None:
                return 1, own
    only_kind = entry.key is None and bool(entry.table.tag) and list(words) == list(entry.kinds)
    return (1, 0) if only_kind else None


def _own_names(words: Sequence[str], steps: Sequence[Any], names: Collection[str]) -> int | None:
    """Count how many words of a query are names chosen by the user; None where they do not match the steps.

    names: keys of such tables, which a last word is not likely to miss by a letter.
    """
    if not steps:
        return None if words else 0
    step, rest = steps[0], steps[1:]
    if isinstance(step, set) or step == NAME_PLACEHOLDER:  # may be left out
        found = _own_names(words, rest, names)
        if found is not None or not words:
            return found
        if isinstance(step, set):
            return _own_names(words[1:], rest, names) if words[0] in step else None
        if len(words) == 1 and get_close_matches(words[0], names, 1, CLOSE):
            return None
        found = _own_names(words[1:], rest, names)
        return None if found is None else found + 1
    return _own_names(words[1:], rest, names) if words and words[0] == step else None


def _together(found: Iterator[CaseEntry]) -> list[CaseEntry]:
    """Merge entries of several kinds that have the same description."""
    kept: dict[tuple[Any, ...], CaseEntry] = {}
    for entry in found:
        key = entry.key
        same: tuple[Any, ...] = (entry.path, entry.kinds)
        if key is not None and not key.names_kind:
            same = (entry.path, key.description, key.allowed, key.default)
        known = kept.get(same)
        kept[same] = entry if known is None else known._replace(kinds=tuple(dict.fromkeys(known.kinds + entry.kinds)))
    return list(kept.values())


def unknown(model: type[BaseModel], query: str, words: Sequence[str]) -> str:
    """Return the message for a key that does not exist: its present name, or the nearest keys, best first."""
    old = retired_keys.retired(words)
    if old is not None:
        return f"{query}: {retired_keys.message(old)}"
    full: dict[str, str] = {}
    for entry in entries(model):
        steps = [step for step in entry.path.split(".") if step != NAME_PLACEHOLDER]
        for short in (".".join(steps), steps[-1], *(".".join((steps[0], kind, *steps[1:])) for kind in entry.kinds)):
            full.setdefault(short, ".".join(steps))
    without_names = [word for i, word in enumerate(words) if not (i == 1 and words[0] in ("joints", "materials"))]
    near: list[str] = []
    for spelling in (".".join(words), ".".join(without_names), *words[-1:]):
        near += [full[name] for name in get_close_matches(spelling, full, 3, 0.7)]
    listed = ", ".join(f"'{name}'" for name in list(dict.fromkeys(near))[:4])
    hint = f"did you mean {listed}?" if listed else "`dem explain` lists the tables"
    return f"no key '{query}' in a case file; {hint}"
