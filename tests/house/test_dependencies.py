"""pyproject.toml lists what is imported and nothing else; constraints.txt pins all of it."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from pathlib import Path

from parsed import nodes

from dem_cli.version import __version__

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
IMPORT_NAMES = {  # distribution: how it is imported
    "vtk": "vtkmodules", "box2d": "Box2D", "pillow": "PIL", "mujoco-core": "mujoco",
}  # fmt: skip
OF_OTHERS = {"llvmlite"}  # numba names the one version of it that it works with
TOOLS = {"mypy", "pytest-timeout", "pytest-xdist", "ruff", "furo", "myst-parser", "sphinx"}  # run, not imported
EXTRA_OF = {  # may be absent
    "pymunk": "bench", "box2d": "bench", "mujoco-core": "bench",
    "compas_cra": "bench", "ezdxf": "import", "svgelements": "import",
    "imageio-ffmpeg": "movie", "dask": "cluster",
}  # fmt: skip


def names(requirements: list[str]) -> set[str]:
    found = {re.split(r"[\s<>=!;\[]", text, maxsplit=1)[0].lower() for text in requirements}
    return found - {PROJECT["name"]}


def imported(*folders: str) -> set[str]:
    """Top-level modules that are neither the standard library nor ours."""
    ours = {"dem_cli", *(path.stem for own in ("tests", "scripts") for path in (ROOT / own).iterdir())}
    found = set()
    for folder in folders:
        for path in (ROOT / folder).rglob("*.py"):
            for node in nodes(path):
                if isinstance(node, ast.Import):
                    found |= {alias.name.split(".")[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and node.module:
                    found.add(node.module.split(".")[0])
    return found - set(sys.stdlib_module_names) - ours - OF_OTHERS


def modules(distributions: set[str]) -> set[str]:
    return {IMPORT_NAMES.get(name, name.replace("-", "_")) for name in distributions - TOOLS}


CORE = names(PROJECT["dependencies"])
EVERY = CORE.union(*map(names, PROJECT["optional-dependencies"].values()))


def test_the_package_imports_what_it_declares():
    assert imported("dem_cli") - modules(set(EXTRA_OF)) == modules(CORE)


def test_extras_are_used():
    for distribution, extra in EXTRA_OF.items():
        assert distribution in names(PROJECT["optional-dependencies"][extra])
    assert imported("dem_cli", "scripts", "tests") == modules(EVERY)


def test_the_citation_is_of_this_version_and_these_authors():
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    found = dict(line.split(": ", 1) for line in lines if re.match(r"[a-z-]+: ", line))
    assert (found["cff-version"], found["type"]) == ("1.2.0", "software")
    assert (found["version"], found["license"]) == (__version__, PROJECT["license"])
    assert f"\n## {__version__} - {found['date-released'].strip(chr(34))}\n" in (ROOT / "CHANGELOG.md").read_text()
    assert [line.strip() for line in lines if "- name: " in line] == [f"- name: {PROJECT['authors'][0]['name']}"]


def test_everything_declared_is_pinned():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    assert {line.split("==")[0].lower() for line in lines} >= EVERY
