"""Failure search: the failure load from gravity under a growing load, with the kinematics that the structure
needs, and a second history beside it.
"""

from __future__ import annotations

from math import ceil, inf, log2
from typing import TYPE_CHECKING

import numpy as np

from dem_cli.core.dynamics.stability import buckles, standing
from dem_cli.core.engine.kinematics import fixed_beside
from dem_cli.core.statics.agreement import at_the_bound, load_range, percent
from dem_cli.core.statics.compliance import compliance
from dem_cli.core.statics.failure_bracket import OK, FailureLoad, SearchRange
from dem_cli.core.statics.failure_load import LoadSearch
from dem_cli.core.statics.rigid_limits import RigidLimits
from dem_cli.core.statics.warm_start import GRAVITY, IMPLICIT, find_start
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from collections.abc import Callable

    from dem_cli.core.engine.job import Job
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.track import Track

INTERRUPTED = "interrupted"
UNFINISHED = "the zero-dilation path was not followed to its end"


def failure_search(
    job: Job,
    max_load: float | None = None,
    bound: Callable[[], float | None] = lambda: None,
    rows: bool = True,
) -> tuple[FailureLoad, Simulation]:
    """Search for the failure load from gravity, with large displacements where given joints are too soft to freeze
    geometry.

    That is decided before the search, by elastic displacements at the load that limit analysis allows at most; and
    after it once more, by those at failure. Where some of several structures have gaps that may close, geometry is that
    of the start unless it is one of these that fails first.

    max_load: multiplier above which the structure counts as self-locking; bound: what rigid blocks carry at most in the
    geometry of the start; rows: whether the observer gets those of the search, where it found a load.
    """
    closing = fixed_beside(job.request, job.model)
    search, sim = FailureLoad(), job.first_simulation() if closing is None else job.simulation("fixed")
    rigid: float | None = None  # what the same blocks carry on stiff joints, or
    searched = False  # at most
    while True:
        track = job.track(sim)
        moved = _raised(job, sim, track, search, rigid, max_load)  # smallest edges
        if closing is not None and search.status != INTERRUPTED:
            if not _fails_beside(search, sim, closing):
                job.warnings.clear()
                closing, search, sim = None, FailureLoad(), job.first_simulation()
                continue
            job.skipped.append("large displacements: what fails first has no gaps that may close")
        again = moved > job.settings.load_search.soft * _resolution(job)
        if not again or search.status == INTERRUPTED:
            if rigid and search.found:
                job.warnings += _changed(search.carried, rigid, searched, job.settings.doubts.lowered)
            if search.status != OK or rows:
                track.flush()
            return search, sim
        job.skipped[:] = [f"fixed geometry: with the given kn blocks move {moved:.2g} smallest edges before failure"]
        rigid, searched = (search.carried, True) if search.found else (_bound_of_the_start(search, bound), False)
        job.warnings.clear()
        search, sim = FailureLoad(), job.simulation("large")


def _raised(
    job: Job, sim: Simulation, track: Track, search: FailureLoad, rigid: float | None, max_load: float | None
) -> float:
    """Raise the load of a simulation from gravity until it fails, into `search`. Returns how far given joints let
    blocks move before failure, in smallest edges, where that says that geometry has to move, else 0.

    rigid: what the same blocks carry on stiff joints, or at most; max_load: as in `failure_search`.
    """
    moved = 0.0
    try:
        if (status := standing(sim, track, job.budget)) == OK:
            search.limits = RigidLimits(job, sim)
            moved = _expected_motion(job, sim, search.limits)
            if not moved:
                near, search.start = find_start(job, sim, search.limits)
                wanted = SearchRange(_resolution(job), max_load, job.request.analysis.step)
                load_search = LoadSearch(sim, wanted, job.budget, track, search, buckling(job))
                load_search.on_stiff_joints = rigid / sim.live_scale if rigid else inf
                load_search.run(near)
                _second_history(job, load_search)
                moved = search.peak_displacement / sim.smallest if _may_move(job, sim) else 0.0
        else:
            search.status = status
    except SolverError as error:
        job.warnings.append(str(error))
        search.end_undecided(job.settings.load_search.widest)
    except KeyboardInterrupt:
        search.status = INTERRUPTED
    return moved


def _fails_beside(search: FailureLoad, sim: Simulation, closing: np.ndarray) -> bool:
    """Test whether the structures that failed in fixed geometry are other ones than those whose gaps may close,
    (n_blocks,) bool. Until then these stood with open gaps, so that none closed."""
    before, failing = search.failed_from or search.held, search.failed_state
    if search.status != OK or not search.found or before is None or failing is None:
        return False
    motion = np.sqrt(((failing.bodies.positions - before.bodies.positions) ** 2).sum(axis=1))
    return bool(motion[closing].max() < sim.settings.mechanism.takes_part * motion.max())


def buckling(job: Job) -> Callable[[Simulation], bool]:
    """Return a test of whether a state at rest buckles, for searches."""
    return lambda sim: buckles(sim, job.budget) is not None


def _bound_of_the_start(search: FailureLoad, bound: Callable[[], float | None]) -> float | None:
    """Return the upper bound of the load of rigid blocks, by limit analysis of the geometry of the start."""
    if search.bound is not None:
        return search.bound
    return bound()


def _may_move(job: Job, sim: Simulation) -> bool:
    """Test whether large displacements may be needed because joints have a given stiffness."""
    return sim.properties.given and sim.kinematics == "fixed" and job.request.analysis.kinematics == "auto"


def _expected_motion(job: Job, sim: Simulation, limits: RigidLimits) -> float:
    """Estimate the elastic displacement, in smallest edges, at the upper bound of limit analysis. It is returned
    where it alone already says that geometry has to move; else 0.
    """
    if not _may_move(job, sim):
        return 0.0
    settings, load = job.settings.load_search, 1.0 if limits.bound is None else limits.bound / sim.live_scale
    moved = compliance(sim, job.budget)[1] * load / sim.smallest
    return moved if moved > settings.soft * _resolution(job) else 0.0


def _second_history(job: Job, load_search: LoadSearch) -> None:
    """Trace the path from gravity beside a load that limit analysis leaves open, where it is affordable.

    Where it ends elsewhere, or nowhere, rested or fell on the way, or a creep came to rest at a higher load, the load
    is raised again in small steps, up to so many blocks: which of the loads a search finds hangs on its steps there,
    and these are its own.
    """
    search, resolution = load_search.answer, _resolution(job)
    if not search.found or search.limits is None or at_the_bound(search, resolution) or search.limits.too_large:
        return
    implicit = search.start["kind"] == IMPLICIT
    if implicit and search.limits.largest > job.settings.warm_start.beside_implicit:
        return
    path = search.limits.path
    if path is None:
        return
    even = path.load is not None and path.finished and path.rest is None and path.fall <= resolution
    if even and load_range(search, resolution) is None:
        return
    if implicit and load_search.run_again_in_small_implicit_steps():
        return
    ends = path.load is not None and path.finished
    if search.limits.largest > job.settings.warm_start.repeated:
        job.skipped.append("the load again in small steps: too many blocks")
        search.alone = "" if ends else f"{UNFINISHED}, and a structure of so many blocks is not pushed again"
    elif search.carried > job.settings.load_search.least * search.scale and search.start["kind"] in (GRAVITY, IMPLICIT):
        load_search.run_again_in_small_steps(2.0 ** ceil(log2(search.carried)))
        if search.earlier is None:
            job.skipped.append("the load again in small steps: not finished; it is that of larger steps")
            search.alone = "" if ends else f"{UNFINISHED}, nor was the load raised again in small steps"


def _changed(load: float, rigid: float, searched: bool, lowered: float) -> list[str]:
    """Warn where joints of the given stiffness carry another load than stiff ones; searched: that was found."""
    if abs(load - rigid) <= lowered * rigid:
        return []
    if not searched:
        return [f"the given kn moves the geometry before failure: on stiff joints it carries at most {rigid:.5g}"]
    change = f"{'lowers' if load < rigid else 'raises'} the failure load by {percent(abs(load / rigid - 1))}"
    return [f"the given kn {change}: on stiff joints it is {rigid:.5g}"]


def _resolution(job: Job) -> float:
    """Requested width of the bracket, over the load."""
    assert job.request.analysis.resolution is not None
    return job.request.analysis.resolution
