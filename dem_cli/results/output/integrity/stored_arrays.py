"""Check arrays of results.h5 against output/layout.py: missing ones, wrong shape or type.

Only what HDF5 knows without reading values: cheap for any size. What is stored elsewhere (links to other files,
external storage) and what would fill the memory is refused before anything is read.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from dem_cli.core.records.frames import STAGES, STATES
from dem_cli.core.records.history_rows import MONITOR_UNITS
from dem_cli.errors import DamagedResults
from dem_cli.input_limits import MOST_EXPANSION, SMALL_RESULTS
from dem_cli.results.output.integrity.array_values import checked
from dem_cli.results.output.layout import GROUPS, NAMES, NUMBERS, ONE_MORE, TRUTHS, WHOLE, Described, Group, declared

KINDS = {NUMBERS: "f", WHOLE: "iu", TRUTHS: "b", NAMES: "OS"}  # of NumPy
GROWING = ("frame", "row", "sample", "contact point")  # axes that a killed run may have left longer than it counted
DEM = "/dem"


class StoredArrays:
    """Datasets below /dem, checked against their declaration."""

    def __init__(self, file: h5py.File):
        """Check all groups. Raises DamagedResults where a group, a dataset or an attribute is missing or wrong."""
        self.dem = self._dem(file)
        self.dimension = int(self.dem["model"].attrs["dimension"])
        if self.dimension not in (2, 3):
            raise DamagedResults(f"/dem/model: the attribute dimension is {self.dimension}; it is 2 or 3")
        self.sizes = {
            "coordinate": self.dimension, "direction": 2, "term": 6, "end": 2, "tangent": self.dimension - 1,
            "stage": len(STAGES), "state": len(STATES),
        }  # fmt: skip
        self._said: dict[str, Described] = {}
        for path, group in GROUPS.items():
            if path in self:
                self._check_group(path, group)

    def __contains__(self, path: str) -> bool:
        return path == DEM or path.removeprefix(f"{DEM}/") in self.dem

    def dataset(self, path: str) -> h5py.Dataset:
        """Return a dataset by its path, such as /dem/model/masses. Raises DamagedResults: it is missing."""
        if path not in self:
            raise DamagedResults(f"{path} is missing")
        return self.dem[path.removeprefix(f"{DEM}/")]

    def array(self, path: str, rows: int | None = None) -> np.ndarray:
        """Read the values of a dataset, of the first rows; text as strings. Raises DamagedResults."""
        data = self.dataset(path)
        try:
            values = data.asstr()[:rows] if data.dtype.kind in KINDS[NAMES] else data[:rows]
        except (OSError, UnicodeDecodeError, ValueError) as error:
            raise DamagedResults(f"{path} cannot be read ({_reason(error)})") from None
        return self.checked(path, values)

    def text(self, path: str) -> str:
        """Read the text of a dataset. Raises DamagedResults."""
        try:
            return str(self.dataset(path).asstr()[()])
        except (OSError, UnicodeDecodeError, ValueError, TypeError) as error:
            raise DamagedResults(f"{path} cannot be read ({_reason(error)})") from None

    def checked(self, path: str, values: np.ndarray) -> np.ndarray:
        """Check values of a dataset, or of a part of it, and return them. Raises DamagedResults."""
        return checked(path, values, self._said[path], self.sizes) if path in self._said else values

    @staticmethod
    def _dem(file: h5py.File) -> h5py.Group:
        """Return the root group after checking its groups and attributes."""
        _check_where(file)
        if not isinstance(file.get("dem"), h5py.Group):
            raise DamagedResults(f"{DEM} is missing")
        dem = file["dem"]
        for path, said in GROUPS.items():
            group = dem if path == DEM else dem.get(path.removeprefix(f"{DEM}/"))
            if group is None and said.optional:
                continue
            if not isinstance(group, h5py.Group):
                raise DamagedResults(f"{path} is {'missing' if group is None else 'not a group'}")
            _check_attributes(path, group, said)
        return dem

    def _check_group(self, path: str, group: Group) -> None:
        """Check all datasets of a group."""
        said = declared(group.datasets, self.dimension)
        inside = self.dem if path == DEM else self.dem[path.removeprefix(f"{DEM}/")]
        if "monitors" in group.attributes:
            self.sizes["monitor"] = len(inside.attrs["monitors"])
        begun = group.counted_by in inside or not group.counted_by
        for name in sorted(said, key=lambda name: name != group.counted_by):
            full = f"{path}/{name}"
            if name in inside:
                self._said[full] = said[name]
                self._check(full, inside[name], said[name])
            elif self._needed(path, name, said[name], begun):
                raise DamagedResults(f"{full} is missing")
        if not begun and any(len(inside[name]) for name in said if name in inside):
            raise DamagedResults(f"{path}/{group.counted_by} is missing")

    def _needed(self, path: str, name: str, said: Described, begun: bool) -> bool:
        """Test whether a missing dataset is required."""
        growing = said.axes[0] if said.axes and said.axes[0] in GROWING else ""
        empty = growing and not self.sizes.get(growing, 0)
        no_monitors = said.axes[-1:] == ("monitor",) and not self.sizes["monitor"]
        return begun and not (said.optional or empty or no_monitors)

    def _check(self, path: str, data: Any, said: Described) -> None:
        """Check type and shape of one dataset; it defines the sizes of axes not seen before."""
        if not isinstance(data, h5py.Dataset):
            raise DamagedResults(f"{path} is not a dataset")
        if data.dtype.kind not in KINDS[said.kind]:
            raise DamagedResults(f"{path} holds {data.dtype}, not {said.kind}")
        if data.shape is None or len(data.shape) != len(said.axes):
            raise DamagedResults(f"{path} has the shape {data.shape}, not {_words(said)}")
        for k, (axis, size) in enumerate(zip(said.axes, data.shape)):
            wanted = self._size(axis, said, k == len(said.axes) - 1, size)
            if size < wanted or (size > wanted and axis not in GROWING):
                raise DamagedResults(f"{path} has the shape {data.shape}, not {_words(said)}: {axis} is {wanted}")
        if path == "/dem/frames/n_contacts":
            self.sizes["contact point"] = int(checked(path, data[:], said, self.sizes).sum())

    def _size(self, axis: str, said: Described, last: bool, size: int) -> int:
        """Return the required length of an axis."""
        if last and said.columns and axis != "mode":
            return len(said.columns)
        more = axis.endswith(ONE_MORE)
        return self.sizes.setdefault(axis.removesuffix(ONE_MORE), max(size - more, 0)) + more


class LaterArray:
    """Dataset of an open file that is read and checked on access."""

    def __init__(self, arrays: StoredArrays, path: str, folder: Path):
        """Open the dataset. folder: of the results, for messages."""
        self._arrays, self._path, self._folder = arrays, path, folder
        self._data = arrays.dataset(path)
        self.shape: tuple[int, ...] = self._data.shape

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, rows: int | slice) -> np.ndarray:
        """Read and check rows. Raises DamagedResults."""
        try:
            return self._arrays.checked(self._path, self._data[rows])
        except DamagedResults as error:
            raise DamagedResults(error.damage, self._folder) from None
        except Exception as error:
            if not of_hdf5(error):
                raise
            raise DamagedResults(f"{self._path} cannot be read ({_reason(error)})", self._folder) from None


def of_hdf5(error: Exception) -> bool:
    """Test whether HDF5 raised an error: on damaged bytes it raises KeyError, OSError, ValueError, …"""
    trace, module = error.__traceback__, ""
    while trace is not None:
        module, trace = trace.tb_frame.f_globals.get("__name__", ""), trace.tb_next
    return isinstance(error, (OSError, RuntimeError)) or module.split(".")[0] == "h5py"


def check_size(file: h5py.File, path: Path) -> None:
    """Raise DamagedResults where reading a file would take far more memory than the file takes on the disk."""
    allowed = max(SMALL_RESULTS, MOST_EXPANSION * path.stat().st_size)
    total = sum(data.nbytes for _, data in _datasets(file))
    if total > allowed:
        raise DamagedResults(
            f"it would take {total / 1e9:,.0f} GB to read a file of {path.stat().st_size / 1e6:,.1f} MB"
        )


def _datasets(group: h5py.Group, above: str = "") -> Iterator[tuple[str, h5py.Dataset]]:
    for name, item in group.items() if above else [("dem", group.get("dem"))]:
        if isinstance(item, h5py.Dataset):
            yield f"{above}/{name}", item
        elif isinstance(item, h5py.Group):
            yield from _datasets(item, f"{above}/{name}")


def _check_where(file: h5py.File) -> None:
    """Raise DamagedResults where something below /dem lies in another file."""
    open_groups = [(DEM, file, "dem")]
    seen = 0
    while open_groups:
        path, group, name = open_groups.pop()
        link = group.get(name, getlink=True)
        if link is not None and not isinstance(link, h5py.HardLink):
            raise DamagedResults(f"{path} is a link to something else")
        item = group.get(name)
        if isinstance(item, h5py.Dataset) and (item.external or item.is_virtual):
            raise DamagedResults(f"{path} is stored in another file")
        if isinstance(item, h5py.Group):
            seen += 1
            if seen > len(GROUPS) and path not in GROUPS:  # a group within itself has no end
                raise DamagedResults(f"{path} is not a group of such results")
            open_groups += [(f"{path}/{inner}", item, inner) for inner in item]


def _check_attributes(path: str, group: h5py.Group, said: Group) -> None:
    """Raise DamagedResults where an attribute is missing or wrong; an open list may have any attribute."""
    for name in said.attributes if "*" not in said.attributes else ():
        if name not in group.attrs:
            raise DamagedResults(f"{path}: the attribute {name} is missing")
        try:
            value = group.attrs[name]
        except (OSError, UnicodeDecodeError, ValueError) as error:
            raise DamagedResults(f"{path}: the attribute {name} cannot be read ({_reason(error)})") from None
        if name in said.several:
            right, what = np.ndim(value) == 1 and all(isinstance(each, str) for each in value), "a list of words"
        elif name in ("format", "dimension"):
            right, what = np.ndim(value) == 0 and np.asarray(value).dtype.kind in "iu", "a whole number"
        else:
            right, what = isinstance(value, str), "text"
        if right and name == "quantities":
            right, what = (
                set(value) <= MONITOR_UNITS.keys() and len(value) == len(group.attrs["monitors"]),
                ("a quantity of each monitor"),
            )
        if not right:
            raise DamagedResults(f"{path}: the attribute {name} is not {what}")


def _words(said: Described) -> str:
    return " × ".join(said.axes) or "a single value"


def _reason(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
