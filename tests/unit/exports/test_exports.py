"""Blocks of a case for other programs, read back: to the last bit, by trimesh, by compas, by a stand-in of LMGC90."""

from __future__ import annotations

import json
import re
import sys
import types
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull
from synthetic.spatial_case import spatial_case

from dem_cli.app.api import build_model, load_case, make_case_model
from dem_cli.app.cli.main import main
from dem_cli.case.reader import CaseSource, validate
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.exports.contents import ExportedCase
from dem_cli.masonry.exports.formats import EXPORT_FORMATS, write_case
from dem_cli.masonry.structures.imported import Import, imported, unsaid

DRAWN = Path(__file__).resolve().parents[2] / "drawn"
STONE, WOOD = 2143.0, 800.0
MATERIALS = {"stone": {"density": STONE}, "wood": {"density": WOOD}}
JOINTS = {"dry": {"friction": 0.6}, "soft": {"friction_angle_deg": 20.0, "kn": 1e9, "ks": 4e8}}
ELL = [[[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.5], [2.0, 0.0, 1.5],
        [2.0, 1.0, 1.5], [0.0, 1.0, 1.5]], [[0.0, 0.0, 1.5], [1.0, 0.0, 1.5], [1.0, 1.0, 1.5], [0.0, 1.0, 1.5],
        [0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0]]]  # fmt: skip


def in_space() -> ExportedCase:
    """A turned column, an L-shaped compound on it of another material, a force on that."""
    case = spatial_case(
        title="Column",
        materials=MATERIALS,
        joints=JOINTS,
        interface=[{"between": ["stone", "wood"], "joint": "soft"}],
        structure=[
            {"kind": "column", "id": "column", "block": [2.0, 1 / 3, 1.0], "courses": 3, "material": "stone",
             "origin": [1.0, 0.5, 0.0]}
        ],
        block=[{"id": "ell", "parts": ELL, "material": "wood"}],
        load=[{"block": "ell", "force": [10.0, 20.0, -30.0]}],
        analysis={"kind": "pushover", "direction": [0.6, 0.8, 0.0]},
    )  # fmt: skip
    made = assembly(case)
    return ExportedCase(case, made.model, made.blocks, "column")


def in_plane() -> ExportedCase:
    tables = {
        "title": "Wall",
        "materials": MATERIALS,
        "joints": JOINTS,
        "interface": [{"between": ["stone", "wood"], "joint": "soft"}],
        "structure": [
            {"kind": "wall", "block": [0.4, 0.2], "courses": 3, "blocks_per_course": 3, "thickness": 0.3,
             "material": "stone", "openings": [{"x": 0.4, "y": 0.0, "width": 0.4, "height": 0.2,
             "lintel": {"height": 0.2, "bearing": 0.1, "material": "wood"}}]}
        ],
        "analysis": {"kind": "gravity"},
    }  # fmt: skip
    case = validate(tables, make_case_model(), CaseSource(Path("case.toml"), ""))
    made = assembly(case)
    return ExportedCase(case, made.model, made.blocks, "wall")


CASES = {"in space": in_space, "in the plane": in_plane}


@pytest.fixture(params=CASES)
def exported(request) -> ExportedCase:
    return CASES[request.param]()


def volumes(exported: ExportedCase) -> dict[str, float]:
    density = {name: material.density for name, material in exported.case.materials.items()}
    masses = zip(exported.blocks, exported.model.masses, strict=True)
    return {block.id: mass / density[block.material] for block, mass in masses}


@pytest.mark.parametrize("suffix", [".obj", ".json", ".stl"])
def test_what_is_written_is_read_back_to_the_last_bit(tmp_path, exported, suffix):
    path = tmp_path / f"model{suffix}"
    write_case(path, exported)
    table = {"kind": "import", "id": "x", "file": str(path), "shells": "parts", "materials": "file"}
    found = imported(Import.model_validate(table)).blocks
    assert [block.id for block in found] == [block.name for block in exported.solids]
    for block, own in zip(found, exported.solids, strict=True):
        assert len(block.parts) == len(own.parts)
        for part, drawn in zip(block.parts, own.parts, strict=True):
            assert {tuple(c) for c in part.vertices.tolist()} == {tuple(c) for c in drawn.vertices.tolist()}
            if suffix != ".stl":
                assert np.array_equal(part.vertices, drawn.vertices)
                assert all(map(np.array_equal, part.faces, drawn.faces))
        if suffix != ".stl":
            assert block.material == own.material
    if suffix == ".json":
        assert [block.fixed for block in found] == [block.fixed for block in exported.solids]


@pytest.fixture(scope="module")
def of_compounds() -> ExportedCase:
    """The section of a three-leaf wall: stones of its core are concave."""
    tables = {
        "materials": {"stone": {"density": 2200.0}, "rubble": {"density": 1900.0}},
        "joints": {"dry": {"friction": 0.7}},
        "structure": [{
            "kind": "wall-section", "id": "w", "size": [0.8, 1.0], "course": [0.25, 0.05], "face": [0.2, 0.05],
            "cell": 0.12, "seed": 20, "shortest": 0.3, "thickness": 0.7, "material": "stone", "core_material": "rubble",
        }],
        "analysis": {"kind": "gravity"},
    }  # fmt: skip
    case = validate(tables, make_case_model(), CaseSource(Path("case.toml"), ""))
    made = assembly(case)
    assert any(len(block.parts) > 1 for block in made.blocks)
    return ExportedCase(case, made.model, made.blocks, "section")


@pytest.mark.parametrize("suffix", [".obj", ".json", ".stl"])
def test_compounds_come_back_as_they_were_or_it_is_said(tmp_path, of_compounds, suffix):
    """Same blocks, same masses; STL has no word for it: both ways it is said, and shells = 'parts' has them again."""
    path, own = tmp_path / f"model{suffix}", of_compounds
    lost = write_case(path, own)
    several = [block for block in own.blocks if len(block.parts) > 1]
    tables = {
        "dimension": 3,
        "materials": {name: {"density": m.density} for name, m in own.case.materials.items()},
        "joints": {"dry": {"friction": 0.7}},
        "structure": [
            {
                "kind": "import",
                "id": "w",
                "file": str(path),
                "fixed": ["w-base"],
                "materials": "file",
                "material": "stone",
            }
        ],
        "analysis": {"kind": "gravity"},
    }
    if suffix == ".stl":
        more = f" and {len(several) - 1} more" if len(several) > 1 else ""
        assert lost == [f"that the parts of '{several[0].id}'{more} are one block"]
        tables["structure"][0]["materials"] = "structure"
        table = imported(Import.model_validate(tables["structure"][0]))
        assert table.divided == {block.id: len(block.parts) for block in several}
        ((key, message),) = unsaid(Import.model_validate(tables["structure"][0]))
        assert key == "shells"
        assert message.startswith(f"'{several[0].id}' has {len(several[0].parts)} solids")
        tables["structure"][0]["shells"] = "parts"
    else:
        assert lost == []
    structure = Import.model_validate(tables["structure"][0])
    assert unsaid(structure) == []
    made = assembly(validate(tables, make_case_model(), CaseSource(Path("case.toml"), "")))
    assert [block.id for block in made.blocks] == [block.id for block in own.blocks]
    assert [len(block.parts) for block in made.blocks] == [len(block.parts) for block in own.blocks]
    if suffix != ".stl":
        assert made.model.masses == pytest.approx(own.model.masses, rel=1e-12)
    with_blocks = imported(structure.model_copy(update={"shells": "blocks"})).blocks
    assert len(with_blocks) == sum(len(block.parts) for block in own.blocks)


def test_a_drawing_comes_back_with_layers(tmp_path):
    exported = in_plane()
    write_case(tmp_path / "wall.dxf", exported)
    layers = {"stone": {}, "wood": {}, "fixed": {"fixed": True}}
    found = imported(
        Import.model_validate({"kind": "import", "id": "x", "file": str(tmp_path / "wall.dxf"), "layers": layers})
    ).blocks
    for block, own in zip(found, exported.blocks, strict=True):
        assert np.array_equal(block.parts[0], own.parts[0])
        assert block.fixed == own.fixed
    with pytest.raises(Exception, match="a DXF drawing is of a case in 2D"):
        write_case(tmp_path / "column.dxf", in_space())


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_trimesh_reads_names_and_volumes_of_gltf(tmp_path, exported, suffix):
    path = tmp_path / f"model{suffix}"
    write_case(path, exported)
    scene = trimesh.load_scene(path)
    wanted = volumes(exported)
    assert set(scene.geometry) == set(wanted)
    for name, mesh in scene.geometry.items():
        assert mesh.volume == pytest.approx(wanted[name], rel=1e-5)  # single precision
    low, high = scene.bounds
    corners = np.concatenate([part.vertices for block in exported.solids for part in block.parts])
    assert low[1] == pytest.approx(corners[:, 2].min())
    assert high[2] == pytest.approx(-corners[:, 1].min())


def test_compas_reads_what_is_written():
    compas = pytest.importorskip("compas")
    exported = in_space()
    meshes = compas.json_loads(EXPORT_FORMATS[".json"].write(exported, "")[0])
    wanted = volumes(exported)
    found: dict[str, float] = {}
    for mesh in meshes:
        assert mesh.is_manifold()
        found[mesh.name] = found.get(mesh.name, 0.0) + mesh.volume()
    assert found == pytest.approx(wanted, rel=1e-12)
    assert meshes[0].attributes == {"is_support": True, "material": "stone", "density": STONE}


def test_a_file_of_compas_goes_round_to_the_last_bit(tmp_path):
    """Made by compas 2.15.1 and compas_assembly 0.7.1: a column of octagonal drums; volumes by compas."""
    table = {"kind": "import", "id": "column", "file": str(DRAWN / "compas_column.json")}
    case = spatial_case(structure=[table])
    made = assembly(case)
    assert dict(zip(made.model.block_ids, made.model.shapes.volumes)) == pytest.approx(
        {
            "column-plinth": 0.4320000000000002,
            "column-drum-1": 0.3833744405785144,
            "column-drum-2": 0.3898703948750148,
            "column-drum-3": 0.28616140030098787,
        },
        rel=1e-14,
    )
    assert made.model.fixed.tolist() == [True, False, False, False]
    exported = ExportedCase(case, made.model, made.blocks, "column")
    text = json.loads(EXPORT_FORMATS[".json"].write(exported, "")[0])
    nodes = json.loads((DRAWN / "compas_column.json").read_text())["data"]["graph"]["data"]["node"]
    originals = [node["block"] for node in nodes.values()]
    for mesh, drawn in zip(text, originals, strict=True):
        assert mesh["data"]["vertex"] == drawn["data"]["vertex"]
        assert mesh["data"]["face"] == drawn["data"]["face"]
        assert mesh["name"] == f"column-{drawn['name']}"


class Recorder:
    """A stand-in for pylmgc90.pre: what a script hands to it."""

    def __init__(self):
        self.bodies, self.sees, self.laws, self.materials = [], [], [], {}
        self.gravity = None

    def module(self):
        recorder = self

        class Avatar:
            def __init__(self, dimension):
                self.dimension, self.parts, self.driven = dimension, [], []

            def addContactors(self, shape, color, **data):
                self.shape, self.color = shape, color
                self.parts.append(data)

            def defineMaterial(self, material):
                self.material = material

            def imposeDrivenDof(self, component, dofty, ct=0.0):
                self.driven.append((component, dofty, ct))

            def computeRigidProperties(self):
                assert self.parts

            def __getattr__(self, name):
                return lambda *args, **keys: None

        class Container(list):
            def __getattr__(self, name):
                return self.append

        pre = types.ModuleType("pre")
        pre.avatars, pre.see_tables, pre.tact_behavs = Container, Container, Container
        pre.materials, pre.models = Container, Container
        pre.avatar = lambda dimension: Avatar(dimension)
        pre.material = lambda name, materialType, density: (name, density)
        pre.tact_behav = lambda name, law, fric: (law, fric)
        pre.see_table = lambda **keys: keys
        pre.model = pre.node = pre.rigid3d = pre.rigid2d = lambda **keys: None

        def write(dim, mats, mods, bodies, tacts, svs, gravy):
            recorder.bodies, recorder.sees, recorder.gravity = bodies, svs, gravy

        pre.writeDatbox = write
        package = types.ModuleType("pylmgc90")
        package.pre = pre
        return package


@pytest.mark.parametrize("name", CASES)
def test_lmgc90_gets_the_masses_the_supports_and_the_friction(tmp_path, monkeypatch, name):
    exported = CASES[name]()
    path = tmp_path / "model.lmgc90.py"
    notes = write_case(path, exported)
    recorder = Recorder()
    monkeypatch.setitem(sys.modules, "pylmgc90", recorder.module())
    monkeypatch.setattr(sys, "argv", [str(path)])
    monkeypatch.chdir(tmp_path)
    exec(compile(path.read_text(), path, "exec"), {"__name__": "__main__"})
    assert (tmp_path / "DATBOX").is_dir()
    masses = []
    for body in recorder.bodies:
        volume = 0.0
        for part in body.parts:
            points = part["vertices"]
            assert len(points) == part["nb_vertices"]
            if body.dimension == 3:
                faces = part["connectivity"] - 1
                arms = points[faces] - points.mean(axis=0)
                assert np.linalg.det(arms).min() > 0.0  # outwards
                volume += np.linalg.det(arms).sum() / 6.0
                assert {tuple(sorted(edge)) for f in faces for edge in zip(f, np.roll(f, 1))}
            else:
                x, y = points.T
                volume += 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
        masses.append(volume * body.material[1])
    assert masses == pytest.approx(exported.model.masses.tolist(), rel=1e-12)
    every = list(range(1, 7 if exported.case.dimension == 3 else 4))
    fixed = [(every, "vlocy", 0.0) in body.driven for body in recorder.bodies]
    assert fixed == exported.model.fixed.tolist()
    seen = {frozenset((s["colorCandidat"], s["colorAntagoniste"])): s["behav"] for s in recorder.sees}
    assert seen[frozenset(("C0000",))] == ("IQS_CLB", 0.6)
    assert seen[frozenset(("C0000", "C0001"))][1] == pytest.approx(np.tan(np.radians(20.0)))
    assert list(recorder.gravity) == [*[0.0] * (exported.case.dimension - 1), -9.81]
    if name == "in space":
        forces = [drive for drive in recorder.bodies[-1].driven if drive[1] == "force"]
        assert [(c, pytest.approx(f)) for c, _, f in forces] == [([1], 10.0), ([2], 20.0), ([3], -30.0)]
        assert notes == ["stiffness of joints: bodies do not overlap in LMGC90"]


def test_lmgc90_says_which_moments_it_has_not(tmp_path):
    """In space those of forces beside the centroid; in the plane they are written."""
    off = [{"block": "ell", "force": [10.0, 0.0, 0.0], "at": [0.5, 0.5, 2.0]}]
    case = spatial_case(materials={"wood": {"density": WOOD}}, block=[{"id": "ell", "parts": ELL}], load=off)
    made = assembly(case)
    notes = write_case(tmp_path / "a.lmgc90.py", ExportedCase(case, made.model, made.blocks, "a"))
    assert notes == ["moments of forces beside the centroid of 'ell'"]
    text = (tmp_path / "a.lmgc90.py").read_text()
    assert ", [10.0, 0.0, 0.0], [0.0, 0.0, 0.0])  # ell" in text
    assert notes[0] in text


def test_3dec_gets_closed_convex_blocks_clockwise_from_outside(tmp_path, exported):
    notes = write_case(tmp_path / "model.3ddat", exported)
    text = (tmp_path / "model.3ddat").read_text()
    found: dict[str, float] = {}
    for name, faces in re.findall(
        r"block create polyhedron group '([^']*)' slot 'dem-name' &\n((?:  face .*\n)+)", text
    ):
        loops = [
            np.array([[float(x) for x in corner.split(",")] for corner in line.replace("&", "").split()[1:]])
            for line in faces.splitlines()
        ]
        middle = np.concatenate(loops).mean(axis=0)
        for loop in loops:
            normal = np.cross(loop[1] - loop[0], loop[2] - loop[1])
            assert normal @ (loop.mean(axis=0) - middle) < 0.0
        found[name] = found.get(name, 0.0) + ConvexHull(np.concatenate(loops)).volume
    assert found == pytest.approx(volumes(exported), rel=1e-9)
    fixed = re.findall(r"^block fix range group '([^']*)' slot 'dem-name'$", text, re.MULTILINE)
    assert fixed == [block.id for block in exported.blocks if block.fixed]
    assert f"block property density {STONE!r} range group 'stone' slot 'dem-material'" in text
    assert "model gravity 0.0 0.0 -9.81" in text
    assert f"friction {float(np.degrees(np.arctan(0.6)))!r}" in text
    if exported.case.dimension == 3:
        soft = "stiffness-normal 1000000000.0 stiffness-shear 400000000.0 friction 20"
        assert re.search(rf"property {soft}\S* .* range group-intersection 'stone' 'wood'", text)
        assert notes == ["forces on blocks (block apply)", "that the parts of 'ell' move as one (block join)"]


WALL = """\
title = "Wall"
dimension = 3

[materials.stone]
density = 2400.0

[joints.dry]
friction = 0.6

[[structure]]
{structure}

[analysis]
kind = "pushover"
direction = [1.0, 0.0, 0.0]
follow = 0.0
"""


def test_a_case_that_went_out_and_came_back_has_the_same_model_and_the_same_failure_load(tmp_path):
    drawn = 'kind = "wall"\nid = "wall"\nblock = [0.4, 0.2, 0.3]\ncourses = 3\nblocks_per_course = 2\n'
    (tmp_path / "drawn.toml").write_text(WALL.format(structure=drawn))
    back = 'kind = "import"\nid = "wall"\nfile = "wall.obj"\nfixed_below = 0.0\n'
    (tmp_path / "back.toml").write_text(WALL.format(structure=back))
    run("build", str(tmp_path / "drawn.toml"), "-o", str(tmp_path / "wall.obj"))
    models = [build_model(load_case(tmp_path / f"{name}.toml")) for name in ("drawn", "back")]
    for field in ("block_ids", "vertices", "centroids", "masses", "inertias", "fixed", "face_corners", "live_loads"):
        assert np.array_equal(*(np.asarray(getattr(model, field)) for model in models)), field
    answers = []
    for name in ("drawn", "back"):
        run("run", str(tmp_path / f"{name}.toml"), "-o", str(tmp_path / name), "--quiet")
        summary = json.loads((tmp_path / name / "summary.json").read_text())
        answers.append([summary[key] for key in ("blocks", "joints", "failure_load", "failure_load_bracket", "steps")])
    assert answers[0] == answers[1]
    assert answers[0][2] > 0.0


def run(*words: str) -> None:
    from click.testing import CliRunner

    result = CliRunner().invoke(main, list(words))
    assert result.exit_code == 0, result.output


def test_every_format_is_in_the_help_and_a_script_needs_its_whole_ending(tmp_path):
    from dem_cli.app.cli.build import command

    assert not [suffix for suffix in EXPORT_FORMATS if suffix not in (command.help or "")]
    with pytest.raises(Exception, match=r"a script for LMGC90 is called x.lmgc90.py"):
        write_case(tmp_path / "x.py", in_plane())
