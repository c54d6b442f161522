"""Vary one number of a case, named by a key path such as structure.0.ring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from pydantic import BaseModel, ValidationError

from dem_cli.case.messages import problems_from
from dem_cli.case.overrides import below, key_path
from dem_cli.case.schema import Case
from dem_cli.case.wording import nearest
from dem_cli.errors import CaseError, CaseProblem, KeyPath, plain

WHERE: KeyPath = ("analysis", "vary")
NO_STRUCTURE = (
    "title", "dimension", "seed", "dem", "output", "monitor", "reference", "sweep", "calibration", "motion", "damping",
)  # fmt: skip


def parts_of(text: str) -> list[str]:
    """Split a key path into its parts: structure.0.ring -> ["structure", "0", "ring"]."""
    return list(map(str, key_path(text)))


def value_at(case: Case, text: str) -> float | int:
    """Return the number at a key path of a case. Raises CaseError, at analysis.vary, where there is none."""
    if not parts_of(text):
        raise _wrong(f"'{text}' is not a key path, such as structure.0.ring")
    node: Any = case
    for depth, part in enumerate(parts_of(text)):
        try:
            node = below(node, part)
        except KeyError:
            raise _wrong(f"'{text}' is not in the case: {_missing(node, part, depth, text)}") from None
    first = parts_of(text)[0]
    if first in NO_STRUCTURE or (first == "analysis" and text != "analysis.load"):
        raise _wrong(f"'{text}' is not allowed; it changes neither structure nor load")
    if isinstance(node, bool) or not isinstance(node, (int, float)):
        found = "has no value" if node is None else f"is {node!r}" if isinstance(node, str) else "is not one number"
        raise _wrong(f"'{text}' is not allowed: it {found}; a number in the case can be varied")
    return node


def with_value(case: Case, text: str, value: float) -> Case:
    """Return a validated case with another value of one number. Raises CaseError, at analysis.between."""
    data = case.model_dump(exclude_unset=True)
    _put(data, case.model_dump(), parts_of(text), value)
    try:
        return type(case).model_validate(data)
    except ValidationError as error:
        raise impossible(f"{text} = {value:.6g}", problems_from(error, type(case), data)) from None


def impossible_table(what: str, path: KeyPath, declared: type[BaseModel], error: ValidationError) -> CaseError:
    """Create the error, at analysis.between, for a value with which a table becomes invalid."""
    found = {str(item["loc"][0]): item["input"] for item in error.errors(include_url=False) if item["loc"]}
    listed = problems_from(error, declared, found)
    return impossible(what, [replace(problem, path=(*path, *problem.path)) for problem in listed])


def impossible(what: str, found: Sequence[CaseProblem]) -> CaseError:
    """Create the error, at analysis.between, for a value with which the case becomes invalid."""
    problems = [problem for problem in found if problem.path != WHERE]
    return CaseError([CaseProblem(("analysis", "between"), f"{what} is not possible: {plain((problems or found)[0])}")])


def _put(data: dict[str, Any], whole: Any, path: list[str], value: float) -> None:
    """Change a nested table in place; tables and lists that were left out are taken from the `whole` case."""
    node: Any = data
    for part in path[:-1]:
        key: Any = int(part) if isinstance(node, list) else part
        whole = whole[key]
        if isinstance(node, dict) and key not in node:
            node[key] = {} if isinstance(whole, dict) else whole
        if isinstance(node[key], tuple):
            node[key] = list(node[key])  # it is going to be changed
        node = node[key]
    node[int(path[-1]) if isinstance(node, list) else path[-1]] = value


def _missing(node: Any, part: str, depth: int, text: str) -> str:
    """Describe the parts that exist where a part of a key path does not."""
    around = ".".join(parts_of(text)[:depth]) or "a case"
    if isinstance(node, tuple):
        return f"{around} has the numbers 0 to {len(node) - 1}" if node else f"there is no [[{around}]]"
    names: list[str] = []
    if isinstance(node, BaseModel):
        names = list(type(node).model_fields)
    elif isinstance(node, Mapping):
        names = list(node)
    near = nearest(part, names)
    return f"{around} has no '{part}'" + (f", {near}" if near else "")


def _wrong(message: str) -> CaseError:
    return CaseError([CaseProblem(WHERE, message)])
