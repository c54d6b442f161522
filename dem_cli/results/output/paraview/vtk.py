"""Export to VTK: the blocks of a model for other programs, and .vtu/.vtp + .pvd series for ParaView before 5.12."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.errors import UsageError
from dem_cli.results.output.atomic_file import whole_folder, write_text
from dem_cli.results.output.folder import write_error
from dem_cli.results.output.paraview.cells import cells_of, outlines
from dem_cli.results.output.paraview.fields import block_fields, contact_fields, turning_fields
from dem_cli.results.output.paraview.vertices import in_space, placed_vertices, rest_vertices, vertex_velocities
from dem_cli.results.output.reader import Results

Fields = Mapping[str, np.ndarray]
_OF_TRIANGLES = (".stl",)  # formats that know no other faces
_TYPES = {
    np.dtype(np.float32): "Float32",
    np.dtype(np.float64): "Float64",
    np.dtype(np.int32): "Int32",
    np.dtype(np.int64): "Int64",
    np.dtype(np.uint8): "UInt8",
}


def write_geometry(path: Path, model: Model) -> None:
    """Write the undeformed blocks: .vtu, or any other format of meshio by its suffix."""
    path = Path(path)
    vertices = in_space(rest_vertices(model))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".vtu":
            write_text(path, _grid(model, vertices, {}, block_fields(model), {}))
        else:
            _write_foreign(path, model, vertices)
    except OSError as error:
        raise write_error(error, path) from None


def export_pvd(results: Results, folder: Path) -> list[Path]:
    """Write every frame as blocks_0000.vtu and contacts_0000.vtp, with blocks.pvd and contacts.pvd over them.

    Raises UsageError where there are no frames, and OutputError; then nothing of it is there.
    """
    if not len(results.frames):
        raise UsageError("the results hold no frames (output.frames = 0), so there is nothing to export")
    model, digits = results.model, max(4, len(str(len(results.frames))))
    series: dict[str, list[str]] = {"blocks": [], "contacts": []}
    with whole_folder(folder) as place:
        for i, frame in enumerate(results.frames):
            files = {
                f"blocks_{i:0{digits}}.vtu": _blocks(model, frame),
                f"contacts_{i:0{digits}}.vtp": _points(frame),
            }
            for name, text in files.items():
                (place / name).write_text(text, encoding="utf-8", newline="\n")
                series[name.split("_")[0]].append(name)
        for kind, names in series.items():
            (place / f"{kind}.pvd").write_text(_collection(names, times(results)), encoding="utf-8", newline="\n")
    return [folder / f"{kind}.pvd" for kind in series]


def _write_foreign(path: Path, model: Model, vertices: np.ndarray) -> None:
    import meshio

    starts, corners = outlines(model)
    loops = [corners[a:b] for a, b in zip(starts, starts[1:])]
    if path.suffix.lower() in _OF_TRIANGLES:
        fans = [np.column_stack([np.full(len(loop) - 2, loop[0]), loop[1:-1], loop[2:]]) for loop in loops]
        cells = [("triangle", np.concatenate(fans))]
    else:
        cells = [("polygon", loop[np.newaxis]) for loop in loops]
    try:
        meshio.Mesh(vertices, cells).write(path)
    except (meshio.ReadError, meshio.WriteError, KeyError, SystemExit) as error:
        reason = str(error).splitlines()[0] if str(error) else "not a format for polygons"
        raise UsageError(f"{path}: cannot be written ({reason}); .vtu always can") from None


def _blocks(model: Model, frame: Frame) -> str:
    vertices = placed_vertices(model, frame.positions, frame.orientations)
    velocities = vertex_velocities(model, vertices, frame.positions, frame.velocities)
    moved = in_space(vertices - rest_vertices(model))
    fields = {"displacement": moved, "velocity": in_space(velocities)}
    cells = block_fields(model) | turning_fields(model, frame)
    return _grid(model, in_space(vertices), fields, cells, _step_fields(frame))


def _step_fields(frame: Frame) -> Fields:
    return {
        "load_multiplier": np.array([frame.load]),
        "control_displacement": np.array([frame.displacement]),
        "step": np.array([frame.step], dtype=np.int64),
        "time": np.array([frame.time]),
    }


def _grid(model: Model, vertices: np.ndarray, points: Fields, cells: Fields, steps: Fields) -> str:
    found = cells_of(model)
    topology: Fields = {"connectivity": found.corners, "offsets": found.starts[1:], "types": found.types}
    piece = f'NumberOfPoints="{len(vertices)}" NumberOfCells="{model.n_parts}"'
    sections = (
        ("PointData", points),
        ("CellData", cells),
        ("Points", {"points": vertices}),
        ("Cells", topology),
    )
    return _file("UnstructuredGrid", piece, sections, steps)


def _points(frame: Frame) -> str:
    contacts = frame.contacts
    n = len(contacts.joint)
    topology = {"connectivity": np.arange(n, dtype=np.int64), "offsets": np.arange(1, n + 1, dtype=np.int64)}
    piece = f'NumberOfPoints="{n}" NumberOfVerts="{n}"'
    sections = (
        ("PointData", contact_fields(contacts)),
        ("Points", {"points": in_space(contacts.points)}),
        ("Verts", topology),
    )
    return _file("PolyData", piece, sections, _step_fields(frame))


def _file(kind: str, piece: str, sections: Iterable[tuple[str, Fields]], steps: Fields) -> str:
    inner = "".join(_section(name, fields) for name, fields in sections)
    field_data = _section("FieldData", steps, 'NumberOfTuples="1" ')
    return (
        f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64">\n<{kind}>\n{field_data}<Piece {piece}>\n{inner}</Piece>\n'
        f"</{kind}>\n</VTKFile>\n"
    )


def _section(name: str, fields: Fields, extra: str = "") -> str:
    return f"<{name}>\n" + "".join(_array(key, values, extra) for key, values in fields.items()) + f"</{name}>\n"


def _array(name: str, values: np.ndarray, extra: str) -> str:
    width = values.shape[1] if values.ndim > 1 else 1
    raw = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).tobytes()
    text = base64.b64encode(np.array([len(raw)], dtype="<u8").tobytes() + raw).decode("ascii")
    return (
        f'<DataArray type="{_TYPES[values.dtype]}" Name={quoteattr(name)} NumberOfComponents="{width}" '
        f'{extra}format="binary">{text}</DataArray>\n'
    )


def times(results: Results) -> list[float]:
    """Return the times of the frames: seconds in time histories, otherwise their number."""
    if kind_of(results.kind).timed:
        return [frame.time for frame in results.frames]
    return [float(i) for i in range(len(results.frames))]


def _collection(names: list[str], values: list[float]) -> str:
    rows = "".join(
        f'<DataSet timestep="{value:.9g}" part="0" file={quoteattr(name)}/>\n'
        for value, name in zip(values, names, strict=True)
    )
    return (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        f"<Collection>\n{rows}</Collection>\n</VTKFile>\n"
    )
