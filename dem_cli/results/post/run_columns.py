"""Columns of a run by name: solver history, time histories, response spectra, fragility curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.records.history_rows import MONITOR_UNITS
from dem_cli.errors import UsageError
from dem_cli.results.output.reader import Results
from dem_cli.results.output.series import BASE, HistorySeries
from dem_cli.results.post.capacity import capacity_axis
from dem_cli.results.post.labels import KNOWN_QUANTITIES, Quantity, nearest, unknown

SPECTRUM_DAMPING = 0.05  # of response spectra
PERIOD, SPECTRAL = "period", "spectral acceleration"
_HISTORY = ("load", "displacement", "live_displacement", "time", "step", "unbalanced", "overlap")
_AXES = "xyz"
_FRAGILITY = {
    "intensity": Quantity("intensity"),
    "share": Quantity("share collapsed", "-"),
    "low": Quantity("share collapsed, lower bound", "-"),
    "high": Quantity("share collapsed, upper bound", "-"),
}


class ColumnTable(NamedTuple):
    """Table of columns of the same length."""

    title: str
    quantities: dict[str, Quantity]
    values: Callable[[str], np.ndarray]  # of a column
    breaks: np.ndarray  # rows before which a line is interrupted


def tables(results: Results) -> list[ColumnTable]:
    """Return all tables of a run; the most useful one comes first."""
    found = [_history(results)] if len(results.history.get("step", ())) else []
    if results.series is not None and len(results.series.time) > 1:
        series = [_series(results.series), _spectra(results.series)]
        found = [*series, *found] if kind_of(results.kind).timed else [*found, *series]
    curve = results.summary.get("curve")
    if curve and "share" in curve:
        held = {name: np.array(curve[name], float) for name in _FRAGILITY if name in curve}
        quantities = {name: _FRAGILITY[name] for name in held}
        found.insert(0, ColumnTable("fragility curve", quantities, held.__getitem__, np.zeros(0, dtype=int)))
    return found


def _history(results: Results) -> ColumnTable:
    history = results.history
    held = {name: history[name] for name in _HISTORY if name in history and history[name].any()}
    quantities = {name: KNOWN_QUANTITIES[name] for name in held}
    said = results.summary.get("monitors") or {}
    series = results.series.quantities if results.series is not None else {}
    for name, values in results.monitors.items():
        unit = str((said.get(name) or {}).get("unit", "")) or MONITOR_UNITS.get(series.get(name, ""), "")
        held[name], quantities[name] = values, Quantity(name, unit)
    for name, values in results.energy.items():
        if values.any():
            column = f"{name.replace('_', ' ')} energy"
            held[column], quantities[column] = values, Quantity(column, "J")
    breaks = np.flatnonzero(np.diff(history["step"]) < 0) + 1  # another simulation of the same run
    return ColumnTable("history", quantities, held.__getitem__, breaks)


def _series(series: HistorySeries) -> ColumnTable:
    held = {"time": series.time}
    quantities = {"time": KNOWN_QUANTITIES["time"]}
    for name, (i, k) in _base(series).items():
        held[name], quantities[name] = series.base[:, i, k], Quantity(name, MONITOR_UNITS[BASE[i]])
    for name, values in series.monitors.items():
        held[name], quantities[name] = values, Quantity(name, MONITOR_UNITS[series.quantities[name]])
    return ColumnTable("time history", quantities, held.__getitem__, np.zeros(0, dtype=int))


def _base(series: HistorySeries) -> dict[str, tuple[int, int]]:
    """Return the components of the base motion that are not always zero."""
    places = [(i, k) for i in range(len(BASE)) for k in range(series.base.shape[2])]
    return {f"base {BASE[i]} {_AXES[k]}": (i, k) for i, k in places if series.base[:, i, k].any()}


def _spectra(series: HistorySeries) -> ColumnTable:
    """Compute response spectra: pseudo-acceleration of the base, and of monitors of absolute acceleration."""
    sources = {
        f"{SPECTRAL} {name.split()[-1]}": series.base[:, i, k] for name, (i, k) in _base(series).items() if i == 0
    }
    for name, kind in series.quantities.items():
        if kind == "absolute acceleration" and series.monitors[name].min(initial=0.0) < 0.0:  # no magnitude
            sources[f"{SPECTRAL} of {name}"] = series.monitors[name]
    words = f"{100 * SPECTRUM_DAMPING:g} % damping"
    quantities = {PERIOD: Quantity("period", "s")}
    quantities |= {name: Quantity(f"pseudo-{name.replace('spectral ', '')}, {words}", "m/s2") for name in sources}
    step = float(series.time[1] - series.time[0])

    def values(name: str) -> np.ndarray:
        from dem_cli.core.motion.spectrum import periods, response_spectrum

        at = periods()
        if name == PERIOD:
            return at
        whole = np.where(np.isfinite(sources[name]), sources[name], 0.0)
        return response_spectrum(whole, step, at, SPECTRUM_DAMPING).pseudo_acceleration.ravel()

    return ColumnTable("response spectra", quantities if sources else {}, values, np.zeros(0, dtype=int))


def find(found: Sequence[ColumnTable], names: Sequence[str]) -> tuple[ColumnTable, list[str]]:
    """Find the first table that has all these columns, and their exact names. Raises UsageError."""
    for table in found:
        exact = [nearest(name, list(table.quantities)) for name in names]
        if all(exact):
            return table, [name for name in exact if name]
    every = list(dict.fromkeys(name for table in found for name in table.quantities))
    for name in names:
        if nearest(name, every) is None:
            raise unknown(name, every)
    homes = {name: [table.title for table in found if nearest(name, list(table.quantities))] for name in names}
    where = "; ".join(f"'{name}' in {' and '.join(titles)}" for name, titles in homes.items())
    raise UsageError(f"these columns are not of one length: {where}")


def usual(results: Results) -> tuple[str, list[str]] | None:
    """Return the usual columns of the chart of a run: names for x and y; None where it has no curve."""
    found = tables(results)
    if not found:
        return None
    first = found[0]
    if "share" in first.quantities:
        return "intensity", ["share"]
    if kind_of(results.kind).timed:
        monitors = list(results.series.monitors) if results.series is not None else []
        return ("time", monitors[:1]) if monitors else None
    along = "live_displacement" if capacity_axis(results).signed else "displacement"
    return (along, ["load"]) if {along, "load"} <= first.quantities.keys() else None
