"""An overturning map as a user makes it: `dem sweep` over amplitude and frequency, then `dem plot`; against Housner."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from casefiles import CASES
from click.testing import CliRunner
from oracle.base_motion import pulse
from oracle.housner import Block, overturns

from dem_cli.app.cli.main import main

AMPLITUDES, FREQUENCIES = (3.5, 6.0), (0.8, 1.4)  # [m/s2], [Hz]; every answer is far from a bound
SECONDS = 3.0


@pytest.fixture(scope="module")
def swept(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("map")
    text = (CASES / "gallery" / "sweeps" / "rocking_pulses.toml").read_text(encoding="utf-8").split("[sweep]")[0]
    lists = f'"motion.amplitude" = {list(AMPLITUDES)}\n"motion.frequency" = {list(FREQUENCIES)}\n'
    (folder / "case.toml").write_text(f"{text}[sweep]\n{lists}", encoding="utf-8")
    words = ["sweep", str(folder / "case.toml"), "-o", str(folder / "out"), "-q", "-j", "1"]
    found = CliRunner().invoke(main, [*words, "--set", f"analysis.duration={SECONDS:g}"])
    assert found.exit_code == 0, found.output
    return folder / "out"


def test_it_is_the_exact_one(swept):
    block = Block(0.5, 2.0)
    with (swept / "sweep.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    found = {(float(row["motion.amplitude"]), float(row["motion.frequency"])): row["collapsed"] for row in rows}
    exact = {(a, f): overturns(block, pulse(a, f), SECONDS) for a in AMPLITUDES for f in FREQUENCIES}
    assert set(exact.values()) == {False, True}
    assert {key: value == "true" for key, value in found.items()} == exact
    assert [row["fallen_blocks.count"] for row in rows] == ["1" if row["collapsed"] == "true" else "" for row in rows]


def test_it_is_drawn_where_nobody_says_how(swept, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    drawn = []
    monkeypatch.setattr("dem_cli.results.post.maps.draw_map", lambda table, x, y, z, *rest: drawn.append((x, y, z)))
    assert CliRunner().invoke(main, ["plot", str(swept), "-o", str(tmp_path / "map.png")]).exit_code == 0
    assert drawn == [("motion.amplitude", "motion.frequency", "collapsed")]
    monkeypatch.undo()
    assert CliRunner().invoke(main, ["plot", str(swept), "-o", str(tmp_path / "map.png")]).exit_code == 0
    assert (tmp_path / "map.png").stat().st_size > 5000
