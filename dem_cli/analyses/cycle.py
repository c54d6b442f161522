"""kind = "cycle": the load multiplier, or the displacement of the live load, follows a path of values to and fro."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.curve_tracing import followed
from dem_cli.engine import measures
from dem_cli.engine.job import Job, Outcome
from dem_cli.engine.joint_summary import END, joint_state
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.engine.simulation import Simulation
from dem_cli.engine.track import Track
from dem_cli.errors import SolverError
from dem_cli.model.model import Model
from dem_cli.output.record import FALLS, Observer
from dem_cli.statics.compliance import check_moves, compliance
from dem_cli.statics.displacement_control import DisplacementControl
from dem_cli.statics.equilibrium import settle, settle_or_fail
from dem_cli.statics.hysteresis import loops, state_of

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

FAILS = "fails on the way"


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Outcome of a load path; status "ok" means that the structure stood at every load of it."""
    job = Job.start(case, model, observer, settings)
    job.skipped.append(f"failure search: the {job.case.analysis.control} follows the path of the case")
    sim = job.first_simulation() if case.analysis.control == "load" else job.moving_simulation()
    track = job.track(sim)
    found: dict[str, Any] = {"status": FALLS, "failure_load": None, "turning_points": [], "loops": []}
    try:
        if settle(sim, track, job.budget).state == "equilibrium":
            track.flush()
            _follow(job, sim, track, found)
    except SolverError as error:
        found["status"] = "not converged"
        job.warnings.append(str(error))
    track.flush()
    found |= {"largest_displacement": measures.largest_displacement(sim), "joint_state": joint_state(sim, END)}
    return job.outcome([sim], found)


def values_between(start: float, end: float, step: float) -> np.ndarray:
    """Equal steps of at most `step` from start (left out) to end."""
    return np.linspace(start, end, max(1, math.ceil(abs(end - start) / step - 1e-9)) + 1)[1:]


def _follow(job: Job, sim: Simulation, track: Track, found: dict[str, Any]) -> None:
    """Every value of the path, after each of whose steps all forces balance; what is found goes to `found` at once."""
    analysis = job.case.analysis
    go = WAYS[analysis.control](job, track)
    at_rest = measures.live_travel(sim)
    value, states, turns = 0.0, [state_of(sim, at_rest)], [0]
    for turn, target in enumerate(analysis.path):
        for next_value in values_between(value, target, analysis.step):
            share, moved = turn / len(analysis.path), measures.largest_displacement(sim)
            track.observer.progress("on the path", sim.load * sim.live_scale, moved, share)
            if not go(next_value):
                found |= {"status": FAILS, "failure_load": sim.load * sim.live_scale}
                track.write("collapse")
                track.frame("collapse")
                return
            track.write("loading")
            states.append(state_of(sim, at_rest))
            value = next_value
        track.frame("loading")
        load = target if analysis.control == "load" else sim.load * sim.live_scale
        point: dict[str, Any] = {"load": load, "displacement": measures.largest_displacement(sim)}
        point["live_displacement"] = states[-1].displacement
        if analysis.control == "displacement":
            point |= {"controlled": target} if analysis.of is None else {"controlled": target, "of": analysis.of}
        found["turning_points"].append(point)
        turns.append(len(states) - 1)
        made = loops(analysis.path, turns, states, measures.live_force(sim) / sim.live_scale)
        found["loops"] = [loop._asdict() for loop in made]
    found["status"] = "ok"


def _by_load(job: Job, track: Track) -> Callable[[float], bool]:
    """Goes to a multiplier, a proven equilibrium."""
    sim = track.sim
    elastic = compliance(sim)[1]
    step = job.case.analysis.step / sim.live_scale

    def go(load: float) -> bool:
        scale = elastic * max(abs(load) / sim.live_scale, step)
        return settle_or_fail(sim, load / sim.live_scale, job.budget, scale).state == "equilibrium"

    return go


def _by_displacement(job: Job, track: Track) -> Callable[[float], bool]:
    """Goes to a displacement of the live load or of a monitor [m], to rest."""
    sim, near = track.sim, job.settings.displacement_control.near_target * job.case.analysis.step
    elastic = compliance(sim)[0]
    check_moves(sim, elastic)
    control = DisplacementControl(sim, job.budget, elastic, of=followed(job, track))
    return lambda displacement: control.go_to(displacement, near)


WAYS = {"load": _by_load, "displacement": _by_displacement}  # of analysis.control
