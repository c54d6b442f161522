"""Structures drawn once: equal tables share what was drawn, another seed or another drawing does not."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.masonry.structures.patterns import voronoi, voronoi_wall
from dem_cli.masonry.structures.patterns.drawn_once import MOST_KEPT, drawn_once
from dem_cli.masonry.structures.patterns.voronoi_wall import VoronoiWall

SVG = '<svg xmlns="http://www.w3.org/2000/svg"><rect x="0" y="0" width="{width}" height="3"/></svg>'


def wall(**more):
    size = {} if "outline" in more else {"size": [4.0, 3.0]}
    return VoronoiWall.model_validate({"cells": 12, "seed": 1} | size | more)


def test_equal_tables_are_drawn_once_and_others_anew():
    drawn = []
    stones = drawn_once(lambda table: drawn.append(table.seed) or len(drawn))
    assert [stones(wall()), stones(wall()), stones(wall(seed=2)), stones(wall(size=[5.0, 3.0])), stones(wall())] == [
        1, 1, 2, 3, 1,
    ]  # fmt: skip
    for seed in range(3, 3 + MOST_KEPT):
        stones(wall(seed=seed))
    assert stones(wall()) == len(drawn) == 4 + MOST_KEPT, "what was drawn long ago is let go"


def test_a_drawing_that_changes_is_drawn_anew(tmp_path):
    drawing = tmp_path / "wall.svg"
    lengths = []
    for width in (4, 6):
        drawing.write_text(SVG.format(width=width))
        table = wall(outline={"file": str(drawing)})
        lengths.append(voronoi_wall.stones(table).corners[:, 0].max())
    assert lengths == pytest.approx([4.0, 6.0])


def test_check_draws_stones_once(tmp_path, monkeypatch):
    drawn, draw = [], voronoi.cells_in
    monkeypatch.setattr(voronoi, "cells_in", lambda *given: drawn.append(1) or draw(*given))
    case = tmp_path / "rubble.toml"
    found = CliRunner().invoke(main, ["new", "voronoi-wall"])
    case.write_text(found.output)
    found = CliRunner().invoke(main, ["check", str(case), "--set", "seed=4711"])
    assert found.exit_code == 0, found.output
    assert "stones of" in found.output
    assert len(drawn) == 1
