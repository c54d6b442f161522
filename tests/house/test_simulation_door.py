"""A simulation is read from anywhere, and written through its own verbs: no one else puts numbers into its arrays."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from parsed import nodes

PACKAGE = Path(__file__).resolve().parents[2] / "dem_cli"
OUTSIDE = (
    "core/statics",
    "core/dynamics",
    "analyses",
    "core/limit",
    "app/cli",
    "app/pipeline",
    "app/public",
)
SOURCES = [path for room in OUTSIDE for path in sorted((PACKAGE / room).rglob("*.py"))]
SIMULATIONS = {"sim", "simulation"}
ARRAYS = {"bodies", "contacts", "loads", "control", "ledger", "joints", "geometry", "tracking"}


def targets(node: ast.AST) -> Iterator[ast.expr]:
    """What a statement writes to, tuples taken apart."""
    waiting = list(node.targets) if isinstance(node, ast.Assign) else [node.target]
    while waiting:
        target = waiting.pop()
        if isinstance(target, ast.Tuple | ast.List):
            waiting += target.elts
        else:
            yield target.value if isinstance(target, ast.Starred) else target


def written_to(target: ast.expr) -> list[str]:
    """The attributes that lead to what is written, and a simulation that they are of: sim, bodies of sim.bodies[0]."""
    words = []
    while isinstance(target, ast.Attribute | ast.Subscript):
        target = target.value
        if isinstance(target, ast.Attribute):
            words.append(target.attr)
        elif isinstance(target, ast.Name) and target.id in SIMULATIONS:
            words.append(target.id)
    return words


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: f"{path.parent.name}.{path.stem}")
def test_only_the_simulation_writes_its_arrays(path):
    statements = [node for node in nodes(path) if isinstance(node, ast.Assign | ast.AugAssign | ast.AnnAssign)]
    assert not [
        f"{node.lineno}: {ast.unparse(target)}"
        for node in statements
        for target in targets(node)
        if (SIMULATIONS | ARRAYS) & {*written_to(target)}
    ]
