"""Imports point one way: each room of dem_cli imports those named here, itself and errors; no file is on a circle."""

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
    "app.cli": ANYTHING,
    "app.api": {
        "analyses.registry",
        "masonry.assembly",
        "app.calibrate.table",
        "case",
        "core.laws.registry",
        "core.links.registry",
        "core.model",
        "masonry.structures.registry",
        "case.tables",
    },
    "app.public": {
        "core.records",
        "app.api",
        "case",
        "core.model.model",
        "results.output",
        "app.pipeline",
        "results.post.run_columns",
        "results.post.labels",
        "results.report.notebook",
    },
    "app.pipeline": {
        "core.records",
        "analyses.solve",
        "app.api",
        "case",
        "core.contact.drawn_joints",
        "core.engine.threads.crew",
        "analyses.ensembles.batch",
        "core.model.model",
        "results.output",
        "app.sweep.identity",
        "app.sweep.run",
    },
    "app.verify": {"case", "results.output.reference", "results.output.scalars"},
    "app.sweep": {"app.api", "case", "results.output"},
    "results.report": {
        "core.geometry",
        "core.model",
        "results.output",
        "results.post",
        "results.render.chamfered",
        "results.render.solids",
        "core.records",
    },
    "results.render": {"core.geometry", "core.model", "results.output", "results.post", "core.records"},
    "results.post": {"core.geometry", "core.model", "core.motion", "results.output", "core.records"},
    "analyses": {
        "masonry.assembly.ground_motions",
        "masonry.assembly.solver_request",
        "case.schema",
        "core.code_checks",
        "core.dynamics",
        "core.failure_search",
        "core.engine",
        "analyses.ensembles",
        "core.geometry",
        "core.laws",
        "core.limit",
        "core.links",
        "core.model",
        "core.motion",
        "results.output.distinct_names",
        "core.records",
        "core.statics",
        "case.tables",
    },
    "analyses.ensembles": {
        "core.geometry",
        "masonry.assembly",
        "case.schema",
        "case.variation",
        "core.dynamics",
        "core.engine",
        "core.laws",
        "core.limit",
        "core.model",
        "core.motion",
        "core.records",
        "core.statics",
        "case.tables",
    },
    "core.dynamics": {
        "core.contact",
        "core.engine",
        "core.geometry",
        "core.kernels.records",
        "core.links",
        "core.model",
        "core.motion",
        "core.records",
        "core.statics",
    },
    "core.statics": {
        "core.contact.joints",
        "core.engine",
        "core.geometry",
        "core.kernels.records",
        "core.laws.envelope",
        "core.limit",
        "core.model.scales",
        "core.records",
    },
    "core.engine": {
        "core.contact",
        "frozen_records",
        "core.geometry",
        "core.kernels",
        "core.laws",
        "core.limit.settings",
        "core.links",
        "core.model",
        "core.records",
    },
    "core.limit": {
        "core.contact",
        "frozen_records",
        "core.geometry",
        "core.kernels.jit",
        "core.kernels.records",
        "core.laws",
        "core.links",
        "core.model",
        "core.records",
    },
    "masonry.assembly": {
        "case",
        "core.contact",
        "core.geometry",
        "core.links",
        "core.model",
        "core.motion",
        "core.records.requests",
        "masonry.structures",
        "case.tables",
    },
    "core.contact": {"core.geometry", "core.kernels", "core.model", "core.records"},
    "masonry.structures": {"case.base", "case.named_file", "core.geometry", "masonry.imports", "core.model.blocks"},
    "masonry.exports": {"case.schema", "core.geometry", "core.model", "results.output"},
    "masonry.imports": {"core.contact.near_boxes", "core.geometry"},
    "core.laws": {"core.kernels"},
    "core.links": {"core.kernels"},
    "case.tables": {
        "case.base",
        "case.named_file",
        "case.selection",
        "case.vector",
        "core.motion",
        "core.records.requests",
    },
    "core.code_checks": {"core.motion.eurocode"},
    "core.motion": set(),
    "app.calibrate": {"case.base", "case.schema", "core.laws", "results.output.csv_cells", "case.tables.declared"},
    "core.model": {"core.geometry"},
    "core.records": {"frozen_records", "core.geometry", "core.laws.stiffness", "core.model.model"},
    "results.output": {"core.geometry", "core.model", "core.records"},
    "core.arithmetic": {"core.kernels.jit"},
    "case": set(),
    "core.geometry": set(),
    "core.kernels": set(),
    "declarations": set(),
    "analysis_kinds": set(),
    "errors": set(),
    "input_limits": set(),
    "frozen_records": set(),
    "interrupts": set(),
    "late_modules": set(),
    "registration": set(),
    "core": {"core"},
    "masonry": set(),
    "results": set(),
    "app": set(),
    "__init__": {"app.public"},
    "version": set(),
    "__main__": {"app.cli"},
}
FOR_ALL = {"analysis_kinds",   # every room may have them
    "core.arithmetic", "declarations", "errors", "input_limits", "interrupts", "registration", "version"
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
    "clarabel": {"core.limit"},
    "click": {"app.cli"},
    "rich": {"app.cli"},
    "h5py": {"results.output", "results.post"},
    "meshio": {"masonry.imports", "results.output", "app.cli"},
    "ezdxf": {"masonry.exports", "masonry.imports"},
    "svgelements": {"masonry.imports"},
    "jinja2": {"results.report"},
    "matplotlib": {"results.post", "results.render"},
    "PIL": {"results.post", "results.render"},
    "dask": {"app.sweep"},
    "pymunk": set(),  # of scripts/bench alone, as the next three
    "Box2D": set(),
    "mujoco": set(),
    "compas_cra": set(),
    "pyvista": {"results.render"},
    "imageio_ffmpeg": {"results.render"},
    "numba": {"core.kernels"},
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


def room(path: Path) -> str:
    """The room that a file is in: the longest name of the table that it begins with."""
    name = dotted(path)
    return max((of for of in ALLOWED if within(name, {of})), key=len, default=name)


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
    package = room(path)
    assert package in ALLOWED, f"package {package} is not in the table of this test"
    allowed = ALLOWED[package]
    if allowed is ANYTHING:
        return
    own = {name.removeprefix("dem_cli.") for name in imported(path) if name.startswith("dem_cli.")}
    wrong = {name for name in own if not within(name, allowed | {package} | FOR_ALL)}
    assert not wrong, f"{dotted(path)} must not import {sorted(wrong)}"


@pytest.mark.parametrize("path", MODULES, ids=dotted)
def test_third_parties_stay_where_they_belong(path):
    package = room(path)
    for name in imported(path):
        top = name.split(".")[0]
        assert package in ONLY_HERE.get(top, {package}), f"{dotted(path)} imports {name}"
        if package == "core.kernels" and top != "dem_cli":
            assert top in IN_KERNELS or path.name in AT_THE_DOOR, f"{dotted(path)} imports {name}"


def test_the_table_names_no_dead_package():
    existing = {room(path) for path in MODULES} | {"__init__"}
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
        used.setdefault(room(path), set()).update(names)
    dead = {
        package: gone
        for package, allowed in ALLOWED.items()
        if (gone := {a for a in allowed or () if not any(within(name, {a}) for name in used[package])})
    }
    assert not dead


def test_packages_import_nothing():
    """Every import of a file runs the __init__.py of its package: what that imports would be on a circle unseen."""
    doors = {PACKAGE, PACKAGE / "core"}  # which import what is asked for, when it is
    inits = [path for path in MODULES if path.name == "__init__.py" and path.parent not in doors]
    assert not [dotted(path) for path in inits if imported(path)]


def test_no_room_is_crowded():
    sizes: dict[str, int] = {}
    for path in MODULES:
        if path.name != "__init__.py" and path.parent != PACKAGE:
            room = str(path.parent.relative_to(PACKAGE))
            sizes[room] = sizes.get(room, 0) + 1
    assert not {room: n for room, n in sizes.items() if n >= LARGEST}
