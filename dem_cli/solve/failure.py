"""The failure load: decelerating creep, a hold that proves an equilibrium, a load above that proves failure.

Equilibrium exists at every prescribed displacement, so nothing has to be guessed about failure: the live
load is replaced by a prescribed rate of its own displacement q·u, and its multiplier is found as a
reaction. The rate is halved several times and then set to zero; what is left after the structure
calmed down is a proven equilibrium. The load is then raised by half the wanted bracket at a time
until failure is proven as well.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.errors import SolverError
from dem_cli.kernels import records as slot
from dem_cli.solve.equilibrium import (
    CHUNK,
    CREEP_SAFETY,
    GRAVITY_TOLERANCE,
    TOLERANCE,
    Budget,
    Verdict,
    check_finite,
    relax,
    settle_or_fail,
)

if TYPE_CHECKING:
    from dem_cli.solve.simulation import Simulation
    from dem_cli.solve.track import Track

PHASES = 5  # times that the rate is halved
FIRST_PASS = 1000  # steps of the first creep phase, doubled from pass to pass
REACH = 15.0  # displacement of the first creep phase, in elastic displacements at multiplier 1
MOST_PASSES = 9
LOCKED = 100.0  # internal multiplier at which a structure counts as self-locking
AGREE = 0.01  # two passes that agree so well are slow enough; the proofs that follow do the rest
ROWS = 20  # history rows of the first phase
PROBE = 0.02  # internal multiplier of the first load
HOLD_STEPS = 60_000
SOFTENED, BEFORE_PEAK = 0.95, 0.7  # drop of the load past a peak; displacement to go back to, over that of the peak


@dataclass(frozen=True)
class Pass:
    """One creep and its hold, or one constant load; multipliers as users know them."""

    kind: str  # "creep" | "load"
    steps: int
    load: float  # held equilibrium, or the constant load
    state: str  # "equilibrium" | "failure" | "unknown"
    power_load: float | None = None  # multiplier from the power balance of the last creep phase


@dataclass
class Search:
    """What was found, and the way to it."""

    low: float | None = None  # highest proven equilibrium
    high: float | None = None  # lowest proven failure
    status: str = "not converged"  # "ok" | "not converged" | "no failure" | "does not stand"
    compliance: float = 0.0  # q·u per unit of internal multiplier while elastic [J]
    elastic: float = 0.0  # largest displacement per unit of internal multiplier while elastic [m]
    peak_displacement: float = 0.0  # largest displacement of a block at the highest equilibrium [m]
    held: tuple | None = None  # state of the highest equilibrium
    failing: Verdict | None = None
    limit: float = 0.0  # multiplier above which nothing was tried
    passes: list[Pass] = field(default_factory=list)


class _Creep(NamedTuple):
    """What a creep found; internal multipliers."""

    held: float | None  # proven equilibrium at its end
    power: float  # from the power balance of its last phase
    where: float  # share of the first phase at which the load was highest


def stand(sim: Simulation, budget: Budget) -> Verdict:
    """Equilibrium under dead loads alone, or proof that there is none."""
    verdict = relax(sim, 0.0, GRAVITY_TOLERANCE)
    if verdict.state == "equilibrium":
        return verdict
    return settle_or_fail(sim, 0.0, budget, sim.dead_scale(), GRAVITY_TOLERANCE)


def compliance(sim: Simulation) -> tuple[float, float]:
    """q·u [J] and largest displacement [m] per unit of multiplier for small loads; the state is left as it was.

    Where the structure has no equilibrium even at the smallest probe, that of the last probe is returned.
    """
    before, places, saved = sim.live_displacement(), sim.save_places(), sim.save()
    load, value, largest = PROBE, 0.0, 0.0
    for _ in range(4):
        verdict = relax(sim, load, TOLERANCE, 20_000)
        value = (sim.live_displacement() - before) / load
        largest = float(np.abs(sim.save_places() - places).max()) / load
        sim.restore(saved)
        if verdict.state == "equilibrium":
            break
        load /= 10.0
    return value, largest


def find_failure(
    sim: Simulation, resolution: float, max_load: float | None, budget: Budget, track: Track, search: Search
) -> Search:
    """Bracket of the failure load of a structure that stands under its dead loads (see the module docstring).

    max_load is the multiplier, as users know it, above which the structure counts as self-locking (None:
    LOCKED times the dead loads). What is found goes to `search` as it is found, so that it is not lost
    where the budget ends; rows of the last creep stay in the track.
    """
    search.low, search.held = 0.0, sim.save()
    search.compliance, search.elastic = compliance(sim)
    soft = search.compliance
    if soft <= 0.0:
        raise SolverError("the live load moves nothing: no free block has a live load")
    start, limit = sim.save(), LOCKED if max_load is None else max_load / sim.live_scale
    search.limit = limit * sim.live_scale
    n, reach, previous, bends = FIRST_PASS, REACH, None, False
    for number in range(MOST_PASSES):
        track.observer.progress(f"creep {number + 1}", search.low, search.peak_displacement, 0.1 + 0.08 * number)
        sim.restore(start)
        held, power, where = _creep(sim, n, reach * soft, budget, track)
        state = "unknown" if held is None else "equilibrium"
        load = sim.load if held is None else held
        search.passes.append(Pass("creep", n, load * sim.live_scale, state, power * sim.live_scale))
        if sim.kinematics == "large" and where < 1.0:  # the curve bends down: stay before its peak
            reach, bends = BEFORE_PEAK * reach * where, True
            continue
        if held is None:
            n *= 2
            continue
        _keep(search, sim, held)
        if held >= limit:
            search.status = "no failure"
            return search
        if bends:
            break  # an equilibrium before the peak: the load goes on from there
        if held > 0.5 * reach:  # still elastic: go on further
            reach *= 4.0
            continue
        if previous is not None and abs(held - previous) < max(2 * resolution, AGREE) * abs(held):
            break
        previous, n = held, 2 * n
    return _raise_to_failure(sim, search, resolution, limit, budget, track)


def _creep(sim: Simulation, n: int, distance: float, budget: Budget, track: Track) -> _Creep:
    """Decelerating creep over about `distance` [J] and a hold."""
    rate = distance / n
    sim.use(CREEP_SAFETY)
    sim.control[slot.RATE] = rate
    del track.kept[1:]  # rows of the pass before; the first is that of gravity
    loads = []
    for _ in range(ROWS):
        sim.advance(n // ROWS, sim.creep_mode)
        loads.append(sim.control[slot.MEAN_LOAD])
        track.keep("loading")
        if sim.kinematics == "large" and loads[-1] < SOFTENED * max(loads):
            break
    where = (1 + int(np.argmax(loads))) / ROWS
    budget.spend(n, "creeping to failure")
    if len(loads) < ROWS:
        return _Creep(None, loads[-1], where)
    for _ in range(PHASES):
        rate *= 0.5
        sim.control[slot.RATE] = rate
        sim.advance(n // 2, sim.creep_mode)
        track.keep("loading")
    check_finite(sim)
    power = sim.control[slot.MEAN_LOAD] - sim.control[slot.MEAN_POWER] / (rate * (n // 2))
    budget.spend(PHASES * (n // 2), "creeping to failure")
    sim.control[slot.RATE] = 0.0
    calm = 0
    for _ in range(HOLD_STEPS // CHUNK):
        sim.advance(CHUNK, sim.creep_mode)
        budget.spend(CHUNK, "holding an equilibrium")
        calm = calm + 1 if sim.unbalanced < TOLERANCE else 0
        if calm == 2:
            load = sim.load
            sim.rest()
            return _Creep(load, power, where)
    return _Creep(None, power, where)


def _keep(search: Search, sim: Simulation, load: float) -> None:
    """The equilibrium of the slowest path so far; a faster path may have passed a higher one by its momentum."""
    search.low, search.held = load * sim.live_scale, sim.save()
    search.peak_displacement = sim.largest_displacement()


def _raise_to_failure(
    sim: Simulation,
    search: Search,
    resolution: float,
    limit: float,
    budget: Budget,
    track: Track,
) -> Search:
    """From the highest equilibrium up, half a bracket at a time, later faster, then back by halves."""
    low = search.low / sim.live_scale
    width = 0.5 * resolution
    step, high, failed = width * max(abs(low), 1e-3), None, None
    while high is None or high - low > 2.0 * width * max(abs(low), 1e-3):
        load = low + step if high is None else 0.5 * (low + high)
        if load >= limit:
            search.status = "no failure"
            return search
        track.observer.progress("raising the load", load * sim.live_scale, search.peak_displacement, 0.85)
        sim.restore(search.held)
        before = sim.steps
        verdict = settle_or_fail(sim, load, budget, search.elastic * max(abs(load), PROBE))
        search.passes.append(Pass("load", sim.steps - before, load * sim.live_scale, verdict.state))
        if verdict.state == "equilibrium":
            low = load
            _keep(search, sim, load)
            step *= 1.5 if high is None else 1.0
        else:
            high, failed = load, (verdict, sim.save())
    search.high, search.failing, search.status = high * sim.live_scale, failed[0], "ok"
    sim.restore(failed[1])
    return search

