"""Cyclic loading: kind = "cycle", the load multiplier or displacement follows a path of values to and fro."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.bound_beside import Carried, beside_path, status_beside
from dem_cli.analyses.curve_tracing import followed
from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.dynamics.stability import buckles, standing
from dem_cli.core.engine import measures
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.joint_summary import END, joint_state
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.track import Track
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer, stage
from dem_cli.core.records.statuses import FALLS
from dem_cli.core.statics.compliance import check_moves, compliance
from dem_cli.core.statics.displacement_control import DisplacementControl
from dem_cli.core.statics.equilibrium import settle_or_fail, unexpected
from dem_cli.core.statics.hysteresis import loops, state_of
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

FAILS = "fails on the way"
RESOLUTION = 0.002  # of a load that is compared with its bound, as that of a pushover


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Run a cyclic load path; status "ok" means that the structure stood at every load of it."""
    job = CaseJob.of_case(case, model, observer, settings)
    job.skipped.append(f"failure search: the {job.case.analysis.control} follows the path of the case")
    sim = job.first_simulation() if case.analysis.control == "load" else job.moving_simulation()
    track = job.track(sim)
    found: dict[str, Any] = {"status": FALLS, "failure_load": None, "turning_points": [], "loops": []}
    try:
        found["status"] = standing(sim, track, job.budget)
        if found["status"] == "ok":
            track.flush()
            path = LoadPath(job, track)
            try:
                path.walk()
            finally:
                found |= path.found | {"highest_load": path.highest.load, "lowest_load": path.lowest.load}
            found |= beside_path(job, sim, path.highest, path.lowest, RESOLUTION)
            found["status"] = status_beside(found["status"], found)
    except SolverError as error:
        found["status"] = "not converged"
        job.warnings.append(str(error))
    track.flush()
    found |= {"largest_displacement": measures.largest_displacement(sim), "joint_state": joint_state(sim, END)}
    return job.outcome([sim], found)


def values_between(start: float, end: float, step: float) -> np.ndarray:
    """Divide an interval into equal steps of at most `step`, start left out."""
    return np.linspace(start, end, max(1, math.ceil(abs(end - start) / step - 1e-9)) + 1)[1:]


class LoadPath:
    """Load path of a case, followed in steps that each end in equilibrium.

    found: keys of the summary, as far as it has come; highest, lowest: equilibria with the largest and the least load.
    """

    LASTING = frozenset(("sim", "job", "track", "way"))

    def __init__(self, job: CaseJob, track: Track) -> None:
        self.job, self.track, self.sim = job, track, track.sim
        self.found: dict[str, Any] = {"turning_points": [], "loops": []}
        self.way = WAYS[job.case.analysis.control](job, track)
        self.turn, self.steps = 0, 0  # turning points that were reached, steps since the last of them
        self.at_rest = measures.live_travel(self.sim)
        self.states, self.turns = [state_of(self.sim, self.at_rest)], [0]
        self.highest = self.lowest = Carried(0.0, self.sim.save(), measures.largest_displacement(self.sim))

    @stage
    def walk(self) -> None:
        """Follow the whole path, or up to failure."""
        path, step = (0.0, *self.job.case.analysis.path), self.job.case.analysis.step
        self.sim.stages.resumed()
        while self.turn < len(path) - 1:
            values = values_between(path[self.turn], path[self.turn + 1], step)
            while self.steps < len(values):
                self.sim.stages.offer()
                if not self._goes_to(values[self.steps], (self.turn + self.steps / len(values)) / (len(path) - 1)):
                    return
                self.steps += 1
            self._turn(path[self.turn + 1])
        self.found["status"] = "ok"

    def _goes_to(self, value: float, share: float) -> bool:
        """Go to another value of the path; returns whether the structure reaches equilibrium there."""
        sim, track = self.sim, self.track
        track.observer.progress("on the path", sim.load * sim.live_scale, measures.largest_displacement(sim), share)
        if not self.way.go(value):
            self.found |= {"status": FAILS, "failure_load": sim.load * sim.live_scale}
            track.write("collapse")
            track.frame("collapse")
            return False
        track.write("loading")
        self.states.append(state_of(sim, self.at_rest))
        load = self.states[-1].load
        if load > self.highest.load:
            self.highest = self.highest._replace(load=load, standing=sim.save())
        elif load < self.lowest.load:
            self.lowest = self.lowest._replace(load=load, standing=sim.save())
        return True

    def _turn(self, target: float) -> None:
        """Record a turning point, and the loops up to there."""
        analysis, sim = self.job.case.analysis, self.sim
        self.track.frame("loading")
        load = target if analysis.control == "load" else sim.load * sim.live_scale
        point: dict[str, Any] = {"load": load, "displacement": measures.largest_displacement(sim)}
        point["live_displacement"] = self.states[-1].displacement
        if analysis.control == "displacement":
            point |= {"controlled": target} if analysis.of is None else {"controlled": target, "of": analysis.of}
        self.found["turning_points"].append(point)
        self.turn, self.steps = self.turn + 1, 0
        self.turns.append(len(self.states) - 1)
        made = loops(analysis.path, self.turns, self.states, measures.live_force(sim) / sim.live_scale)
        self.found["loops"] = [loop._asdict() for loop in made]


class ByLoad:
    """Load control: goes to multipliers, each a proven equilibrium."""

    LASTING = frozenset(("sim", "job"))

    def __init__(self, job: CaseJob, track: Track) -> None:
        self.job, self.sim, self.elastic = job, track.sim, compliance(track.sim)[1]

    def go(self, load: float) -> bool:
        """Go to a load multiplier of the case."""
        sim = self.sim
        scale = self.elastic * max(abs(load) / sim.live_scale, self.job.case.analysis.step / sim.live_scale)
        verdict = settle_or_fail(sim, load / sim.live_scale, self.job.budget, scale, ahead=unexpected(sim))
        return verdict.state == "equilibrium" and buckles(sim, self.job.budget) is None


class ByDisplacement:
    """Displacement control: goes to displacements of the live load or of a monitor [m], each at rest."""

    LASTING = frozenset(("control",))

    def __init__(self, job: CaseJob, track: Track) -> None:
        elastic = compliance(track.sim)[0]
        check_moves(track.sim, elastic)
        self.near = job.settings.displacement_control.near_target * job.case.analysis.step
        self.control = DisplacementControl(track.sim, job.budget, elastic, of=followed(job, track))

    def go(self, displacement: float) -> bool:
        """Go to a displacement [m]."""
        return self.control.go_to(displacement, self.near)


WAYS: dict[str, type[ByLoad | ByDisplacement]] = {"load": ByLoad, "displacement": ByDisplacement}  # analysis.control
