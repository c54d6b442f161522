"""Files of results that a stranger reads: each dataset says what it is, the page says the same, viewers open them."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from casefiles import CASES
from click.testing import CliRunner
from synthetic.solid_runs import solid_frames, solid_wall, write_solid_run

import dem_cli
from dem_cli.app.cli.main import main
from dem_cli.core.contact.drawn_joints import DrawnJoints
from dem_cli.core.records.frames import STATES
from dem_cli.results.output import layout
from dem_cli.results.output.layout import GROUPS
from dem_cli.results.output.paraview.described_fields import STEP_FIELDS, VTK_FILES

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "results.md").read_text(encoding="utf-8")
COLUMN = """\
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.7
kn = 1e9
[[structure]]
kind = "column"
id = "c"
courses = 3
block = [0.4, 0.8]
CRACK[output]
frames = 4
[[monitor]]
name = "=turn"
block = "c-top"
quantity = "rotation"
"""
SHAKEN = '[[motion]]\nkind = "pulse"\namplitude = 1.0\nfrequency = 2.0\n'
TIED = "[[tie]]\nends = [[0.1, 1.2], [0.1, 2.0]]\nstiffness = 1e4\n"
CRACKING = """\
[[restraint]]
block = "c-3*"
fixed = ["rotation"]
[joints.crack]
law = "fracture"
friction = 0.7
cohesion = 1e7
tension = 1e7
fracture_energy_tension = 1e4
fracture_energy_shear = 1e4
kn = 1e11
"""
KINDS = {
    "gravity": "",
    "pushover": f"follow = 0.004\nresolution = 0.02\n{TIED}",  # with points, so that it turns about an edge
    "pushover of rigid joints": "follow = 0.0\n",  # with certificates, here of a proof that a load is impossible
    "pushover of rigid joints in moving geometry": 'follow = 0.0\nkinematics = "large"\n',  # and here of failure
    "cycle": "path = [0.02, 0.0]\nstep = 0.02\n",
    "modes": "",
    "time-history": f"duration = 0.3\n{SHAKEN}",
    "fragility": f"intensities = [0.5, 1.0]\nduration = 0.3\n{SHAKEN}{SHAKEN}",
    "settlement": CRACKING + '[[settlement]]\nblock = "c-base"\ndisplacement = [0.001, 0.0]\n',
}
G, DENSITY, WIDTH, HEIGHT = 9.81, 2000.0, 0.4, 0.8


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """A run of each kind."""
    place = tmp_path_factory.mktemp("files")
    for kind, more in KINDS.items():
        case = place / f"{kind}.toml"
        column = COLUMN.replace("CRACK", 'crack = "crack"\n' if CRACKING in more else "")
        column = column.replace("kn = 1e9", "kn = 1e9\npoints = 5") if kind == "pushover" else column
        column = column.replace("kn = 1e9\n", "") if "rigid" in kind else column
        case.write_text(f'{column}[analysis]\nkind = "{kind.split()[0]}"\n{more}', encoding="utf-8")
        dem_cli.run(case, out=place / kind).close()
    return {kind: place / kind for kind in KINDS}


def objects(path: Path) -> dict[str, h5py.Group | h5py.Dataset]:
    """Everything below /dem, by its path; a copy in memory stays when the file is closed."""
    found = {"/dem": None}
    with h5py.File(path, "r") as file:
        file["dem"].visititems(lambda name, item: found.update({f"/dem/{name}": item}))
        found["/dem"] = file["dem"]
        return {
            name: (isinstance(item, h5py.Dataset), dict(item.attrs), getattr(item, "shape", None))
            for name, item in found.items()
        }


def declared() -> dict[str, tuple]:
    return {f"{path}/{name}": said for path, group in GROUPS.items() for name, said in group.datasets.items()}


def test_every_dataset_says_what_it_is(folders):
    known = declared()
    for kind, folder in folders.items():
        for path, (is_dataset, attributes, shape) in objects(folder / "results.h5").items():
            if not is_dataset:
                continue
            said = known[path]
            where = f"{kind}: {path}"
            assert attributes["meaning"] == said.meaning, where
            names = list(attributes.get("columns", ()))
            assert not said.columns or names == list(said.columns), where
            assert not names or len(names) == shape[-1], where
            assert list(attributes.get("DIMENSION_LABELS", ())) == list(said.axes), where
            assert len(said.axes) == len(shape), where
            units = attributes["units"]
            assert isinstance(units, str) or len(units) == shape[-1], where


def test_every_attribute_of_groups_is_declared_and_there(folders):
    groups = [
        (path, set(attributes))
        for folder in folders.values()
        for path, (is_dataset, attributes, _) in objects(folder / "results.h5").items()
        if not is_dataset
    ]
    for path, names in groups:
        said = set(GROUPS[path].attributes)
        assert names <= said or "*" in said
        assert said - {"*"} <= names
    assert {path for path, _ in groups} == set(GROUPS)


# Of blocks that deform alone: tests/unit/statics/test_uniform_strain.py
MODES = ("mode_stiffness", "dead_mode_loads", "live_mode_loads", "mode_shapes", "imposed_strains")
OF_STRAINED = {"/dem/frames/stresses", "CellData/stress", *(f"/dem/model/{name}" for name in MODES)}
OF_HEADS = {"/dem/model/courses"}  # of cases with joints.NAME.head: tests/unit/engine/test_head_joints.py


def test_all_that_is_declared_is_in_some_file(folders, tmp_path):
    model = solid_wall()
    in_space = write_solid_run(tmp_path, model, solid_frames(model, 2), DrawnJoints)
    seen = {path for folder in (*folders.values(), in_space) for path in objects(folder / "results.h5")}
    assert set(declared()) - OF_STRAINED - OF_HEADS <= seen


def test_the_page_has_all_of_it_and_nothing_else():
    sections = re.split(r"^###? `([^`]+)`$", PAGE, flags=re.MULTILINE)[1:]
    told = dict(zip(sections[::2], sections[1::2]))
    assert set(told) == {*GROUPS, *VTK_FILES}
    for name, text in told.items():
        rows = set(re.findall(r"^\| `([^`]+)` \|", text.split("### Fields of all three")[0], flags=re.MULTILINE))
        said = (*GROUPS[name].datasets, *GROUPS[name].attributes) if name in GROUPS else VTK_FILES[name][1]
        assert rows == set(said)
    shared = PAGE.split("### Fields of all three")[1]
    assert set(re.findall(r"^\| `([^`]+)` \|", shared, flags=re.MULTILINE)) == set(STEP_FIELDS)


def test_monitors_by_name_with_units(folders):
    with h5py.File(folders["time-history"] / "results.h5", "r") as file:
        for path in ("dem/history/monitor_values", "dem/series/monitors"):
            assert list(file[path].attrs["columns"]) == ["=turn"]
            assert list(file[path].attrs["units"]) == ["rad"]
        assert list(file["dem/frames/velocities"].attrs["units"]) == ["m/s", "m/s", "rad/s"]
    with h5py.File(folders["gravity"] / "results.h5", "r") as file:
        assert list(file["dem/frames/velocities"].attrs["units"]) == ["m/step", "m/step", "rad/step"]
    first = (folders["time-history"] / "history.csv").read_text(encoding="utf-8").split("\n")[0]
    assert first.split(",")[-1] == "'=turn [rad]"


def test_stress_of_a_column_is_the_weight_above_it(folders):
    """Exact: n blocks of height h press with n ρ g h; nothing is open, and the force goes through the middle."""
    with dem_cli.open(folders["gravity"]) as result:
        joints = result.joints()
        above = 3 - np.arange(3)
        np.testing.assert_allclose(joints["normal_stress"], above * DENSITY * G * HEIGHT, rtol=1e-5)
        np.testing.assert_allclose(joints["area"], WIDTH)
        np.testing.assert_allclose(joints["eccentricity"], 0.0, atol=1e-5 * WIDTH)
        assert joints["state"].tolist() == ["sticking"] * 3
        assert joints.units["normal_stress"] == "Pa"
        state = result.summary["joint_state"]
        assert (state["at"], state["joints"], state["open"]) == ("end", 3, 0)
        assert state["normal_stress"]["value"] == pytest.approx(3 * DENSITY * G * HEIGHT, rel=1e-5)
        assert state["normal_stress"]["between"] == ["c-base", "c-1"]


def test_a_column_at_failure_turns_about_its_edge(folders):
    """The force goes through the edge of the lowest joint, under the whole weight."""
    with dem_cli.open(folders["pushover"]) as result:
        number = next(i for i, frame in enumerate(result.frames) if frame.stage == "loading")
        joints = result.joints(number)
        assert abs(joints["eccentricity"][0]) == pytest.approx(0.5 * WIDTH, rel=0.02)
        after = result.summary["after_collapse"]
        widest = result.joints()["crack_width"]
        assert after["crack_width"]["value"] == widest.max()
        assert after["moved_blocks"] == {"count": 3, "first": ["c-1", "c-2", "c-3"]}
        assert after["open"] == int((result.joints()["state"] == "open").sum())


# -- by name ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", VTK_FILES)
def test_pyvista_opens_it_by_name(folders, name):
    pyvista = pytest.importorskip("pyvista")
    folder = folders["pushover" if name == "links.vtkhdf" else "time-history"]
    path = folder / name
    assert pyvista.read(path).n_cells > 0
    reader = pyvista.get_reader(path)
    with dem_cli.open(folder) as result:
        reader.reader.UpdateInformation()
        assert reader.reader.GetNumberOfSteps() == len(result.frames)
        reader.reader.SetStep(len(result.frames) - 1)
        found = reader.read()
        if result.kind == "time-history":
            assert found.field_data["time"][0] == result.frames[-1].time
        fields = [f"PointData/{key}" for key in found.point_data] + [f"CellData/{key}" for key in found.cell_data]
        assert set(fields) == set(layout.declared(VTK_FILES[name][1], 2)) - OF_STRAINED
        if name == "joints.vtkhdf":
            joints = result.joints()
            for field in ("crack_width", "normal_stress", "eccentricity", "area"):
                np.testing.assert_array_equal(found.cell_data[field], joints[field].astype(np.float32))
            assert [STATES[i] for i in found.cell_data["state"]] == joints["state"].tolist()
            assert {cell.type.name for cell in found.cell} == {"LINE"}
            width = np.linalg.norm(found.points[1::2] - found.points[::2], axis=1)
            np.testing.assert_allclose(width, WIDTH, rtol=1e-3)


@pytest.mark.parametrize("name", [*VTK_FILES, "results.h5"])
def test_vtk_says_that_it_can_read_it(folders, name):
    """As ParaView asks its readers; results.h5 leads to the blocks by its link."""
    vtk = pytest.importorskip("vtkmodules.vtkIOHDF")
    reader = vtk.vtkHDFReader()
    path = str(folders["pushover"] / name)
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
    reader.Update()
    assert reader.GetOutput().GetNumberOfCells() > 0


def test_fields_say_what_they_are(folders):
    for name, (_, fields) in VTK_FILES.items():
        with h5py.File(folders["pushover"] / name, "r") as file:
            for path, said in layout.declared({**fields, **STEP_FIELDS}, 2).items():
                if path in OF_STRAINED:
                    continue
                assert file[f"VTKHDF/{path}"].attrs["meaning"] == said.meaning
                assert file[f"VTKHDF/{path}"].attrs["units"] == said.units


def test_the_same_in_two_runs(tmp_path):
    """All files for ParaView, as results.h5 (tests/determinism)."""
    for name in ("a", "b"):
        changes = {"analysis.follow": 0.004, "output.frames": 3, "analysis.resolution": 0.02}
        dem_cli.run(CASES / "verification" / "column_14.toml", changes, tmp_path / name).close()
    for name in (*(name for name in VTK_FILES if name != "links.vtkhdf"), "results.h5"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


# -- joints ----------------------------------------------------------------------------------------


def dem(*words):
    result = CliRunner().invoke(main, [str(word) for word in words])
    return result.exit_code, result.output


def test_joints_as_a_table(folders):
    folder = folders["pushover"]
    assert dem("export", folder, "--joints") == (0, f"{folder / 'joints.csv'}\n")
    with (folder / "joints.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    with dem_cli.open(folder) as result:
        joints = result.joints()
    assert [row["block a"] for row in rows] == ["c-base", "c-1", "c-2"]
    for name in ("opening", "crack_width", "slip", "normal_stress", "shear_stress", "eccentricity"):
        column = f"{name.replace('_', ' ')} [{joints.units[name]}]"
        assert [float(row[column]) for row in rows] == joints[name].tolist()
    assert [float(row["y [m]"]) for row in rows] == pytest.approx([0.0, HEIGHT, 2 * HEIGHT])
    assert [float(row["steepness [deg]"]) for row in rows] == [0.0] * 3
    assert [row["state"] for row in rows] == joints["state"].tolist()
    assert dem("export", folder, "--joints", "--frame", "0", "-o", folder / "joints.csv")[0] == 0
    assert "sticking" in (folder / "joints.csv").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--joints", "--frame", "99"], "--frame 99: the run kept"),
        (["--pvd", "--frame", "0"], "--frame is for --joints"),
        (["--pvd", "--joints"], "say which format is wanted"),
    ],
)
def test_what_export_refuses(folders, words, message):
    code, said = dem("export", folders["pushover"], *words)
    assert code == 2
    assert message in said


def test_no_joints_without_frames(folders):
    code, said = dem("export", folders["fragility"], "--joints")
    assert (code, "the results hold no joints" in said) == (2, True)


def test_joints_as_a_picture(folders, tmp_path):
    pytest.importorskip("matplotlib")
    for kind in ("pushover", "gravity"):  # with open joints, and with none
        assert dem("plot", folders[kind], "--picture", "joints", "-o", tmp_path / f"{kind}.png")[0] == 0
        assert (tmp_path / f"{kind}.png").stat().st_size > 5000
