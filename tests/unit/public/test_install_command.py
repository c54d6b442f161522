"""What installs an optional part: dem is in no index, so the advice names the folder that it came from."""

from __future__ import annotations

import json
import pickle
import shlex
from pathlib import Path

import pytest

from dem_cli import version
from dem_cli.errors import MissingExtra, UsageError

ROOT = Path(__file__).resolve().parents[3]


class Installed:
    """A distribution that was installed from somewhere."""

    def __init__(self, url):
        self.url = url

    def read_text(self, name):
        assert name == "direct_url.json"
        return None if self.url is None else json.dumps({"url": self.url, "dir_info": {}})


def test_of_the_checkout_that_dem_runs_in():
    words = shlex.split(version.install_command("plot"))
    assert words == ["pip", "install", f"{ROOT}[plot]"]


@pytest.mark.parametrize("there", [True, False])
def test_of_the_checkout_that_dem_was_installed_from(tmp_path, monkeypatch, there):
    checkout = tmp_path / "my dem"
    checkout.mkdir()
    if there:
        (checkout / "pyproject.toml").touch()
    monkeypatch.setattr(version, "_HERE", tmp_path)
    monkeypatch.setattr("importlib.metadata.distribution", lambda name: Installed(checkout.as_uri()))
    found = version.install_command("viz")
    assert found == (f"pip install '{checkout}[viz]'" if there else "pip install '.[viz]' in the folder of dem")


def test_of_no_checkout(tmp_path, monkeypatch):
    monkeypatch.setattr(version, "_HERE", tmp_path)
    monkeypatch.setattr("importlib.metadata.distribution", lambda name: Installed(None))
    assert version.install_command("viz") == "pip install '.[viz]' in the folder of dem"


def test_an_error_that_comes_from_another_process():
    error = MissingExtra("drawing needs matplotlib", "plot")
    again = pickle.loads(pickle.dumps(error))
    assert isinstance(again, UsageError)
    assert str(again) == str(error) == f"drawing needs matplotlib: pip install '{ROOT}[plot]'"


def test_no_message_names_an_index():
    """`pip install dem-cli` finds nothing, or something that is not ours."""
    pages = [*(ROOT / "dem_cli").rglob("*.py"), *(ROOT / "dem_cli").rglob("*.html"), *(ROOT / "docs").rglob("*.md")]
    named = [p.name for p in [*pages, ROOT / "README.md"] if "install dem-cli" in p.read_text(encoding="utf-8")
             or "install 'dem-cli" in p.read_text(encoding="utf-8")]  # fmt: skip
    assert not named
