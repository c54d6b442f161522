"""Compiled functions work on numbers and arrays alone: no strings, input, output or allocation, wherever they stand."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from parsed import nodes, tree

from dem_cli.core.kernels.compilation.cache_folder import compiled_sources

PACKAGE = Path(__file__).resolve().parents[2] / "dem_cli"
BEHIND_IT = PACKAGE / "core" / "kernels" / "compilation"  # may name numba
TEXTS = {path: path.read_text(encoding="utf-8") for path in sorted(PACKAGE.rglob("*.py"))}
TREES = {path: tree(path) for path, text in TEXTS.items() if "kernels.jit import" in text}  # users of the one door
COMPILED = {"always_inline", "kernel", "inline"}  # the decorators of jit.py
OF_NUMBA = {"njit", "jit", "vectorize", "guvectorize", "stencil", "cfunc", "intrinsic", "register_jitable"}
IO = {"print", "open", "input", "exec", "eval"}
ALLOCATORS = {
    "array", "arange", "asarray", "concatenate", "copy", "empty", "empty_like", "full", "full_like",
    "linspace", "ones", "ones_like", "sort", "argsort", "stack", "vstack", "hstack", "unique", "where",
    "zeros", "zeros_like",
}  # fmt: skip


def decorator_names(function: ast.FunctionDef) -> set[str]:
    names = set()
    for decorator in function.decorator_list:
        target = decorator.func if isinstance(decorator, ast.Call) else decorator
        names.add(target.attr if isinstance(target, ast.Attribute) else getattr(target, "id", ""))
    return names


def compiled_functions(tree: ast.Module) -> list[ast.FunctionDef | ast.Lambda]:
    """Functions behind one of our decorators; of an overload those that it makes, as it is Python itself."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            names = decorator_names(node)
            if names & COMPILED:
                found.append(node)
            elif "overload" in names:
                made = (inner for inner in ast.walk(node) if inner is not node)
                found += [inner for inner in made if isinstance(inner, ast.FunctionDef | ast.Lambda)]
    return found


SOURCES = [path for path, tree in TREES.items() if compiled_functions(tree)]


def body_nodes(function: ast.FunctionDef | ast.Lambda):
    """Every node of the body, without docstrings and annotations."""
    waiting = [function.body] if isinstance(function, ast.Lambda) else list(function.body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            continue
        yield node
        if isinstance(node, ast.FunctionDef):
            waiting += node.body
        elif isinstance(node, ast.AnnAssign):
            waiting += [node.target, *([node.value] if node.value else [])]
        else:
            waiting += list(ast.iter_child_nodes(node))


def problems_of(function: ast.FunctionDef | ast.Lambda, name: str) -> list[str]:
    """What a compiled function holds that it may not."""
    problems = []
    for node in body_nodes(function):
        where = f"{name}:{getattr(node, 'lineno', '?')} {getattr(function, 'name', 'lambda')}"
        if isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, (str, bytes))):
            problems.append(f"{where}: a string")
        if isinstance(node, (ast.ListComp, ast.DictComp, ast.SetComp, ast.List, ast.Dict, ast.Set)):
            problems.append(f"{where}: a {type(node).__name__}")
        if isinstance(node, (ast.Try, ast.With, ast.Import, ast.ImportFrom, ast.Global)):
            problems.append(f"{where}: {type(node).__name__}")
        if isinstance(node, ast.Call):
            called = node.func
            if isinstance(called, ast.Name) and called.id in IO:
                problems.append(f"{where}: {called.id}()")
            if isinstance(called, ast.Attribute) and called.attr in ALLOCATORS:
                problems.append(f"{where}: allocates with {ast.unparse(called)}()")
    return problems


WITH_KERNELS = ("kernels", "kernels/deformation", "kernels/tiles", "laws", "limit", "links")


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_compiled_functions_hold_numbers_alone(path):
    found = [problem for function in compiled_functions(TREES[path]) for problem in problems_of(function, path.name)]
    assert not found, "\n".join(found)


def test_kernels_are_looked_at_wherever_they_stand():
    rooms = {path.parent.relative_to(PACKAGE).as_posix() for path in SOURCES}
    assert {f"core/{room}" for room in WITH_KERNELS} <= rooms
    assert len(SOURCES) > 30


@pytest.mark.parametrize(
    "body",
    ["x = 'a'", "print(x)", "y = np.zeros(3)", "y = [x]", "y = x.copy()", "raise ValueError(f'{x}')", "import math"],
)
def test_what_they_may_not_hold_is_found(body):
    assert problems_of(ast.parse(f"@inline\ndef f(x):\n    {body}").body[0], "f")


def test_one_door_to_numba():
    """Nothing outside `kernels/compilation` imports numba or llvmlite, or decorates with what is theirs."""
    word = re.compile(rf"llvmlite|numba|@({'|'.join(OF_NUMBA)})\b")
    for path in (path for path, text in TEXTS.items() if word.search(text) and BEHIND_IT not in path.parents):
        for node in nodes(path):
            if isinstance(node, ast.FunctionDef):
                assert not decorator_names(node) & OF_NUMBA, path
            named = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            named += [one.name for one in node.names] if isinstance(node, ast.Import) else []
            assert not {"numba", "llvmlite"} & {name.split(".")[0] for name in named}, path


def test_all_that_is_compiled_names_the_cache():
    """Else an edited callee would go on running the machine code of before."""
    assert set(SOURCES) - set(compiled_sources()) == set()
    assert all(source.is_file() for source in compiled_sources())
