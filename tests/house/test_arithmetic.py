"""What enters a run goes without BLAS, LAPACK and NumPy's functions for one processor: core/arithmetic has them."""

from __future__ import annotations

import ast
from pathlib import Path

from parsed import tree

PACKAGE = Path(__file__).resolve().parents[2] / "dem_cli"
# Rooms that only show, write for others or measure, and the one that replaces what is forbidden.
FREE = {
    "core/arithmetic", "app/cli", "masonry/exports", "results/post", "results/render", "results/report",
    "app/verify", "core/kernels",
}  # fmt: skip
FUNCTIONS = {
    "arccos", "arccosh", "arcsin", "arcsinh", "arctan", "arctan2", "arctanh", "cbrt", "cosh", "exp", "exp2", "expm1",
    "float_power", "geomspace", "log", "log10", "log1p", "log2", "logaddexp", "logspace", "power", "sinh", "tan",
    "tanh",
}  # fmt: skip
PRODUCTS = {
    "convolve", "correlate", "cov", "corrcoef", "dot", "inner", "matmul", "polyfit", "tensordot", "vdot", "vecdot",
    "matvec", "vecmat",
}  # fmt: skip
IN_LINALG = {"norm", "LinAlgError"}  # norm: along an axis
EXEMPT = {  # file and name: why
    ("core/dynamics/frequencies.py", "np.linalg.eigh"): "rounded where they leave it",
    ("core/dynamics/frequencies.py", "scipy.sparse.linalg"): "rounded where they leave it",
    ("core/limit/sparse_factors.py", "scipy.sparse.linalg"): "for the order of elimination alone",
    ("core/motion/synthetic.py", "np.exp"): "of complex numbers: by the C library",
    ("core/dynamics/vibration_error.py", "np.exp"): "of complex numbers: by the C library",
}
SPARSE = {  # files with `@` of sparse matrices, which SciPy adds up itself
    "core/dynamics/frequencies.py", "core/dynamics/rocking_stiffness.py", "core/engine/rigid_joints.py",
    "core/limit/associated.py", "core/limit/collapse_states.py", "core/limit/cone.py", "core/limit/elastic.py",
    "core/limit/frontal_program.py", "core/limit/interior.py", "core/limit/joint_forces.py", "core/limit/matrices.py",
    "core/limit/program.py", "core/limit/snapshot.py", "core/links/tension_points.py",
}  # fmt: skip
SOURCES = sorted(
    path for path in PACKAGE.rglob("*.py") if not any(path.is_relative_to(PACKAGE / room) for room in FREE)
)


def forbidden(module: ast.Module) -> set[str]:
    """Names that give other last digits on other processors, and `@`."""
    found = set()
    for node in ast.walk(module):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            found.add("@")
        elif isinstance(node, ast.ImportFrom) and node.module in ("scipy.linalg", "scipy.sparse.linalg"):
            found.add(node.module)
        elif isinstance(node, ast.Attribute):
            room, name = ast.unparse(node.value), node.attr
            wrong = name in FUNCTIONS | PRODUCTS if room == "np" else room == "np.linalg" and name not in IN_LINALG
            found |= {f"{room}.{name}"} if wrong else set()
        elif isinstance(node, ast.Call) and ast.unparse(node.func) == "np.linalg.norm":
            found |= set() if any(word.arg == "axis" for word in node.keywords) else {"np.linalg.norm without an axis"}
    return found


def test_nothing_depends_on_the_processor():
    wrong = {}
    for path in SOURCES:
        name = path.relative_to(PACKAGE).as_posix()
        allowed = {what for file, what in EXEMPT if file == name} | ({"@"} if name in SPARSE else set())
        found = forbidden(tree(path)) - allowed
        wrong |= {name: sorted(found)} if found else {}
    assert not wrong, f"use dem_cli/core/arithmetic in the place of {wrong}"


def test_the_tables_name_nothing_that_is_gone():
    for name in SPARSE | {file for file, _ in EXEMPT}:
        found = forbidden(tree(PACKAGE / name))
        assert found >= {what for file, what in EXEMPT if file == name} | ({"@"} if name in SPARSE else set()), name
