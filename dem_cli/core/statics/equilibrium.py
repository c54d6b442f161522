"""Equilibrium or failure at a constant load: each claim with its proof.

An equilibrium is proven by the largest unbalanced force, a failure by power: under constant load the
motion accelerates while the loads release more energy than friction and joints take (statics/failure_test.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.measures import free_falls
from dem_cli.core.engine.rigid_joints import relieved
from dem_cli.core.kernels import records as slot
from dem_cli.core.records.ports import stage
from dem_cli.core.statics.failure_test import FailureTest, displaced
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.track import Track


@dataclass(frozen=True)
class Verdict:
    """Verdict on a structure at a constant load: equilibrium, failure, or neither."""

    state: str  # "equilibrium" | "failure" | "unknown"
    unbalanced: float  # largest unbalanced force at the end, in weights of its own block
    released: float = 0.0  # failure: share of the work of the loads that became motion or was damped
    growth: float = 0.0  # failure: growth of the displacement in the last doubling of time
    block: str | None = None  # failure: that came to rest elsewhere
    buckles: bool = False  # failure: forces balance, and the least push makes it go on


class Ahead(NamedTuple):
    """Expectation about a load from a path from gravity or a curve (see FailureTest)."""

    plateau: bool = False
    reach: float = 0.0
    change: float | None = None  # what is elastic of the way there from an equilibrium [m]; None: as from zero


NOTHING_KNOWN = Ahead()  # but that elastic displacements are overestimated, or a failure is expected


def unexpected(sim: Simulation) -> Ahead:
    """Return the expectation for a load that no path calls a plateau: it may rest and rise again.

    Blocks of irregular walls give way by 30 to 150 elastic displacements before they rest.
    """
    return Ahead(reach=sim.settings.proof.unexpected)


@dataclass
class _Settling:
    """Progress of a structure on its way to rest or failure."""

    done: int = 0  # steps; looks of `relax`
    calm: int = 0  # looks in a row at which forces balanced
    look: int = 2  # for failure
    motion: FailureTest | None = None


def check_finite(sim: Simulation) -> None:
    """Raises SolverError that names the block where a number is not finite."""
    bad = ~np.isfinite(sim.bodies.velocities).all(axis=1)
    if bad.any():
        name = sim.model.block_ids[int(np.flatnonzero(bad)[0])]
        raise SolverError(f"the motion of block '{name}' is not a number after {sim.steps} steps")


@stage
def relax(
    sim: Simulation,
    load: float,
    tolerance: float,
    max_steps: int | None = None,
    scale: float = 0.0,
    since: np.ndarray | None = None,
    budget: Budget | None = None,
    elastic: bool = True,
) -> Verdict:
    """Search for an equilibrium at this load by fast inertial relaxation (FIRE); "unknown" if there is none within
    max_steps.

    "failure" where blocks came to rest elsewhere (`displaced`) than at `since` (Simulation.places; default: where they
    are now); scale: displacement that is elastic [m]; max_steps: None: that of the settings; budget: what the steps are
    taken from; elastic: joints show their closure (engine/rigid_joints.py).
    """
    relaxation = sim.settings.relaxation
    since = sim.places() if since is None else since
    way = _Settling()
    if not sim.stages.resumed(way):
        sim.use(relaxation.fire_safety, damping=0.0)
        sim.set_load(load)
        limit_falls(sim)
        sim.restart_relaxation()
    max_steps = relaxation.most_steps if max_steps is None else max_steps
    while way.done < max(1, max_steps // relaxation.chunk):
        sim.stages.offer(way)
        sim.advance(relaxation.chunk, slot.FIRE)
        if budget is not None:
            budget.spend(relaxation.chunk, f"at load multiplier {load * sim.live_scale:.5g}")
        check_finite(sim)
        way.done, way.calm = way.done + 1, way.calm + 1 if sim.unbalanced < tolerance else 0
        if way.calm == relaxation.looks_at_rest:
            if _rests(sim, tolerance, slot.FIRE) and (elastic or relieved(sim)):
                break
            way.calm = 0
    sim.rest()
    sim.use(relaxation.creep_safety)
    if way.calm < relaxation.looks_at_rest:
        return Verdict("unknown", sim.unbalanced)
    return _at_rest(sim, since, scale)


def stand(sim: Simulation, budget: Budget) -> Verdict:
    """Find an equilibrium under dead loads alone, or prove that there is none."""
    relaxation = sim.settings.relaxation
    start, scale = sim.places(), measures.dead_scale(sim)
    _weigh_down(sim, budget)
    verdict = relax(sim, 0.0, relaxation.gravity_tolerance, scale=scale, since=start, budget=budget, elastic=False)
    if verdict.state != "unknown":
        return verdict
    return settle_or_fail(sim, 0.0, budget, scale, relaxation.gravity_tolerance, start)


@stage
def settle_or_fail(
    sim: Simulation,
    load: float,
    budget: Budget,
    scale: float,
    tolerance: float | None = None,
    since: np.ndarray | None = None,
    ahead: Ahead = NOTHING_KNOWN,
    most_steps: float = math.inf,
) -> Verdict:
    """Hold a load with combined damping until equilibrium or failure is proven; "unknown" after `most_steps`.

    scale: displacement that is elastic [m]. Looks for failure when the time grew by √2 (statics/failure_test.py).
    since: places of the structure that must not have moved grossly when it comes to rest (Simulation.places);
    default: where it is now. ahead: what a path or a curve says of this load.
    """
    relaxation = sim.settings.relaxation
    tolerance = relaxation.tolerance if tolerance is None else tolerance
    since = sim.places() if since is None else since
    doing, way = f"at load multiplier {load * sim.live_scale:.5g}", _Settling()
    if not sim.stages.resumed(way):
        sim.use_combined_damping()
        limit_falls(sim)
        way.motion = FailureTest(sim, scale, ahead.plateau, ahead.reach)
        _ramp(sim, load, scale if ahead.change is None else ahead.change, budget, doing)
    assert way.motion is not None
    while True:
        if _comes_to_rest(sim, way, tolerance, budget, doing):
            return _at_rest(sim, since, scale)
        check_finite(sim)
        failing = way.motion.look()
        if failing is not None:
            return Verdict("failure", sim.unbalanced, *failing)
        if way.done >= most_steps:
            return Verdict("unknown", sim.unbalanced)
        way.look += 1


def _comes_to_rest(sim: Simulation, way: _Settling, tolerance: float, budget: Budget, doing: str) -> bool:
    """Advance under a constant load until the next look for failure; returns whether the structure came to rest
    before."""
    relaxation = sim.settings.relaxation
    while way.done < relaxation.chunk * round(math.sqrt(2.0) ** way.look):
        sim.stages.offer(way)
        sim.advance(relaxation.chunk, slot.HOLD_LOAD)
        budget.spend(relaxation.chunk, doing)
        way.done += relaxation.chunk
        way.calm = way.calm + 1 if sim.unbalanced < tolerance else 0
        if way.calm == relaxation.looks_at_rest:
            if _rests(sim, tolerance, slot.HOLD_LOAD) and relieved(sim):
                return True
            way.calm = 0
    return False


def _rests(sim: Simulation, tolerance: float, mode: int) -> bool:
    """Stop all blocks and test whether forces balance where they stand: they may only have passed by an
    equilibrium."""
    sim.rest()
    sim.advance(1, mode)
    sim.rest()
    return sim.unbalanced < tolerance


def limit_falls(sim: Simulation) -> None:
    """Limit the speed of falling blocks: in flight they would be detected at every step; joints are slower by far."""
    if sim.kinematics == "large" and len(sim.free):
        sim.limit_speed(sim.settings.relaxation.fall_speed * float(sim.widths[sim.free].min()))


def _ramp(sim: Simulation, load: float, scale: float, budget: Budget, doing: str) -> None:
    """Change to a load, at once where every block follows its neighbours, else so slowly that none is thrown.

    What moves by `scale` in a ramp of n steps is accelerated by about 4·scale/n².
    """
    relaxation = sim.settings.relaxation
    before = sim.load
    sim.set_load(load)
    fall = free_falls(sim)[sim.free]
    slowest = fall[fall > 0.0].min(initial=math.inf)
    steps = int(min(math.sqrt(4.0 * scale / (relaxation.gentle * slowest)), relaxation.longest_ramp))
    steps = max(steps if steps >= relaxation.shortest_ramp else 0, _steps_of_memory(sim))
    if load != before:
        _climb(sim, lambda share: sim.set_load(before + (load - before) * share), steps, _stair(sim))
        budget.spend(steps, doing)


def _weigh_down(sim: Simulation, budget: Budget) -> None:
    """Apply dead loads little by little, where joints or links have memory or blocks swell or shrink by themselves."""
    steps, stair = max(_steps_of_memory(sim), _steps_of_links(sim)), _stair(sim)
    if len(sim.model.imposed_strains):
        steps, stair = _steps_by_depth(sim), sim.settings.relaxation.stair_of_strain
    if not steps:
        return
    sim.use_combined_damping()
    sim.set_load(0.0)
    limit_falls(sim)
    _climb(sim, sim.set_dead_share, steps, stair)
    sim.rest()
    budget.spend(steps, "putting on the dead loads")


def _steps_of_memory(sim: Simulation) -> int:
    """Length of the ramp of a load on joints with memory; 0 for others."""
    return _steps_by_depth(sim) if sim.law.n_memory(sim.model.dimension) else 0


def _steps_of_links(sim: Simulation) -> int:
    """Length of a ramp in which blocks follow on ties and bars that yield or slide, without swinging past
    equilibrium; 0: there are none."""
    relaxation = sim.settings.relaxation
    softest = min((link.softest() for link in sim.links if link.yields()), default=math.inf)
    light = sim.loads.inverse_masses[sim.free, : sim.model.dimension]
    heaviest = float((1.0 / light[light > 0.0]).max(initial=0.0))
    period = 2.0 * math.pi * math.sqrt(heaviest / softest)
    return int(min(relaxation.ramp_of_links * period, relaxation.longest_ramp))


def _steps_by_depth(sim: Simulation) -> int:
    """Length of a ramp in which all courses follow."""
    relaxation = sim.settings.relaxation
    return max(relaxation.shortest_ramp, relaxation.ramp_of_memory * sim.depth)


def _stair(sim: Simulation) -> int:
    """Steps between the loads of a ramp."""
    relaxation = sim.settings.relaxation
    return relaxation.stair_of_memory if sim.law.n_memory(sim.model.dimension) else relaxation.stair


@stage
def _climb(sim: Simulation, put: Callable[[float], None], steps: int, stair: int) -> None:
    """Advance with loads applied by their share, which grows smoothly to 1, each for `stair` steps."""
    stairs, way = steps // stair, _Settling()
    sim.stages.resumed(way)
    while way.done < stairs:
        sim.stages.offer(way)
        way.done += 1
        share = way.done / stairs
        put(share * share * (3.0 - 2.0 * share))
        sim.advance(stair, slot.HOLD_LOAD)


def _at_rest(sim: Simulation, since: np.ndarray, scale: float) -> Verdict:
    """Return the verdict on a structure in which all forces balance."""
    block = displaced(sim, since, scale)
    if block is None:
        return Verdict("equilibrium", sim.unbalanced)
    return Verdict("failure", sim.unbalanced, block=sim.model.block_ids[block])


def settle(sim: Simulation, track: Track, budget: Budget) -> Verdict:
    """Apply dead loads to equilibrium; the row is stored in the track, the frame handed over."""
    track.observer.progress("gravity", 0.0, 0.0, None)
    verdict = stand(sim, budget)
    track.keep("gravity")
    track.frame("gravity")
    return verdict


class _MovingOn:
    """Largest displacement of blocks [m], and the share of the work that was released."""

    def __init__(self) -> None:
        self.moved = self.released = 0.0


@stage
def released_in_motion(sim: Simulation, budget: Budget, load: float, far: float) -> float:
    """Return the share of the work of a constant load that is released, once blocks moved on by so much [m] and
    any is."""
    start, ledger, way, begun = sim.places(), measures.energy_sums(sim), _MovingOn(), sim.steps
    chunk = sim.settings.relaxation.chunk
    sim.stages.resumed(way)
    while way.moved < far or way.released <= 0.0:
        sim.stages.offer(way)
        steps = chunk * (1 + (sim.steps - begun) // (10 * chunk))  # a look costs as many
        sim.advance(steps, slot.HOLD_LOAD)
        budget.spend(steps, f"at load multiplier {load * sim.live_scale:.5g}")
        check_finite(sim)
        way.moved = float(np.abs(sim.places() - start).max())
        now = measures.energy_sums(sim)
        given = now.given - ledger.given
        way.released = 1.0 - (now.taken - ledger.taken) / given if given > 0.0 else 0.0
    return way.released
