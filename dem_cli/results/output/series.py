"""Write time histories: base motion and monitors at an even rate, in results.h5 (/dem/series) and history.csv."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np

from dem_cli.core.records.history_rows import MONITOR_UNITS, Samples
from dem_cli.results.output.csv_cells import cell
from dem_cli.results.output.growing_dataset import GrowingGroup
from dem_cli.results.output.layout import SERIES, declared

BASE = ("acceleration", "velocity", "displacement")  # as Samples.base
_AXES = "xyz"
_EQUAL = 1e-6  # of a peak: what is not larger by more is the same, that of an undamped swing that comes again
_TEXT = h5py.string_dtype()


class Peak(NamedTuple):
    """Extreme values of a monitor over the whole motion: by size, to the positive side, to the negative one."""

    peak: float  # the larger of max and min by size, with its sign
    time: float  # of the peak [s]
    max: float
    max_time: float  # [s]
    min: float
    min_time: float  # [s]
    residual: float  # the last value of the motion
    during_motion: float  # the peak before the coda
    during_motion_time: float  # [s]


class HistorySeries(NamedTuple):
    """Time histories of a run."""

    time: np.ndarray  # [s], (n,)
    base: np.ndarray  # acceleration, velocity and displacement of the base [m, s], (n, 3, d)
    monitors: dict[str, np.ndarray]  # by name, (n,) each
    quantities: dict[str, str]  # of each monitor, a key of UNITS


class SeriesWriter:
    """Writer of time histories: buffers them until `flush`, and records the peaks."""

    def __init__(self, group: h5py.Group, names: Sequence[str], quantities: Sequence[str], dimension: int):
        self.names, self.quantities = tuple(names), tuple(quantities)
        group.attrs.create("monitors", list(self.names), dtype=_TEXT)
        group.attrs.create("quantities", list(self.quantities), dtype=_TEXT)
        units = tuple(MONITOR_UNITS[quantity] for quantity in self.quantities)
        watched = SERIES["monitors"]._replace(columns=self.names, units=units)
        said = declared(SERIES, dimension) | {"monitors": watched}
        self._group, self._columns, self.dimension = group, GrowingGroup(group, said), dimension
        self._waiting: list[Samples] = []
        self.n_waiting = 0
        self._peaks: list[Peak] = []

    def append(self, samples: Samples) -> None:
        """Append a stretch of samples. Raises ValueError where the number of monitors is wrong."""
        n_values = samples.monitors.shape[1]
        if n_values != len(self.names):
            raise ValueError(f"{n_values} values of {len(self.names)} monitors")
        if len(samples.times):
            self._waiting.append(samples)
            self.n_waiting += len(samples.times)
        if len(samples.times) or len(samples.extremes):
            self._remember(samples)

    def _remember(self, samples: Samples) -> None:
        for i, (high, high_time, low, low_time) in enumerate(self._extremes(samples).tolist()):
            most, least = (high, high_time), (low, low_time)
            before = self._peaks[i] if i < len(self._peaks) else None
            if before is not None:  # the earlier one of two that are equal
                same = _EQUAL * max(before.max, -before.min)
                most = most if most[0] > before.max + same else (before.max, before.max_time)
                least = least if least[0] < before.min - same else (before.min, before.min_time)
            largest = least if -least[0] > most[0] or (-least[0] == most[0] and least[1] < most[1]) else most
            last, during = float(samples.monitors[-1, i]) if len(samples.monitors) else 0.0, largest
            if before is not None and (samples.coda or not len(samples.monitors)):
                last = before.residual
            if before is not None and samples.coda:
                during = before.during_motion, before.during_motion_time
            self._peaks[i : i + 1] = [Peak(*largest, *most, *least, last, *during)]

    def _extremes(self, samples: Samples) -> np.ndarray:
        """Return the extremes of samples, those computed by the solver where available."""
        if len(samples.extremes) or not self.names:
            return samples.extremes
        values = np.where(np.isfinite(samples.monitors), samples.monitors, 0.0)  # a run may end in nonsense
        high, low, each = values.argmax(axis=0), values.argmin(axis=0), np.arange(values.shape[1])
        return np.column_stack([values[high, each], samples.times[high], values[low, each], samples.times[low]])

    def peaks(self, impacts: bool = False) -> dict[str, dict[str, float | str | None]]:
        """Return extremes with their times, the last value and the unit of each monitor, by name.

        impacts: whether blocks hit each other: of accelerations the last value alone means something then.
        """
        found: dict[str, dict[str, float | str | None]] = {}
        for name, quantity, peak in zip(self.names, self.quantities, self._peaks):
            known: dict[str, float | str | None] = dict(peak._asdict())
            if impacts and quantity.endswith("acceleration"):
                known = dict.fromkeys(known) | {"residual": peak.residual}
            found[name] = known | {"unit": MONITOR_UNITS[quantity]}
        return found

    def flush(self) -> None:
        """Write the buffered samples to the file."""
        waiting, self._waiting, self.n_waiting = self._waiting, [], 0
        if waiting:
            times, base, monitors = (
                np.concatenate([getattr(one, name) for one in waiting]) for name in ("times", "base", "monitors")
            )
            for i, name in enumerate(BASE):
                self._columns.append(f"base_{name}", base[:, i])
            if self.names:
                self._columns.append("monitors", monitors)
            self._columns.append("time", times)  # last: it counts
            self._columns.write_out()

    def write_csv(self, path: Path) -> None:
        """Write all samples as text, one line each."""
        series = read_series(self._group, self.dimension)
        with path.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerow(map(cell, headers(series)))
            if len(series.time):
                np.savetxt(file, table(series), fmt="%.9g", delimiter=",")


def headers(series: HistorySeries) -> list[str]:
    """Return a name with its unit for each column of `table`."""
    axes = _AXES[: series.base.shape[2]]
    base = [f"base {name} {axis} [{MONITOR_UNITS[name]}]" for name in BASE for axis in axes]
    return ["time [s]", *base, *(f"{name} [{MONITOR_UNITS[quantity]}]" for name, quantity in series.quantities.items())]


def table(series: HistorySeries) -> np.ndarray:
    """Combine time, motion of the base and monitors side by side, (n, n_columns)."""
    return np.column_stack([series.time, series.base.reshape(len(series.time), -1), *series.monitors.values()])


def read_series(group: h5py.Group, dimension: int) -> HistorySeries:
    """Read the samples written so far."""
    names, quantities = (list(map(str, group.attrs[key])) for key in ("monitors", "quantities"))
    if "time" not in group:
        nothing = np.zeros(0)
        return HistorySeries(
            nothing, np.zeros((0, len(BASE), dimension)), dict.fromkeys(names, nothing), dict(zip(names, quantities))
        )
    n = len(group["time"])
    base = np.stack([group[f"base_{name}"][:n] for name in BASE], axis=1)
    values = group["monitors"][:n] if names else np.zeros((n, 0))
    monitors = {name: values[:, i] for i, name in enumerate(names)}
    return HistorySeries(group["time"][:], base, monitors, dict(zip(names, quantities, strict=True)))
