"""The storey of the solvers stands alone: nothing of it imports case files, results or what is above, for types alone
neither; and in a fresh interpreter it loads no library of theirs.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

from parsed import nodes, tree

PACKAGE = Path(__file__).resolve().parents[2] / "dem_cli"
CORE = PACKAGE / "core"
BELOW = {"declarations", "errors", "frozen_records", "input_limits", "interrupts", "late_modules", "registration",
         "version"}  # fmt: skip
LEFT: set[tuple[str, str]] = set()  # arrows that still lead out: this list only gets shorter
ABOVE = ("pydantic", "h5py", "click", "rich", "matplotlib")  # libraries of the other storeys


def leaving(path: Path) -> set[str]:
    """What a file imports of the package from outside of this storey, as `room.file`."""
    found = set()
    for node in nodes(path):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "dem_cli":
            whole = node.module.split(".")[1:]
            found |= {".".join(whole)} if whole else {alias.name for alias in node.names}
        elif isinstance(node, ast.Import):
            names = [alias.name.split(".") for alias in node.names]
            found |= {".".join(name[1:]) or "__init__" for name in names if name[0] == "dem_cli"}
    return {name for name in found if name.split(".")[0] not in {"core"} | BELOW}


def test_no_arrow_leads_out_of_the_core():
    found = {(str(path.relative_to(PACKAGE)), name) for path in CORE.rglob("*.py") for name in leaving(path)}
    assert not found - LEFT, f"these lead out: {sorted(found - LEFT)}"
    assert not LEFT - found, f"these are gone: take them off the list: {sorted(LEFT - found)}"


def test_what_is_below_the_core_imports_nothing_above_it():
    assert not {name: above for name in BELOW if (above := leaving(PACKAGE / f"{name}.py"))}


def on_import(path: Path) -> set[Path]:
    """Files of the package that a file imports as it is loaded: not for types alone, and not when a function runs."""
    names = set()
    for node in tree(path).body:
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    files = {PACKAGE.parent / Path(*name.split(".")).with_suffix(".py") for name in names}
    return {file for file in files if PACKAGE in file.parents}


def standing_alone() -> list[str]:
    """Modules of the core that load nothing which leads out of it."""
    files = {path for path in CORE.rglob("*.py") if path.name != "__init__.py"}
    leading_out = {PACKAGE / path for path, _ in LEFT}
    while more := {path for path in files - leading_out if on_import(path) & leading_out}:
        leading_out |= more
    return sorted(".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts) for path in files - leading_out)


def test_no_library_of_another_storey_is_loaded():
    """In a fresh interpreter, with every module of the core that does not lead out of it by the list above."""
    modules = standing_alone()
    assert len(modules) > 100
    loaded = f"print(*sorted(set({ABOVE!r}) & set(sys.modules)))"
    program = f"import sys\nfor name in {modules!r}: __import__(name)\n{loaded}"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.split() == []
