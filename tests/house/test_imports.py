"""Dependencies point one way. Each package of dem_cli may import the ones named here, itself and errors."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "dem_cli"

ANYTHING = None
ALLOWED: dict[str, set[str] | None] = {
    "cli": ANYTHING,
    "bench": {"api", "case", "contact", "kernels", "laws", "limit", "model", "output", "post", "solve"},
    "api": {"case", "model", "structures", "laws", "solve", "output.record", "calibrate.table", "motion"},
    "pipeline": {"api", "case", "model.model", "output", "solve.run", "solve.batch", "sweep.identity", "sweep.run"},
    "public": {"api", "case", "model.model", "output", "pipeline", "post.columns", "post.labels"},
    "verify": {"case", "output.reference", "output.summary"},
    "case": {"case"},
    "sweep": {"api", "case", "output", "kernels.jit"},
    "report": {"model", "output", "post"},
    "post": {"output", "model", "motion"},
    "output": {"model"},
    "motion": {"case.base", "case.schema"},
    "solve": {
        "motion",
        "limit",
        "contact",
        "model",
        "geometry",
        "laws",
        "kernels",
        "output.record",
        "case.base",
        "case.schema",
        "case.vary",
    },
    "calibrate": {"laws", "case.base", "case.schema"},
    "limit": {"contact", "model", "geometry", "laws", "kernels", "output.record", "case.schema"},
    "contact": {"model", "geometry", "kernels"},
    "model": {"structures", "geometry", "contact", "case"},
    "structures": {"geometry", "model.blocks", "case.base"},
    "laws": {"kernels", "case.base"},
    "geometry": set(),
    "kernels": set(),
    "errors": set(),
    "__init__": {"public"},
    "__main__": {"cli"},
}
IN_KERNELS = {"numba", "numpy", "math", "__future__", "collections", "typing"}
ONLY_HERE = {  # third parties that stay in the packages named
    "clarabel": {"limit"},
    "click": {"cli"},
    "rich": {"cli"},
    "h5py": {"output", "post"},
    "meshio": {"output", "cli"},
    "jinja2": {"report"},
    "matplotlib": {"post"},
    "PIL": {"post"},
    "dask": {"sweep"},
    "pymunk": {"bench"},
    "Box2D": {"bench"},
    "pyvista": {"post"},
    "imageio_ffmpeg": {"post"},
    "numba": {"kernels"},
    "tomli": {"case"},
    "tomllib": {"case"},
    "tomli_w": {"case"},
}

MODULES = sorted(PACKAGE.rglob("*.py"))


def dotted(path: Path) -> str:
    """dem_cli/analyses/gravity.py -> solve.gravity; the package's own __init__ keeps that name."""
    name = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
    return name.removesuffix(".__init__")


def imported(path: Path) -> set[str]:
    """Every module that a file imports, at any depth, `from x import y` as x.y."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def within(name: str, allowed: set[str]) -> bool:
    return any(name == a or name.startswith(a + ".") for a in allowed)


@pytest.mark.parametrize("path", MODULES, ids=dotted)
def test_only_the_arrows_of_the_house(path):
    package = dotted(path).split(".")[0]
    assert package in ALLOWED, f"package {package} is not in the table of this test"
    allowed = ALLOWED[package]
    if allowed is ANYTHING:
        return
    own = {name.removeprefix("dem_cli.") for name in imported(path) if name.startswith("dem_cli.")}
    wrong = {name for name in own if not within(name, allowed | {package, "errors", "__version__"})}
    assert not wrong, f"{dotted(path)} must not import {sorted(wrong)}"


@pytest.mark.parametrize("path", MODULES, ids=dotted)
def test_third_parties_stay_where_they_belong(path):
    package = dotted(path).split(".")[0]
    for name in imported(path):
        top = name.split(".")[0]
        assert package in ONLY_HERE.get(top, {package}), f"{dotted(path)} imports {name}"
        if package == "kernels" and top != "dem_cli":
            assert top in IN_KERNELS or path.name == "jit.py", f"{dotted(path)} imports {name}"


def test_the_table_names_no_dead_package():
    existing = {dotted(p).split(".")[0] for p in MODULES} | {"__init__"}
    assert set(ALLOWED) <= existing, f"gone: {sorted(set(ALLOWED) - existing)}"
