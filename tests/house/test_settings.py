"""Settings of the solvers: none is dead, and none that is handed in is lost on the way to who reads it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest
from parsed import nodes, tree

from dem_cli.core.engine.settings import DEFAULT

PACKAGE = Path(__file__).resolve().parents[2] / "dem_cli"
ROOMS = ("core/limit", "core/engine", "core/statics", "core/dynamics", "analyses")
SOURCES = [path for room in ROOMS for path in sorted((PACKAGE / room).rglob("*.py"))]
SOURCES += sorted((PACKAGE / "core").glob("*.py"))
DEFAULTS = {"DEFAULT", "DEFAULT_LIMIT"}


def paths(settings: object, group: str = "") -> Iterator[tuple[str, str]]:
    """Group and name of every setting."""
    for part in fields(settings):
        value = getattr(settings, part.name)
        if is_dataclass(value):
            yield from paths(value, part.name)
        else:
            yield group, part.name


def last_word(node: ast.expr) -> str:
    """The name, or the last attribute, of an expression."""
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


def read() -> set[tuple[str, str]]:
    """Every attribute that the solvers read, and the last word of what it is read of."""
    return {
        (last_word(node.value), node.attr)
        for path in SOURCES
        for node in nodes(path)
        if isinstance(node, ast.Attribute)
    }


def test_no_setting_is_dead():
    known = read()
    assert not [path for path in paths(DEFAULT) if path not in known and ("settings", path[1]) not in known]


# -- handed on ---------------------------------------------------------------------------------------


def is_default(node: ast.expr | None) -> bool:
    """Whether an expression is of the default settings: DEFAULT, DEFAULT.safety, …"""
    while isinstance(node, ast.Attribute):
        node = node.value
    return isinstance(node, ast.Name) and node.id in DEFAULTS


def of_function(function: ast.FunctionDef, method: bool) -> dict[str, int]:
    """Parameters whose default is a setting, and their places among the arguments of a call."""
    names = [argument.arg for argument in function.args.args][int(method) :]
    given = [None] * (len(names) - len(function.args.defaults)) + function.args.defaults[-len(names) :]
    return {name: i for i, (name, value) in enumerate(zip(names, given, strict=True)) if is_default(value)}


def of_class(node: ast.ClassDef) -> dict[str, int]:
    """The same of a call that makes an instance."""
    for part in node.body:
        if isinstance(part, ast.FunctionDef) and part.name == "__init__":
            return of_function(part, method=True)
    rows = [part for part in node.body if isinstance(part, ast.AnnAssign)]
    return {last_word(part.target): i for i, part in enumerate(rows) if is_default(part.value)}


def expecting() -> dict[str, dict[str, int]]:
    """Functions and classes that go on with the default settings where they are given none."""
    found: dict[str, dict[str, int]] = {}
    for path in SOURCES:
        for node in tree(path).body:
            if isinstance(node, ast.FunctionDef):
                found[node.name] = of_function(node, method=False)
            elif isinstance(node, ast.ClassDef):
                found[node.name] = of_class(node)
                for part in node.body:
                    if isinstance(part, ast.FunctionDef) and part.name != "__init__":
                        found[f"{node.name}.{part.name}"] = of_function(part, method=True)
    return {name: places for name, places in found.items() if places}


def met(module: ast.Module) -> set[str]:
    """Names that a file imports or defines: what is called by another one came as an argument."""
    imports = (node for node in ast.walk(module) if isinstance(node, ast.ImportFrom))
    made = (node.name for node in module.body if isinstance(node, ast.FunctionDef | ast.ClassDef))
    return {alias.asname or alias.name for node in imports for alias in node.names} | {*made}


def called(node: ast.Call, names: set[str]) -> str:
    """What is called: a name that the file has met, or what a module or a class of such a name has; else nothing."""
    target = node.func
    if isinstance(target, ast.Name):
        return target.id if target.id in names else ""
    if isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and target.value.id in names:
        return f"{target.value.id}.{target.attr}" if target.value.id[0].isupper() else target.attr
    return ""


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: f"{path.parent.name}.{path.stem}")
def test_settings_are_handed_on(path):
    waiting, names = expecting(), met(tree(path))
    lost = []
    for node in nodes(path):
        if not isinstance(node, ast.Call) or any(isinstance(argument, ast.Starred) for argument in node.args):
            continue
        target, given = called(node, names), {keyword.arg for keyword in node.keywords}
        for name, place in waiting.get(target, {}).items():
            if place >= len(node.args) and name not in given:
                lost.append(f"{node.lineno}: {target}({name})")
    assert not lost


def test_there_are_settings_to_hand_on():
    assert {"Simulation", "Job.start", "associated_limit", "joint_properties"} <= expecting().keys()
