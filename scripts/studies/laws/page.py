"""A page as text: what the law's own docstring and its table say, and the notes beside this file."""

from __future__ import annotations

import re
import sys

import tomli_w

from dem_cli.case.base import CaseModel
from dem_cli.case.keys import CaseKey, CaseTable
from dem_cli.case.tables.declared import table_of
from dem_cli.core.laws.stiffness import StiffJoint
from studies.laws.diagrams import PAGES
from studies.laws.driven_point import LawPage
from studies.template import filled
from studies.template import table as markdown

COMMON = tuple(StiffJoint.declared)  # keys of every joint, at the end of the table


def text(page: LawPage) -> str:
    """The whole page."""
    title, body = equation(page)
    caption, _, rest = notes(page.name, page.numbers()).partition("\n\n")
    return filled(
        "laws/page.md.j2", name=page.name, title=title, body=body, caption=caption.strip(), example=example(page),
        parameters=parameters(page), rest=rest.strip(), source=f"{page.law.source[0].upper()}{page.law.source[1:]}",
        module=module(page),
    )  # fmt: skip


def notes(name: str, numbers: dict[str, str]) -> str:
    """notes/NAME.md.j2 with numbers filled in."""
    return filled(f"laws/notes/{name}.md.j2", **numbers)


def equation(page: LawPage) -> tuple[str, str]:
    """Title and body of the docstring of the law's module."""
    doc = sys.modules[page.law.function.__module__].__doc__ or ""
    title, _, body = doc.strip().partition("\n\n")
    return title.rstrip("."), body


def module(page: LawPage) -> str:
    """Path of the law's module."""
    return page.law.function.__module__.replace(".", "/") + ".py"


def example(page: LawPage) -> str:
    """[joints.*] as in the picture."""
    table = {key: value for key, value in page.keys.items() if not isinstance(value, dict)}
    inner = {key: value for key, value in page.keys.items() if isinstance(value, dict)}
    lines = ["[joints.stone]", tomli_w.dumps({"law": page.key, **table}).strip()]
    for key, value in inner.items():
        lines.append(f"{key} = {{ {', '.join(tomli_w.dumps(value).strip().splitlines())} }}")
    return "\n".join(lines)


def parameters(page: LawPage) -> list[str]:
    """Tables of the keys; the keys that all joints have come last."""
    model, head = table_of(page.law.parameters), ("key", "unit", "range", "default", "meaning")
    own = [key for key in model.model_fields if key != "law" and key not in COMMON]
    table = [markdown(head, [row(model, key) for key in own])] if own else []
    if not issubclass(page.law.parameters, StiffJoint):
        return [*table, "These are the keys of `softening`; the others are those of [coulomb](coulomb.md)."]
    shared = markdown(head, [row(model, key) for key in COMMON])
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
    return notes("README", {"laws": markdown(("page", "in a case file", "what it is"), rows)})
