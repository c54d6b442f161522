"""Monitor values of a static analysis in its last equilibrium: before failure, or at the end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from dem_cli.core.records.history_rows import MONITOR_UNITS, HistoryRow

PARTS = ("value", "load", "unit")  # what is said of a monitor
AT_REST = ("gravity", "loading", "settlement")  # stages of rows in equilibrium


class EquilibriumMonitors:
    """Monitor values of a run, recorded at each equilibrium."""

    def __init__(self, names: Sequence[str], quantities: Sequence[str]):
        self.names, self.units = tuple(names), [MONITOR_UNITS[quantity] for quantity in quantities]
        self._rows: list[HistoryRow] = []

    def row(self, row: HistoryRow) -> None:
        """Record the row of an equilibrium; others are ignored."""
        if self.names and row.stage in AT_REST:
            self._rows.append(row)

    def values(self, found: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
        """Return value, load multiplier and unit of each monitor, by name; empty without an equilibrium.

        found: the solver's summary. Before a failure load that is the value at the highest load that was held. With
        the geometry of the start a mechanism rests wherever it is left: there it is the smallest of all at this load,
        within its bracket.
        """
        stands = found.get("status", "ok") == "ok"
        rest = [row for row in self._rows if row.stage != "gravity" or stands]
        load, rows = found.get("failure_load"), rest[-1:]
        if load is not None:
            low, high = found.get("failure_load_bracket") or (load, load)
            slack = abs((high or load) - (low or load)) if found.get("kinematics") == "fixed" else 0.0
            rows = [row for row in rest if row.load >= load - slack] or rows
        answer = {}
        for i, (name, unit) in enumerate(zip(self.names, self.units) if rows else ()):
            value, load = min(((row.monitors[i], row.load) for row in rows), key=_size)
            answer[name] = dict(zip(PARTS, (value, load, unit)))
        return answer


def _size(held: tuple[float, float]) -> float:
    """Return the absolute value of a monitor."""
    return abs(held[0])
