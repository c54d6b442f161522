"""What tests of pages share: a folder of one's own on a machine of one core, a browser, reports to open in it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from click.testing import CliRunner
from shown.browser import chromium
from shown.opened import Opened
from synthetic.pages import evil, sweep, wall
from synthetic.shaking import write_shaking
from synthetic.solid_runs import solid_frames, solid_wall, write_solid_run
from synthetic.tumbling import write_shaken_column

from dem_cli.app.cli.main import main

ASK = "from dem_cli.results.render.opengl import choose_window; import pyvista; choose_window()"


@pytest.fixture
def one_core(tmp_path, monkeypatch):
    """Commands that use all cores use one: starting more costs more than the runs that pages show."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr("dem_cli.app.pipeline.batches.usable_cores", lambda: 1)


@pytest.fixture(scope="session")
def can_render() -> bool:
    """Whether pictures can be rendered; continuous integration has what is needed."""
    asked = subprocess.run([sys.executable, "-c", ASK], capture_output=True, text=True)
    if asked.returncode and os.environ.get("CI"):
        pytest.fail(f"no graphics libraries: {asked.stderr[-300:]}")
    return not asked.returncode


@pytest.fixture(scope="session")
def browser():
    """One Chromium, cut off from the network, for all tests that open a page."""
    with chromium() as session:
        session.execute_cdp_cmd("Network.enable", {})
        offline = {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
        session.execute_cdp_cmd("Network.emulateNetworkConditions", offline)
        yield session


@pytest.fixture(scope="session")
def pages(tmp_path_factory):
    """Reports by name, each written once."""
    root = tmp_path_factory.mktemp("pages")
    (root / "shaken").mkdir()
    solid = solid_wall(3, 2)
    folders = {
        "wall": wall(root / "wall"),
        "evil": evil(root / "evil"),
        "sweep": sweep(root / "sweep"),
        "shaken": write_shaking(root / "shaken"),
        "solid": write_solid_run(root / "solid", solid, solid_frames(solid)),
        "tumbling": write_shaken_column(root / "tumbling", 60),
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "matplotlib", None)  # still pictures are not the point here
        for folder in folders.values():
            assert CliRunner().invoke(main, ["report", str(folder)]).exit_code == 0
    return folders


@pytest.fixture
def opened(browser, pages):
    """Opens a report by its name."""
    return lambda name: Opened(browser, pages[name])
