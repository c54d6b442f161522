"""Pictures of ground motions: response spectra beside their target, and the histories."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.motion.eurocode import Target
from dem_cli.motion.measures import LEAST_MEAN, spectra
from dem_cli.motion.motion import Motion
from dem_cli.motion.spectrum import periods
from dem_cli.post import style

DAMPING = 0.05  # of spectra without a target
POINTS = 4000  # of a curve
_ROWS = (("acceleration", "m/s²"), ("velocity", "m/s"), ("displacement", "m"))


def draw_spectra(motions: Sequence[Motion], target: Target | None, path: Path, title: str = "") -> None:
    """Pseudo-acceleration by period: every motion thin, their mean thick, the target and 90 % of it.

    Motions of other strength than the target asks for (`scale`) are drawn as they are.
    """
    at = periods()
    damping = DAMPING if target is None else target.damping
    values = spectra(motions, at, damping)
    with style.figure(path, figsize=(7.4, 4.4)) as figure:
        axis = figure.add_subplot()
        alone = len(motions) == 1
        for i, row in enumerate(values):
            label = motions[0].name if alone else "records" if i == 0 else None
            colour, width = (style.THRUST, 1.8) if alone else (style.GREY, 0.6)
            axis.plot(at, row, color=colour, lw=width, alpha=1.0 if alone else 0.6, label=label)
        if not alone:
            axis.plot(at, values.mean(axis=0), color=style.THRUST, lw=2.2, label=f"mean of {len(motions)}")
        if target is not None:
            axis.plot(at, target(at), color=style.FAILURE, lw=1.4, label=target.title)
            axis.plot(at, LEAST_MEAN * target(at), color=style.FAILURE, lw=1.0, ls=(0, (4, 3)), label="90 % of it")
        axis.set_xscale("log")
        axis.set_xlim(at[0], at[-1])
        axis.set_ylim(0.0, 1.08 * values.max())
        ticks = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0]
        axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axis.minorticks_off()
        axis.set_xlabel("period [s]")
        axis.set_ylabel("pseudo-acceleration [m/s²]")
        axis.legend(loc="upper right", fontsize=9)
        figure.suptitle(_fitted(f"{title}: response spectra, {100 * damping:g} % damping", 7.4), **_TITLE)


def draw_motions(motions: Sequence[Motion], path: Path, title: str = "", chosen: int = 0) -> None:
    """Acceleration, velocity and displacement by time: the motion `chosen` in colour, the others grey behind it."""
    with style.figure(path, figsize=(7.4, 5.4)) as figure:
        axes: Any = figure.subplots(3, 1, sharex=True)
        end = max(motion.duration for motion in motions)
        for axis, (quantity, unit) in zip(axes, _ROWS):
            order = [i for i in range(len(motions)) if i != chosen] + [chosen]
            for i in order:
                motion = motions[i]
                times = _times(motion, end)
                colour, width = (style.THRUST, 1.0) if i == chosen else (style.FAINT, 0.5)
                label = motion.name if i == chosen else None
                axis.plot(times, getattr(motion, quantity)(times), color=colour, lw=width, label=label)
            axis.set_ylabel(f"{quantity}\n[{unit}]")
        axes[-1].set_xlabel("time [s]")
        axes[-1].set_xlim(0.0, end)
        if len(motions) > 1:
            axes[0].legend(loc="upper right", fontsize=9)
        figure.align_ylabels(axes)
        figure.suptitle(_fitted(title, 7.4), **_TITLE)


_TITLE: dict[str, Any] = {"x": 0.01, "ha": "left", "fontsize": 12, "fontweight": "bold"}


def _fitted(text: str, width: float) -> str:
    """A title in one line: cut where it would leave the picture of that width [inch]."""
    most = int(11.0 * width)
    return text if len(text) <= most else text[: most - 1] + "…"


def _times(motion: Motion, end: float) -> np.ndarray:
    """Samples close enough for the picture, and the end of the longest motion."""
    own = motion.times()
    many = own if len(own) >= POINTS else np.linspace(0.0, motion.duration, POINTS)
    return np.append(many, end) if end > motion.duration else many
