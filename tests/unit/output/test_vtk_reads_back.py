"""VTK's own reader must see what we wrote: every step, every field, every value."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic import history_rows, wall_frames, wall_model, wall_summary

from dem_cli.core.records.frames import STAGES
from dem_cli.results.output.paraview.fields import contact_fields
from dem_cli.results.output.paraview.vertices import placed_vertices, rest_vertices, vertex_velocities
from dem_cli.results.output.store import ResultWriter

vtkIOHDF = pytest.importorskip("vtkmodules.vtkIOHDF")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    model = wall_model()
    frames = wall_frames(model)
    writer = ResultWriter(folder, model, "title = 'x'\n", {"dem": "0.1.0"}, ["top"])
    rows = history_rows(frames)
    for i, frame in enumerate(frames):
        for row in rows[10 * i : 10 * i + 10]:
            writer.row(row)
        writer.frame(frame)
    writer.close(wall_summary())
    return folder, model, frames


def steps(path):
    """Every step as VTK reads it: value, points, point data, cell data, field data, corners of the cells."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    reader = vtkIOHDF.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    for value in reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()):
        reader.UpdateTimeStep(value)
        out = reader.GetOutput()
        found = [
            {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)).copy() for k in range(data.GetNumberOfArrays())}
            for data in (out.GetPointData(), out.GetCellData(), out.GetFieldData())
        ]
        points = vtk_to_numpy(out.GetPoints().GetData()).copy() if out.GetNumberOfPoints() else np.zeros((0, 3))
        yield value, points, *found, [corners(out.GetCell(i)) for i in range(out.GetNumberOfCells())]


def corners(cell):
    return [cell.GetPointIds().GetId(i) for i in range(cell.GetNumberOfPoints())]


def expand(vectors):
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1]))).astype(np.float32)


def test_blocks(run):
    folder, model, frames = run
    read = list(steps(folder / "results.h5"))
    assert [step[0] for step in read] == list(range(len(frames)))
    for frame, (_, points, point_data, cell_data, field_data, cells) in zip(frames, read, strict=True):
        vertices = placed_vertices(model, frame.positions, frame.orientations)
        velocities = vertex_velocities(model, vertices, frame.positions, frame.velocities)
        np.testing.assert_array_equal(points, expand(vertices))
        np.testing.assert_array_equal(point_data["displacement"], expand(vertices - rest_vertices(model)))
        np.testing.assert_array_equal(point_data["velocity"], expand(velocities))
        np.testing.assert_array_equal(cell_data["block_id"], model.part_blocks)
        np.testing.assert_array_equal(cell_data["material"], model.block_material)
        np.testing.assert_array_equal(cell_data["fixed"], model.fixed)
        np.testing.assert_array_equal(cell_data["rotation"], frame.orientations[:, 0].astype(np.float32))
        check_step_fields(field_data, frame)
        starts = model.part_starts.tolist()
        assert cells == [list(range(a, b)) for a, b in zip(starts, starts[1:])]


def check_step_fields(field_data, frame):
    assert field_data["load_multiplier"] == frame.load
    assert field_data["control_displacement"] == frame.displacement
    assert field_data["stage"] == STAGES.index(frame.stage)
    assert field_data["step"] == frame.step


def test_contacts(run):
    folder, _, frames = run
    read = list(steps(folder / "contacts.vtkhdf"))
    assert len(read) == len(frames)
    for frame, (_, points, point_data, _, field_data, cells) in zip(frames, read, strict=True):
        np.testing.assert_array_equal(points, expand(frame.contacts.points))
        assert cells == [[i] for i in range(len(frame.contacts.joint))]
        check_step_fields(field_data, frame)
        expected = contact_fields(frame.contacts)
        assert point_data.keys() == expected.keys()
        for name, values in expected.items():
            np.testing.assert_array_equal(point_data[name], values)
