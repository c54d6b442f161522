"""Names say what they are: no class name twice in the package, no file that could hold anything."""

from __future__ import annotations

import ast
from pathlib import Path

from parsed import nodes

ROOT = Path(__file__).resolve().parents[2]
MODULES = sorted((ROOT / "dem_cli").rglob("*.py"))
SAY_NOTHING = {"common", "core", "data", "helper", "helpers", "lib", "manager", "misc", "stuff",
               "tools", "util", "utils"}  # fmt: skip


def classes() -> dict[str, list[str]]:
    """Files of each class, by its name."""
    found: dict[str, list[str]] = {}
    for path in MODULES:
        for node in nodes(path):
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, []).append(str(path.relative_to(ROOT)))
    return found


def test_no_class_name_twice():
    assert not {name: files for name, files in classes().items() if len(files) > 1}


def test_no_dead_constant():
    """Every constant of a module is read somewhere in the package."""
    read, constants = set(), []
    for path in MODULES:
        for node in nodes(path):
            if isinstance(node, ast.Assign):  # those that are told apart by numbers, A, B = 0, 1, go together
                names = [target.id for target in node.targets if isinstance(target, ast.Name)]
                constants += [(name, path) for name in names if name.isupper()]
            elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
                read.add(node.id)
            elif isinstance(node, ast.Attribute):
                read.add(node.attr)
            elif isinstance(node, ast.Constant) and path.name == "registry.py":
                read.add(node.value)  # loaded by name
    assert not [f"{path.relative_to(ROOT)}: {name}" for name, path in constants if name not in read]


def test_no_file_that_could_hold_anything():
    assert not [str(path) for path in MODULES if path.stem in SAY_NOTHING]
