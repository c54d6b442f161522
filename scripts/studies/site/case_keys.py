"""docs/case.md: every table and key of a case file, from their declarations."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import combinations

from pydantic import BaseModel, ValidationError

from dem_cli.app.api import make_case_model
from dem_cli.case.explain import CaseEntry
from dem_cli.case.keys import CaseKey, CaseTable, only_in, tables
from studies.places import DOCS
from studies.template import table as markdown

HEAD = ("key", "what it may be", "unit", "default", "meaning")
INTRODUCTION = """# Case file: every table and key

A case file is [TOML](https://toml.io/en/v1.0.0) in SI units: m, kg, s, N, Pa; angles are in degrees where a key ends
in `_deg`. Unknown keys are errors. `dem explain KEY` prints what stands here about one key, and `dem schema` the JSON
Schema for editors.

In headings, `NAME` is a name of your choice, `[table]` stands once and `[[table]]` as often as needed; a table inside
another may also be written on one line, as in `cap = { width = 0.6, height = 0.15 }`. An example has what its table
needs and no more. The [guide](guide/model.md) says how to go about it.

Cases are in 2D, or in 3D with `dimension = 3`. What one of them alone may have is marked (2D only) or (3D only). A
vector that is left out has a third component of 0 in 3D.

Made from the program's own declarations by `scripts/docs --write`; do not edit.
"""


def text() -> str:
    """The whole page."""
    case, *others = tables(make_case_model())
    parts = [INTRODUCTION, overview(others), "## Keys at the top of the file", *rows_of(plain(case))]
    for name in dict.fromkeys(table.path[0] for table in others):
        parts += section([table for table in others if table.path[0] == name])
    return "\n\n".join(part.strip() for part in parts) + "\n"


def overview(found: Sequence[CaseTable]) -> str:
    """A table of tables: heading, kinds, what it is for."""
    rows = []
    for name in dict.fromkeys(table.path[0] for table in found):
        table = next(one for one in found if one.path[0] == name)
        alike = [one for one in found if one.path == table.path and one.tag]
        kinds = [f"[{one.kinds[0]}](#{anchor(one)})" for one in alike]
        rows.append(
            (
                f"[`{table.heading}`](#{slug(table.heading)})",
                safe(table.said + only_in(table.dimension)),
                ", ".join(kinds),
            )
        )
    return markdown(("table", "holds", "kinds"), rows)


def section(found: Sequence[CaseTable]) -> list[str]:
    """A table at the top of the file with all its kinds, then the tables inside it."""
    first = found[0]
    kinds = [table for table in found if table.tag and table.path == first.path]
    parts = [f"## `{first.heading}`"]
    if kinds:
        shared = common(kinds)
        names = {key.name for key in shared}
        parts += [f"{capital(safe(first.said))}. `{first.tag}` says which it is."]
        parts += ["All have:", *rows_of(shared)] if shared else []
        for table in kinds:
            own = [key for key in plain(table) if key.name not in names and not key.names_kind]
            parts += [f'### `{first.tag} = "{table.kinds[0]}"`', paragraphs(table) + more(table)]
            parts += [*rows_of(own), example(table)]
    else:
        parts += [paragraphs(first) + more(first), *rows_of(plain(first)), example(first)]
    inner = [table for table in found if table.path != first.path]
    for declared in dict.fromkeys(table.declared for table in inner):
        alike = [table for table in inner if table.declared is declared]
        headings = ", ".join(f"`{table.heading}`" for table in alike)
        where = f"Of {', '.join(f'`{kind}`' for kind in alike[0].kinds)}." if alike[0].kinds else ""
        if alike[0].tag:
            headings, where = f'{headings}, `{alike[0].tag} = "{alike[0].kinds[0]}"`', ""
        own = [key for key in plain(alike[0]) if not (alike[0].tag and key.names_kind)]
        parts += [f"### {headings}", " ".join(filter(None, [paragraphs(alike[0]), where])), *rows_of(own)]
        parts += [example(alike[0])]
    return parts


def plain(table: CaseTable) -> list[CaseKey]:
    """The keys of a table; at the top of a case only those that are no tables."""
    return [key for key in table.keys if table.path or not key.only_tables]


def common(kinds: Sequence[CaseTable]) -> list[CaseKey]:
    """Keys that all kinds have and explain alike."""
    said = [{(key.name, key.description, key.allowed, key.default) for key in table.keys} for table in kinds]
    alike = set.intersection(*said)
    return [key for key in kinds[0].keys if (key.name, key.description, key.allowed, key.default) in alike]


def rows_of(keys: Sequence[CaseKey]) -> list[str]:
    """A table of keys; nothing for none."""
    return [markdown(HEAD, map(row, keys))] if keys else []


def row(key: CaseKey) -> tuple[str, ...]:
    units = ", ".join("–" if unit == "-" else unit for unit in key.units)
    default = "**required**" if key.required else safe(key.default)
    return f"`{key.name}`", safe(key.allowed.replace("'", '"')), units, default, safe(key.meaning)


def example(table: CaseTable) -> str:
    """The table with the keys that it needs, which is valid; as a block of TOML."""
    needed = [key for key in table.keys if key.names_kind or key.required]
    others = [key for key in table.keys if key.example and key not in needed]
    simple = [key for key in others if "{" not in key.example]
    for count, of in ((0, simple), (1, simple), (2, simple), (1, others), (2, others), (3, others)):
        for added in combinations(of, count):
            lines = [key.example for key in table.keys if key in needed or key in added]
            if valid(table.declared, lines):
                return "\n".join(["```toml", table.heading, *lines, "```"])
    lines = [key.example for key in needed]
    return "\n".join(["```toml", table.heading, *lines, "```"])


def valid(declared: type[BaseModel], lines: Sequence[str]) -> bool:
    import tomllib

    try:
        declared.model_validate(tomllib.loads("\n".join(lines)))
    except ValidationError:
        return False
    return True


def paragraphs(table: CaseTable) -> str:
    """What the table is, each paragraph a sentence or more."""
    lines = [capital(line) for line in safe(table.about).split("\n") if line]
    return "\n\n".join(line if line.endswith((".", "?")) else f"{line}." for line in lines)


def more(table: CaseTable) -> str:
    """A link to the page that says most about a table, where there is one beside this."""
    page = CaseEntry(table, None, table.kinds).page.removeprefix("docs/")
    title = (DOCS / page).read_text(encoding="utf-8").split("\n")[0].removeprefix("# ")
    return "" if page == "case.md" else f" More: [{title}]({page})."


def capital(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}" if words else ""


def safe(words: str) -> str:
    """Words in which nothing but code is taken for Markdown."""
    parts = words.split("`")
    parts[::2] = [re.sub(r"([|<>\[\]_*])", r"\\\1", part) for part in parts[::2]]
    return "`".join(parts)


def slug(heading: str) -> str:
    """The anchor of a heading, as forges and MyST make it."""
    kept = (letter for letter in heading.lower().replace(" ", "-") if letter.isalnum() or letter in "-_")
    return "".join(kept)


def anchor(table: CaseTable) -> str:
    """Of the section of one kind."""
    return slug(f"{table.tag} = {table.kinds[0]}")
