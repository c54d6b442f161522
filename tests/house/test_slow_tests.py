"""tests/slow_tests.txt names all slow tests, which exist, in order, and leaves quick ones in every folder."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from parsed import tree

ROOT = Path(__file__).resolve().parents[2]
LINES = (ROOT / "tests" / "slow_tests.txt").read_text(encoding="utf-8").splitlines()
NAMED = [line for line in LINES if not line.startswith("#")]
FILES = sorted((ROOT / "tests").rglob("test_*.py"))


def functions(path: Path) -> set[str]:
    """Tests of a file, as the list names them."""
    defined = [node.name for node in tree(path).body if isinstance(node, ast.FunctionDef)]
    names = [name for name in defined if name.startswith("test_")]
    return {f"{path.relative_to(ROOT).as_posix()}::{name}" for name in names}


def test_all_that_is_named_exists():
    there = set().union(*map(functions, FILES))
    assert not [line for line in NAMED if re.sub(r"\[.*\]$", "", line) not in there]


def test_names_are_in_order_and_once():
    assert sorted(set(NAMED)) == NAMED
    whole = {line for line in NAMED if not line.endswith("]")}
    assert not [line for line in NAMED if line.endswith("]") and line.split("[")[0] in whole]


def test_every_folder_keeps_quick_tests():
    left: dict[Path, int] = {}
    for path in FILES:
        left[path.parent] = left.get(path.parent, 0) + len(functions(path) - set(NAMED))
    assert min(left.values()) > 0, left


def test_nothing_else_says_what_is_slow():
    mark = "mark" + ".slow"
    users = [path.name for path in sorted((ROOT / "tests").rglob("*.py")) if mark in path.read_text(encoding="utf-8")]
    assert users == ["conftest.py"]
