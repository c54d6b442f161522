"""A page as text: what the law's own docstring and its table say, and the notes beside this file."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import tomli_w

from dem_cli.bench.table import lines_of
from dem_cli.case.base import CaseModel
from dem_cli.case.keys import CaseKey, CaseTable
from dem_cli.laws.stiffness import StiffJoint
from lawpages.pages import PAGES
from lawpages.panels import Page

NOTES = Path(__file__).parent / "notes"
COMMON = tuple(StiffJoint.model_fields)  # keys of every joint, at the end of the table


def text(page: Page) -> str:
    """The whole page."""
    title, body = equation(page)
    caption, _, rest = notes(page.name, page.numbers()).partition("\n\n")
    parts = [
        f"# {page.name}", f"{title}.", body,
        f"![Response along displacement paths]({page.name}.png)", caption.strip(),
        "## In a case file", f"```toml\n{example(page)}\n```",
        "## Parameters", *parameters(page), *([rest.strip()] if rest else []),
        "## Source", f"{page.law.source[0].upper()}{page.law.source[1:]}.",
        f"The law is `{module(page)}`, its tests are in `tests/laws/`. Written by `scripts/laws`; do not edit.",
    ]  # fmt: skip
    return "\n\n".join(parts) + "\n"


def notes(name: str, numbers: dict[str, str]) -> str:
    """notes/NAME.md with numbers filled in."""
    found = (NOTES / f"{name}.md").read_text(encoding="utf-8")
    for key, value in numbers.items():
        found = found.replace("{{" + key + "}}", value)
    return found


def equation(page: Page) -> tuple[str, str]:
    """Title and body of the docstring of the law's module."""
    doc = sys.modules[page.law.function.__module__].__doc__ or ""
    title, _, body = doc.strip().partition("\n\n")
    return title.rstrip("."), body


def module(page: Page) -> str:
    """Path of the law's module."""
    return page.law.function.__module__.replace(".", "/") + ".py"


def example(page: Page) -> str:
    """[joints.*] as in the picture."""
    table = {key: value for key, value in page.keys.items() if not isinstance(value, dict)}
    inner = {key: value for key, value in page.keys.items() if isinstance(value, dict)}
    lines = ["[joints.stone]", tomli_w.dumps({"law": page.key, **table}).strip()]
    for key, value in inner.items():
        lines.append(f"{key} = {{ {', '.join(tomli_w.dumps(value).strip().splitlines())} }}")
    return "\n".join(lines)


def parameters(page: Page) -> list[str]:
    """Tables of the keys; the keys that all joints have come last."""
    model, head = page.law.parameters, ("key", "unit", "range", "default", "meaning")
    own = [key for key in model.model_fields if key != "law" and key not in COMMON]
    table = ["\n".join(lines_of(head, [row(model, key) for key in own]))] if own else []
    if not issubclass(model, StiffJoint):
        return [*table, "These are the keys of `softening`; the others are those of [coulomb](coulomb.md)."]
    shared = "\n".join(lines_of(head, [row(model, key) for key in COMMON]))
    return [*table, "Of every joint, whatever its law:", shared]


def row(model: type[CaseModel], key: str) -> tuple[str, ...]:
    """Key, unit, range, default and meaning of a key."""
    table = CaseTable(("joints", "NAME"), model, False, "law", (), "")
    found = CaseKey(table, key, model.model_fields[key])
    default = "**required**" if found.required else found.default or "–"
    return f"`{key}`", " ".join(found.units) or "–", limits(found.allowed), default, found.meaning.replace("|", "\\|")


def limits(allowed: str) -> str:
    """The range of a number out of what is allowed: '> 0', '≥ 0 and ≤ 1'."""
    found = re.search(r"(?:number|integer) ([><≥≤].*?)(?: or|$)", allowed)
    return found[1] if found else "–"


def index() -> str:
    """docs/laws/README.md: all laws with their first sentence."""
    rows = [
        (f"[{page.name}]({page.name}.md)", page.chosen or f'`law = "{page.name}"`', equation(page)[0]) for page in PAGES
    ]
    return notes("README", {"laws": "\n".join(lines_of(("page", "in a case file", "what it is"), rows))})
