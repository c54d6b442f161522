"""kind = "pushover": the load multiplier at which a structure fails, and how it falls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.errors import SolverError
from dem_cli.model.model import Model
from dem_cli.output.record import Observer
from dem_cli.solve import follow
from dem_cli.solve.equilibrium import Budget
from dem_cli.solve.failure import Search, find_failure
from dem_cli.solve.gravity import FALLS, begin, settle
from dem_cli.solve.mechanism import describe
from dem_cli.solve.monitors import Monitors
from dem_cli.solve.run import Clock, Outcome, common_summary, simulation
from dem_cli.solve.simulation import Simulation
from dem_cli.solve.track import Track

if TYPE_CHECKING:
    from dem_cli.case.schema import Case


def run(case: Case, model: Model, observer: Observer) -> Outcome:
    """Outcome of a pushover; raises SolverError only where a number is no number."""
    clock = Clock(observer)
    sim, skipped = begin(case, model, clock)
    monitors, frames = Monitors(case, model), case.output.frames
    budget = Budget(case.analysis.max_steps)
    search, sim, why = _search(case, model, sim, monitors, budget, clock, skipped)
    sims, found = [sim], {"failure_mode": None, "displacement_at_failure": None}
    track = Track(sim, clock, monitors, frames)
    if search.status == "ok":
        found |= describe(sim, search.held)
        failing = sim.save()
        sim.restore(search.held)
        track.frame("loading")
        sim.restore(failing)
        track.frame("collapse")
        if case.analysis.follow > 0.0:
            falling, peak = _follow(case, model, sim, search, monitors, budget, clock, why)
            sims.append(falling)
            found["displacement_at_failure"] = peak["displacement"]
            found["peak_of_curve"] = peak["load"] * sim.live_scale
        else:
            skipped.append("collapse: analysis.follow = 0")
            found["displacement_at_failure"] = search.peak_displacement
    elif search.status != FALLS:
        track.frame("loading")
    summary = common_summary(sims, clock, skipped)
    summary["warnings"] += why
    return Outcome(summary | _answer(search, sim, case) | found)


def _search(
    case: Case,
    model: Model,
    sim: Simulation,
    monitors: Monitors,
    budget: Budget,
    clock: Clock,
    skipped: list[str],
) -> tuple[Search, Simulation, list[str]]:
    """Gravity and the failure search; again with moving geometry where the joints are too soft to freeze it."""
    analysis = case.analysis
    search, why = Search(), []
    while True:
        track = Track(sim, clock, monitors, case.output.frames)
        try:
            if settle(sim, track, budget).state != "equilibrium":
                search.status = FALLS
            else:
                find_failure(sim, analysis.resolution, analysis.max_load, budget, track, search)
        except SolverError as error:
            why = [str(error)]
        soft = search.peak_displacement / sim.smallest > 0.5 * analysis.resolution
        given = all(joint.kn != "auto" for joint in case.joints.values())
        if not (soft and given and sim.kinematics == "fixed" and analysis.kinematics == "auto"):
            if search.status != "ok" or analysis.follow == 0.0:
                track.flush()  # else the rows of the collapse tell the whole way
            return search, sim, why
        skipped[:] = [f"fixed geometry: the given joints are so soft that blocks move {search.peak_displacement:.2g} m"]
        search, sim = Search(), simulation(case, model, "large")
        clock.compile(sim)


def _follow(
    case: Case,
    model: Model,
    sim: Simulation,
    search: Search,
    monitors: Monitors,
    budget: Budget,
    clock: Clock,
    why: list[str],
) -> tuple[Simulation, dict[str, float]]:
    load = search.low / sim.live_scale
    falling, softer = follow.simulate(
        case, model, search.elastic, load, sim.smallest, case.analysis.follow
    )
    falling.steps = sim.steps
    clock.compile(falling)
    track = Track(falling, clock, monitors, case.output.frames)
    fast = search.compliance * softer / follow.STEPS
    rate = min(fast, search.compliance / search.elastic * case.analysis.follow / follow.FEWEST)
    try:
        return falling, follow.follow(
            falling, track, rate, load, case.analysis.follow, case.output.frames, budget
        )
    except SolverError as error:
        why.append(f"the collapse was not followed to its end: {error}")
        return falling, {"load": 0.0, "displacement": 0.0}


def _answer(search: Search, sim: Simulation, case: Case) -> dict[str, Any]:
    """The failure load and how it was obtained."""
    status = search.status
    if status == "no failure":
        status = f"no failure up to a load multiplier of {case.analysis.max_load:g}"
    answer: dict[str, Any] = {
        "status": status,
        "failure_load": search.low if search.status == "ok" else None,
        "failure_load_bracket": [search.low, search.high],
        "kinematics": sim.kinematics,
        "search": [vars(p) for p in search.passes],
    }
    if search.failing is not None:
        answer["proof_of_failure"] = {
            "released_share_of_work": search.failing.released,
            "growth_when_time_doubles": search.failing.growth,
        }
    return answer
