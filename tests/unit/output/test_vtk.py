"""The XML files for older ParaView, read by VTK's own readers."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest
from synthetic import history_rows, wall_frames, wall_model, wall_summary

from dem_cli.errors import OutputError, UsageError
from dem_cli.results.output.paraview.fields import block_fields, contact_fields, turning_fields
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices
from dem_cli.results.output.paraview.vtk import export_pvd, write_geometry
from dem_cli.results.output.reader import read
from dem_cli.results.output.store import ResultWriter

vtkIOXML = pytest.importorskip("vtkmodules.vtkIOXML")


def read_xml(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    kinds = {".vtu": vtkIOXML.vtkXMLUnstructuredGridReader, ".vtp": vtkIOXML.vtkXMLPolyDataReader}
    reader = kinds[path.suffix]()
    reader.SetFileName(str(path))
    reader.Update()
    out = reader.GetOutput()
    found = [
        {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}
        for data in (out.GetPointData(), out.GetCellData(), out.GetFieldData())
    ]
    points = vtk_to_numpy(out.GetPoints().GetData()) if out.GetNumberOfPoints() else np.zeros((0, 3))
    return points, *found, out.GetNumberOfCells()


def assert_fields(found, expected):
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], values)


def test_geometry(tmp_path):
    model = wall_model()
    write_geometry(tmp_path / "new" / "model.vtu", model)
    points, _, cells, _, n_cells = read_xml(tmp_path / "new" / "model.vtu")
    assert n_cells == model.n_parts
    np.testing.assert_array_equal(points[:, :2], rest_vertices(model).astype(np.float32))
    assert_fields(cells, block_fields(model))
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["model.vtu"]


def test_geometry_in_another_format(tmp_path):
    write_geometry(tmp_path / "model.obj", wall_model())
    assert (tmp_path / "model.obj").read_text().count("\nf ") == 22


def test_geometry_in_an_unknown_format(tmp_path):
    with pytest.raises(UsageError, match=r"model\.docx: cannot be written"):
        write_geometry(tmp_path / "model.docx", wall_model())


def test_export(tmp_path):
    model = wall_model()
    frames = wall_frames(model, 4)
    writer = ResultWriter(tmp_path, model, "", {}, ["top"])
    for row in history_rows(frames):
        writer.row(row)
    for frame in frames:
        writer.frame(frame)
    writer.close(wall_summary())
    series = export_pvd(read(tmp_path), tmp_path / "pvd")
    assert [path.name for path in series] == ["blocks.pvd", "contacts.pvd"]
    for path, suffix in zip(series, (".vtu", ".vtp"), strict=True):
        sets = ElementTree.parse(path).findall("Collection/DataSet")
        assert [float(s.get("timestep")) for s in sets] == [0, 1, 2, 3]
        for entry, frame in zip(sets, frames, strict=True):
            points, point_data, cells, steps, _ = read_xml(path.parent / entry.get("file"))
            assert entry.get("file").endswith(suffix)
            assert (steps["load_multiplier"], steps["step"]) == (frame.load, frame.step)
            if suffix == ".vtu":
                vertices = placed_vertices(model, frame.positions, frame.orientations)
                np.testing.assert_array_equal(points[:, :2], vertices.astype(np.float32))
                assert point_data.keys() == {"displacement", "velocity"}
                assert_fields(cells, block_fields(model) | turning_fields(model, frame))
            else:
                np.testing.assert_array_equal(points[:, :2], frame.contacts.points.astype(np.float32))
                assert_fields(point_data, contact_fields(frame.contacts))


@pytest.mark.parametrize(("there", "error"), [(False, OSError(28, "full")), (True, KeyboardInterrupt())])
def test_an_export_that_fails_leaves_nothing(tmp_path, monkeypatch, there, error):
    """The folder stayed, with the frames up to the one that failed and no .pvd over them."""
    from dem_cli.results.output.paraview import vtk

    writer = ResultWriter(tmp_path, wall_model(), "", {}, ["top"])
    for frame in wall_frames(wall_model(), 4):
        writer.frame(frame)
    writer.close(wall_summary())
    place = tmp_path / "a" / "pvd"
    if there:
        place.mkdir(parents=True)
        (place / "blocks_0000.vtu").write_text("earlier")
    written = iter(range(3))

    def points(frame):
        if next(written) == 2:
            raise error
        return ""

    monkeypatch.setattr(vtk, "_points", points)
    with pytest.raises((OutputError, KeyboardInterrupt)):
        export_pvd(read(tmp_path), place)
    assert (tmp_path / "a").exists() is there
    if there:
        assert [(path.name, path.read_text()) for path in place.iterdir()] == [("blocks_0000.vtu", "earlier")]


def test_nothing_to_export(tmp_path):
    writer = ResultWriter(tmp_path, wall_model(), "", {})
    writer.close(wall_summary())
    with pytest.raises(UsageError, match="no frames"):
        export_pvd(read(tmp_path), tmp_path / "pvd")
