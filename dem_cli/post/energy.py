"""energy.png: the ledger over the run."""

from __future__ import annotations

from pathlib import Path

from dem_cli.output.reader import Results
from dem_cli.post import style
from dem_cli.post.capacity import with_breaks

_COLOURS = {
    "external": "#1f5fa8",
    "gravity": "#5aa0d8",
    "friction": "#e08214",
    "damping": "#c0392b",
    "elastic": "#2a8c5b",
    "kinetic": "#8250a8",
    "supports": "#7c7c86",
}


def draw_energy(results: Results, path: Path) -> None:
    """Every entry of the ledger that is not zero, against the solver step."""
    with style.figure(path, figsize=(7.2, 4.3)) as figure:
        axis = figure.subplots()
        steps = results.history["step"]
        for name, colour in _COLOURS.items():
            values = results.energy.get(name)
            if values is not None and (values != 0.0).any():
                axis.plot(*with_breaks(steps, steps, values), color=colour, label=name)
        axis.axhline(0.0, color=style.GREY, lw=0.8)
        axis.set_xlabel("solver step")
        axis.set_ylabel("energy since the start [J]")
        handles, _ = axis.get_legend_handles_labels()
        if handles:
            figure.legend(loc="outside right center")
        figure.suptitle("Energy ledger", x=0.01, ha="left", fontsize=12, fontweight="bold")
