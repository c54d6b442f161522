"""Imports point one way: each package of dem_cli imports those named here, itself and errors; no file a circle."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest
from parsed import nodes

PACKAGE = Path(__file__).resolve().parents[2] / "dem_cli"

ANYTHING = None
ALLOWED: dict[str, set[str] | None] = {
    "cli": ANYTHING,
    "bench": {
        "assembly.solver_request",
        "analyses",
        "api",
        "case",
        "contact",
        "dynamics",
        "engine",
        "kernels",
        "limit.analysis",
        "model",
        "records",
        "output.store",
        "post.style",
    },
    "api": {
        "analyses.registry",
        "assembly",
        "calibrate.table",
        "case",
        "laws.registry",
        "links.registry",
        "model",
        "structures.registry",
        "tables",
    },
    "public": {
        "records",
        "api",
        "case",
        "model.model",
        "output",
        "pipeline",
        "post.run_columns",
        "post.labels",
        "report.notebook",
    },
    "pipeline": {
        "records",
        "analyses.solve",
        "api",
        "case",
        "contact.drawn_joints",
        "engine.threads.crew",
        "ensembles.batch",
        "model.model",
        "output",
        "sweep.identity",
        "sweep.run",
    },
    "verify": {"case", "output.reference", "output.scalars"},
    "sweep": {"api", "case", "output"},
    "report": {"geometry", "model", "output", "post", "render.chamfered", "render.solids", "records"},
    "render": {"geometry", "model", "output", "post", "records"},
    "post": {"geometry", "model", "motion", "output", "records"},
    "analyses": {
        "assembly.ground_motions",
        "assembly.solver_request",
        "case.schema",
        "code_checks",
        "dynamics",
        "engine",
        "ensembles",
        "geometry",
        "laws",
        "limit",
        "links",
        "model",
        "motion",
        "output.distinct_names",
        "records",
        "statics",
        "tables",
    },
    "ensembles": {
        "geometry",
        "assembly",
        "case.schema",
        "case.variation",
        "dynamics",
        "engine",
        "laws",
        "limit",
        "model",
        "motion",
        "records",
        "statics",
        "tables",
    },
    "dynamics": {"contact", "engine", "geometry", "kernels.records", "links", "model", "motion", "records", "statics"},
    "statics": {
        "contact.joints",
        "engine",
        "geometry",
        "kernels.records",
        "laws.envelope",
        "limit",
        "model.scales",
        "records",
    },
    "engine": {
        "contact",
        "frozen_records",
        "geometry",
        "kernels",
        "laws",
        "limit.settings",
        "links",
        "model",
        "records",
    },
    "limit": {
        "contact",
        "frozen_records",
        "geometry",
        "kernels.jit",
        "kernels.records",
        "laws",
        "links",
        "model",
        "records",
    },
    "assembly": {"case", "contact", "geometry", "links", "model", "motion", "records.requests", "structures", "tables"},
    "contact": {"geometry", "kernels", "model", "records"},
    "structures": {"case.base", "case.named_file", "geometry", "imports", "model.blocks"},
    "exports": {"case.schema", "geometry", "model", "output"},
    "imports": {"contact.near_boxes", "geometry"},
    "laws": {"kernels"},
    "links": {"kernels"},
    "tables": {"case.base", "case.named_file", "case.selection", "case.vector", "motion", "records.requests"},
    "code_checks": {"motion.eurocode"},
    "motion": set(),
    "calibrate": {"case.base", "case.schema", "laws", "output.csv_cells", "tables.declared"},
    "model": {"geometry"},
    "records": {"frozen_records", "geometry", "laws.stiffness", "model.model"},
    "output": {"geometry", "model", "records"},
    "arithmetic": {"kernels.jit"},
    "case": set(),
    "geometry": set(),
    "kernels": set(),
    "declarations": set(),
    "errors": set(),
    "input_limits": set(),
    "frozen_records": set(),
    "interrupts": set(),
    "late_modules": set(),
    "registration": set(),
    "__init__": {"public"},
    "version": set(),
    "__main__": {"cli"},
}
FOR_ALL = {  # every room may have them
    "arithmetic", "declarations", "errors", "input_limits", "interrupts", "registration", "version"
}  # fmt: skip
LARGEST = 25  # files of a package, without its __init__.py
IN_KERNELS = {"numba", "numpy", "math", "__future__", "collections", "typing"}
AT_THE_DOOR = {
    "jit.py",
    "machine_code.py",
    "bits.py",
    "door.py",
    "kinds.py",
    "numba_setup.py",
    "plain_numba.py",
    "private_names.py",
    "self_check.py",
    "switch.py",
    "function_copies.py",
    "callees.py",
    "references.py",
    "shortcuts.py",
    "atomics.py",
    "cache_folder.py",
    "compile_time.py",
    "entries.py",
    "kept_code.py",
    "views.py",
}  # of kernels, to numba
ONLY_HERE = {  # third parties that stay in the packages named
    "clarabel": {"limit"},
    "click": {"cli"},
    "rich": {"cli"},
    "h5py": {"output", "post"},
    "meshio": {"imports", "output", "cli"},
    "ezdxf": {"exports", "imports"},
    "svgelements": {"imports"},
    "jinja2": {"report"},
    "matplotlib": {"post", "render"},
    "PIL": {"post", "render"},
    "dask": {"sweep"},
    "pymunk": {"bench"},
    "Box2D": {"bench"},
    "mujoco": {"bench"},
    "compas_cra": {"bench"},
    "pyvista": {"render"},
    "imageio_ffmpeg": {"render"},
    "numba": {"kernels"},
    "tomli": {"case"},
    "tomllib": {"case"},
    "tomli_w": {"case"},
}

MODULES = sorted(PACKAGE.rglob("*.py"))
MODULE_NAME = re.compile(r"dem_cli(\.[a-z_]+)+")


def dotted(path: Path) -> str:
    """dem_cli/analyses/gravity.py -> analyses.gravity; the package's own __init__ keeps that name."""
    name = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
    return name.removesuffix(".__init__")


@cache
def imported(path: Path) -> frozenset[str]:
    """Every module that a file imports or names in a string, at any depth, `from x import y` as x.y."""
    names = set()
    for node in nodes(path):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and MODULE_NAME.fullmatch(node.value):
            names.add(node.value)  # for import_module
    return frozenset(names)


def within(name: str, allowed: set[str]) -> bool:
    return any(name == a or name.startswith(a + ".") for a in allowed)


def arrows() -> dict[str, set[str]]:
    """For each file the files of the package that it imports, at any depth and for types alone as well."""
    names = {dotted(path) for path in MODULES}
    found: dict[str, set[str]] = {}
    for path in MODULES:
        own = {name.removeprefix("dem_cli.") for name in imported(path) if name.startswith("dem_cli.")}
        files = {name if name in names else name.rpartition(".")[0] or "__init__" for name in own}
        found[dotted(path)] = (files & names) - {dotted(path)}
    return found


@pytest.mark.parametrize("path", MODULES, ids=dotted)
def test_only_the_arrows_of_the_house(path):
    package = dotted(path).split(".")[0]
    assert package in ALLOWED, f"package {package} is not in the table of this test"
    allowed = ALLOWED[package]
    if allowed is ANYTHING:
        return
    own = {name.removeprefix("dem_cli.") for name in imported(path) if name.startswith("dem_cli.")}
    wrong = {name for name in own if not within(name, allowed | {package} | FOR_ALL)}
    assert not wrong, f"{dotted(path)} must not import {sorted(wrong)}"


@pytest.mark.parametrize("path", MODULES, ids=dotted)
def test_third_parties_stay_where_they_belong(path):
    package = dotted(path).split(".")[0]
    for name in imported(path):
        top = name.split(".")[0]
        assert package in ONLY_HERE.get(top, {package}), f"{dotted(path)} imports {name}"
        if package == "kernels" and top != "dem_cli":
            assert top in IN_KERNELS or path.name in AT_THE_DOOR, f"{dotted(path)} imports {name}"


def test_the_table_names_no_dead_package():
    existing = {dotted(p).split(".")[0] for p in MODULES} | {"__init__"}
    assert set(ALLOWED) <= existing, f"gone: {sorted(set(ALLOWED) - existing)}"


def test_no_circle_of_files():
    left = arrows()
    while True:  # take away what imports nothing that is left; what stays is on a circle or imports one
        free = {name for name, targets in left.items() if not targets & left.keys()}
        if not free:
            break
        left = {name: targets for name, targets in left.items() if name not in free}
    assert not left, {name: sorted(targets & left.keys()) for name, targets in left.items()}


def test_the_table_names_no_arrow_that_is_gone():
    used: dict[str, set[str]] = {}
    for path in MODULES:
        names = {name.removeprefix("dem_cli.") for name in imported(path)}
        used.setdefault(dotted(path).split(".")[0], set()).update(names)
    dead = {
        package: gone
        for package, allowed in ALLOWED.items()
        if (gone := {a for a in allowed or () if not any(within(name, {a}) for name in used[package])})
    }
    assert not dead


def test_packages_import_nothing():
    """Every import of a file runs the __init__.py of its package: what that imports would be on a circle unseen."""
    inits = [path for path in MODULES if path.name == "__init__.py" and path.parent != PACKAGE]
    assert not [dotted(path) for path in inits if imported(path)]


def test_no_room_is_crowded():
    sizes: dict[str, int] = {}
    for path in MODULES:
        if path.name != "__init__.py" and path.parent != PACKAGE:
            room = str(path.parent.relative_to(PACKAGE))
            sizes[room] = sizes.get(room, 0) + 1
    assert not {room: n for room, n in sizes.items() if n >= LARGEST}
