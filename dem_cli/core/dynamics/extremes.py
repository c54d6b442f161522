"""Extremes of the monitors of a time history over all that was followed, from stretch to stretch."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.engine.measures import largest_displacement
from dem_cli.core.engine.monitors import extremes_of
from dem_cli.core.kernels import records as slot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dem_cli.core.dynamics.ground import GroundMotion
    from dem_cli.core.engine.dynamic import DynamicSimulation, Looker
    from dem_cli.core.engine.monitors import Monitors
    from dem_cli.core.records.requests import MonitorRequest


MOST_SAMPLES = 400_000  # of a block in a stretch: 58 MB in space
WIDER = 4  # times farther apart than wanted may samples be, where their number is to divide another


class MotionStretch(NamedTuple):
    """Samples and extreme values of the monitors in a stretch of a time history."""

    times: np.ndarray  # of the samples [s], (n,)
    base: np.ndarray  # acceleration, velocity and displacement of the base there [m, s], (n, 3, d)
    values: np.ndarray  # of the monitors there, (n, n_monitors)
    extremes: np.ndarray  # as Monitors.extremes, (n_monitors, 4)
    overlap: float  # the largest of a contact point at any step [m]
    impacts: int  # steps in which contact points met, where joints have dashpots and a block has moved visibly


def without_meaning(monitors: Sequence[MonitorRequest], impacts: int) -> list[int]:
    """Numbers of monitors whose peaks mean nothing: accelerations where blocks hit each other.

    An impact of stiff joints lasts as long as these are soft, and its acceleration is what that makes it.
    """
    return [i for i, monitor in enumerate(monitors) if impacts and monitor.quantity == "acceleration"]


class Extremes:
    """Largest absolute value of each monitor, and the largest overlap, of all stretches so far."""

    LASTING = frozenset[str]()

    def __init__(self, count: int) -> None:
        self.values = np.zeros(count)
        self.overlap, self.impacts = 0.0, 0

    def see(self, stretch: MotionStretch) -> None:
        """Add the extremes of one more stretch."""
        ends = np.abs(stretch.extremes[:, [slot.HIGHEST, slot.LOWEST]])
        self.values = np.maximum(self.values, np.where(np.isfinite(ends), ends, 0.0).max(axis=1, initial=0.0))
        self.go_on(stretch)

    def go_on(self, stretch: MotionStretch) -> None:
        """Add the overlap and impacts of a stretch whose values do not count: that of a fall."""
        self.overlap, self.impacts = max(self.overlap, stretch.overlap), self.impacts + stretch.impacts


class CutReader:
    """Forces in cuts at the samples of a stretch: read in the step of each, as samples of motion hold none.

    first: step of the stretch at which the first sample is due; every: steps from one to the next.
    """

    def __init__(self, sim: DynamicSimulation, monitors: Monitors, first: int, every: int) -> None:
        self.sim, self.monitors, self.every = sim, monitors, every
        self.due = first + 1
        self.rows: list[list[float]] = []

    def look(self) -> None:
        """Read the forces in cuts at the end of a step."""
        self.rows.append(self.monitors.in_cuts(self.sim))
        self.due += self.every


def finest(every: int, wanted: int, least: int) -> int:
    """Return the steps from one sample to the next, a divisor of `every`: about as many as wanted, no fewer than
    `least`."""
    divisors = [steps for steps in range(1, every + 1) if every % steps == 0]
    wanted = max(wanted, least)
    larger = next((steps for steps in divisors if steps >= wanted), every)
    smaller = max(steps for steps in divisors if steps <= wanted)
    return larger if larger <= WIDER * wanted or smaller < least else smaller


def _between(sim: DynamicSimulation, monitors: Monitors, every: int, n_steps: int) -> int:
    """Return the steps between samples that the extremes of monitors without gauges are found from.

    Every step where joints have a given stiffness. Vibration on others is none of the structure's: as often as its
    motion needs.
    """
    if not len(monitors.stepped):
        return every
    rigid = bool(sim.properties.rigid.all()) and not sim.links
    wanted = round(sim.settings.history.sampled / sim.dt) if rigid else 1
    return finest(every, min(wanted, every), min(every, -(-n_steps * len(monitors.watched) // MOST_SAMPLES)))


def shaken_on(
    sim: DynamicSimulation,
    ground: GroundMotion,
    monitors: Monitors,
    n_steps: int,
    every: int,
    looker: Looker | None = None,
    with_base: bool = True,
) -> MotionStretch:
    """Advance a simulation by n_steps of ground motion: samples every so many steps since the start, extremes of
    every step.

    with_base: whether the motion of the base at the samples is wanted; else it is left at zero.
    """
    dt = sim.dt
    done = round(sim.time / dt)
    since = done % every  # steps since the last sample was due, which the stretch begins with
    n_samples, start = -(-(since + n_steps) // every), (done - since) * dt
    of_steps = np.zeros((0, 2, sim.model.dimension))
    if monitors.absolute:
        of_steps = np.ascontiguousarray(ground.of_base(start + dt * np.arange(since + n_steps))[:, [2, 1]])
    gauges = monitors.gauges(of_steps)
    finer = _between(sim, monitors, every, since + n_steps)
    watch = sim.watch(monitors.watched, finer, -(-(since + n_steps) // finer), gauges)
    new = 1 if since else 0  # the first sample of a stretch that begins between two is none
    first, n = done - since + every * new, max(n_samples - new, 0)
    if with_base:
        times, base = ground.sampled(first, n, every, dt)
    else:
        times, base = dt * (first + every * np.arange(n)), np.zeros((n, 3, sim.model.dimension))
    reader = CutReader(sim, monitors, every * new, every) if monitors.columns_of_cuts else None
    sim.shake(ground.stretch(start, since + n_steps, dt), n_steps, watch, since, looker, reader)
    values = np.zeros((0, len(monitors.requests)))
    if n_samples > new:
        wanted = slice(new * (every // finer), None, every // finer)
        values = monitors.series(watch.samples[wanted], base, watch.links[wanted])
        if reader is not None:
            values[:, monitors.columns_of_cuts] = reader.rows
    overlap = max(0.0, -float(gauges.tally[slot.LEAST_GAP]))
    extremes = monitors.extremes(gauges, times, values, start, dt)
    if finer < every:
        begins = -(-since // finer)
        between = start + dt * finer * np.arange(begins, len(watch.samples))
        bases = ground.of_base(between) if with_base else np.zeros((len(between), 3, sim.model.dimension))
        read = monitors.series(watch.samples[begins:], bases, watch.links[begins:], gauged=False)
        extremes[monitors.stepped] = extremes_of(between, read)[monitors.stepped]
    moved = largest_displacement(sim) >= sim.settings.history.noticeable * sim.smallest
    return MotionStretch(times, base, values, extremes, overlap, int(gauges.tally[slot.MET]) if moved else 0)
