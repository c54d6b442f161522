"""Time series in the VTKHDF format, appended step by step; ParaView opens them (5.12 and later).

Offsets follow what VTK 9.3 to 9.7 read alike: topology that stays is stored once, the number of steps is
updated last, so that a file cut off between two steps stays readable.
"""

from __future__ import annotations

from collections.abc import Mapping

import h5py
import numpy as np

_CHUNK_BYTES = 32768


def grow(group: h5py.Group, name: str, rows: np.ndarray) -> int:
    """Append `rows` to a dataset, made where it is missing; returns the length that it had before."""
    rows = np.asarray(rows)
    if name not in group:
        width = [max(1, size) for size in rows.shape[1:]]
        row_bytes = rows.dtype.itemsize * int(np.prod(width))
        n_rows = max(1, min(max(64, len(rows)), _CHUNK_BYTES // row_bytes))
        group.create_dataset(name, data=rows, maxshape=(None, *rows.shape[1:]), chunks=(n_rows, *width))
        return 0
    data = group[name]
    start = data.shape[0]
    data.resize(start + len(rows), axis=0)
    if len(rows):
        data[start:] = rows
    return start


def _root(file: h5py.File, kind: str) -> h5py.Group:
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = (2, 0)
    root.attrs.create("Type", kind.encode("ascii"), dtype=h5py.string_dtype("ascii", len(kind)))
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = 0
    return root


def _add_fields(root: h5py.Group, kind: str, fields: Mapping[str, np.ndarray]) -> None:
    """Append a step of fields; `kind` is PointData, CellData or FieldData."""
    data, steps = root.require_group(kind), root["Steps"]
    offsets = steps.require_group(f"{kind}Offsets")
    for name, values in fields.items():
        grow(offsets, name, np.array([grow(data, name, values)], dtype=np.int64))
        if kind == "FieldData":
            size = np.array([[values.shape[1] if values.ndim > 1 else 1, len(values)]], dtype=np.int64)
            grow(steps.require_group("FieldDataSizes"), name, size)


def _close_step(root: h5py.Group, value: float, static: Mapping[str, int]) -> None:
    """Write the step's value and topology offsets; only then does the step count."""
    steps = root["Steps"]
    grow(steps, "Values", np.array([value]))
    grow(steps, "NumberOfParts", np.array([1], dtype=np.int64))
    grow(steps, "PointOffsets", np.array([static["PointOffsets"]], dtype=np.int64))
    grow(steps, "PartOffsets", np.array([static["PartOffsets"]], dtype=np.int64))
    width = static["cell_columns"]
    zeros = np.zeros((1, width) if width > 1 else 1, dtype=np.int64)
    grow(steps, "CellOffsets", zeros)
    grow(steps, "ConnectivityIdOffsets", zeros)
    steps.attrs["NSteps"] = steps["Values"].shape[0]


class GridSeries:
    """Blocks as cells whose corners move and whose topology stays (UnstructuredGrid)."""

    def __init__(self, file: h5py.File, starts: np.ndarray, cell_type: int, cells: Mapping[str, np.ndarray]):
        self.root = root = _root(file, "UnstructuredGrid")
        self.static = dict(cells)
        n_points, n_cells = int(starts[-1]), len(starts) - 1
        for name, count in (("Points", n_points), ("Cells", n_cells), ("ConnectivityIds", n_points)):
            root[f"NumberOf{name}"] = np.array([count], dtype=np.int64)
        root["Connectivity"] = np.arange(n_points, dtype=np.int64)
        root["Offsets"] = np.asarray(starts, dtype=np.int64)
        root["Types"] = np.full(n_cells, cell_type, dtype=np.uint8)
        for name, values in cells.items():
            root.require_group("CellData")[name] = values

    def add(
        self,
        value: float,
        points: np.ndarray,
        point_fields: Mapping[str, np.ndarray],
        cell_fields: Mapping[str, np.ndarray],
        step_fields: Mapping[str, np.ndarray],
    ) -> None:
        """Append a step; the cell fields of the constructor are the same in all."""
        root = self.root
        start = grow(root, "Points", points)
        _add_fields(root, "PointData", point_fields)
        _add_fields(root, "CellData", cell_fields)
        _add_fields(root, "FieldData", step_fields)
        offsets = root["Steps"].require_group("CellDataOffsets")
        for name in self.static:
            grow(offsets, name, np.zeros(1, dtype=np.int64))
        _close_step(root, value, {"PointOffsets": start, "PartOffsets": 0, "cell_columns": 1})


class PointSeries:
    """Points with fields, a different number at each step (PolyData of vertices)."""

    def __init__(self, file: h5py.File):
        self.root = root = _root(file, "PolyData")
        for name in ("Vertices", "Lines", "Polygons", "Strips"):
            group = root.create_group(name)
            grow(group, "Connectivity", np.zeros(0, dtype=np.int64))
            grow(group, "Offsets", np.zeros(1, dtype=np.int64))

    def add(
        self,
        value: float,
        points: np.ndarray,
        point_fields: Mapping[str, np.ndarray],
        step_fields: Mapping[str, np.ndarray],
    ) -> None:
        """Append a step. All steps share one list of vertices, as long as the longest needs it."""
        root, count = self.root, len(points)
        part = grow(root, "NumberOfPoints", np.array([count], dtype=np.int64))
        for name in ("Vertices", "Lines", "Polygons", "Strips"):
            n_cells = np.array([count if name == "Vertices" else 0], dtype=np.int64)
            grow(root[name], "NumberOfCells", n_cells)
            grow(root[name], "NumberOfConnectivityIds", n_cells)
        vertices = root["Vertices"]
        have = vertices["Connectivity"].shape[0]
        if count > have:
            grow(vertices, "Connectivity", np.arange(have, count, dtype=np.int64))
            grow(vertices, "Offsets", np.arange(have + 1, count + 1, dtype=np.int64))
        start = grow(root, "Points", points)
        _add_fields(root, "PointData", point_fields)
        _add_fields(root, "FieldData", step_fields)
        _close_step(root, value, {"PointOffsets": start, "PartOffsets": part, "cell_columns": 4})
