"""Templates of generated pages: Markdown by jinja2, beside the modules whose values they show."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from bench.table import lines_of, percent
from jinja2 import Environment, FileSystemLoader, StrictUndefined


def filled(template: str, **values: Any) -> str:
    """The text of a template, such as chapter6/arch.md.j2, with these values."""
    return _environment().get_template(template).render(**values)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    return "\n".join(lines_of(head, rows))


def commands(*runs: dict[str, Any], more: int = 0) -> str:
    """How runs are repeated, with their seconds; more: how many others are like them."""
    lines = [f"{run['command']}  # {run['seconds']:.1f} s" for run in runs]
    return "\n".join(["```", *lines, *([f"# and so on: {more} more"] if more else []), "```"])


def bracket(found: Sequence[float | None], form: str = ".4f") -> str:
    """Highest load that stands and lowest that fails: "0.1230 to 0.1240"; without the latter "above 0.1230"."""
    low, high = found
    return f"{low:{form}} to {high:{form}}" if high is not None else f"above {low:{form}}"


def minus(text: str) -> str:
    """Hyphens before numbers as true minus signs."""
    return text.replace("-", "−")


@cache
def _environment() -> Environment:
    folder = FileSystemLoader(Path(__file__).parent)
    made = Environment(loader=folder, undefined=StrictUndefined, keep_trailing_newline=True, trim_blocks=True)
    made.filters |= {
        "to": format,  # {{ load | to(".3f") }}
        "percent": percent,
        "size": lambda error: percent(error).lstrip("+"),  # of an error whose sign is known
    }
    return made
