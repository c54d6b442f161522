"""Kernels are dumb: no strings, no input or output, no allocation inside a compiled function."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from dem_cli.kernels.compilation.cache_folder import compiled_sources

KERNELS = Path(__file__).resolve().parents[2] / "dem_cli" / "kernels"
SOURCES = sorted(p for p in KERNELS.glob("*.py") if p.name not in ("__init__.py", "jit.py"))
COMPILED = {"always_inline", "kernel", "inline", "overload"}  # the decorators of jit.py
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


def compiled_functions(tree: ast.Module) -> list[ast.FunctionDef]:
    """Functions behind one of our decorators (an overload's inner functions come with it)."""
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and decorator_names(node) & COMPILED]


def body_nodes(function: ast.FunctionDef):
    """Every node of the body, without docstrings and annotations."""
    waiting = list(function.body)
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


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: p.stem)
def test_compiled_functions_are_dumb(path):
    problems = []
    for function in compiled_functions(ast.parse(path.read_text(encoding="utf-8"))):
        for node in body_nodes(function):
            where = f"{path.name}:{getattr(node, 'lineno', '?')} {function.name}"
            if isinstance(node, ast.JoinedStr) or (
                isinstance(node, ast.Constant) and isinstance(node.value, (str, bytes))
            ):
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
    assert not problems, "\n".join(problems)


def test_there_are_kernels_to_look_at():
    assert any(compiled_functions(ast.parse(p.read_text(encoding="utf-8"))) for p in SOURCES)


def test_one_door_to_numba():
    """Only jit.py decorates; everything else goes through @kernel and @inline."""
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                assert not decorator_names(node) & {"njit", "jit", "register_jitable"}, path.name


def test_all_that_is_compiled_names_the_cache():
    """Else an edited callee would go on running the machine code of before."""
    package = KERNELS.parent
    texts = {path: path.read_text("utf-8") for path in package.rglob("*.py")}
    users = {path: text for path, text in texts.items() if "from dem_cli.kernels.jit import" in text}
    compiled = {path for path, text in users.items() if compiled_functions(ast.parse(text))}
    assert len(compiled) > 30
    assert compiled - set(compiled_sources()) == set()
    assert all(source.is_file() for source in compiled_sources())
