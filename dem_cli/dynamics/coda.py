"""Coda: how a shaken structure ends. After its motion one that still moves is followed until that is known.

It has collapsed, is at rest, or has turned back: no block goes beyond what it went to before. On ground at rest (not
where analysis.duration cuts a motion short) energy only gets less, so that a rocking block that has turned back once
does so again; of many blocks that is no proof, but a block on its way down goes farther in every look. Where nothing
of this has come when the coda is over nobody knows.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.dynamics.collapse_criterion import CollapsedBlock, check_energy, check_finite, fallen
from dem_cli.output.record import COLLAPSED, MOVES, ROCKS, STOOD
from dem_cli.output.resume.stages import stage

if TYPE_CHECKING:
    from dem_cli.dynamics.time_step import TimeStep
    from dem_cli.engine.dynamic import DynamicSimulation
    from dem_cli.tables.analysis import ShakingAnalysis


class Ending(NamedTuple):
    """How a structure that was shaken ended, and which block fell first where it collapsed."""

    how: str  # COLLAPSED, STOOD: at rest; ROCKS: it has turned back; MOVES: not known whether it falls
    block: CollapsedBlock | None = None
    followed: float = 0.0  # after the motion [s]
    still: bool = False  # it was at rest when the motion ended, or moved by next to nothing since

    @property
    def collapsed(self) -> bool | None:
        """None: not known."""
        return None if self.how == MOVES else self.how == COLLAPSED

    @property
    def time(self) -> float | None:
        """Of the collapse [s]."""
        return self.block and self.block.time

    @property
    def why(self) -> str:
        """Which block fell and how, or why nobody knows whether one does; empty where it stands."""
        if self.block is not None:
            return f"'{self.block.block}' {self.block.how}"
        if self.how == MOVES:
            return f"{MOVES} {self.followed:.3g} s after the motion"
        return ""


class _Coda:
    """How far a structure was followed after its motion."""

    def __init__(self, sim: DynamicSimulation) -> None:
        self.done, self.looks, self.since, self.swings = 0, 0, sim.time, Swings(sim)


@stage
def ending(
    sim: DynamicSimulation, analysis: ShakingAnalysis, step: TimeStep, stretch: int, advance: Callable[[int], None]
) -> Ending:
    """How `sim` ends, which has come to the end of its motion; `advance` takes it on by so many steps, `stretch` of
    them or less at a time. Raises SolverError where it blows up.
    """
    most, coda, history = math.ceil(analysis.coda / step.step), _Coda(sim), sim.settings.history
    sim.stages.resumed(coda)
    while True:
        sim.stages.offer(coda)
        found = _ended(sim, analysis, coda, most)
        if found is not None:
            return found
        n = min(stretch, most - coda.done)
        advance(n)
        coda.done, coda.looks = coda.done + n, coda.looks + 1
        check_finite(sim)
        if coda.looks % history.energy_every == 0:
            check_energy(sim, step)
        coda.swings.look()


def _ended(sim: DynamicSimulation, analysis: ShakingAnalysis, coda: _Coda, most: int) -> Ending | None:
    """How it ends, where that is known by now, or nobody looks any longer: after so many steps."""
    swings, followed = coda.swings, sim.time - coda.since
    block = fallen(sim, analysis)
    if block is not None:
        return Ending(COLLAPSED, block, followed)
    if at_rest(sim):
        return Ending(STOOD, None, followed, coda.done == 0 or swings.small())
    if coda.done >= sim.settings.history.least_coda * most and swings.turned_back():
        return Ending(STOOD if swings.small() else ROCKS, None, followed, swings.small())
    return Ending(MOVES, None, followed) if coda.done >= most else None


def undecided(moving: int, runs: int, coda: float) -> list[str]:
    """Words for runs of many of which nobody knows whether they fall; none where there are none."""
    if not moving:
        return []
    return [
        f"{moving} of {runs} runs still moved {coda:g} s after the motion and are left out, neither standing nor "
        "fallen: a longer analysis.coda may tell which"
    ]


def at_rest(sim: DynamicSimulation) -> bool:
    """Neither moving nor about to: a block at the turning point of its rocking is not in balance."""
    history = sim.settings.history
    still = sim.unbalanced < history.still
    return bool(still and sim.centred_kinetic_energy() < history.quiet * sim.noticeable_energy)


class Swings:
    """How far blocks went since the motion ended, look by look: places and turned angles times the radius [m]."""

    def __init__(self, sim: DynamicSimulation):
        self.sim, self._looks = sim, [sim.places()[sim.free]]

    def look(self) -> None:
        """Remember where blocks are."""
        self._looks.append(self.sim.places()[self.sim.free])

    def small(self) -> bool:
        """Whether no block went anywhere."""
        least = self.sim.settings.history.noticeable * self.sim.smallest
        return bool(np.ptp(np.array(self._looks), axis=0).max(initial=0.0) <= least)

    def turned_back(self) -> bool:
        """Whether no block went farther in the second half of the time than in the first, to either side, by what
        counts; none may be farther out now.
        """
        middle = len(self._looks) // 2
        if middle == 0:
            return False
        first, second = np.array(self._looks[: middle + 1]), np.array(self._looks[middle:])
        history = self.sim.settings.history
        small, high, low = history.steady * self.sim.smallest, first.max(axis=0), first.min(axis=0)
        beyond = np.maximum(second - high, low - second)
        return bool((beyond[-1] <= small).all() and (beyond <= small + history.grows * (high - low)).all())
