"""Walls that fill an outline: volumes, shared faces, what stands, loads, and what is refused with its name."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError
from synthetic.drawn_elsewhere import elevation_by_ezdxf
from synthetic.skins import free_volume, model_of, open_area

import dem_cli
from dem_cli.core.geometry import polygon
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.sanity import doubts
from dem_cli.masonry.structures.registry import GENERATORS, generated_blocks

THICKNESS = 0.5
COURSES = {"spacing": [0.4, 0.05], "segment": [0.8, 0.3], "deviation": [0.0, 0.04], "head_spacing": [0.6, 0.2]}
WALLS = {
    "blocks": {"kind": "wall", "block": [0.6, 0.3]},
    "flemish": {"kind": "wall", "block": [0.5, 0.21], "bond": "flemish"},
    "rubble": {"kind": "voronoi-wall", "cell": 0.4, "stretch": 1.5, "seed": 3},
    "courses": {"kind": "coursed-wall", "seed": 3} | COURSES,
}
RUIN = {  # a door around which the outline goes, a concave top, a slanted end, a window of six corners
    "points": [
        *([0.0, 0.0], [1.0, 0.0], [1.0, 1.5], [1.8, 1.5], [1.8, 0.0], [5.0, 0.0], [5.2, 2.2], [4.3, 3.1], [3.5, 2.2]),
        *([2.5, 2.2], [2.5, 2.9], [1.9, 3.4], [1.2, 2.9], [0.3, 2.5], [0.0, 2.0]),
    ],
    "holes": [[[3.2, 0.8], [4.1, 0.8], [4.1, 1.2], [3.9, 1.5], [3.4, 1.55], [3.2, 1.2]]],
}
LINTEL = {"lintel": {"height": 0.3, "bearing": 0.3}}
SQUARE = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    file = elevation_by_ezdxf(tmp_path_factory.mktemp("drawn") / "elevation.dxf")
    return {"file": str(file), "layer": "WALL", "openings": "OPENINGS", "chords": 4} | LINTEL


def case(outline: dict, analysis: dict, **keys) -> dict:
    wall = WALLS["blocks"] | {"thickness": THICKNESS, "outline": outline} | keys
    return {
        "materials": {"stone": {"density": 2400.0}},
        "joints": {"dry": {"friction": 0.6}},
        "structure": [wall],
        "analysis": analysis,
    }


def length_around(shape: np.ndarray) -> float:
    return float(np.hypot(*(np.roll(shape, -1, axis=0) - shape).T).sum())


@pytest.mark.parametrize(
    ("of", "name"), [("file", "blocks"), ("file", "rubble"), *(("points", name) for name in WALLS)]
)
def test_in_space_stones_fill_the_outline_and_share_their_faces(drawn, of, name):
    outline = drawn if of == "file" else RUIN
    if of == "file":
        arch = 0.45 * np.array([[np.cos(a), np.sin(a)] for a in np.pi * np.arange(9) / 8.0])
        area = 6.0 * 3.0 + 0.5 * 6.0 * 1.8 - 1.0 * 2.1 - 0.9 * 1.2 - 0.9 * 0.8 - polygon.area(arch)
        rim = 6.0 - 1.0 + 2.0 * 3.0 + 2.0 * np.hypot(3.0, 1.8) + 2.0 * 2.1 + 1.0 + 4.2 + 0.9 + 1.6
        rim += np.hypot(*np.diff(arch, axis=0).T).sum()
        close = 1e-4  # quarters of a circle are Bézier curves
    else:
        whole, hole = np.array(RUIN["points"]), np.array(RUIN["holes"][0])
        area, rim = polygon.area(whole) - polygon.area(hole), length_around(whole) + length_around(hole)
        close = 1e-12
    wall = WALLS[name] | {"thickness": THICKNESS, "outline": outline, "base": False}
    kind = GENERATORS[wall["kind"]].parameters
    face = kind.model_validate(wall).outline.drawn
    exact = polygon.area(face.outline) - sum(polygon.area(each.shape) for each in face.openings)
    model = model_of(wall)
    assert free_volume(model) == pytest.approx(exact * THICKNESS, rel=1e-12)
    assert free_volume(model) == pytest.approx(area * THICKNESS, rel=close)
    assert open_area(model) == pytest.approx(2.0 * area + rim * THICKNESS, rel=max(close, 1e-9))


def test_a_rectangle_as_an_outline_is_the_wall_of_that_size():
    opening = {"x": 0.7, "y": 0.3, "width": 0.6, "height": 0.9} | LINTEL
    corners, hole = [[1.0, 2.0], [4.0, 2.0], [4.0, 4.4], [1.0, 4.4]], [[1.7, 2.3], [2.3, 2.3], [2.3, 3.2], [1.7, 3.2]]
    given = {"courses": 8, "length": 3.0, "openings": [opening]}
    traced = {"outline": {"points": corners, "holes": [hole]} | LINTEL}
    kind = GENERATORS["wall"].parameters
    found = [generated_blocks(kind.model_validate(WALLS["blocks"] | keys), 1) for keys in (given, traced)]
    assert [block.id for block in found[0]] == [block.id for block in found[1]]
    for one, two in zip(*found, strict=True):
        for a, b in zip(one.parts, two.parts, strict=True):
            assert np.abs(a - b).max() < 1e-12


def test_the_drawn_facade_stands_and_falls_below_the_load_of_a_wall_without_openings(drawn):
    assert dem_cli.run(case(drawn, {"kind": "gravity"})).summary["status"] == "ok"
    push = {"kind": "pushover", "direction": [1.0, 0.0], "resolution": 0.02}
    found = dem_cli.run(case(drawn, push)).summary
    blind = dem_cli.run(case({key: drawn[key] for key in ("file", "layer")}, push)).summary
    assert 0.3 < found["failure_load"] < blind["failure_load"] < 0.6
    assert found["failure_load"] <= found["limit_analysis"]["associated"] * 1.001


def test_openings_without_lintel_are_named(drawn):
    made = dem_cli.load(case(drawn, {"kind": "gravity"}))
    found = [doubt for doubt in doubts(made.case, *assembly(made.case)[:2], []) if "neither" in doubt.message]
    assert [doubt.path for doubt in found] == [("structure", 0, "outline")]
    assert "on layer 'OPENINGS' has neither lintel nor arch" in found[0].message


@pytest.mark.parametrize(
    ("outline", "message"),
    [
        ({"points": SQUARE, "file": "a.dxf"}, "either file or points; found both"),
        ({"points": SQUARE, "chords": 2}, "not used with points"),
        ({"file": "a.obj"}, "'.obj' is not a drawing; the file ends in one of .dxf, .svg"),
        ({"file": "nowhere.dxf"}, "no such file"),
        ({"points": [[0, 0], [2, 2], [2, 0], [0, 2]]}, "the outline: its outline crosses or touches itself"),
        ({"points": SQUARE, "holes": [[[1, 1], [3, 1], [3, 1.5]]]}, "holes.0 reaches out of the outline"),
        (
            {"points": SQUARE, "holes": [[[0.5, 1], [1, 1], [1, 1.5]], [[0.7, 1], [1.3, 1], [1, 1.7]]]},
            "holes.1 and holes.0 lie over each other",
        ),
        (
            {"points": SQUARE, "holes": [[[0.5, 1], [1.9, 1], [1.9, 1.5], [0.5, 1.5]]]} | LINTEL,
            r"the lintel of holes.0 would go from \[0.2, 1.5\] to \[2.2, 1.8\], out of the wall",
        ),
    ],
)
def test_outlines_that_cannot_be_a_wall_are_refused(outline, message):
    with pytest.raises(ValidationError, match=message):
        GENERATORS["wall"].parameters.model_validate(WALLS["blocks"] | {"outline": outline})


def test_what_is_wrong_in_a_drawing_is_said_with_its_entity(tmp_path, drawn):
    import ezdxf

    drawing = ezdxf.new(units=6)
    space = drawing.modelspace()
    shapes = {
        "open": ([(0, 0), (6, 0), (6, 3)], False),
        "crossed": ([(0, 0), (6, 0), (0, 3), (6, 3.5)], True),
        "good": ([(0, 0), (6, 0), (6, 3)], True),
        "far": ([(7, 0), (9, 0), (9, 3)], True),
    }
    handles = {}
    for layer, (corners, close) in shapes.items():
        drawing.layers.add(layer)
        entity = space.add_lwpolyline(corners, close=close, dxfattribs={"layer": layer})
        handles[layer] = f"LWPOLYLINE #{entity.dxf.handle}"
    drawing.saveas(tmp_path / "bad.dxf")
    said = {
        ("open", None): f"bad.dxf: layer 'open': {handles['open']} ends at",
        ("crossed", None): f"bad.dxf: {handles['crossed']} on layer 'crossed': its outline crosses or touches itself",
        ("good", "far"): f"{handles['far']} on layer 'far' reaches out of the outline of the wall",
        ("good", ("far", "open")): f"bad.dxf: layer 'open': {handles['open']} ends at",
        ("good", ("good",)): "openings on the layer of the outline need not be named",
        ("god", None): "nothing is drawn on a layer 'god'; layers with something on them: 'open', 'crossed', 'good'",
    }
    for (layer, openings), message in said.items():
        outline = {"file": str(tmp_path / "bad.dxf"), "layer": layer} | ({"openings": openings} if openings else {})
        with pytest.raises(ValidationError, match=message):
            GENERATORS["wall"].parameters.model_validate(WALLS["blocks"] | {"outline": outline})
    for key, value in {"courses": 4, "length": 6.0, "gable": {"height": 1.0}}.items():
        with pytest.raises(ValidationError, match="not used with outline"):
            GENERATORS["wall"].parameters.model_validate(WALLS["blocks"] | {"outline": drawn, key: value})


def test_openings_may_be_drawn_on_several_layers(tmp_path):
    import ezdxf

    drawing = ezdxf.new(units=6)
    for layer, (x0, y0, x1, y1) in {"wall": (0, 0, 6, 3), "doors": (1, 0, 2, 2), "windows": (3, 1, 4, 2)}.items():
        shape = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        drawing.modelspace().add_lwpolyline(shape, close=True, dxfattribs={"layer": layer})
    drawing.saveas(tmp_path / "f.dxf")
    keys = {"file": str(tmp_path / "f.dxf"), "layer": "wall", "openings": ["doors", "windows"]}
    table = GENERATORS["wall"].parameters.model_validate(WALLS["blocks"] | {"outline": keys})
    assert [each.spanned(None).x for each in table.outline.drawn.openings] == [1.0, 3.0]
    keys = {"file": keys["file"], "openings": ["doors", "windows", "arches"]}
    with pytest.raises(ValidationError, match="no closed outline on layer 'arches'; drawn on: 'wall', 'doors', 'windo"):
        GENERATORS["wall"].parameters.model_validate(WALLS["blocks"] | {"outline": keys})


def test_svg_groups_are_layers(tmp_path):
    text = '<svg xmlns="http://www.w3.org/2000/svg"><g id="wall">'
    text += '<path id="w" d="M 0 0 L 4 0 L 4 -3 L 2 -4 L 0 -3 Z"/></g>'
    text += '<g id="holes"><rect id="door" x="1" y="-2" width="1" height="2"/></g><text>a</text></svg>'
    (tmp_path / "f.svg").write_text(text)
    outline = {"file": str(tmp_path / "f.svg"), "layer": "wall", "openings": "holes"} | LINTEL
    table = GENERATORS["wall"].parameters.model_validate(WALLS["blocks"] | {"outline": outline})
    found = {block.id: block for block in generated_blocks(table, 1)}
    assert found["lintel-1"].parts[0].tolist() == [[0.7, 2.0], [2.3, 2.0], [2.3, 2.3], [0.7, 2.3]]
    assert table.outline.unspanned == []


def test_rubble_in_an_outline_is_written_with_its_case():
    """Tables keep arrays of what was drawn beside their keys: those are not compared."""
    from dem_cli.case.writer import effective
    from dem_cli.masonry.structures.patterns.voronoi_wall import VoronoiWall

    given = {
        "kind": "voronoi-wall",
        "cells": 12,
        "outline": {"points": [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 3.0]]},
    }
    table = VoronoiWall.model_validate(given)
    assert table.outline.drawn.size == (4.0, 3.0)
    assert effective(table)["cells"] == 12
