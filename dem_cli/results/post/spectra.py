"""Draw ground motions: response spectra beside their target, and the histories."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.motion.eurocode import TargetSpectrum
from dem_cli.core.motion.intensity_measures import LEAST_MEAN, spectra
from dem_cli.core.motion.motion import Motion
from dem_cli.core.motion.spectrum import periods
from dem_cli.results.post import style

SPECTRUM_DAMPING = 0.05  # of spectra without a target
CURVE_POINTS = 4000  # of a curve
_WIDTH = 7.4  # inch
_TITLE: dict[str, Any] = {"x": 0.01, "ha": "left", "fontsize": 12, "fontweight": "bold"}
_ROWS = (("acceleration", "m/s²"), ("velocity", "m/s"), ("displacement", "m"))


class MotionSuite(NamedTuple):
    """Ground motions of one [motion] table."""

    motions: Sequence[Motion]
    target: TargetSpectrum | None = None  # what they were made to fit
    chosen: int = 0  # which of them a time history uses


def draw_spectra(suites: Sequence[MotionSuite], path: Path, title: str = "") -> None:
    """Draw pseudo-acceleration by period: every motion thin, their mean thick, the target and 90 % of it."""
    height = 1.0 + 3.4 * len(suites)
    with style.figure(path, figsize=(_WIDTH, height)) as figure:
        axes = figure.subplots(len(suites), 1, squeeze=False, sharex=True)[:, 0]
        for axis, suite in zip(axes, suites):
            _draw_suite(axis, suite)
        axes[-1].set_xlabel("period [s]")
        figure.suptitle(_fitted(f"{title}: response spectra"), **_TITLE)


def _draw_suite(axis: Any, suite: MotionSuite) -> None:
    motions, target = suite.motions, suite.target
    at, damping = periods(), SPECTRUM_DAMPING if target is None else target.damping
    values = spectra(motions, at, damping)
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
    axis.set_ylim(0.0, (1.3 if target is not None else 1.15) * values.max())  # room for the legend
    ticks = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0]
    axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.minorticks_off()
    axis.set_ylabel(f"pseudo-acceleration [m/s²]\n{100 * damping:g} % damping")
    axis.legend(loc="upper right", fontsize=9)


def draw_motions(suites: Sequence[MotionSuite], path: Path, title: str = "") -> None:
    """Draw acceleration, velocity and displacement by time: chosen motions in colour, the others grey behind them."""
    with style.figure(path, figsize=(_WIDTH, 5.4)) as figure:
        axes: Any = figure.subplots(3, 1, sharex=True)
        end = max(motion.duration for suite in suites for motion in suite.motions)
        others = [motion for suite in suites for i, motion in enumerate(suite.motions) if i != suite.chosen]
        used = [suite.motions[suite.chosen] for suite in suites]
        for axis, (quantity, unit) in zip(axes, _ROWS):
            for motion in others:
                times = _times(motion, end)
                axis.plot(times, getattr(motion, quantity)(times), color=style.FAINT, lw=0.5)
            for motion, colour in zip(used, cycle((style.THRUST, style.REFERENCE, style.LIMIT))):
                times = _times(motion, end)
                axis.plot(times, getattr(motion, quantity)(times), color=colour, lw=1.0, label=motion.name)
            axis.set_ylabel(f"{quantity}\n[{unit}]")
        axes[-1].set_xlabel("time [s]")
        axes[-1].set_xlim(0.0, end)
        axes[0].legend(loc="upper right", fontsize=9)
        figure.align_ylabels(axes)
        figure.suptitle(_fitted(title), **_TITLE)


def _fitted(text: str) -> str:
    """Shorten a title to one line where it would leave the picture."""
    most = int(11.0 * _WIDTH)
    return text if len(text) <= most else text[: most - 1] + "…"


def _times(motion: Motion, end: float) -> np.ndarray:
    """Return sample times close enough for the picture, and the end of the longest motion."""
    own = motion.times()
    many = own if len(own) >= CURVE_POINTS else np.linspace(motion.start, motion.duration, CURVE_POINTS)
    before = [0.0, motion.start * (1.0 - 1e-9)] if motion.start > 0.0 else []  # so that a jump is upright
    after = [motion.duration * (1.0 + 1e-9), end] if end > motion.duration else []
    return np.concatenate((before, many, after))
