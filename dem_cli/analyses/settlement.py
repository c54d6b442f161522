"""Settlement analysis, kind = "settlement": supports move slowly as [[settlement]] says, with moving geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.arithmetic.products import product
from dem_cli.core.dynamics.stability import buckles
from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.joint_summary import END, joint_state
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.engine.track import Track
from dem_cli.core.geometry.rotation import turned_as_one
from dem_cli.core.model.model import Model
from dem_cli.core.records.ports import Observer, stage
from dem_cli.core.records.statuses import BUCKLED, FALLS
from dem_cli.core.statics.equilibrium import stand
from dem_cli.core.statics.mechanism import describe
from dem_cli.core.statics.settlement_way import SettlementWay
from dem_cli.errors import CaseError, CaseProblem, SolverError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

COLLAPSED = "collapsed under the settlement"


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Run a settlement; status "ok" means that the structure stands afterwards."""
    if not case.settlement:
        raise CaseError([CaseProblem(("analysis", "kind"), "'settlement' needs at least one [[settlement]] table")])
    job = CaseJob.of_case(case, model, observer, settings)
    job.skipped.append("failure search: the supports move, the load does not")
    sim = job.simulation("large", stiffness_ratio(model, settings.stiffness.settlement_overlap))
    track = job.track(sim)
    found: dict[str, Any] = {}
    try:
        job.clock.progress("gravity", 0.0, 0.0, None)
        status = "ok" if stand(sim, job.budget).state == "equilibrium" else FALLS
        if status == "ok" and buckles(sim, job.budget) is not None:
            status = BUCKLED
        track.write("gravity")
        track.frame("gravity")
        if status == "ok":
            movement = SupportMovement(case, model)
            path = movement.at if movement.curved else None
            way = SettlementWay(sim, movement.at(1.0), path, lambda at_rest: buckles(at_rest, job.budget) is not None)
            status = _move(way, track, case.output.snapshots, job.budget)
            found |= measured_at_end(sim)
            if status == COLLAPSED:
                found |= _collapse(case, way, job)
    except SolverError as error:
        status = "not converged"
        job.warnings.append(str(error))
    return job.outcome([sim], {"status": status} | (found or measured_at_end(sim)))


def measured_at_end(sim: Simulation) -> dict[str, Any]:
    """Return the state of the structure at this settlement, for the summary."""
    return {"largest_displacement": measures.largest_displacement(sim), "joint_state": joint_state(sim, END)}


def stiffness_ratio(model: Model, overlap: float = DEFAULT.stiffness.settlement_overlap) -> float:
    """Return kn·h/W of "auto" joints that keeps overlaps small: the whole weight may rest on one joint."""
    return float((~model.fixed).sum()) / overlap


class SupportMovement:
    """Movement of the supports of all [[settlement]] tables, each table as one rigid body.

    curved: some turn about a point that is not their own centroid, which then moves on a circle
    """

    def __init__(self, case: Case, model: Model):
        self.tables, self.model = case.settlement, model
        self.chosen = [model.chosen(table.selected, True) for table in self.tables]
        turning = [len(chosen) > 1 and any(table.rotation) for table, chosen in zip(self.tables, self.chosen)]
        self.curved = any(turning)

    def at(self, share: float) -> np.ndarray:
        """Return the movement of every block at a share of the way, zero but for settling supports [m, rad], (n,
        n_dof).
        """
        motion = np.zeros_like(self.model.dead_loads)
        for table, chosen in zip(self.tables, self.chosen, strict=True):
            motion[chosen] += share * np.array([*table.displacement, *table.rotation])
            if len(chosen) > 1 and any(table.rotation):
                masses, centroids = self.model.masses[chosen], self.model.centroids[chosen]
                arms = centroids - product(masses, centroids) / masses.sum()
                turn = share * np.array(table.rotation)
                motion[chosen, : self.model.dimension] += turned_as_one(arms, turn) - arms
        return motion


@stage
def _move(way: SettlementWay, track: Track, frames: int, budget: Budget) -> str:
    """Move the supports, then wait for equilibrium; returns the status."""
    sim, rows = way.sim, way.rows
    every = max(rows // max(frames - 2, 1), 1)
    if not sim.stages.resumed():
        way.begin()
    while way.done < rows:
        sim.stages.offer()
        way.go_on(budget)
        track.write("settlement")
        if way.done % every == 0:
            track.frame("settlement")
        share, moved = way.done / rows, measures.largest_displacement(sim)
        track.observer.progress("settlement", share, moved, share)
    track.observer.progress("settled", 1.0, measures.largest_displacement(sim), None)
    stands = way.stands(budget)
    track.write("settlement")
    track.frame("settlement")
    return "ok" if stands else COLLAPSED


def _collapse(case: Case, way: SettlementWay, job: CaseJob) -> dict[str, Any]:
    """Bracket the support movement at failure and follow the collapse; the final state is left unchanged."""
    sim = way.sim
    end = sim.save()
    job.clock.progress("how far it stands", 1.0, measures.largest_displacement(sim), None)
    try:
        low, high = way.bracket(job.budget)
        sim.restore(way.failing)
        how = describe(sim, way.standing)
    except SolverError as error:
        job.warnings.append(f"the settlement at collapse was not found: {error}")
        return {}
    finally:
        sim.restore(end)
    share = low / way.rows
    supports = {
        table.selected: {
            "displacement": [share * component for component in table.displacement],
            "rotation": _plain([share * angle for angle in table.rotation]),
        }
        for table in case.settlement
    }
    found = {"share": share, "bracket": [share, high / way.rows], "supports": supports}
    return {"settlement_at_collapse": found} | how


def _plain(turn: list[float]) -> float | list[float]:
    """Convert a rotation for the summary: in the plane one angle, in space axis times angle [rad]."""
    return turn if len(turn) > 1 else turn[0]
