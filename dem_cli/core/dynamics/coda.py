"""Motion after the end of a ground motion (coda): whether the structure comes to rest, still moves or collapses.
After its motion one that still moves is followed until that is known.

It has collapsed, is at rest, or has turned back: no block goes beyond what it went to before. At rest is what hardly
moves and would not in one second more: a block in balance on an edge, or at the turning point of its rocking, is not.
On ground at rest (not where analysis.duration cuts a motion short) energy only gets less, so that a rocking block that
has turned back once does so again; of many blocks that is no proof, but a block on its way down goes farther in every
look. Where nothing of this has come when the coda is over nobody knows, neither how it ends nor how far it goes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.dynamics.balanced_bodies import balances
from dem_cli.core.dynamics.collapse_criterion import CollapsedBlock, check_energy, check_finite, fallen
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.records.ports import stage
from dem_cli.core.records.statuses import COLLAPSED, MOVES, ROCKS, STOOD

if TYPE_CHECKING:
    from dem_cli.core.dynamics.extremes import Extremes, MotionStretch
    from dem_cli.core.dynamics.time_step import TimeStep
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.requests import ShakingRequest, SolverRequest


class Ending(NamedTuple):
    """Final state of a structure that was shaken, and the block that fell first where it collapsed."""

    how: str  # COLLAPSED, STOOD: at rest; ROCKS: it has turned back; MOVES: not known whether it falls
    block: CollapsedBlock | None = None
    followed: float = 0.0  # after the motion [s]
    still: bool = False  # it was at rest when the motion ended, or moved by next to nothing since

    @property
    def collapsed(self) -> bool | None:
        """Test whether the structure collapsed; None where that is not known."""
        return None if self.how == MOVES else self.how == COLLAPSED

    @property
    def time(self) -> float | None:
        """Time of the collapse [s]; None without one."""
        return self.block and self.block.time

    @property
    def why(self) -> str:
        """Describe the block that fell, or why the outcome is undecided; empty where the structure stands."""
        if self.block is not None:
            return f"'{self.block.block}' {self.block.how}"
        if self.how == MOVES:
            return f"{MOVES} {self.followed:.3g} s after the motion"
        return ""


class _Coda:
    """Progress of the coda: steps and looks after the motion, and motions since."""

    def __init__(self, sim: DynamicSimulation) -> None:
        self.done, self.looks, self.since, self.swings = 0, 0, sim.time, Swings(sim)
        self.quiet: Swings | None = None  # since it hardly moves; None: it moves
        self.quiet_at = 0.0  # and when that began [s]


def longest_coda(request: SolverRequest, model: Model) -> float:
    """Return the longest time for which a structure is followed after its motion [s].

    The requested time, else `least_limit`, or longer where it is tall: slow rocking goes by √(R/g), with half the
    height of the free blocks for R.
    """
    given, history = request.shaking.coda, DEFAULT.history
    if given is not None:
        return float(given)
    heights = (model.centroids[model.vertex_blocks] + model.vertices)[~model.fixed[model.vertex_blocks], -1]
    if request.gravity <= 0.0 or not len(heights):
        return history.least_limit
    return max(history.least_limit, history.limit * math.sqrt(0.5 * float(np.ptp(heights)) / request.gravity))


@stage
def ending(
    sim: DynamicSimulation,
    analysis: ShakingRequest,
    longest: float,
    step: TimeStep,
    stretch: int,
    extremes: Extremes,
    advance: Callable[[int], MotionStretch],
) -> Ending:
    """Follow a simulation after its motion until it stands, collapses or the time is over. `advance` takes it on
    by so many steps, `stretch` of them or less at a time, whose extremes go to `extremes`. Raises SolverError
    where it blows up.

    longest: how long it is followed at most [s]; what hardly moves then, for the second that shows whether it rests.
    """
    most, coda, history = math.ceil(longest / step.step), _Coda(sim), sim.settings.history
    sim.stages.resumed(coda)
    while True:
        sim.stages.offer(coda)
        found = _ended(sim, analysis, coda, most)
        if found is not None:
            return found
        n = min(stretch, most - coda.done) if coda.done < most else stretch
        extremes.see(advance(n))
        coda.done, coda.looks = coda.done + n, coda.looks + 1
        check_finite(sim)
        if coda.looks % history.energy_every == 0:
            check_energy(sim, step)
        coda.swings.look()
        if coda.quiet is not None:
            coda.quiet.look()


def _ended(sim: DynamicSimulation, analysis: ShakingRequest, coda: _Coda, most: int) -> Ending | None:
    """Return the outcome of the coda once it is known, or after so many steps; None: not yet."""
    history, swings, followed = sim.settings.history, coda.swings, sim.time - coda.since
    block = fallen(sim, analysis)
    if block is not None:
        return Ending(COLLAPSED, block, followed)
    if not hardly_moves(sim):
        coda.quiet = None
    elif coda.quiet is None:
        coda.quiet, coda.quiet_at = Swings(sim), sim.time
    elif sim.time - coda.quiet_at >= history.one_more:
        if coda.quiet.small() and not coda.quiet.grew() and not balances(sim):
            since = coda.quiet_at - coda.since
            return Ending(STOOD, None, since, since == 0.0 or swings.small())
        coda.quiet = None
    long_enough = coda.done * sim.dt >= history.least_coda * history.least_limit
    if coda.quiet is None and long_enough and swings.turned_back() and not (swings.small() and balances(sim)):
        return Ending(STOOD if swings.small() else ROCKS, None, followed, swings.small())
    return Ending(MOVES, None, followed) if coda.done >= most and coda.quiet is None else None


def undecided(moving: int, runs: int, coda: float) -> list[str]:
    """Write the warning for runs of which it is not known whether they collapse; empty where there are none."""
    if not moving:
        return []
    return [
        f"{moving} of {runs} runs still moved {coda:.3g} s after the motion and are left out, neither standing nor "
        "fallen: a longer analysis.coda may tell which"
    ]


def hardly_moves(sim: DynamicSimulation) -> bool:
    """Test whether forces on all blocks balance and next to nothing moves at this instant, which need not last."""
    history = sim.settings.history
    still = sim.unbalanced < history.still
    return bool(still and sim.centred_kinetic_energy() < history.quiet * sim.noticeable_energy)


class Swings:
    """Motions of blocks since the ground motion ended, look by look: places and turned angles times the radius [m]."""

    def __init__(self, sim: DynamicSimulation):
        self.sim, self._looks = sim, [sim.places()[sim.free]]

    def look(self) -> None:
        """Record the places and rotations of all blocks."""
        self._looks.append(self.sim.places()[self.sim.free])

    def small(self) -> bool:
        """Test whether no block moved noticeably."""
        least = self.sim.settings.history.noticeable * self.sim.smallest
        return bool(np.ptp(np.array(self._looks), axis=0).max(initial=0.0) <= least)

    def turned_back(self) -> bool:
        """Test whether the swings of all blocks decay. No block went farther in the second half of the time than
        in the first, to either side, by what counts. None may be farther out now, and none that went anywhere
        farther than in all looks before: what slows down towards its balance does.
        """
        middle = len(self._looks) // 2
        if middle == 0:
            return False
        first, second = np.array(self._looks[: middle + 1]), np.array(self._looks[middle:])
        history, smallest = self.sim.settings.history, self.sim.smallest
        high, low = first.max(axis=0), first.min(axis=0)
        way = high - low
        small = np.minimum(history.steady * smallest, history.doubles * way + history.creeps * smallest)
        beyond = np.maximum(second - high, low - second)
        before, now = np.array(self._looks[:-1]), self._looks[-1]
        outwards = np.maximum(now - before.max(axis=0), before.min(axis=0) - now)
        went = np.ptp(before, axis=0) > history.noticeable * smallest
        if (went & (outwards > history.creeps * smallest)).any():
            return False
        return bool((beyond[-1] <= small).all() and (beyond <= small + history.grows * way).all())

    def grew(self) -> bool:
        """Test whether a block went much farther from its first place in the second half of the time than in the
        first, or went on and on in one direction, hardly slower in the second half.

        What leaves a balance goes as cosh, four times as far in twice the time, and as exp where it moved before;
        what slides goes twice as far. What settles or trembles does neither.
        """
        history, looks = self.sim.settings.history, np.array(self._looks)
        ways, middle = np.abs(looks - looks[0]), len(looks) // 2
        creeps = history.creeps * self.sim.smallest
        first, second = ways[: middle + 1].max(axis=0), ways[middle:].max(axis=0)
        if (second > (1.0 + history.doubles) * first + creeps).any():
            return True
        one_way = ways[-1] >= history.one_way * np.ptp(looks, axis=0)
        later = np.abs(looks[-1] - looks[middle])
        return bool((one_way & (ways[-1] > creeps) & (later >= history.keeps * ways[middle])).any())
