"""`import dem_cli` is fast: what is public is loaded when it is used."""

from __future__ import annotations

import subprocess
import sys

import pytest

import dem_cli

HEAVY = ("numpy", "h5py", "numba", "scipy", "pydantic", "click", "rich", "matplotlib", "typing", "dem_cli.app.api")


def modules_after(code: str) -> set[str]:
    """Modules that a fresh interpreter has loaded after some code, without those of its own start."""
    program = f"import sys; before = set(sys.modules)\n{code}\nprint(*sorted(set(sys.modules) - before))"
    return set(
        subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout.split()
    )


def test_importing_loads_nothing_heavy():
    loaded = modules_after("import dem_cli; dem_cli.__version__; dir(dem_cli); dem_cli.__all__")
    assert not loaded & set(HEAVY)
    assert {name for name in loaded if name.startswith("dem_cli")} == {"dem_cli", "dem_cli.version"}


def test_loading_a_case_needs_no_solver():
    assert "dem_cli.app.cli" not in modules_after("import dem_cli; dem_cli.load")
    assert not modules_after("import dem_cli; dem_cli.run") & {"click", "rich", "numba", "matplotlib"}


def test_what_is_public():
    assert set(dem_cli.__all__) <= set(dir(dem_cli))
    assert all(getattr(dem_cli, name) is not None for name in dem_cli.__all__)
    assert dem_cli.run is dem_cli.run
    with pytest.raises(AttributeError, match=r"no attribute 'rnu' \(public: "):
        dem_cli.rnu  # noqa: B018
