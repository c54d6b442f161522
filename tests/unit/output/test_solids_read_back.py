"""Files of structures in space: every reader gets back the numbers, and each block is the solid that it was."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from synthetic.solid_runs import DEPTH, drum, solid_frames, solid_wall, write_solid_run
from synthetic.spatial import spatial_model
from synthetic.tumbling import column, write_collapse

from dem_cli.core.contact.drawn_joints import DrawnJoints
from dem_cli.core.geometry.polyhedron import box, hull
from dem_cli.core.model.model import WHERE_ASKED_FOR
from dem_cli.core.records.frames import JointPlaces
from dem_cli.results.output.joint_table import write_joints
from dem_cli.results.output.layout import CONTACTS, FRAMES, MODEL, declared
from dem_cli.results.output.paraview.cells import CONVEX_POINT_SET, cells_of, outlines_of_joints
from dem_cli.results.output.paraview.vtk import export_pvd, write_geometry
from dem_cli.results.output.reader import read

DENSITY = 2000.0  # of the made-up models
TETRAHEDRON, HEXAHEDRON, WEDGE, PYRAMID, PENTAGONAL, HEXAGONAL = 10, 12, 13, 14, 15, 16


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    model = solid_wall()
    frames = solid_frames(model)
    return write_solid_run(tmp_path_factory.mktemp("space") / "run", model, frames), model, frames


def test_everything_comes_back(run):
    folder, model, frames = run
    found = read(folder)
    for name, value in model._asdict().items():
        np.testing.assert_array_equal(getattr(found.model, name), value, err_msg=name)
    assert len(found.frames) == len(frames)
    for frame, expected in zip(found.frames, frames, strict=True):
        for name in ("positions", "orientations", "velocities"):
            np.testing.assert_array_equal(getattr(frame, name), getattr(expected, name))
        for name, values in expected.contacts._asdict().items():
            np.testing.assert_array_equal(getattr(frame.contacts, name), values, err_msg=name)
    assert "orientations" not in found.frames.units  # quaternions have none


def test_every_component_has_its_name(run):
    said = {"model": MODEL, "frames": FRAMES, "contacts": CONTACTS}
    with h5py.File(run[0] / "results.h5", "r") as file:
        for group, table in said.items():
            for name, what in declared(table, 3).items():
                if name in (*WHERE_ASKED_FOR, "stresses", "first_moments"):  # where the case asks for it
                    assert name not in file["dem"][group]
                    continue
                data = file["dem"][group][name]
                assert data.attrs["meaning"] == what.meaning, name
                assert list(data.attrs.get("DIMENSION_LABELS", ())) == list(what.axes), name
                assert len(what.axes) == data.ndim, name
                for words in (what.columns, what.units):
                    assert isinstance(words, str) or not words or len(words) == data.shape[-1], name
        assert file["dem/contacts/shear_force"].attrs["columns"].tolist() == ["t1", "t2"]
        assert file["dem/model/vertices"].attrs["columns"].tolist() == ["x", "y", "z"]


def test_paraview_knows_how_blocks_turn(tmp_path):
    """Blocks that tumble: orientations as they were handed over, and velocities of corners that follow from them."""
    folder, model = write_collapse(tmp_path / "run", 12), column()
    with h5py.File(folder / "blocks.vtkhdf", "r") as file:
        cells, points = file["VTKHDF/CellData"], file["VTKHDF/PointData"]
        turns, spins, speeds = cells["orientation"][:], cells["angular_velocity"][:], points["velocity"][:]
        corners = file["VTKHDF/Points"][:]
    n, frames = model.n_blocks, read(folder).frames
    for i, frame in enumerate(frames):
        np.testing.assert_array_equal(turns[n * i : n * (i + 1)], frame.orientations.astype(np.float32))
        np.testing.assert_array_equal(spins[n * i : n * (i + 1)], frame.velocities[:, 3:].astype(np.float32))
        here, owners = slice(8 * n * i, 8 * n * (i + 1)), model.vertex_blocks
        expected = Rotation.from_quat(frame.orientations[owners], scalar_first=True).apply(model.vertices)
        np.testing.assert_allclose(corners[here], frame.positions[owners] + expected, atol=1e-6)
        swept = frame.velocities[owners, :3] + np.cross(frame.velocities[owners, 3:], expected)
        np.testing.assert_allclose(speeds[here], swept, atol=2e-6)
    assert np.abs(turns[:, 0]).min() < 0.2  # some turn right over


def test_forces_in_space(run):
    """Normal force along the normal, shear along the tangents, which make a right-handed frame."""
    contacts = run[2][-1].contacts
    n, t1 = contacts.normals, contacts.tangents
    t2 = np.cross(n, t1)
    forces = contacts.forces()
    parts = [(forces * axis).sum(axis=1) for axis in (n, t1, t2)]
    np.testing.assert_allclose(parts[0], contacts.normal_force, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(np.stack(parts[1:], axis=1), contacts.shear_force, rtol=1e-12, atol=1e-9)


def volumes(cells):
    return measured(cells, "Volume")


def measured(cells, size_of):
    vtk = pytest.importorskip("vtkmodules.vtkFiltersVerdict")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    size = vtk.vtkCellSizeFilter()
    size.SetInputData(cells)
    size.Update()
    return vtk_to_numpy(size.GetOutput().GetCellData().GetArray(size_of))


def faces_look_outwards(cell, places) -> bool:
    """Whether every face of a VTK cell is counter-clockwise seen from outside."""
    ids = [cell.GetPointIds().GetId(i) for i in range(cell.GetNumberOfPoints())]
    middle = places[ids].mean(axis=0)
    for k in range(cell.GetNumberOfFaces()):
        face = cell.GetFace(k).GetPointIds()
        loop = places[[face.GetId(i) for i in range(face.GetNumberOfIds())]]
        if np.cross(loop[1] - loop[0], loop[2] - loop[0]) @ (loop.mean(axis=0) - middle) <= 0.0:
            return False
    return True


def shapes():
    """One block of each kind, turned so that no edge is along an axis."""
    ring = [(np.cos(a), np.sin(a)) for a in np.linspace(0.0, 2.0 * np.pi, 9)[:-1]]
    prisms = {n: [(x, y, z) for x, y in np.array(ring)[: n if n < 8 else 8] for z in (0.0, 1.3)] for n in (3, 5, 6, 7)}
    points = {
        TETRAHEDRON: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
        PYRAMID: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.4, 2.0)],
        WEDGE: prisms[3], PENTAGONAL: prisms[5], HEXAGONAL: prisms[6], CONVEX_POINT_SET: prisms[7],
        HEXAHEDRON: [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)],
    }  # fmt: skip
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    return {kind: hull(np.array(corners, float) @ turn.T) for kind, corners in points.items()}


def test_cells_are_solids_of_the_right_kind_and_volume(tmp_path):
    solids = shapes()
    model = spatial_model([box((0, 0, 0), (1, 1, 1)), *solids.values()])
    assert cells_of(model).types.tolist() == [HEXAHEDRON, *solids]
    write_geometry(tmp_path / "model.vtu", model)
    grid = vtu(tmp_path / "model.vtu")
    np.testing.assert_allclose(volumes(grid), model.masses / DENSITY, rtol=1e-5)  # of float32 corners
    places = np.array([grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())])
    for i, kind in enumerate([HEXAHEDRON, *solids]):
        assert kind == CONVEX_POINT_SET or faces_look_outwards(grid.GetCell(i), places), kind


def vtu(path):
    vtk = pytest.importorskip("vtkmodules.vtkIOXML")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def test_blocks_over_time_as_paraview_reads_them(run):
    vtk = pytest.importorskip("vtkmodules.vtkIOHDF")
    folder, model, frames = run
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(folder / "blocks.vtkhdf"))
    reader.UpdateInformation()
    reader.SetStep(len(frames) - 1)
    reader.Update()
    grid = reader.GetOutput()
    assert [grid.GetCellType(i) for i in range(grid.GetNumberOfCells())] == [HEXAHEDRON] * model.n_blocks
    np.testing.assert_allclose(volumes(grid), model.masses / DENSITY, rtol=1e-5)


def test_a_drum_of_seven_sides_keeps_its_volume(tmp_path):
    model = drum(7)
    write_geometry(tmp_path / "drum.vtu", model)
    np.testing.assert_allclose(volumes(vtu(tmp_path / "drum.vtu"))[1], 7.0 * np.sin(2.0 * np.pi / 7.0), rtol=1e-5)


def test_faces_for_other_programs(run, tmp_path):
    """Of a box six faces of four corners, for programs that know no solids."""
    write_geometry(tmp_path / "model.obj", run[1])
    lines = (tmp_path / "model.obj").read_text().splitlines()
    faces = [line.split()[1:] for line in lines if line.startswith("f ")]
    assert len(faces) == 6 * run[1].n_blocks
    assert {len(face) for face in faces} == {4}


def test_triangles_for_programs_that_know_no_other_faces(run, tmp_path):
    """The surface of STL encloses the volume of the blocks."""
    write_geometry(tmp_path / "model.stl", run[1])
    lines = [line.split() for line in (tmp_path / "model.stl").read_text(encoding="ascii").splitlines()]
    corners = np.array([line[1:] for line in lines if line and line[0] == "vertex"], float)
    a, b, c = (corners[k::3] for k in range(3))
    assert len(a) == 12 * run[1].n_blocks
    enclosed = np.einsum("nk,nk->n", a, np.cross(b, c)).sum() / 6.0
    assert enclosed == pytest.approx(run[1].masses.sum() / DENSITY, rel=1e-5)


def test_series_for_older_paraview(run, tmp_path):
    series = export_pvd(read(run[0]), tmp_path)
    assert [path.name for path in series] == ["blocks.pvd", "contacts.pvd"]
    grid = vtu(tmp_path / "blocks_0007.vtu")
    np.testing.assert_allclose(volumes(grid), run[1].masses / DENSITY, rtol=1e-5)


def test_joints_are_polygons_that_move_with_the_blocks(tmp_path):
    """ParaView reads as many polygons as there are joints, with their areas; the table has a line for each."""
    vtk = pytest.importorskip("vtkmodules.vtkIOHDF")
    model = solid_wall()
    folder = write_solid_run(tmp_path, model, solid_frames(model, 2), DrawnJoints)
    found, drawn = read(folder).joints, DrawnJoints(model)
    for name, values in drawn.places._asdict().items():
        np.testing.assert_array_equal(getattr(found.places, name), values, err_msg=name)
    assert found.at(1).opening.max() == pytest.approx(0.5 * DEPTH * np.sin(0.5))  # leaning by 0.5 about its lower edge
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(folder / "joints.vtkhdf"))
    reader.UpdateInformation()
    reader.SetStep(0)
    reader.Update()
    grid = reader.GetOutput()
    assert [grid.GetCellType(i) for i in range(grid.GetNumberOfCells())] == [7] * len(drawn.places.area)
    np.testing.assert_allclose(measured(grid, "Area"), drawn.places.area, rtol=1e-5)
    write_joints(read(folder), 1, tmp_path / "joints.csv")
    head, first = (tmp_path / "joints.csv").read_text().splitlines()[:2]
    assert head.startswith("block a,block b,x [m],y [m],z [m],steepness [deg],length [m],area [m2],opening [m]")
    assert len(first.split(",")) == len(head.split(","))


def test_lone_edges_and_corners_are_lines_and_points():
    places = JointPlaces(
        np.zeros((3, 2), int), np.zeros((3, 2, 3)), np.zeros((3, 3)), np.zeros(3), np.ones(3),
        np.array([0, 1, 3, 7]), np.zeros((7, 3)),
    )  # fmt: skip
    assert outlines_of_joints(places).types.tolist() == [1, 3, 7]
