"""Time series in the VTKHDF format, to which steps are appended; ParaView 5.12 and later opens them.

Offsets follow what VTK 9.3 to 9.7 read alike: topology that stays is stored once, equal columns are one
dataset under several names, and the number of steps is updated last, so that a file cut off between two
steps stays readable.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import h5py
import numpy as np

from dem_cli.results.output.growing_dataset import GrowingGroup
from dem_cli.results.output.layout import Described, describe
from dem_cli.results.output.paraview.cells import Cells

_CELL_KINDS = ("Vertices", "Lines", "Polygons", "Strips")
_PARTS = "Steps/PartOffsets"
Fields = Mapping[str, np.ndarray]
Declared = Mapping[str, Described]  # what fields mean, by their paths: "PointData/displacement"


class _Series:
    """Base class of time series in VTKHDF: root group, columns and bookkeeping of steps."""

    def __init__(self, file: h5py.File, kind: str, declared: Declared):
        self.root = root = file.create_group("VTKHDF")
        root.attrs["Version"] = (2, 0)
        root.attrs.create("Type", kind.encode("ascii"), dtype=h5py.string_dtype("ascii", len(kind)))
        root.create_group("Steps").attrs["NSteps"] = 0
        self.columns = GrowingGroup(root, declared)
        self.n_steps = 0

    def _append_fields(self, kind: str, fields: Fields) -> None:
        for name, values in fields.items():
            self.columns.append(f"{kind}/{name}", values)

    def _link_offsets(self, kind: str, names: Iterable[str], target: str) -> None:
        """Link the field offsets of each step, at the first step."""
        for name in names if self.n_steps == 0 else ():
            self.columns.link(f"Steps/{kind}Offsets/{name}", target)

    def _append_step_fields(self, n: int, fields: Fields) -> None:
        """Append one number per step and field, shown by ParaView as field data."""
        columns = self.columns
        columns.append("Steps/Index", self._numbers(n))
        columns.append("Steps/One", np.ones((n, 2), dtype=np.int64))  # one component, one tuple
        self._append_fields("FieldData", fields)
        self._link_offsets("FieldData", fields, "Steps/Index")
        for name in fields if self.n_steps == 0 else ():
            columns.link(f"Steps/FieldDataSizes/{name}", "Steps/One")

    def _numbers(self, n: int) -> np.ndarray:
        """Return the numbers of the next n steps."""
        return self.n_steps + np.arange(n)

    def _close_steps(self, values: np.ndarray) -> None:
        self.columns.append("Steps/Values", values)
        self.columns.append("Steps/NumberOfParts", np.ones(len(values), np.int64))
        self.n_steps += len(values)

    def write_out(self) -> None:
        """Write the buffered rows to the file."""
        self.columns.write_out()
        self.root["Steps"].attrs["NSteps"] = self.n_steps


class GridSeries(_Series):
    """Time series of block cells whose corners move and whose topology stays (UnstructuredGrid)."""

    def __init__(self, file: h5py.File, cells: Cells, fields: Fields, declared: Declared):
        """Create the series. fields: of the cells, the same in all steps."""
        super().__init__(file, "UnstructuredGrid", declared)
        root = self.root
        self.static, self.n_cells = tuple(fields), len(cells.types)
        n_points, n_cells = int(cells.starts[-1]), self.n_cells
        for name, count in (("Points", n_points), ("Cells", n_cells), ("ConnectivityIds", n_points)):
            root[f"NumberOf{name}"] = np.array([count], dtype=np.int64)
        root["Connectivity"], root["Offsets"], root["Types"] = cells.corners, cells.starts, cells.types
        for name, values in fields.items():
            root[f"CellData/{name}"] = values
            describe(root[f"CellData/{name}"], declared[f"CellData/{name}"])

    def add(
        self,
        values: np.ndarray,
        points: np.ndarray,
        point_fields: Fields,
        cell_fields: Fields,
        step_fields: Fields,
    ) -> None:
        """Append n steps, values (n,); points and cells of the steps are concatenated.

        The cell fields of the constructor are the same in all.
        """
        columns, n = self.columns, len(values)
        start = columns.append("Points", points)
        columns.append("Steps/PointOffsets", start + len(points) // n * np.arange(n))
        columns.append("Steps/CellSteps", self._numbers(n) * (self.n_cells if cell_fields else 0))
        columns.append(_PARTS, np.zeros(n, np.int64))
        self._append_fields("PointData", point_fields)
        self._append_fields("CellData", cell_fields)
        self._append_step_fields(n, step_fields)
        self._link_offsets("PointData", point_fields, "Steps/PointOffsets")
        self._link_offsets("CellData", cell_fields, "Steps/CellSteps")
        self._link_offsets("CellData", self.static, _PARTS)
        for name in ("CellOffsets", "ConnectivityIdOffsets") if self.n_steps == 0 else ():
            columns.link(f"Steps/{name}", _PARTS)
        self._close_steps(values)


class PointSeries(_Series):
    """Time series of points with fields, a different number at each step (PolyData of vertices)."""

    def __init__(self, file: h5py.File, declared: Declared):
        super().__init__(file, "PolyData", declared)
        columns = self.columns
        columns.append("Vertices/Connectivity", np.zeros(0, dtype=np.int64))
        columns.append("Vertices/Offsets", np.zeros(1, dtype=np.int64))
        self.longest = 0
        for name in _CELL_KINDS[1:]:
            self.root[f"{name}/Connectivity"] = np.zeros(0, dtype=np.int64)
            self.root[f"{name}/Offsets"] = np.zeros(1, dtype=np.int64)

    def add(
        self, values: np.ndarray, counts: np.ndarray, points: np.ndarray, point_fields: Fields, step_fields: Fields
    ) -> None:
        """Append n steps with counts (n,) of points, concatenated with their fields.

        All steps share one list of vertices, as long as the longest needs it.
        """
        columns, n, most = self.columns, len(values), int(counts.max())
        columns.append("NumberOfPoints", counts)
        columns.append("Steps/NoCells", np.zeros(n, np.int64))
        columns.append("Steps/CellOffsets", np.zeros((n, len(_CELL_KINDS)), dtype=np.int64))
        columns.append(_PARTS, self._numbers(n))
        if most > self.longest:
            columns.append("Vertices/Connectivity", np.arange(self.longest, most, dtype=np.int64))
            columns.append("Vertices/Offsets", np.arange(self.longest + 1, most + 1, dtype=np.int64))
            self.longest = most
        start = columns.append("Points", points)
        columns.append("Steps/PointOffsets", start + np.cumsum(counts) - counts)
        self._append_fields("PointData", point_fields)
        self._append_step_fields(n, step_fields)
        self._link_offsets("PointData", point_fields, "Steps/PointOffsets")
        if self.n_steps == 0:
            self._link_topology()
        self._close_steps(values)

    def _link_topology(self) -> None:
        self.columns.link("Steps/ConnectivityIdOffsets", "Steps/CellOffsets")
        for kind in _CELL_KINDS:
            for name in ("NumberOfCells", "NumberOfConnectivityIds"):
                target = "NumberOfPoints" if kind == "Vertices" else "Steps/NoCells"
                self.columns.link(f"{kind}/{name}", target)
