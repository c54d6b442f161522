"""Records that checkpoints may hold: those that stages give and change, and what these have in them."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

from parsed import nodes

from dem_cli.core.links.registry import LINKS
from dem_cli.results.output.resume.kept_records import RECORDS

PACKAGE = Path(__file__).resolve().parents[2] / "dem_cli"
NAME = re.compile(r"[A-Z]\w+")


@cache
def classes():
    """Classes of the package by name."""
    return {node.name: node for path in PACKAGE.rglob("*.py") for node in nodes(path) if isinstance(node, ast.ClassDef)}


def lasts(of):
    """Whether it says what of it stays: then it is put back, and is no record."""
    names = [target for node in of.body for target in getattr(node, "targets", [getattr(node, "target", None)])]
    return any(getattr(name, "id", None) == "LASTING" for name in names)


def named_in(annotation):
    """Classes of the package that an annotation names."""
    return {name for name in NAME.findall(ast.unparse(annotation)) if name in classes() and not lasts(classes()[name])}


def test_each_is_where_it_is_said_to_be():
    for name, record in RECORDS.items():
        assert record.__name__ == name
        assert record.__init__ is not object.__init__ or issubclass(record, tuple)


def test_what_records_hold_is_kept_too():
    fields = [node for name in RECORDS for node in classes()[name].body if isinstance(node, ast.AnnAssign)]
    named = set().union(*(named_in(node.annotation) for node in fields))
    assert len(named) > 5
    assert not {name for name in named - set(RECORDS) if "Protocol" not in map(ast.unparse, classes()[name].bases)}


def test_what_stages_give_is_kept():
    found = set()
    for path in PACKAGE.rglob("*.py"):
        for node in nodes(path):
            decorators = getattr(node, "decorator_list", []) if isinstance(node, ast.FunctionDef) else []
            if any(ast.unparse(each) == "stage" for each in decorators):
                found |= named_in(node.returns)
    assert len(found) > 5
    assert not found - set(RECORDS)


def test_links_of_a_simulation_are_kept():
    kinds = {name for name, node in classes().items() if {"started", "acting"} <= {f.name for f in methods(node)}}
    kinds -= {"LinkArrays"}  # what they have in common
    assert len(kinds) == len(LINKS)
    assert kinds <= set(RECORDS)


def methods(node):
    return [each for each in node.body if isinstance(each, ast.FunctionDef)]
