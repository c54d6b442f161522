"""Explain a key of the case file: meaning, allowed values, and default: `dem explain`."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from dem_cli.case.explain import CaseEntry
    from dem_cli.case.keys import CaseTable

MOST_ENTRIES = 3  # more matches than this are listed, one line each
WIDEST = 110  # columns of a terminal that are used


@click.command("explain", short_help="Say what a key of the case file means.")
@click.argument("key", required=False, metavar="[KEY]")
@click.option("--json", "as_json", is_flag=True, help="Print all that is known as JSON.")
def command(key: str | None, as_json: bool) -> None:
    """Meaning, unit, range, default and an example of KEY, a key or a table of the case file.

    Such as: dem explain joints.friction, dem explain structure.arch, dem explain margin. Without KEY: all tables.
    """
    from dem_cli.app.api import make_case_model
    from dem_cli.case.explain import CaseEntry, find
    from dem_cli.case.keys import tables

    model = make_case_model()
    found = find(model, key) if key else [CaseEntry(table, None, table.kinds) for table in tables(model) if table.path]
    if as_json:
        click.echo(json.dumps([facts(entry) for entry in found], indent=2, ensure_ascii=False))
    elif key is not None and several_kinds(found):
        click.echo(about_kinds(found), nl=False)
    elif key is not None and len(found) <= MOST_ENTRIES:
        click.echo("\n".join(about_key(entry) if entry.key else about_table(entry) for entry in found), nl=False)
    else:
        click.echo(listing(found))


def about_key(entry: CaseEntry) -> str:
    """Describe a key: its meaning, then a line per property."""
    key = entry.key
    assert key is not None
    example = f"{key.table.heading}   {key.example}" if key.table.path else key.example
    rows = [
        ("unit", " or ".join("none" if unit == "-" else unit for unit in key.units)),
        ("allowed", key.allowed),
        ("default", "no default: must be given" if key.required else key.default or "none"),
        ("found in", found_in(entry)),
        ("example", example if key.example else ""),
        ("more", entry.page),
    ]
    return laid_out(key.path, key.meaning, [row for row in rows if row[1]])


def about_kinds(found: Sequence[CaseEntry]) -> str:
    """Describe the key that selects the kind of a table, or several such tables: each kind in a line."""
    table = found[0].table
    rows = [(f'"{entry.kinds[0]}"', summary(entry.table)) for entry in found]
    about = f"{table.said}\n{table.tag} is one of these"
    if len(table.path) == 1:
        about += f"; keys: dem explain {table.path[0]}.{found[0].kinds[0]}"
    return laid_out(found[0].path if found[0].key else table.heading, about, [*rows, ("more", "docs/case.md")])


def about_table(entry: CaseEntry) -> str:
    """Describe a table, then its keys."""
    table, rows = entry.table, []
    for key in table.keys:
        if not key.names_kind:
            unit = f" [{', '.join(key.units)}]" if key.units and key.units != ("-",) else ""
            note = "; required" if key.required else f"; default: {key.default}" if key.default else ""
            rows.append((key.name, key.meaning + unit + note))
    return laid_out(f"{table.heading}   {found_in(entry)}".strip(), table.about, [*rows, ("more", entry.page)])


def laid_out(head: str, about: str, rows: Sequence[tuple[str, str]]) -> str:
    """Format a heading, paragraphs and two columns, as wide as the terminal."""
    page = click.HelpFormatter(width=min(shutil.get_terminal_size((WIDEST, 24)).columns, WIDEST))
    page.write(f"{head}\n")
    page.indent()
    page.write_text(about.replace("\n", "\n\n"))
    page.write_dl(rows)
    return page.getvalue()


def found_in(entry: CaseEntry) -> str:
    """List the kinds of table that have a key."""
    tag = "law" if entry.table.path[:1] == ("joints",) else "kind"
    return f"{tag} = " + ", ".join(f'"{kind}"' for kind in entry.kinds) if entry.kinds else ""


def listing(found: Sequence[CaseEntry]) -> str:
    """List keys and tables, one line each; all kinds of a table share one."""
    lines: dict[str, list[str]] = {}
    for entry in found:
        name = entry.path if entry.key else entry.table.heading
        if names_kind(entry):
            lines.setdefault(name, []).append(entry.kinds[0])
        elif entry.key is not None:
            kinds = f"  ({found_in(entry)})" if entry.kinds else ""
            lines[name] = [*lines.get(name, ()), entry.key.meaning + kinds]
        else:
            lines[name] = [summary(entry.table)]
    width = max(map(len, lines))
    return "\n".join(f"{name:<{width}}  {', '.join(texts)}".rstrip() for name, texts in lines.items())


def several_kinds(found: Sequence[CaseEntry]) -> bool:
    """Test whether all entries are kinds of one table."""
    return len(found) > 1 and len({entry.path for entry in found}) == 1 and all(map(names_kind, found))


def names_kind(entry: CaseEntry) -> bool:
    """Test whether an entry is one kind of a table, or the key that selects the kind."""
    return bool(entry.table.tag) and (entry.key is None or entry.key.names_kind)


def summary(table: CaseTable) -> str:
    """Describe a table in one line."""
    return table.about.split("\n")[0].rstrip(".")


def facts(entry: CaseEntry) -> dict[str, Any]:
    """Return all properties of one key or table."""
    table, key = entry.table, entry.key
    found: dict[str, Any] = {"path": entry.path, "table": table.heading, "kinds": list(entry.kinds)}
    if key is None:
        keys = [facts(type(entry)(table, inner, entry.kinds)) for inner in table.keys]
        return {**found, "meaning": table.about, "dimension": table.dimension, "page": entry.page, "keys": keys}
    return {
        **found, "meaning": key.meaning, "dimension": key.dimension or table.dimension, "units": list(key.units),
        "allowed": key.allowed, "required": key.required, "default": key.default or None,
        "example": key.example or None, "page": entry.page,
    }  # fmt: skip
