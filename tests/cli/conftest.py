"""What tests of pages share: a folder of one's own on a machine of one core, and whether it can render."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

ASK = "from dem_cli.render.opengl import choose_window; import pyvista; choose_window()"


@pytest.fixture
def one_core(tmp_path, monkeypatch):
    """Commands that use all cores use one: starting more costs more than the runs that pages show."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr("dem_cli.pipeline.batches.usable_cores", lambda: 1)


@pytest.fixture(scope="session")
def can_render() -> bool:
    """Whether pictures can be rendered; continuous integration has what is needed."""
    asked = subprocess.run([sys.executable, "-c", ASK], capture_output=True, text=True)
    if asked.returncode and os.environ.get("CI"):
        pytest.fail(f"no graphics libraries: {asked.stderr[-300:]}")
    return not asked.returncode
