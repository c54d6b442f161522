"""Rigid-block limits of a structure: the associated bound and the zero-dilation path, each computed at first use.

The bound is rigorous: above it no forces inside the friction cones are in equilibrium, whatever the history. The path
is a second history from gravity (limit/path.py), by another method than the explicit solver's.
"""

from __future__ import annotations

import time
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.contact.joints import only_points
from dem_cli.core.model.scales import largest_structure
from dem_cli.core.records.ports import stage
from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from dem_cli.core.engine.job import Job
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.limit.analysis import LimitLoads
    from dem_cli.core.limit.associated import LimitLoad
    from dem_cli.core.limit.matrices import LimitStructure
    from dem_cli.core.limit.path import Path
    from dem_cli.core.statics.implicit_history import LoadHistory


class RigidLimits:
    """Associated load and zero-dilation path of the blocks of a simulation; multipliers as users know them.

    why_not   why limit analysis does not apply: geometry that moves, profiles, a law without a friction cone, no loads
    gaps      of all contact points at the start [m], (n_points,); what is open there carries nothing
    touching  points without a gap, (n_points,) bool
    seconds   wall time of the associated load and of the path, as far as they were computed
    """

    def __init__(self, job: Job, sim: Simulation) -> None:
        self.job, self.sim = job, sim
        self.why_not: str | None = None
        self.seconds: dict[str, float] = {}
        self.gaps = sim.first_gaps
        self.touching = sim.first_gaps <= 0.0
        if sim.kinematics != "fixed" or sim.properties.rough:
            self.why_not = "geometry moves on the way to failure"
        elif not (sim.loads.dead[sim.free].any() and sim.loads.live[sim.free].any()):
            self.why_not = "there are no dead loads beside the live ones"

    @cached_property
    def _matrices(self) -> tuple[LimitStructure, np.ndarray] | None:
        """Return the structure and the friction of its points; None where limit analysis does not apply."""
        if self.why_not is not None:
            return None
        self.job.clock.imported("dem_cli.core.limit.analysis")
        from dem_cli.core.limit.cone import friction_of
        from dem_cli.core.limit.matrices import structure_of

        joints = only_points(self.sim.joints, self.touching)
        try:
            return structure_of(self.sim.model, joints), friction_of(joints, self.sim.law)
        except UsageError as error:
            self.why_not = str(error)
            return None

    @cached_property
    def associated(self) -> LimitLoad | None:
        """Return the associated limit load; None where limit analysis does not apply."""
        if self._matrices is None:
            return None
        self.job.clock.progress("limit analysis", 0.0, 0.0, None)
        begun = time.perf_counter()
        found = self._limit_load(*self._matrices)
        self.seconds["associated"] = time.perf_counter() - begun
        return found

    @stage
    def _limit_load(self, structure: LimitStructure, friction: np.ndarray) -> LimitLoad:
        from dem_cli.core.laws.envelope import frictional
        from dem_cli.core.limit.associated import associated_limit

        return associated_limit(structure, frictional(friction), self.job.settings.limit.associated)

    @cached_property
    def without_head_friction(self) -> LimitLoad | None:
        """Return the associated limit load without friction in head joints; None where limit analysis does not
        apply."""
        if self._matrices is None:
            return None
        from dem_cli.core.limit.cone import friction_of

        begun = time.perf_counter()
        structure = self._matrices[0]
        found = self._limit_load(structure, friction_of(structure.joints, self.sim.law, heads_frictionless=True))
        self.seconds["safe"] = time.perf_counter() - begun
        return found

    @property
    def _resolution(self) -> float:
        """Width of the bracket over the failure load [-]."""
        resolution = self.job.request.analysis.resolution
        assert resolution is not None
        return resolution

    @property
    def bound(self) -> float | None:
        """Multiplier above which no equilibrium exists; None: not known, or there is none."""
        return self.associated.upper if self.associated is not None else None

    @cached_property
    def slides(self) -> bool:
        """Test whether friction takes part in the mechanism of the bound; without it the history of sliding does
        not matter."""
        found = self.associated
        if self._matrices is None or found is None or found.upper is None:
            return True
        from dem_cli.core.limit.associated import slides

        return slides(*self._matrices, found, self.job.settings.limit.associated)

    @cached_property
    def none_slides(self) -> bool:
        """Test whether friction is proved to take no part in any mechanism of the bound, not only in the one found."""
        found, settings = self.associated, self.job.settings.limit.associated
        if self.slides or self._matrices is None or found is None:
            return False
        from dem_cli.core.limit.associated import sliding_share

        return sliding_share(self._matrices[1], found, settings) <= settings.slides

    @cached_property
    def path(self) -> Path | None:
        """Trace the zero-dilation path from gravity to the plateau of its load; None where it does not apply."""
        if self._matrices is None:
            return None
        begun = time.perf_counter()
        found = self._traced(*self._matrices)
        self.seconds["path"] = time.perf_counter() - begun
        return found

    @stage
    def _traced(self, structure: LimitStructure, friction: np.ndarray) -> Path:
        from dem_cli.core.limit.path import trace

        settings, clock = self.job.settings, self.job.clock
        plateau = min(settings.warm_start.flat * self._resolution, settings.limit.path.plateau)
        return trace(
            structure, friction, plateau,
            progress=lambda load, _: clock.progress("following the path to failure", load, 0.0, None),
            settings=settings.limit.of_path(self.largest, self.sim.model.dimension),
        )  # fmt: skip

    @cached_property
    def history(self) -> LoadHistory | None:
        """Return the implicit history from gravity to failure; None where it does not apply, or was not found."""
        if self._matrices is None or self.bound is None:
            return None
        return self._timed_history(small=False)

    @cached_property
    def history_in_small_steps(self) -> LoadHistory | None:
        """Return the implicit history in small steps of the load; None as `history`."""
        return None if self.history is None else self._timed_history(small=True)

    def _timed_history(self, small: bool) -> LoadHistory | None:
        assert self._matrices is not None
        begun = time.perf_counter()
        found = self._followed(*self._matrices, small)
        self.seconds["history"] = time.perf_counter() - begun
        return found

    @stage
    def _followed(self, structure: LimitStructure, friction: np.ndarray, small: bool) -> LoadHistory | None:
        from dem_cli.core.limit.elastic import Elastic
        from dem_cli.core.statics.implicit_history import ImplicitHistory

        settings, clock, bound = self.job.settings.implicit_history, self.job.clock, self.bound
        assert bound is not None
        problem = Elastic(structure, friction, self.job.settings.limit)
        most = settings.effort / max(problem.n_points, 1)
        history = ImplicitHistory(
            problem, settings, lambda: problem.factorisations > most,
            lambda load, _: clock.progress("holding loads in implicit steps", load, 0.0, None),
        )  # fmt: skip
        return history.search(bound, settings.narrow * self._resolution, small)

    @cached_property
    def largest(self) -> int:
        """Number of blocks of the largest structure."""
        return largest_structure(self.sim.joints.blocks, self.sim.model.fixed)

    @property
    def too_large(self) -> bool:
        """Test whether a path takes too many factorisations to be followed to its end: in the plane it is smoothed."""
        return self.job.settings.limit.too_large(self.largest, self.sim.model.dimension)

    def on_points(self, values: np.ndarray, otherwise: np.ndarray | float = 0.0) -> np.ndarray:
        """Values of the points that touch at the start among all points, (n_points, ...); otherwise: of the others."""
        shape = (len(self.touching), *values.shape[1:])
        whole = np.broadcast_to(otherwise, shape).copy()
        whole[self.touching] = values
        return whole

    def on_blocks(self, moved: np.ndarray) -> np.ndarray:
        """Displacements of all blocks, (n_blocks, n_dof), by those of the free degrees of freedom, (n_free,)."""
        assert self._matrices is not None
        return self._matrices[0].on_blocks(moved)

    @property
    def followed(self) -> bool:
        """Test whether the path was traced."""
        return "path" in self.seconds

    def loads(self) -> LimitLoads | None:
        """Bounds of limit analysis so far, for `limit_analysis` of summary.json."""
        if self._matrices is None or self.associated is None:
            return None
        from dem_cli.core.limit.analysis import LimitLoads

        path = self.path if self.followed else None
        return LimitLoads(
            *self._matrices, self.associated, path, self.seconds["associated"], self.seconds.get("path")
        )  # fmt: skip
