"""docs/commands.md: every command with its arguments and options, from the commands themselves."""

from __future__ import annotations

import inspect
import re

import click

from dem_cli.app.cli.main import COMMANDS, main
from studies.template import table as markdown

INTRODUCTION = """# Commands

Every command takes `--help`. CASE is a TOML file, or `-`, which reads it from standard input. What is asked for is
printed on stdout, as text or with `--json` as one JSON object; progress, remarks and errors go to stderr. Exit codes
are the same everywhere:

| code | means |
| --- | --- |
| 0 | solved, done, all within tolerance |
| 1 | solved, but outside a `[reference]`, or it does not stand and none expects that; or some runs of many failed |
| 2 | a wrong case file or wrong arguments; nothing was run |
| 3 | the solver gave up, or memory or disk did; it says why, and what it has is kept |
| 70 | a fault of the program; a file to send, with traceback and case, is left (`DEM_TRACEBACK=1` shows it too) |
| 130 | interrupted; what is finished is kept |

Made from the program itself by `scripts/docs --write`; do not edit.
"""

KEPT = "\b\n"  # in front of a paragraph whose lines are not to be filled


def text() -> str:
    """The whole page."""
    rows = [(f"[`dem {name}`](#dem-{name})", about) for name, about in COMMANDS.items()]
    parts = [INTRODUCTION, markdown(("command", "does"), rows)]
    context = click.Context(main, info_name="dem")
    for name in COMMANDS:
        found = main.get_command(context, name)
        assert found is not None
        parts += section(name, found, click.Context(found, info_name=name, parent=context))
    return "\n\n".join(part.strip() for part in parts if part) + "\n"


def section(name: str, found: click.Command, context: click.Context) -> list[str]:
    """Heading, usage, what it does, a table of options."""
    records = [param.get_help_record(context) for param in found.get_params(context) if "--help" not in param.opts]
    rows = [(f"`{option}`".replace("|", "\\|"), safe(about)) for option, about in filter(None, records) if about]
    return [
        f"## dem {name}",
        f"```text\n{re.sub(r'^Usage: ', '', found.get_usage(context))}\n```",
        *map(paragraph, inspect.cleandoc(found.help or "").split("\n\n")),
        markdown(("option", "means"), rows) if rows else "",
    ]


def paragraph(words: str) -> str:
    """A paragraph of a help text; one that click is told to leave as it is stays so."""
    return f"```text\n{words.removeprefix(KEPT)}\n```" if words.startswith(KEPT) else safe(words)


def safe(words: str) -> str:
    """Words in which nothing is taken for Markdown."""
    return re.sub(r"([|<>\[\]*_])", r"\\\1", words)
