"""`dem run`, `plot`, `report`, `verify` of capacity curves as a user calls them: answer, pictures, check, cycles."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.results.output.reader import read
from dem_cli.results.post.capacity import capacity_axis

BLOCK = """
title = "A block that slides"
[materials.stone]
density = 2000.0
[joints.bed]
friction = 0.6
kn = 8e7
ks = 8e6
points = 5
[[block]]
id = "base"
vertices = [[-2.0, -1.0], [4.0, -1.0], [4.0, 0.0], [-2.0, 0.0]]
fixed = true
[[block]]
id = "block"
vertices = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.1], [0.0, 0.1]]
[analysis]
direction = [-1.0, 0.0]
control = "displacement"
"""
CURVE = """kind = "pushover"
follow = 0.002
increments = 20
loads_at = [0.0001, 0.001, 0.1]
[analysis.idealise]
secant = 0.6
drop = 0.85
[analysis.check]
spectrum = "EC8-1"
soil = "B"
ag = 3.5
[[reference]]
quantity = "capacity_curve"
displacements = [0.0005, 0.001, 0.0015]
value = [0.6, 0.6, 0.6]
"""
CYCLES = """kind = "cycle"
path = [0.001, -0.001, 0.001]
step = 5e-5
"""


def dem(*arguments):
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    return result.exit_code, result.output


def case(tmp_path, text):
    file = tmp_path / "block.toml"
    file.write_text(BLOCK + text, encoding="utf-8")
    return file


def test_a_curve(tmp_path):
    pytest.importorskip("matplotlib")
    file, folder = case(tmp_path, CURVE), tmp_path / "out"
    code, said = dem("run", file, "-o", folder)
    assert code == 0, said
    rows = ("capacity curve peak 0.6000 at", "bilinear       yields at", "N2             T* 0.0314 s")
    for words in (*rows, "– at 100 mm", "reference      curve of 3 points, peak 0.6"):
        assert words in said
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    curve = summary["capacity_curve"]
    assert curve["force_at_load_1"] == pytest.approx(0.2 * 2000.0 * 9.81)
    at = [one["load"] for one in curve["loads_at"]]
    assert at[:2] == pytest.approx([8e6 * 2.0 * 1e-4 / 3924.0, 0.6], rel=5e-3)
    assert at[2] is None
    assert (curve["bilinear"]["secant"], curve["bilinear"]["drop"]) == (0.6, 0.85)
    assert curve["residual_share"] == pytest.approx(1.0, abs=1e-3)
    results = read(folder)
    live = results.history["live_displacement"]
    assert live[0] == 0.0
    assert live[1:] == pytest.approx(curve["displacements"][1:], abs=1e-12)  # positive along the load, to the left
    assert capacity_axis(results).signed
    for command in ("plot", "report"):
        assert dem(command, folder)[0] == 0
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "displacement of the live load" in page
    assert "bilinear system" in page
    assert dem("plot", folder, "-y", "load", "-o", tmp_path / "one.png")[0] == 0
    assert dem("verify", file)[0] == 0


def test_no_period_without_a_stiffness(tmp_path):
    text = (BLOCK + CURVE).replace("kn = 8e7\nks = 8e6\npoints = 5\n", "")
    file = tmp_path / "stiff.toml"
    file.write_text(text, encoding="utf-8")
    said = dem("run", file, "-o", tmp_path / "stiff")[1]
    assert "no check against the spectrum: with kn = 'auto' the period is that of the solver's joints" in said
    assert "elastic part: joints of the solver's choice" in said
    assert "check" not in json.loads((tmp_path / "stiff" / "summary.json").read_text(encoding="utf-8"))


def test_cycles_are_signed(tmp_path):
    folder = tmp_path / "out"
    code, said = dem("run", case(tmp_path, CYCLES), "-o", folder)
    assert code == 0, said
    assert "1 mm at 0.6000, -1 mm at -0.6000, 1 mm at 0.6000" in said
    (loop,) = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["loops"]
    yields = 0.6 * 3924.0 / 16e6
    assert loop["energy"] == pytest.approx(4.0 * 0.6 * 3924.0 * (1e-3 - yields), rel=5e-3)
    assert loop["damping"] == pytest.approx(2.0 / np.pi * (1.0 - yields / 1e-3), rel=5e-3)
    axis = capacity_axis(read(folder))
    assert axis.values.min() == pytest.approx(-1e-3, rel=1e-3)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("control = 'load'\nloads_at = [0.1]", "analysis.loads_at: only allowed with control = 'displacement'"),
        ("control = 'load'\nidealise = { drop = 0.85 }", "analysis.idealise: only allowed with"),
        ("follow = 0.1\npattern = 'tilt'\ncheck = { spectrum = 'EC8-1', soil = 'A', ag = 1.0 }", "only with 'mass'"),
        ("follow = 0.1\ncheck = { spectrum = 'EC8-1', ag = 1.0 }", "analysis.check.soil: missing"),
        ("follow = 0.1\ncheck = { spectrum = [[0.0, 1.0], [1.0, 2.0]] }", "analysis.check.corner: missing"),
        ("follow = 0.1\ncheck = { spectrum = 'EC8-1', soil = 'A', ag = 1.0, confidence = 1.2 }",
         "confidence: only allowed with method = 'mechanism'"),
        ("follow = 0.1\nidealise = { secant = 1.2 }", "analysis.idealise.secant"),
    ],
)  # fmt: skip
def test_what_is_refused(tmp_path, keys, words):
    text = BLOCK.replace('control = "displacement"\n', "" if "control" in keys else 'control = "displacement"\n')
    file = tmp_path / "bad.toml"
    file.write_text(f'{text}kind = "pushover"\n{keys}\n', encoding="utf-8")
    code, said = dem("run", file)
    assert code == 2
    assert words in said
