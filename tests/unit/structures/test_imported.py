"""kind = "import": what comes out of files of other programs, and what is refused, each with one clear message."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from synthetic.drawn_elsewhere import by_trimesh, facade_by_ezdxf, obj_text, prism, wall_boxes

from dem_cli.case.base import KeyProblem
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.solid_decomposition import volume
from dem_cli.core.model.blocks import corners_of
from dem_cli.masonry.structures.imported import Import, imported

L = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)]
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


def read(path: Path, **keys):
    return imported(Import.model_validate({"kind": "import", "id": "import", "file": str(path), **keys}))


def volumes(blocks) -> dict[str, float]:
    return {block.id: sum(volume(corners_of(part)) for part in block.parts) for block in blocks}


@pytest.fixture(scope="module")
def boxes():
    return wall_boxes(4, 3)


@pytest.mark.parametrize("name", ["w.obj", "w.stl", "w.ply"])
def test_a_wall_by_another_program_comes_back_block_by_block(tmp_path, boxes, name):
    blocks = read(by_trimesh(boxes, tmp_path / name), fixed_below=0.0).blocks
    wanted = sorted(np.prod(np.subtract(high, low)) for _, low, high in boxes)
    assert sorted(volumes(blocks).values()) == pytest.approx(wanted, rel=1e-6)  # single precision, or 8 digits
    assert sum(block.fixed for block in blocks) == 1
    assert all(len(part.vertices) == 8 and len(part.faces) == 6 for block in blocks for part in block.parts)
    if name.endswith("obj"):
        assert {block.id for block in blocks} == {name for name, _, _ in boxes}


def test_neighbours_of_a_rounded_file_lie_on_common_planes(tmp_path, boxes):
    turn = trimesh.transformations.rotation_matrix(0.3, [0.0, 0.0, 1.0])
    rough = {}
    rng = np.random.default_rng(3)
    for name, low, high in boxes:
        mesh = trimesh.creation.box(bounds=[low, high]).apply_transform(turn)
        places = np.round(mesh.vertices + rng.uniform(-4e-5, 4e-5, mesh.vertices.shape), 6)
        rough[name] = (places, mesh.faces.tolist())
    (tmp_path / "rough.obj").write_text(obj_text(rough))
    found = read(tmp_path / "rough.obj", snap=3e-4)
    assert "corners moved onto common planes, by at most" in found.notes[1]
    moved = np.concatenate([block.parts[0].vertices for block in found.blocks])
    back = moved @ turn[:3, :3]
    for axis, step in ((0, 0.2), (1, 0.1), (2, 0.25)):
        levels = np.unique(np.round(back[:, axis] / step))
        off = [np.ptp(back[np.round(back[:, axis] / step) == level, axis]) for level in levels]
        assert max(off) < 4e-4  # outer faces stay as rough as they are
    heads = moved[:, 2]
    for level in (0.25, 0.5, 0.75):  # every bed joint is one plane: both sides are level with the other
        bed = moved[np.abs(heads - level) < 1e-3]
        middle = bed.mean(axis=0)
        normal = np.linalg.svd(bed - middle)[2][-1]
        assert np.abs((bed - middle) @ normal).max() < 1e-12
    far = max(np.linalg.norm(block.parts[0].vertices - rough[block.id][0], axis=1).max() for block in found.blocks)
    assert far < 2e-4


def test_a_soup_in_single_precision_far_from_the_origin_falls_into_its_stones(tmp_path, boxes):
    """Tilted, in STL, all stones touching, coordinates rounded to 2e-6 m: each edge has four faces or more."""
    tilt = trimesh.transformations.euler_matrix(0.2, 0.1, 0.6)
    tilt[:2, 3] = 20.0, 10.0
    meshes = [trimesh.creation.box(bounds=[low, high]).apply_transform(tilt) for _, low, high in boxes]
    trimesh.util.concatenate(meshes).export(tmp_path / "tilted.stl")
    found = read(tmp_path / "tilted.stl")
    assert len(found.blocks) == len(boxes)
    assert "corners moved onto common planes" in found.notes[1]
    wanted = sorted(np.prod(np.subtract(high, low)) for _, low, high in boxes)
    assert sorted(volumes(found.blocks).values()) == pytest.approx(wanted, rel=1e-4)
    back = np.concatenate([block.parts[0].vertices for block in found.blocks]) - tilt[:3, 3]
    heights = (back @ tilt[:3, :3])[:, 2]
    for level in (0.0, 0.25, 0.5, 0.75):
        bed = back[np.abs(heights - level) < 1e-3]
        normal = np.linalg.svd(bed - bed.mean(axis=0))[2][-1]
        assert np.abs((bed - bed.mean(axis=0)) @ normal).max() < 1e-13


def test_what_is_exact_keeps_every_bit(tmp_path):
    x = np.array([0.1, 0.30000000000000004, 1 / 3, 2 / 3, 0.7])
    solids = {
        f"s{i}": prism([(x[i], 0.0), (x[i + 1], 0.0), (x[i + 1], 0.2), (x[i], 0.2)], 0.0, np.pi) for i in range(4)
    }
    (tmp_path / "a.obj").write_text(obj_text(solids))
    found = read(tmp_path / "a.obj")
    assert len(found.notes) == 1
    for block in found.blocks:
        assert np.array_equal(block.parts[0].vertices, solids[block.id][0])


def test_a_drawing_by_hand_gets_common_lines(tmp_path):
    """A course of four stones whose corners miss each other by up to 2 mm; joints are shared afterwards."""
    rng = np.random.default_rng(2)
    rings = [
        np.array([(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 0.5), (x, 0.5)]) + rng.uniform(-1e-3, 1e-3, (4, 2))
        for x in range(4)
    ]
    shapes = "".join(
        f'<polygon id="s{k}" points="{" ".join(f"{x},{-y}" for x, y in ring)}"/>' for k, ring in enumerate(rings)
    )
    (tmp_path / "hand.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg">{shapes}</svg>')
    found = read(tmp_path / "hand.svg", snap=5e-3)
    assert "6 corners moved" in found.notes[1] or "12 corners moved" in found.notes[1]
    for left, right in zip(found.blocks, found.blocks[1:]):
        near = [corner for corner in left.parts[0] if np.abs(corner[0] - right.parts[0][:, 0]).min() < 0.1]
        start, end = sorted((corner.tolist() for corner in near), key=lambda corner: corner[1])
        along = np.subtract(end, start)
        others = right.parts[0][np.abs(right.parts[0][:, 0] - start[0]) < 0.1]
        assert np.abs(polygon.cross(along, others - start)).max() < 1e-12
    before = read(tmp_path / "hand.svg", snap=0)
    assert len(before.notes) == 1
    for block, ring in zip(before.blocks, rings):
        assert np.abs(np.sort(block.parts[0], axis=0) - np.sort(ring, axis=0)).max() < 1e-12


@pytest.mark.parametrize("outline", [L, [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]])
def test_concave_solids_are_refused_with_the_place_or_decomposed_exactly(tmp_path, outline):
    (tmp_path / "l.obj").write_text(obj_text({"corner": prism(outline, 0.0, 0.7), "cube": prism(SQUARE, -1.0, 0.0)}))
    with pytest.raises(KeyProblem, match=r"l.obj: 'corner': it is concave: the corner at \[.*\] lies .* m in front"):
        read(tmp_path / "l.obj")
    blocks = read(tmp_path / "l.obj", concave="decompose").blocks
    area = polygon.area(np.array(outline, float))
    assert volumes(blocks)["corner"] == pytest.approx(0.7 * area, rel=1e-12)
    assert [len(block.parts) for block in blocks] == [2 if len(outline) == 6 else 3, 1]
    places = {tuple(corner) for corner in prism(outline, 0.0, 0.7)[0].tolist()}
    assert places <= {tuple(c) for part in blocks[0].parts for c in part.vertices.tolist()}  # to the last bit


def test_a_frame_with_a_hole_is_decomposed(tmp_path):
    outer = trimesh.creation.box(bounds=[(0, 0, 0), (4, 1, 4)])
    inner = [(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)]
    outer_ring = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]
    points = [(*p, z) for z in (0.0, 1.0) for ring in (outer_ring, inner) for p in ring]
    faces = []
    for i in range(4):
        j = (i + 1) % 4
        faces += [[i, j, 8 + j, 8 + i], [4 + j, 4 + i, 12 + i, 12 + j]]  # outside and inside walls
        faces += [[8 + i, 8 + j, 12 + j, 12 + i], [j, i, 4 + i, 4 + j]]  # top and bottom
    (tmp_path / "frame.obj").write_text(obj_text({"frame": (np.array(points), faces)}))
    (frame,) = read(tmp_path / "frame.obj", concave="decompose").blocks
    assert volumes([frame])["frame"] == pytest.approx(outer.volume - 4.0, rel=1e-12)
    assert len(frame.parts) == 4


def test_a_facade_in_dxf_has_its_layers_units_and_names(tmp_path):
    path = facade_by_ezdxf(tmp_path / "facade.dxf")
    layers = {"stone": {}, "ground": {"fixed": True}, "lintel": {"material": "wood", "thickness": 0.3}}
    found = read(path, layers=layers, thickness=0.4, material="stone")
    by_name = {block.id: block for block in found.blocks}
    assert len(by_name) == 87
    assert [name for name, block in by_name.items() if block.fixed] == ["ground"]
    assert (by_name["lintel"].material, by_name["lintel"].thickness) == ("wood", 0.3)
    assert by_name["stone-1"].thickness == 0.4
    area = sum(polygon.area(block.parts[0]) for name, block in by_name.items() if name != "ground")
    assert area == pytest.approx(4.0 * 2.0 - 1.2 * 1.4, rel=1e-12)
    assert found.notes == [
        "87 blocks from 87 outlines (1 on ground, 85 on stone, 1 on lintel), lengths in mm",
        "left out: 1 TEXT",
    ]
    with pytest.raises(KeyProblem, match="nothing is said of 1 blocks on 'ground'; name it here, or with skip = true"):
        read(path, layers={"stone": {}, "lintel": {}})
    with pytest.raises(KeyProblem, match="no blocks on 'stones' in the file, did you mean 'stone'"):
        read(path, layers={"stones": {}})
    without = read(path, layers=layers | {"lintel": {"skip": True}})
    assert len(without.blocks) == 86
    assert without.notes[1] == "left out: 1 on layer 'lintel', 1 TEXT"


def test_a_layer_that_is_skipped_is_not_read(tmp_path):
    """Lines that do not close, or a curve, on a layer with skip = true stopped the run."""
    import ezdxf

    drawing = ezdxf.new(units=6)
    drawing.layers.add("axes")
    space = drawing.modelspace()
    space.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "stone"})
    space.add_line((0, -1), (5, -1), dxfattribs={"layer": "axes"})
    space.add_circle((2, 2), 0.5, dxfattribs={"layer": "axes"})
    space.add_arc((2, 2), 0.5, 0, 90, dxfattribs={"layer": "axes"})
    drawing.saveas(tmp_path / "a.dxf")
    svg = '<svg xmlns="http://www.w3.org/2000/svg"><g id="stone"><rect width="1" height="1"/></g>'
    (tmp_path / "a.svg").write_text(f'{svg}<g id="axes"><path d="M 0 0 L 1 5"/><circle r="1"/></g></svg>')
    for name, said in (("a.dxf", "left out: 3 on layer 'axes'"), ("a.svg", "left out: 2 on group 'axes'")):
        found = read(tmp_path / name, layers={"stone": {}, "axes": {"skip": True}})
        assert [block.id for block in found.blocks] == ["stone"]
        assert said in found.notes


def test_a_unit_that_is_not_read_is_asked_for_and_layers_are_no_names_of_parts(tmp_path):
    """Yards were taken for metres without a word; many outlines on each of two layers had a warning."""
    import ezdxf

    drawing = ezdxf.new(units=10)
    for layer, y in (("stone", 0.0), ("ground", -2.0)):
        for x in (0.0, 2.0):
            square = [(x + a, y + b) for a, b in SQUARE]
            drawing.modelspace().add_lwpolyline(square, close=True, dxfattribs={"layer": layer})
    drawing.saveas(tmp_path / "d.dxf")
    with pytest.raises(
        KeyProblem, match=r"d.dxf: its lengths are in yards \(\$INSUNITS = 10\).*; give unit, one of m, "
    ):
        read(tmp_path / "d.dxf")
    found = read(tmp_path / "d.dxf", unit="ft")
    assert polygon.area(found.blocks[0].parts[0]) == pytest.approx(0.3048**2)
    assert not found.divided


def test_a_depth_of_a_layer_of_solids_is_refused(tmp_path, boxes):
    by_trimesh(boxes[:1], tmp_path / "w.obj")
    with pytest.raises(ValueError, match="which holds solids"):
        read(tmp_path / "w.obj", layers={"stone": {"thickness": 0.3}})


def test_lines_that_meet_in_twos_are_outlines_and_bulges_become_chords(tmp_path):
    import ezdxf

    drawing = ezdxf.new()
    space = drawing.modelspace()
    for a, b in zip(SQUARE, SQUARE[1:] + SQUARE[:1]):
        space.add_line(a, b)
    space.add_lwpolyline([(2, 0, 0), (3, 0, 0), (3, 1, 1), (2, 1, 0)], format="xyb", close=True)  # a semicircle on top
    drawing.saveas(tmp_path / "d.dxf")
    with pytest.raises(KeyProblem, match=r"d.dxf: a curve on layer '0' from \[3, 1\]; .* give chords"):
        read(tmp_path / "d.dxf")
    for chords in (1, 8):
        areas = sorted(polygon.area(block.parts[0]) for block in read(tmp_path / "d.dxf", chords=chords).blocks)
        assert areas[0] == 1.0
        n = 2 * chords  # pieces of the semicircle, of two quarters
        assert areas[1] == pytest.approx(1.0 + n / 8.0 * np.sin(np.pi / n), rel=1e-4)  # quarters are Bézier curves
    space.add_line((0, 0), (-1, -1))
    drawing.saveas(tmp_path / "d.dxf")
    with pytest.raises(KeyProblem, match=r"layer '0': LINE #.* at .*; an outline is a closed polyline"):
        read(tmp_path / "d.dxf", chords=1)


SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="10cm" height="10cm" viewBox="0 0 50 50">
<g id="stones" transform="translate(10 0)"><rect id="a" x="0" y="-20" width="40" height="20"/>
<polygon id="b" points="0,-40 40,-40 40,-20 0,-20"/></g>
<path id="base" d="M 0 0 h 60 v 10 h -60 z"/><text x="0" y="0">x</text></svg>"""


def test_svg_shapes_keep_their_numbers_and_groups(tmp_path):
    (tmp_path / "d.svg").write_text(SVG)
    found = read(tmp_path / "d.svg", unit="cm", fixed=["base"])
    by_name = {block.id: block for block in found.blocks}
    assert by_name["base"].fixed
    assert not by_name["a"].fixed
    assert np.array_equal(
        np.sort(by_name["b"].parts[0], axis=0), np.sort([[0.1, 0.2], [0.5, 0.2], [0.5, 0.4], [0.1, 0.4]], axis=0)
    )
    assert found.notes[1] == "left out: 1 text"


def test_layers_that_are_off_in_svg_are_left_out_with_a_word(tmp_path):
    off = '<g id="off" style="fill:red; display: none"><rect x="5" y="0" width="1" height="1"/></g></svg>'
    (tmp_path / "d.svg").write_text(SVG.replace("</svg>", off))
    found = read(tmp_path / "d.svg")
    assert len(found.blocks) == 3
    assert found.notes[1] == "left out: 1 hidden, 1 text"


def test_a_concave_outline_is_refused_or_decomposed(tmp_path):
    points = " ".join(f"{x},{-y}" for x, y in L)
    (tmp_path / "l.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg"><polygon id="ell" points="{points}"/></svg>'
    )
    with pytest.raises(KeyProblem, match="'ell': it is concave"):
        read(tmp_path / "l.svg")
    (block,) = read(tmp_path / "l.svg", concave="decompose").blocks
    assert sum(map(polygon.area, block.parts)) == pytest.approx(4.0, rel=1e-14)
    assert len(block.parts) == 2


def test_faces_that_look_inwards_are_turned_and_a_mixed_surface_too(tmp_path):
    points, faces = prism(SQUARE, 0.0, 2.0)
    for wrong in ([face[::-1] for face in faces], [face[::-1] if k % 2 else face for k, face in enumerate(faces)]):
        (tmp_path / "in.obj").write_text(obj_text({"a": (points, wrong)}))
        (block,) = read(tmp_path / "in.obj").blocks
        solid = trimesh.Trimesh(
            block.parts[0].vertices, [[f[0], a, b] for f in block.parts[0].faces for a, b in zip(f[1:], f[2:])]
        )
        assert solid.volume == pytest.approx(2.0, rel=1e-14)


def test_triangles_without_common_corners_close_all_the_same(tmp_path):
    mesh = trimesh.creation.box(bounds=[(0, 0, 0), (1, 2, 3)])
    points = mesh.vertices[mesh.faces].reshape(-1, 3)
    (tmp_path / "soup.obj").write_text(obj_text({"a": (points, np.arange(len(points)).reshape(-1, 3).tolist())}))
    (block,) = read(tmp_path / "soup.obj").blocks
    assert volumes([block])["a"] == pytest.approx(6.0)
    assert len(block.parts[0].vertices) == 8


def test_a_file_that_changed_is_read_again(tmp_path):
    for height in (1.0, 2.0):
        (tmp_path / "a.obj").write_text(obj_text({"a": prism(SQUARE, 0.0, height)}))
        assert volumes(read(tmp_path / "a.obj").blocks)["a"] == pytest.approx(height)
        assert read(tmp_path / "a.obj") is read(tmp_path / "a.obj")


def test_y_up_and_units(tmp_path):
    (tmp_path / "y.obj").write_text(obj_text({"a": prism([(0, 0), (100, 0), (100, 300), (0, 300)], 0.0, 200.0)}))
    (block,) = read(tmp_path / "y.obj", up="y", unit="cm").blocks
    assert np.ptp(block.parts[0].vertices, axis=0) == pytest.approx([1.0, 2.0, 3.0])
    assert block.parts[0].vertices[:, 2].max() == pytest.approx(3.0)


def test_names_are_made_unique_and_a_prefix_that_is_the_id_is_not_doubled(tmp_path):
    cubes = [prism([(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)], 0.0, 1.0) for x in (0.0, 1.0, 2.0)]
    both = (np.concatenate([c[0] for c in cubes[:2]]), cubes[0][1] + [[k + 8 for k in f] for f in cubes[1][1]])
    (tmp_path / "n.obj").write_text(obj_text({"wall-a b": both, "wall-c": cubes[2]}))
    assert [b.id for b in read(tmp_path / "n.obj", id="wall").blocks] == ["a-b-1", "a-b-2", "c"]
    assert [b.id for b in read(tmp_path / "n.obj", names="numbers").blocks] == ["1", "2", "3"]
    parts = read(tmp_path / "n.obj", shells="parts").blocks
    assert [(b.id, len(b.parts)) for b in parts] == [("wall-a-b", 2), ("wall-c", 1)]
    with pytest.raises(KeyProblem, match="no block is called 'wall-d', did you mean 'wall-c'"):
        read(tmp_path / "n.obj", fixed=["wall-d"])


MESH = {
    "dtype": "compas.datastructures/Mesh",
    "data": {
        "attributes": {"is_support": True, "material": "tuff"},
        "vertex": {str(k): dict(zip("xyz", p)) for k, p in enumerate(prism(SQUARE, 0.0, 1 / 3)[0].tolist())},
        "face": {str(k): face for k, face in enumerate(prism(SQUARE, 0.0, 1 / 3)[1])},
    },
    "name": "base",
}


def test_compas_meshes_have_names_supports_and_materials(tmp_path):
    (tmp_path / "m.json").write_text(json.dumps([MESH]))
    (block,) = read(tmp_path / "m.json", materials="file").blocks
    assert (block.id, block.fixed, block.material) == ("base", True, "tuff")
    assert np.array_equal(block.parts[0].vertices, prism(SQUARE, 0.0, 1 / 3)[0])


def test_a_material_in_full_has_a_name(tmp_path):
    full = {"dtype": "compas_dem.material/Stone", "data": {"name": "tuff", "density": 1600.0}}
    mesh = {**MESH, "data": {**MESH["data"], "attributes": {"is_support": True, "material": full}}}
    (tmp_path / "m.json").write_text(json.dumps([mesh]))
    assert read(tmp_path / "m.json", materials="file").blocks[0].material == "tuff"


def test_a_model_of_compas_dem_has_supports_materials_and_transformations(tmp_path):
    """As compas_dem 0.3 writes a BlockModel: elements by guid, materials beside them, contacts in the graph."""
    shift = [[1.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]

    def element(support: bool, transformation):
        data = {"transformation": transformation, "features": [], "name": "Block", "material": "m1"}
        return {"dtype": "compas_dem.elements/Block", "data": {**data, "geometry": PLAIN_MESH, "is_support": support}}

    moved = {"dtype": "compas.geometry/Transformation", "data": {"matrix": shift}}
    tuff = {"dtype": "compas_dem.material/Stone", "data": {"name": "tuff", "density": 1600.0}}
    point = {"dtype": "compas.geometry/Point", "data": [0.0, 0.0, 0.0]}
    model = {
        "elements": {"e1": element(True, None), "e2": element(False, moved)},
        "materials": {"m1": tuff},
        "graph": {
            "node": {"0": {"element": "e1"}},
            "edge": {"0": {"1": {"contacts": [{"data": {"points": [point]}}]}}},
        },
    }
    (tmp_path / "model.json").write_text(json.dumps({"dtype": "compas_dem.models/BlockModel", "data": model}))
    found = read(tmp_path / "model.json", materials="file")
    assert [(b.id, b.fixed, b.material) for b in found.blocks] == [
        ("Block-1", True, "tuff"),
        ("Block-2", False, "tuff"),
    ]
    assert found.notes[-1] == "the file says tuff: 1600 kg/m3"
    here, there = (block.parts[0].vertices for block in found.blocks)
    assert np.array_equal(there - here, np.tile([5.0, 0.0, 0.0], (8, 1)))


PLAIN_MESH = {**MESH, "data": {**MESH["data"], "attributes": {}}}


NO_NUMBER = [
    "facet normal 0 0 1",
    "outer loop",
    "vertex 0 0 nan",
    "vertex 1 0 0",
    "vertex 1 1 0",
    "endloop",
    "endfacet",
]
XMLNS = '<svg xmlns="http://www.w3.org/2000/svg">'
OPEN = (prism(SQUARE, 0.0, 1.0)[0], prism(SQUARE, 0.0, 1.0)[1][1:])
NO_EDGE = "'lid': the surface is not closed: the edge from .* belongs to 1 face instead of two"
FACES_IN_A_LIST = '{"dtype": "compas.datastructures/Mesh", "data": {"vertex": {"0": {"x": 1}}, "face": [[0]]}}'
BOX_WITHOUT_AXES = '{"dtype": "compas.geometry/Box", "data": {"frame": [0, 0, 0], "xsize": 1}}'
HEAVY = {"data": {"materials": {"m": {"data": {"name": "tuff", "density": "heavy"}}}, "block": PLAIN_MESH}}
HALF_A_MESH = '{"dtype": "compas.datastructures/Mesh", "data": {"vertex": {"0": {"x": 1}}, "face": {}}}'
BAD = {
    "empty.obj": ("", "no objects in it"),
    "empty.stl": ("", "0 bytes, too short for an STL file"),
    "cut.stl": (b"\0" * 80 + b"\7\0\0\0" + b"\0" * 120, "7 triangles, the file has room for 2: it is not whole"),
    "cut_ascii.stl": ("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "ends at line 4 within solid 'x'"),
    "nan.obj": ("o a\nv 0 0 nan\n", r"line 2: 'v 0 0 nan' is not three finite coordinates"),
    "nan.stl": ("\n".join(["solid a", *NO_NUMBER, "endsolid"]), "solid 'a': corner 1 is not finite"),
    "words.obj": ("v a b c\n", "is not three finite coordinates"),
    "corner.obj": ("v 0 0 0\nf 1 2 3\n", "line 2: a face names corner 2; there are 1 so far"),
    "open.obj": (obj_text({"lid": OPEN}), NO_EDGE),
    "flat.obj": (obj_text({"a": (np.zeros((8, 3)), prism(SQUARE, 0.0, 1.0)[1])}), "'a'.*(no area|no volume)"),
    "twice.stl": (None, "two solids are in the same place"),
    "bad.ply": ("ply\nformat ascii 1.0\nelement vertex 3\n", "not a PLY file that can be read"),
    "bad.json": ("{", "not JSON"),
    "none.json": ('{"a": 1}', "no meshes in it"),
    "mesh.json": (HALF_A_MESH, "is not as compas writes it"),
    "list.json": (FACES_IN_A_LIST, "is not as compas writes it"),
    "box.json": (BOX_WITHOUT_AXES, "is not as compas writes it"),
    "heavy.json": (json.dumps(HEAVY), "material 'tuff': its density 'heavy' is not a number"),
    "bad.dxf": ("hello", "not a DXF file that can be read"),
    "bad.svg": ("<html/>", "<html>, not an SVG drawing"),
    "worse.svg": ("<svg", "not an SVG drawing that can be read"),
    "open.svg": (f'{XMLNS}<path id="p" d="M 0 0 L 1 0 L 1 1"/></svg>', r"'p' is not closed: it ends at \[1, 1\]"),
    "bow.svg": (
        f'{XMLNS}<polygon id="p" points="0,0 2,2 2,0 0,1"/></svg>',
        "'p': its outline crosses or touches itself",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_one_clear_message_says_the_file_and_what_is_wrong(tmp_path, name):
    text, message = BAD[name]
    path = tmp_path / name
    if name == "twice.stl":
        box = trimesh.creation.box()
        trimesh.util.concatenate([box, box]).export(path)
    elif isinstance(text, bytes):
        path.write_bytes(text)
    else:
        path.write_text(text)
    with pytest.raises(KeyProblem, match=rf"{name}: .*{message}"):
        read(path)


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".ply", ".json", ".svg", ".dxf"])
def test_files_cut_short_or_scrambled_end_in_a_message_or_in_blocks(tmp_path, boxes, suffix):
    """Never in a traceback: of 12 damaged copies of each format."""
    path = tmp_path / f"good{suffix}"
    if suffix == ".dxf":
        facade_by_ezdxf(path)
    elif suffix == ".svg":
        path.write_text(SVG)
    elif suffix == ".json":
        path.write_text(json.dumps([MESH]))
    else:
        by_trimesh(boxes[:4], path)
    good, rng = path.read_bytes(), np.random.default_rng(1)
    refused = 0
    for k in range(12):
        bad = bytearray(good[: int(rng.integers(len(good)))] if k % 2 else good)
        for at in rng.integers(max(len(bad), 1), size=0 if k % 2 else 6):
            bad[at] = int(rng.integers(32, 127))
        path.write_bytes(bytes(bad))
        with contextlib.suppress(KeyProblem):
            read(path)
            refused -= 1
        refused += 1
    assert refused >= 3
