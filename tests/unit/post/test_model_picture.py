"""Pictures of a model before a run: where arrows of loads are, and that every case can be drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from synthetic.spatial_case import spatial_case

from dem_cli.app.cli.main import main
from dem_cli.masonry.assembly.assemble import assemble
from dem_cli.results.post.scene.axonometry import AS_BEST
from dem_cli.results.post.scene.drawing import drawing_of
from dem_cli.results.post.scene.model_picture import DEAD, LIVE, ModelFacts, _forces

ROOT = Path(__file__).resolve().parents[3]
BLOCKS = [
    {"id": "ground", "polygon": [[0.0, -1.0], [2.0, -1.0], [2.0, 0.0], [0.0, 0.0]], "y": [0.0, 1.0], "fixed": True},
    {"id": "block", "polygon": [[0.5, 0.0], [1.5, 0.0], [1.5, 3.0], [0.5, 3.0]], "y": [0.0, 1.0]},
]


def test_an_arrow_ends_on_the_line_along_which_its_force_acts():
    at, force = np.array([1.5, 0.25, 2.75]), np.array([-300.0, 0.0, -400.0])
    loads = [
        {"block": "block", "force": force.tolist(), "at": at.tolist()},
        {"block": "block", "force": [0.0, 50.0, 0.0], "at": [1.0, 0.0, 3.0], "kind": "live"},
    ]
    analysis = {"kind": "pushover", "pattern": "live"}
    model = assemble(spatial_case(block=BLOCKS, load=loads, analysis=analysis))
    drawing = drawing_of(model, None, AS_BEST)
    arrows = _forces(model, ModelFacts("", [], 9.81), drawing, reach=1.0)
    assert [colour for _, _, colour in arrows] == [DEAD, LIVE]
    for (tail, tip, _), place, along in zip(arrows, (at, (1.0, 0.0, 3.0)), (force, np.array([0.0, 1.0, 0.0]))):
        flat = drawing.flat(np.array([place, np.array(place) + along]))
        way = (flat[1] - flat[0]) / np.linalg.norm(flat[1] - flat[0])
        assert (tip - tail) / np.linalg.norm(tip - tail) == pytest.approx(way)
        off = tip - flat[0]
        assert off[0] * way[1] - off[1] * way[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("cases/verification/wall_21.toml", ()),
        ("dem_cli/app/cli/templates/retaining.toml", ()),
        ("dem_cli/app/cli/templates/shaken.toml", ()),
        ("dem_cli/app/cli/templates/import.toml", ("--azimuth", "200", "--elevation", "40")),
    ],
)
def test_dem_check_draws_any_case(tmp_path, case, words):
    picture = tmp_path / "model.png"
    result = CliRunner().invoke(main, ["check", str(ROOT / case), "-o", str(picture), *words])
    assert result.exit_code == 0, result.output
    assert result.stdout.endswith(f"{picture}\n")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_picture_is_called_as_the_case(tmp_path):
    (tmp_path / "mine.toml").write_text((ROOT / "cases/verification/wall_21.toml").read_text())
    result = CliRunner().invoke(main, ["check", str(tmp_path / "mine.toml"), "--plot"])
    assert (result.exit_code, (tmp_path / "mine.png").is_file()) == (0, True)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-o", "x.jpg"], "x.jpg"),
        (["--plot", "--azimuth", "30"], "this one lies in the plane"),
        (["--azimuth", "30"], "--azimuth and --elevation are for --plot"),
    ],
)
def test_what_cannot_be_drawn_is_refused(words, message):
    result = CliRunner().invoke(main, ["check", str(ROOT / "cases/verification/wall_21.toml"), *words])
    assert result.exit_code == 2
    assert message in result.stderr
