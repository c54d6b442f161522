"""Implicit increments of displacement control: the contact problem of an increment about the present configuration.

Where blocks are moved in ramps they are accelerated, and joints that slip meanwhile may stay weaker. Here each
increment is posed where the structure is: gaps measured, compatibility made anew, springs and friction from the forces
of the last state, and solved by an interior point under the exact law (limit/elastic.py, limit/interior.py), in 2D and
3D alike. Blocks then go there by finite rotations, and the explicit solver brings them to rest at that displacement,
from close by: what the increment missed, as forces turn with the blocks, is found there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.joints import only_points
from dem_cli.core.engine.placement import moves
from dem_cli.core.statics.displacement_control import DisplacementControl, Followed
from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Callable

    from dem_cli.core.engine.budget import Budget
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.limit.elastic import Elastic, State


class PosedIncrement(NamedTuple):
    """Contact problem of the present configuration, in its units."""

    problem: Elastic
    before: State  # forces of the last state; no displacements yet
    kept: np.ndarray  # points that are any, (n_points,) bool
    on_blocks: Callable[[np.ndarray], np.ndarray]  # limit/matrices.py: LimitStructure


def why_not(sim: Simulation) -> str | None:
    """Return the reason why implicit increments do not apply: a law without a friction cone, profiles, ties,
    elastic parts."""
    from dem_cli.core.limit.cone import friction_of

    if sim.links or sim.model.n_modes or sim.properties.rough:
        return "no implicit increments with ties, profiles or blocks that deform"
    if sim.integrates:
        return "no implicit increments with joints of given stiffness"
    if sim.loads_follow:
        return "no implicit increments with loads that follow their blocks"
    try:
        friction_of(sim.joints, sim.law)
    except UsageError:
        return f"no implicit increments with joints of law '{sim.law.name}'"
    return None


class ImplicitControl(DisplacementControl):
    """Displacement control in implicit increments; one that has no solution is moved in a ramp, as DisplacementControl.

    starts: DisplacementControl.way at which each increment began; ramped: of those without a solution; effort:
    factorisations × points so far. least: ramps of less steps than that are moved as ramps.
    """

    least = 0.0

    def __init__(
        self,
        sim: Simulation,
        budget: Budget,
        compliance: float,
        watch: Callable[[], None] = lambda: None,
        of: Followed | None = None,
    ) -> None:
        super().__init__(sim, budget, compliance, watch, of)
        self.starts: list[float] = []
        self.ramped: list[float] = []
        self.effort = 0.0

    def mostly(self, until: float) -> bool:
        """Test whether most of the increments up to DisplacementControl.way had a solution."""
        starts, ramped = (sum(way < until for way in ways) for ways in (self.starts, self.ramped))
        return ramped <= self.settings.mostly * starts

    def _ramp(self, distance: float) -> None:
        if self._steps(distance) < self.least:
            super()._ramp(distance)
            return
        way = self.way
        self.starts.append(way)
        if not self._gone(distance):
            self.ramped.append(way)
            super()._ramp(distance)
        self.watch()

    def _gone(self, distance: float) -> bool:
        """Solve an increment from the present configuration; returns whether it had a solution. Small ones without
        a displacement follow it, as forces turn with the blocks.
        """
        settings = self.settings
        if self.effort > settings.implicit_effort:
            return False
        for following in range(settings.implicit_rounds):
            posed = self._posed()
            problem, before = posed.problem, posed.before
            off = np.abs(problem.imbalance(before.normal, before.shear, before.load)) / problem.own
            if following and off.max(initial=0.0) < settings.implicit_near:
                break
            found = self._solution(posed, 0.0 if following else distance)
            if found is None:
                return following > 0
            self._move(posed, found)
        return True

    def _posed(self) -> PosedIncrement:
        from dem_cli.core.limit.cone import friction_of
        from dem_cli.core.limit.elastic import Elastic, State
        from dem_cli.core.limit.matrices import structure_of

        sim = self.sim
        contacts, kept = sim.measured(), sim.joints.kn > 0.0  # in space a slot without a point has no stiffness
        joints = only_points(sim.joints, kept)
        structure = structure_of(sim.model, joints)
        gaps = (contacts.gaps - contacts.closure)[kept]
        problem = Elastic(structure, friction_of(joints, sim.law), sim.settings.limit, gaps)
        normal, shear = np.maximum(-joints.kn * gaps, 0.0), sim.contacts.shear[kept].T.ravel()
        load, still = sim.load * sim.live_scale / problem.live_scale, np.zeros(len(problem.columns))
        slip = np.zeros(len(normal) + len(shear))
        before = State(still, load, normal / problem.weight, shear / problem.weight, slip)
        return PosedIncrement(problem, before, kept, structure.on_blocks)

    def _solution(self, posed: PosedIncrement, distance: float) -> State | None:
        """Solve for the state after a displacement of the live load [m]; None where there is no solution."""
        from dem_cli.core.limit.interior import Increment

        problem, before, path = posed.problem, posed.before, posed.problem.settings.path
        work = distance * self.forces / self.sim.live_scale  # of the live loads at the multiplier 1 of users [J]
        target = work * problem.live_scale / (problem.weight * problem.unit)
        tau = path.tau * max(float(before.normal.max(initial=1.0)), 1.0) ** 2
        for easier in self.settings.implicit_starts:
            found = Increment(problem, before, target).solve(easier * tau)
            if found is not None and problem.residual(found, before) < path.accepted:
                break
            found = None
        self.effort += problem.factorisations * problem.n_points
        return found

    def _move(self, posed: PosedIncrement, found: State) -> None:
        """Move the blocks to where an increment takes them, with its shear forces; gaps follow from the geometry."""
        problem, before, kept, on_blocks = posed
        slid = problem.slid(found.displacements) + (found.shear - before.shear) / problem.ks_t
        friction = -float(product(found.shear, slid)) * problem.weight * problem.unit
        shear = self.sim.contacts.shear.copy()
        shear[kept] = found.shear.reshape(-1, int(kept.sum())).T * problem.weight
        motion = on_blocks(problem.displacements(found.displacements))
        moves.move_to(self.sim, motion, shear, found.load * problem.live_scale / self.sim.live_scale, friction)


class StiffControl(ImplicitControl):
    """Displacement control in ramps, but for those that are long, as joints are stiff: implicit increments instead."""

    def __init__(
        self,
        sim: Simulation,
        budget: Budget,
        compliance: float,
        watch: Callable[[], None] = lambda: None,
        of: Followed | None = None,
    ) -> None:
        super().__init__(sim, budget, compliance, watch, of)
        self.least = self.settings.long_ramp[sim.model.dimension]
