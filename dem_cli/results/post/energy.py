"""Draw energy.png: the energy balance over the run, against time, displacement or the solver step."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from dem_cli.results.output.reader import Results
from dem_cli.results.post import style
from dem_cli.results.post.capacity import with_breaks

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
    "reweighting": "#404048",
}
_WORDS = {"reweighting": "areas of contacts", "mass_damping": "mass damping"}
_IN_TIME = _WORDS | {"damping": "local damping", "external": "base and loads"}  # what these are in time histories
_SPARE = "#404048"
_BY_DISPLACEMENT = ("pushover", "settlement")  # kinds whose structures go on and on, not to and fro


class Across(NamedTuple):
    """Horizontal axis of an energy balance."""

    column: str  # of the history, and of frames
    factor: float  # to the unit that is drawn
    label: str


def draw_energy(results: Results, path: Path) -> None:
    """Draw every term of the energy balance that is not zero."""
    history = results.history
    shaken = history["stage"] == "shaking"
    rows = np.flatnonzero(shaken) if shaken.any() else np.arange(len(shaken))
    along = across(results)
    x = along.factor * history[along.column][rows]
    with style.figure(path, figsize=(7.2, 4.3)) as figure:
        axis = figure.subplots()
        for name, values in _in_order(results):
            values = values[rows]
            if (values != 0.0).any():
                word = (_IN_TIME if shaken.any() else _WORDS).get(name, name)
                axis.plot(*with_breaks(history["step"][rows], x, values), color=_COLOURS.get(name, _SPARE), label=word)
        collapse = results.summary.get("collapse_time")
        if collapse is not None:
            axis.axvline(collapse, color=style.COLLAPSE, lw=1.1, ls=(0, (4, 2)), label="collapse")
        axis.axhline(0.0, color=style.GREY, lw=0.8)
        axis.set_xlabel(along.label)
        axis.set_ylabel("energy since the start [J]")
        handles, _ = axis.get_legend_handles_labels()
        if handles:
            figure.legend(loc="outside right center")
        figure.suptitle("Energy balance", x=0.01, ha="left", fontsize=12, fontweight="bold")


def across(results: Results) -> Across:
    """Choose the horizontal axis of the energy balance: time, displacement where that grows, else the solver step."""
    history = results.history
    if (history["stage"] == "shaking").any():
        return Across("time", 1.0, "time [s]")
    if results.kind in _BY_DISPLACEMENT:
        factor, unit = style.length_unit(history["displacement"].max(initial=0.0))
        return Across("displacement", factor, f"largest displacement of a block [{unit}]")
    return Across("step", 1.0, "solver step")


def _in_order(results: Results) -> list[tuple[str, np.ndarray]]:
    """Order the terms of the energy balance by their colours, then those without one."""
    names = [*_COLOURS, *(name for name in results.energy if name not in _COLOURS)]
    return [(name, results.energy[name]) for name in names if name in results.energy]
