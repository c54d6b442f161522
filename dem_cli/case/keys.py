"""Keys of a case file as its tables declare them: meaning, unit, allowed values, default, example.

`dem explain`, docs/case.md and the key tables of docs/laws are made from nothing else. Conventions of a declaration:
units stand in brackets in the description (`[m]`; `[-]`: a number without one), what is used where a key without a
default value is left out follows `default: ` at its end, and `examples` has a value where there is no default.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any, Literal, NamedTuple, get_args, get_origin

import tomli_w
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from dem_cli.case.base import OneOrMoreSchema
from dem_cli.case.dimensions import known_in
from dem_cli.case.wording import DeclaredType, allowed, is_table, kind_of

NAME_PLACEHOLDER = "NAME"  # stands for a name of the user's choice: [materials.NAME]
EMPTY_VALUES: tuple[Any, ...] = (None, (), {}, "")
TAGS = ("kind", "law")  # keys that say which kind of table it is
KNOWN_UNITS = (
    "-", "m", "m2", "s", "kg", "N", "N/m", "Pa", "J", "Hz", "rad", "deg", "1/s", "m/s", "m/s2", "rad/s", "kg/m3",
    "Pa/m", "J/m2", "deg per decade of stress", "unit of the key", "unit of the quantity",
)  # fmt: skip
BRACKETS = re.compile(r" ?\[(" + "|".join(map(re.escape, KNOWN_UNITS)) + r")\]")
# Of a docstring: `[materials.NAME]`, `[analysis] with kind = "modes": `, `damping.rayleigh: `.
HEADING = re.compile(r"^(\[[\w.*\[\]]+\.?$|[\[a-z][^:\n]*: )")
DEFAULT = re.compile(r"[;,]? ?\bdefault: (.*)$")


class CaseTable(NamedTuple):
    """Table of the case file; where a table has kinds, one of its kinds."""

    path: tuple[str, ...]  # ("structure", "openings")
    declared: type[BaseModel]
    several: bool  # [[block]]
    tag: str  # "kind" or "law"; empty where all such tables are alike
    kinds: tuple[str, ...]  # the kind itself; of a table in another one, the kinds of that which have it
    said: str  # what the table around it says of it

    @property
    def heading(self) -> str:
        """Heading of the table as a file writes it: [joints.NAME], [[structure]]."""
        name = ".".join(self.path)
        return f"[[{name}]]" if self.several else f"[{name}]"

    @property
    def dimension(self) -> int | None:
        """Only dimension of cases that allows this table or kind; None: both."""
        inside = (known_in(self.path[:k]) for k in range(1, len(self.path) + 1))
        of_kind = known_in((*self.path, self.tag), self.kinds[0]) if self.tag and self.kinds else None
        return next(filter(None, inside), None) or of_kind or getattr(self.declared, "only_in", None)

    @property
    def about(self) -> str:
        """Description of the table from its docstring without the heading; for a joint law, from that of its module."""
        source = sys.modules[self.declared.__module__] if self.tag == "law" else self.declared
        paragraphs = re.split(r"\n\s*\n", inspect.cleandoc(source.__doc__ or ""))
        lines = [" ".join(paragraph.split()) for paragraph in paragraphs]
        text = lines[0] if self.tag == "law" else HEADING.sub("", "\n".join(lines)) or self.said
        first, *others = text.split("\n")
        if self.dimension is not None:
            first = first.rstrip(".") + only_in(self.dimension) + "." * first.endswith(".")
        return "\n".join([first, *others])

    @property
    def keys(self) -> list[CaseKey]:
        """List the keys of the table, the one that names the kind first."""
        names = sorted(self.declared.model_fields, key=lambda name: name != self.tag)
        return [CaseKey(self, name, self.declared.model_fields[name]) for name in names]


class CaseKey(NamedTuple):
    """Key of a table of the case file: name, type, limits and description."""

    table: CaseTable
    name: str
    field: FieldInfo

    @property
    def path(self) -> str:
        """Key path including the table: joints.NAME.friction."""
        return ".".join((*self.table.path, self.name))

    @property
    def dimension(self) -> int | None:
        """Only dimension of cases that allows this key, where its table is allowed in both; None: both."""
        return None if self.table.dimension else known_in((*self.table.path, self.name))

    @property
    def kind(self) -> DeclaredType:
        """Declared type of the key and the limits on its value."""
        return kind_of(self.field.annotation, self.field.metadata)

    @property
    def description(self) -> str:
        """Description of the key as declared; for the key that names the kind, the description of that kind."""
        if self.names_kind:
            return self.table.about.split("\n")[0].rstrip(".")
        return self.field.description or ""

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the numbers of the key; ("-",) for numbers without a unit, () for values that have none."""
        return tuple(dict.fromkeys(BRACKETS.findall(self.description))) if self.numeric else ()

    @property
    def numeric(self) -> bool:
        """Tell whether the value is or contains physical numbers, not mere counts."""
        return _holds_float(self.kind)

    @property
    def meaning(self) -> str:
        """Meaning of the key in words, without the default and, where there is only one, the unit."""
        text = DEFAULT.sub("", self.description)
        text = (BRACKETS.sub("", text) if len(self.units) == 1 else text).strip()
        return text + only_in(self.dimension)

    @property
    def allowed(self) -> str:
        """Allowed values of the key in words: `a number > 0 or 'auto'`."""
        return allowed((self.kind,))

    @property
    def required(self) -> bool:
        """Tell whether the key must be given."""
        return self.field.is_required()

    @property
    def default(self) -> str:
        """Default of the key as TOML text or in words; empty where there is none."""
        said = DEFAULT.search(self.description)
        if said:
            return said[1]
        value = self._default
        return "" if value in EMPTY_VALUES else toml(value)

    @property
    def _default(self) -> Any:
        """Declared default of the key as plain values; None where there is none."""
        value = None if self.required else self.field.get_default(call_default_factory=True)
        return value.model_dump() if isinstance(value, BaseModel) else value

    @property
    def only_tables(self) -> bool:
        """Tell whether the value can only be a table or several tables."""
        return all(bool(list(_inside(choice))) for choice in self.kind.choices)

    @property
    def names_kind(self) -> bool:
        """Tell whether the key selects the kind of its table."""
        return self.name == self.table.tag

    @property
    def example(self) -> str:
        """Example line of a file with this key; empty for a table of tables that has sections of its own."""
        value = self.field.examples[0] if self.field.examples else self._default
        return "" if value in EMPTY_VALUES else f"{self.name} = {toml(value)}"


def only_in(dimension: int | None) -> str:
    """Return the remark for a table or key that is allowed in one dimension only."""
    return "" if dimension is None else f" ({dimension}D only)"


def json_schema(model: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON Schema of a case file; descriptions name the dimension where only one is allowed."""
    schema = model.model_json_schema()
    for table in tables(model):
        place = schema["$defs"][table.declared.__name__] if table.path else schema
        if table.dimension is not None:
            place["description"] = table.about
        for key in table.keys:
            if key.dimension is not None:
                place["properties"][key.name]["description"] = key.description + only_in(key.dimension)
    return schema


@cache
def tables(model: type[BaseModel]) -> tuple[CaseTable, ...]:
    """List all tables of a case file, each followed by its subtables; the case itself comes first."""
    found: dict[tuple[tuple[str, ...], type[BaseModel]], CaseTable] = {}
    for table in _below(CaseTable((), model, False, "", (), "")):
        known = found.setdefault((table.path, table.declared), table)
        kinds = tuple(dict.fromkeys(known.kinds + table.kinds))
        found[table.path, table.declared] = known._replace(kinds=kinds)
    return tuple(found.values())


def _below(table: CaseTable) -> Iterator[CaseTable]:
    """List a table and all its subtables."""
    yield table
    for name, field in table.declared.model_fields.items():
        for declared, steps, several in _inside(kind_of(field.annotation, field.metadata)):
            tag = next((tag for tag in TAGS if _kind(declared, tag)), "")
            kinds = (_kind(declared, tag),) if tag else table.kinds
            path = (*table.path, name, *steps)
            yield from _below(CaseTable(path, declared, several, tag, kinds, field.description or ""))


def _inside(
    kind: DeclaredType, steps: tuple[str, ...] = (), several: bool = False
) -> Iterator[tuple[type[BaseModel], tuple[str, ...], bool]]:
    """Find the tables that a value may be or contain: class, path to it, and whether there may be several."""
    for choice in kind.choices:
        arguments, origin = get_args(choice.type), get_origin(choice.type)
        if is_table(choice.type):
            yield choice.type, steps, several
        elif origin is dict:
            yield from _inside(kind_of(arguments[1]), (*steps, NAME_PLACEHOLDER), several)
        elif origin is tuple and arguments[-1] is Ellipsis:
            one_will_do = any(isinstance(limit, OneOrMoreSchema) for limit in choice.limits)
            yield from _inside(kind_of(arguments[0]), steps, not one_will_do)


def _holds_float(kind: DeclaredType) -> bool:
    """Tell whether a value of this type is or may contain a float, tables aside."""
    inner = [kind_of(part) for choice in kind.choices for part in get_args(choice.type) if part is not Ellipsis]
    literal = get_origin(kind.type) is Literal
    return any(choice.type is float for choice in kind.choices) or (not literal and any(map(_holds_float, inner)))


def _kind(declared: type[BaseModel], tag: str) -> str:
    """Return the kind that a table class declares; empty where its table has no kinds."""
    field = declared.model_fields.get(tag)
    names = get_args(field.annotation) if field is not None and get_origin(field.annotation) is Literal else ()
    return names[0] if len(names) == 1 else ""


def toml(value: Any) -> str:
    """Format a value as TOML on one line."""
    if isinstance(value, dict):
        pairs = [f"{_key(key)} = {toml(item)}" for key, item in value.items() if item is not None]
        return "{ " + ", ".join(pairs) + " }" if pairs else "{}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, float) and abs(value) >= 1e5:
        digits, exponent = f"{value:e}".split("e")
        return f"{digits.rstrip('0').rstrip('.')}e{int(exponent)}"
    return tomli_w.dumps({"x": value}).removeprefix("x = ").strip()


def _key(name: str) -> str:
    """Format a key as TOML, quoted where it contains dots."""
    return name if re.fullmatch(r"[\w-]+", name, re.ASCII) else toml(name)
