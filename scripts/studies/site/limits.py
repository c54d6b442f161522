"""docs/guide/limits.md: how large what is read may be, from the limits that the program keeps."""

from __future__ import annotations

from dem_cli.input_limits import LIMITS, InputLimit
from studies.template import table as markdown

INTRODUCTION = """# Limits: how large input may be

What is beyond a limit is refused with one message and exit code 2, before it takes long or fills the memory. The
message says the file, the key, the value and what is allowed. Only files are read; a case may also come through a pipe,
such as `dem check -` or `dem check <(...)`. Devices and folders are refused at once, pipes that stay silent soon.

Made from the program's own limits by `scripts/docs --write`; do not edit."""
HEAD = ("what", "at most", "why")


def text() -> str:
    """The whole page."""
    parts = [INTRODUCTION]
    for title, limits in LIMITS.items():
        parts += [f"## {title[0].upper()}{title[1:]}", markdown(HEAD, [row(limit) for limit in limits])]
    return "\n\n".join(parts) + "\n"


def row(limit: InputLimit) -> tuple[str, str, str]:
    """A line of the table."""
    number = f"{limit.most:g}" if limit.most > 1e12 else f"{limit.most:,.0f}"
    return (limit.of, f"{number} {limit.unit}".strip(), limit.why)
