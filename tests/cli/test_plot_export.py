"""`dem plot` and `dem export` on the results of a made-up run."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from synthetic import history_rows, wall_frames, wall_model, wall_summary

from dem_cli.app.cli.main import main
from dem_cli.results.output.store import ResultWriter

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def folder(tmp_path):
    target = tmp_path / "out"
    target.mkdir()
    frames = wall_frames(wall_model(), 4)
    writer = ResultWriter(target, wall_model(), "", {}, ["top"])
    for row in history_rows(frames):
        writer.row(row)
    for frame in frames:
        writer.frame(frame)
    writer.close(wall_summary())
    return target


def dem(*arguments):
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    return result.exit_code, result.output


def is_png(path):
    return path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_plot(folder, tmp_path):
    pytest.importorskip("matplotlib")
    code, output = dem("plot", folder, "-o", tmp_path / "pictures")
    assert code == 0
    names = ("capacity.png", "collapse.png", "energy.png")
    assert output.splitlines() == [str(tmp_path / "pictures" / name) for name in names]
    assert all(is_png(tmp_path / "pictures" / name) for name in names)


def test_plot_of_an_unfinished_run(folder):
    pytest.importorskip("matplotlib")
    (folder / "summary.json").unlink()
    assert dem("plot", folder)[0] == 0
    assert is_png(folder / "collapse.png")


def test_plot_without_matplotlib(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    code, output = dem("plot", folder)
    assert (code, output) == (2, f"error: drawing needs matplotlib: pip install '{ROOT}[plot]'\n")


@pytest.mark.parametrize("command", [("plot",), ("export", "--pvd")])
def test_no_results(tmp_path, command):
    code, output = dem(*command, tmp_path)
    assert (code, output) == (2, f"error: {tmp_path}: holds no results of dem run (no results.h5)\n")


def test_export(folder):
    code, output = dem("export", folder, "--pvd")
    assert code == 0
    assert output.splitlines() == [str(folder / "pvd" / "blocks.pvd"), str(folder / "pvd" / "contacts.pvd")]
    assert len(list((folder / "pvd").iterdir())) == 10


def test_export_needs_a_format(folder):
    assert dem("export", folder) == (2, "error: say which format is wanted: --joints or --pvd\n")
