"""energy.png: the ledger over the run, against time where the run has one."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dem_cli.output.reader import Results
from dem_cli.post import style
from dem_cli.post.capacity import with_breaks

_COLOURS = {
    "external": "#1f5fa8",
    "gravity": "#5aa0d8",
    "friction": "#e08214",
    "dashpots": "#a6761d",
    "mass_damping": "#c51b7d",
    "maxwell": "#66a61e",
    "damping": "#c0392b",
    "elastic": "#2a8c5b",
    "kinetic": "#8250a8",
    "supports": "#7c7c86",
}
_IN_TIME = {"damping": "local damping", "external": "base and loads"}  # what these are in time histories
_SPARE = "#404048"


def draw_energy(results: Results, path: Path) -> None:
    """Every entry of the ledger that is not zero, against the solver step or the time of shaking."""
    history = results.history
    shaken = history["stage"] == "shaking"
    rows = np.flatnonzero(shaken) if shaken.any() else np.arange(len(shaken))
    x = history["time"][rows] if shaken.any() else history["step"][rows]
    with style.figure(path, figsize=(7.2, 4.3)) as figure:
        axis = figure.subplots()
        for name, values in _in_order(results):
            values = values[rows]
            if (values != 0.0).any():
                label = _IN_TIME.get(name, name.replace("_", " ")) if shaken.any() else name
                axis.plot(*with_breaks(history["step"][rows], x, values), color=_COLOURS.get(name, _SPARE), label=label)
        collapse = results.summary.get("collapse_time")
        if collapse is not None:
            axis.axvline(collapse, color=style.COLLAPSE, lw=1.1, ls=(0, (4, 2)), label="collapse")
        axis.axhline(0.0, color=style.GREY, lw=0.8)
        axis.set_xlabel("time [s]" if shaken.any() else "solver step")
        axis.set_ylabel("energy since the start [J]")
        handles, _ = axis.get_legend_handles_labels()
        if handles:
            figure.legend(loc="outside right center")
        figure.suptitle("Energy ledger", x=0.01, ha="left", fontsize=12, fontweight="bold")


def _in_order(results: Results) -> list[tuple[str, np.ndarray]]:
    """Entries in the order of the colours, then those that have none."""
    names = [*_COLOURS, *(name for name in results.energy if name not in _COLOURS)]
    return [(name, results.energy[name]) for name in names if name in results.energy]
