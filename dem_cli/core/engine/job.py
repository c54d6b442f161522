"""Run of one analysis (job), from its request and model to an outcome; what every analysis shares."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from dem_cli.core.engine import measures
from dem_cli.core.engine.audit import unproven
from dem_cli.core.engine.audit import warnings as doubts
from dem_cli.core.engine.automatic_stiffness import leaning, needed_ratio, ratio_of, shown_closure, static_ratio
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.clock import Clock
from dem_cli.core.engine.kinematics import live_scale, open_gaps_doubt, why_moving
from dem_cli.core.engine.measures import closure
from dem_cli.core.engine.monitors import Monitors
from dem_cli.core.engine.properties import integrates_with, joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.engine.track import Track
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer

if TYPE_CHECKING:
    from dem_cli.core.records.requests import SolverRequest


@dataclass
class Outcome:
    """Outcome of an analysis; `summary` has the keys of summary.json that are the solver's."""

    summary: dict[str, Any]


@dataclass
class Job:
    """Run of one analysis: its request, its model, and what its stages share."""

    LASTING: ClassVar[frozenset[str]] = frozenset(("request", "model", "clock", "monitors", "budget", "settings"))
    request: SolverRequest
    model: Model
    clock: Clock
    monitors: Monitors
    budget: Budget
    settings: Settings = DEFAULT
    skipped: list[str] = field(default_factory=list)  # what was not needed
    warnings: list[str] = field(default_factory=list)
    contradictions: list[str] = field(default_factory=list)  # of how it ended, which stand beside that

    @classmethod
    def start(cls, request: SolverRequest, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Job:
        """Create a run that reports to `observer`."""
        monitors, budget = Monitors(request.monitors, model), Budget(request.analysis.max_steps)
        return cls(request, model, Clock(observer), monitors, budget, settings)

    def stiffness(self, kinematics: str) -> float:
        """Return kn·h/W of "auto" joints in a static analysis, at least."""
        return static_ratio(self.model, kinematics, self.settings.stiffness)

    def simulation(self, kinematics: str, ratio: float | None = None, elastic: bool = False) -> Simulation:
        """Build a compiled simulation; ratio: kn·h/W of "auto" joints (None: that of the settings).

        Where geometry moves they stand for rigid ones (engine/rigid_joints.py) and are stiffer if the structure leans
        too far on them; elastic: they are the springs that they are.
        """
        ratio = self.stiffness(kinematics) if ratio is None else ratio
        sim, resolution = self._compiled(kinematics, ratio), self.request.analysis.resolution
        if kinematics == "fixed" or elastic:
            sim.takes_back = False
            return sim
        needed = needed_ratio(sim, resolution)
        sim = sim if needed == ratio_of(sim) else self._compiled(kinematics, needed)
        sim.leans = leaning(sim)
        sim.shown = shown_closure(sim, resolution)
        return sim

    def moving_simulation(self, elastic: bool = False) -> Simulation:
        """Build a simulation with large displacements, unless fixed geometry is requested; elastic as for
        `simulation`."""
        return self.simulation("fixed" if self.request.analysis.kinematics == "fixed" else "large", elastic=elastic)

    def softer(self, sim: Simulation, times: float) -> Simulation:
        """Build the same simulation with large displacements on "auto" joints that are so many times as soft."""
        softer = self._compiled("large", ratio_of(sim) / times)
        softer.takes_back, softer.leans = sim.takes_back, leaning(softer)
        softer.shown = shown_closure(softer, self.request.analysis.resolution)
        return softer

    def _compiled(self, kinematics: str, ratio: float) -> Simulation:
        integrates = integrates_with(self.request, kinematics)
        tilting = self.request.analysis.tilting
        return self.clock.compiled(
            lambda: Simulation(
                self.model,
                law_of(self.request),
                joint_properties(self.request, self.model, ratio, integrates=integrates),
                kinematics,
                live_scale=1.0 if tilting else live_scale(self.model),
                tilting=tilting,
                settings=self.settings,
            )
        )

    def first_simulation(self) -> Simulation:
        """Build the simulation that finds equilibria and failure, with the requested or necessary kinematics."""
        moving = why_moving(self.request, self.model)
        if moving is None:
            self.skipped.append("large displacements: the geometry of the start is exact for a failure load")
            self.skipped.append("detection: done once, nothing moves visibly before failure")
            if doubt := open_gaps_doubt(self.model):
                self.warnings.append(doubt)
        elif moving:
            self.skipped.append(f"fixed geometry: {moving}")
        return self.simulation("fixed" if moving is None else "large")

    def track(self, sim: Simulation) -> Track:
        """Create the track for rows and frames of a simulation."""
        return Track(sim, self.clock, self.monitors, self.request.snapshots)

    def outcome(self, sims: list[Simulation], found: dict[str, Any]) -> Outcome:
        """Build the audited summary of all simulations of this run."""
        worst = max((closure(sim) for sim in sims), key=abs)
        overlap = max(measures.largest_overlap(sim) / sim.smallest for sim in sims)
        self.warnings += doubts(self.request, sims, found)
        if found.get("status") == "ok" and unproven(self.request, sims[0]):
            found = found | {"status": "not converged"}
        summary = {
            "joints": sims[0].first_joints,
            "contacts": sims[0].first_points,
            "steps": sims[-1].steps,
            "time_step": 1.0,
            "solve_seconds": self.clock.seconds(),
            "solve_cpu_seconds": self.clock.cpu_seconds(),
            "compile_seconds": self.clock.compiling,
            "energy_closure": worst,
            **measures.reweighting(sims),
            "largest_overlap": overlap * sims[0].smallest,
            "unbalanced_force": sims[0].unbalanced,
            "skipped": self.skipped,
            "warnings": self.warnings,
        }
        return Outcome(summary | found)
