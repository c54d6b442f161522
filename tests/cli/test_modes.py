"""`dem run`, `dem check`, `dem plot` of a modal analysis."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.results.output.reader import read

CASE = Path(__file__).resolve().parents[2] / "cases" / "validation" / "portal_modes.toml"


def dem(*arguments: str | Path):
    return CliRunner().invoke(main, [str(argument) for argument in arguments], standalone_mode=False)


def test_table_calibration_and_pictures(tmp_path):
    done = dem("run", CASE, "--set", "analysis.measured=10.0", "-o", tmp_path / "out", "-q")
    assert done.exception is None
    summary = read(tmp_path / "out").summary
    for number, frequency in enumerate(summary["frequencies"], start=1):
        assert f"mode {number} " in done.output
        assert f"{frequency:.4g} Hz" in done.output
    stiffness = summary["calibration"]["joints"]["dry"]
    assert f"kn = {stiffness['kn']:.5g}, ks = {stiffness['ks']:.5g}" in done.output
    assert summary["calibration"]["frequencies_tried"][-1] == pytest.approx(10.0, rel=1e-4)
    drawn = dem("plot", tmp_path / "out")
    assert drawn.exception is None
    assert [path.name for path in (tmp_path / "out").glob("*.png")] == ["modes.png"]
    assert dem("run", CASE, "-o", tmp_path / "out", "-q").exception is None  # replaces all that dem wrote


def test_nothing_that_vibrates(tmp_path):
    """A structure of fixed blocks alone."""
    path = tmp_path / "case.toml"
    path.write_text(
        '[materials.m]\ndensity = 2000.0\n[joints.j]\nfriction = 0.6\nkn = 1e9\n[analysis]\nkind = "modes"\n'
        '[[block]]\nid = "a"\nfixed = true\nvertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]\n'
    )
    done = dem("run", path, "-o", tmp_path / "out", "-q")
    assert done.exception is None
    assert "none: no joint holds any block" in done.output


def test_check():
    done = dem("check", CASE)
    assert done.exception is None
    assert "the forces of gravity turn and shift with the blocks" in done.output
