"""The failure load: a start next to it or a creep that says where it is, then loads raised, each with its proof.

Where a static solver left a state next to failure (statics/warm_start.py), it is held a little below its load, and the
load is raised from there. Else, and where that does not hold, it is raised from gravity:

Equilibrium exists at every prescribed displacement, so nothing has to be guessed for the estimate: the
live load is replaced by a prescribed rate of its own displacement q·u, and its multiplier is found as a
reaction. The rate is halved several times and then set to zero; what is left is close to the failure load,
but a joint that slides back and forth on that way may have lost strength. The answer therefore comes from
the way that a tilting table takes: the load is raised from gravity in steps that shrink towards the
estimate, every step a proven equilibrium, until failure is proven as well and the bracket is narrow enough. Where the
creep ended in an equilibrium inside that bracket, that one is the highest.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.engine import measures
from dem_cli.engine.budget import Budget
from dem_cli.errors import SolverError
from dem_cli.kernels import records as slot
from dem_cli.statics.equilibrium import (
    Verdict,
    check_finite,
    relax,
    settle_or_fail,
)
from dem_cli.statics.warm_start import GRAVITY, place

if TYPE_CHECKING:
    from dem_cli.engine.simulation import SavedState, Simulation
    from dem_cli.engine.track import Track
    from dem_cli.limit.analysis import LimitLoads
    from dem_cli.statics.warm_start import WarmStart


@dataclass(frozen=True)
class LoadPass:
    """One creep or one constant load; multipliers as users know them."""

    kind: str  # "creep" | "start" | "load" | "impossible"
    steps: int
    load: float  # estimate of the creep, or the constant load
    state: str  # "estimate" | "equilibrium" | "failure"


@dataclass
class FailureSearch:
    """What was found, and the way to it."""

    low: float | None = None  # highest proven equilibrium
    high: float | None = None  # lowest proven failure
    status: str = "not converged"  # "ok" | "not converged" | "no failure" | "does not stand"
    compliance: float = 0.0  # q·u per unit of internal multiplier while elastic [J]
    elastic: float = 0.0  # largest displacement per unit of internal multiplier while elastic [m]
    settled: float = 0.0  # largest displacement of a block under the dead loads alone [m]
    onset: float | None = None  # lowest held load at which blocks had moved by more than joints deform
    peak_displacement: float = 0.0  # largest displacement of a block at the highest equilibrium [m]
    held: SavedState | None = None  # state of the highest equilibrium
    found: bool = False  # the bracket is as narrow as it was asked for
    failing: Verdict | None = None
    crept: float | None = None  # internal multiplier of the equilibrium in which the creep ended, if it did
    crept_state: SavedState | None = None
    limit: float = 0.0  # multiplier above which nothing was tried
    passes: list[LoadPass] = field(default_factory=list)
    start: dict[str, Any] = field(default_factory=dict)  # how the structure came next to failure
    limits: LimitLoads | None = None  # limit analysis that the start needed


def compliance(sim: Simulation) -> tuple[float, float]:
    """q·u [J] and largest displacement [m] per unit of multiplier for small loads; the state is left as it was.

    Where the structure has no equilibrium even at the smallest probe, that of the last probe is returned.
    """
    load_search = sim.settings.load_search
    before, places, saved = measures.live_displacement(sim), sim.places(), sim.save()
    load, value, largest = load_search.probe_in_play if sim.play.moved.any() else load_search.probe, 0.0, 0.0
    for _ in range(4):
        verdict = relax(sim, load, sim.settings.relaxation.tolerance, 20_000)
        value = (measures.live_displacement(sim) - before) / load
        largest = float(np.abs(sim.places() - places).max()) / load
        sim.restore(saved)
        if verdict.state == "equilibrium":
            break
        load /= 10.0
    return _compliance_in_play(sim, (value, largest)) if sim.play.moved.any() else (value, largest)


def _compliance_in_play(sim: Simulation, first: tuple[float, float]) -> tuple[float, float]:
    """The same where any load may roll blocks over sides of a profile: the step of it that moves them least."""
    load_search, relaxation = sim.settings.load_search, sim.settings.relaxation
    saved, found, load = sim.save(), first, load_search.probe_in_play
    for _ in range(load_search.doublings):
        if relax(sim, load, relaxation.tolerance, 20_000).state != "equilibrium":
            break
        before, places = measures.live_displacement(sim), sim.places()
        if relax(sim, 2.0 * load, relaxation.tolerance, 20_000).state != "equilibrium":
            break
        value = (measures.live_displacement(sim) - before) / load
        largest = float(np.abs(sim.places() - places).max()) / load
        if value > 0.0 and largest < found[1]:
            found = value, largest
        load *= 2.0
    sim.restore(saved)
    return found


def find_failure(
    sim: Simulation,
    resolution: float,
    max_load: float | None,
    budget: Budget,
    track: Track,
    search: FailureSearch,
    start: WarmStart | None = None,
    longest: float | None = None,
) -> None:
    """Bracket of the failure load of a structure that stands under its dead loads (see the module docstring).

    max_load is the multiplier, as users know it, above which the structure counts as self-locking (None:
    a hundred times the dead loads). start: a state next to failure, instead of creep and loads raised from gravity;
    where it does not hold, these are the way after all. longest: step of the load, as users know it, that is never
    exceeded; then, and where joints have a profile, nothing is estimated first. What is found goes to `search` as it
    is found, so that it is not lost where the budget ends; the equilibria are kept as rows in the track.
    """
    load_search = sim.settings.load_search
    search.low, search.held, search.settled = 0.0, sim.save(), measures.largest_displacement(sim)
    limit = load_search.locked if max_load is None else max_load / sim.live_scale
    search.limit = limit * sim.live_scale
    search.compliance, search.elastic = compliance(sim)
    if search.compliance <= 0.0:
        if sim.loads.live[sim.free].any():
            raise SolverError("a small live load moves the structure against its direction: it hardly stands as it is")
        raise SolverError("the live load moves nothing: no free block has a live load")
    if start is not None and _holds(sim, search, start, resolution, limit, budget, track):
        low = search.low / sim.live_scale
        if start.limits is not None:
            above = (1.0 + load_search.beyond_impossible) * start.limits.associated.upper / sim.live_scale
            if above <= min(limit, (1.0 + max(resolution, load_search.coarse)) * low):
                _fail_above(sim, search, above, budget, track)
                return
        step = load_search.one_step * resolution * low
        _raise_load(sim, search, low, [], step, resolution, limit, budget, track, start.plateau)
        return
    if longest is not None or sim.play.moved.any():  # a creep would stop at the first microrotation
        most = np.inf if longest is None else longest / sim.live_scale
        first = load_search.first_in_play if longest is None else most
        _raise_load(sim, search, 0.0, [], first, resolution, limit, budget, track, longest=most)
        return
    track.observer.progress("estimating the failure load", 0.0, 0.0, 0.05)
    estimate = _creep(sim, load_search.reach * search.compliance, budget, search)
    sim.restore(search.held)
    estimate = min(estimate if estimate > 0.0 else load_search.probe, limit)
    levels = [share * estimate for share in load_search.shares]
    _raise_load(sim, search, 0.0, levels, 0.5 * resolution * estimate, resolution, limit, budget, track)


def _holds(
    sim: Simulation,
    search: FailureSearch,
    start: WarmStart,
    resolution: float,
    limit: float,
    budget: Budget,
    track: Track,
) -> bool:
    """Whether the explicit solver holds the state of `start` a little below its load; else all is as it was."""
    load = (1.0 - sim.settings.load_search.below * resolution) * start.load / sim.live_scale
    if not 0.0 < load < limit:
        return False
    track.observer.progress("holding the start", load * sim.live_scale, 0.0, None)
    place(sim, start)
    before = sim.steps
    verdict = settle_or_fail(sim, load, budget, search.elastic * load)
    search.passes.append(LoadPass("start", sim.steps - before, load * sim.live_scale, verdict.state))
    if verdict.state != "equilibrium":
        sim.restore(search.held)
        search.start |= {"kind": GRAVITY, "note": "the start did not hold; the load is raised from gravity"}
        return False
    _keep(sim, search, load, track)
    return True


def _fail_above(sim: Simulation, search: FailureSearch, load: float, budget: Budget, track: Track) -> None:
    """Failure at a load that limit analysis proved impossible: its mechanism gains more work than any forces in the
    friction cones can take, and the explicit solver shows that the structure moves on and releases energy.
    """
    relaxation = sim.settings.relaxation
    track.observer.progress("failing", load * sim.live_scale, search.peak_displacement, None)
    before, start, ledger = sim.steps, sim.places(), measures.energy_sums(sim)
    sim.use(relaxation.combined_safety, relaxation.combined_damping, relaxation.combined_damping)
    sim.set_load(load)
    moved, released = 0.0, 0.0
    while moved < sim.settings.load_search.shown * search.elastic * load or released <= 0.0:
        sim.advance(relaxation.chunk, slot.HOLD_LOAD)
        budget.spend(relaxation.chunk, f"at load multiplier {load * sim.live_scale:.5g}")
        check_finite(sim)
        moved = float(np.abs(sim.places() - start).max())
        now = measures.energy_sums(sim)
        given = now.given - ledger.given
        released = 1.0 - (now.taken - ledger.taken) / given if given > 0.0 else 0.0
    search.failing = Verdict("failure", sim.unbalanced, released)
    search.passes.append(LoadPass("impossible", sim.steps - before, load * sim.live_scale, "failure"))
    search.high, search.status, search.found = load * sim.live_scale, "ok", True
    track.keep("collapse")


def _creep(sim: Simulation, distance: float, budget: Budget, search: FailureSearch) -> float:
    """Internal multiplier to which a decelerating creep over about `distance` [J] settles: an estimate.

    Where geometry moves, a creep that passed the peak of the curve stops there and gives the peak.
    """
    relaxation, load_search = sim.settings.relaxation, sim.settings.load_search
    sim.use(relaxation.creep_safety)
    rate, loads, before = distance / load_search.first_phase, [], sim.steps
    for phase in range(load_search.phases + 1):
        sim.prescribe_rate(rate * 0.5**phase)
        for _ in range(load_search.looks if phase == 0 else load_search.looks // 2):
            sim.advance(load_search.first_phase // load_search.looks, sim.creep_mode)
            loads.append(sim.mean_load)
        check_finite(sim)
        if sim.kinematics == "large" and loads[-1] < load_search.softened * max(loads):
            break
    else:
        sim.prescribe_rate(0.0)
        calm = 0
        for _ in range(load_search.hold_steps // relaxation.chunk):
            sim.advance(relaxation.chunk, sim.creep_mode)
            calm = calm + 1 if sim.unbalanced < relaxation.tolerance else 0
            if calm == 2:
                search.crept = sim.load
                sim.rest()
                search.crept_state = sim.save()
                break
    softened = sim.kinematics == "large" and sim.load < load_search.softened * max(loads)
    estimate = max(loads) if softened else sim.load
    budget.spend(sim.steps - before, "creeping to failure")
    search.passes.append(LoadPass("creep", sim.steps - before, estimate * sim.live_scale, "estimate"))
    return estimate


def _raise_load(
    sim: Simulation,
    search: FailureSearch,
    low: float,
    levels: list[float],
    step: float,
    resolution: float,
    limit: float,
    budget: Budget,
    track: Track,
    plateau: bool = False,
    longest: float = np.inf,
) -> None:
    """From a proven equilibrium up, first to `levels`, then by growing steps, after failure back by halves."""
    load_search = sim.settings.load_search
    high, failed, jumped = None, None, False
    first_step = step
    while high is None or jumped or high - low > resolution * max(abs(low), load_search.least):
        if high is not None and high - low <= resolution * max(abs(low), load_search.least):
            load = high  # failed after a jump, which may break what a gentler step does not: once more from close by
        elif high is not None:
            load = 0.5 * (low + high)
        elif levels:
            load = levels.pop(0)
        else:
            load, step = low + step, min(load_search.growth * step, longest)
        load = min(load, limit)
        verdict = _settle(sim, search, load, budget, track, plateau)
        if verdict.state == "equilibrium":
            if high is not None and load >= high:
                high, step = None, first_step
            low, jumped = load, False if high is None else jumped
            _keep(sim, search, low, track)
            if low >= limit:
                search.status = "no failure"
                return
        else:
            jumped = load - low > load_search.jump * resolution * max(abs(low), load_search.least)
            high, failed = load, (verdict, sim.save())
            search.high, search.failing = high * sim.live_scale, verdict
    if search.crept is not None and low < search.crept < high:
        search.held, held = search.crept_state, search.held  # closer to failure still, if it holds as well
        if _settle(sim, search, search.crept, budget, track, plateau).state == "equilibrium":
            _keep(sim, search, search.crept, track)
        else:
            search.held = held
    search.status, search.found = "ok", True
    sim.restore(failed[1])
    track.keep("collapse")


def _settle(
    sim: Simulation, search: FailureSearch, load: float, budget: Budget, track: Track, plateau: bool = False
) -> Verdict:
    """The verdict on a load, from the highest equilibrium so far."""
    track.observer.progress("raising the load", load * sim.live_scale, search.peak_displacement, None)
    sim.restore(search.held)
    before = sim.steps
    verdict = settle_or_fail(sim, load, budget, search.elastic * abs(load), plateau=plateau)
    search.passes.append(LoadPass("load", sim.steps - before, load * sim.live_scale, verdict.state))
    return verdict


def _keep(sim: Simulation, search: FailureSearch, load: float, track: Track) -> None:
    """The highest proven equilibrium so far, and its row."""
    search.low, search.held = load * sim.live_scale, sim.save()
    search.peak_displacement = measures.largest_displacement(sim)
    if (
        search.onset is None
        and search.peak_displacement > search.settled + sim.settings.proof.not_elastic * search.elastic * load
    ):
        search.onset = search.low
    track.keep("loading")
