"""Warm start: a state next to failure from a static solver, which the explicit solver proves and goes on from.

Raising the load from gravity step by step costs the explicit solver most of its time, and large walls need
more motion than it can wait for. A static solver knows where failure is: the zero-dilation path of limit.path, a
state that the structure reaches from gravity, or, for structures too large for that, the forces of limit analysis.
Its forces become the springs of the contact points; nothing is claimed before the explicit solver held it.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.errors import UsageError

if TYPE_CHECKING:
    from dem_cli.engine.job import Job
    from dem_cli.engine.simulation import Simulation
    from dem_cli.limit.analysis import LimitLoads
    from dem_cli.limit.matrices import Structure

GRAVITY, PATH, LIMIT = "gravity", "path", "limit"  # analysis.start


class WarmStart(NamedTuple):
    """A state in equilibrium."""

    kind: str  # PATH or LIMIT
    load: float  # its multiplier, as users know it
    normal: np.ndarray  # [N], (n_points,)
    shear: np.ndarray  # [N], (n_points, d − 1)
    gaps: np.ndarray  # [m], (n_points,)
    displacements: np.ndarray  # since before gravity, (n_blocks, n_dof)
    work: float  # of the live loads on the way [J]
    plateau: bool = False  # the load grows no more with displacement
    limits: LimitLoads | None = None  # limit analysis, where it was done: nothing is in equilibrium above its bound


def find_start(job: Job, sim: Simulation) -> tuple[WarmStart | None, dict[str, Any]]:
    """The start that the case asks for or that its size needs (None: gravity), and what summary.json says of it."""
    warm_start = sim.settings.warm_start
    wanted = job.case.analysis.start
    blocks = len(sim.free)
    automatic = GRAVITY if blocks <= warm_start.small else PATH if blocks <= warm_start.large else LIMIT
    kind = automatic if wanted == "auto" else wanted
    if sim.kinematics != "fixed" or sim.properties.profiled:
        kind = GRAVITY  # gaps that may close, or soft joints: the geometry of the start is not that of failure
    if not (sim.loads.dead[sim.free].any() and sim.loads.live[sim.free].any()):
        kind = GRAVITY  # nothing to start from
    if getattr(job.case.analysis, "step", None) is not None:
        kind = GRAVITY  # every step is asked for
    report: dict[str, Any] = {"kind": kind, "chosen": "by size" if wanted == "auto" else "by the case"}
    if kind == GRAVITY:
        return None, report
    job.clock.imported("dem_cli.limit.analysis")
    begun = time.perf_counter()
    start = _found(job, sim, kind, report)
    report["seconds"] = time.perf_counter() - begun
    if start is None:
        report["kind"] = GRAVITY
    return start, report


def place(sim: Simulation, start: WarmStart) -> None:
    """Puts the simulation into the state of `start`; what the work on the way did not store counts as friction.

    Where the forces come without a way (limit analysis), what they store was put in from outside.
    """
    sim.set_load(start.load / sim.live_scale)
    share = sim.dead_share  # a tilted table has less of all loads
    gaps = np.where(start.normal > 0.0, -share * start.normal / sim.joints.kn, start.gaps)
    sim.place(share * start.normal, share * start.shear, gaps, start.displacements)
    given = float((sim.loads.dead * start.displacements).sum()) + start.work
    sim.open_books(max(given - sim.elastic_energy(), 0.0))


def _found(job: Job, sim: Simulation, kind: str, report: dict[str, Any]) -> WarmStart | None:
    from dem_cli.limit.cone import friction_of
    from dem_cli.limit.matrices import structure_of

    try:
        structure = structure_of(sim.model, sim.joints)
        if kind == PATH:
            return _by_path(job, structure, friction_of(sim.joints, sim.law), report)
        return _by_limit_analysis(structure, job, sim, report)
    except UsageError as error:
        report["note"] = str(error)
        return None


def _by_path(job: Job, structure: Structure, friction: np.ndarray, report: dict[str, Any]) -> WarmStart | None:
    from dem_cli.limit.path import OK, trace

    warm_start = job.settings.warm_start
    path = trace(
        structure, friction, warm_start.flat * job.case.analysis.resolution,
        progress=lambda load, _: job.clock.progress("following the path to failure", load, 0.0, None),
        settings=job.settings.limit,
    )  # fmt: skip
    report |= path.summary()
    if path.load is None or path.load <= 0.0 or path.state is None:
        report["note"] = "no path; the load is raised from gravity"
        return None
    if path.status != OK:
        report["note"] = "the path ended before the load stopped growing; the load is raised from there"
    if path.loads[-1] < warm_start.drop * path.load:
        report["note"] = "the load drops along the path, maybe into another mechanism; it is raised from gravity"
        return None
    upto = path.highest + 1
    work = _work(path.loads[:upto], path.live_displacements[:upto])
    at_the_end = path.status == OK and path.highest >= len(path.loads) - warm_start.at_the_end
    return WarmStart(PATH, path.load, *path.state, work, at_the_end)


def _by_limit_analysis(structure: Structure, job: Job, sim: Simulation, report: dict[str, Any]) -> WarmStart | None:
    """Forces in equilibrium without friction in head joints, whose wedging no real joint can be trusted with."""
    from dem_cli.limit.analysis import LimitLoads
    from dem_cli.limit.associated import OK, limit_load
    from dem_cli.limit.cone import friction_of

    associated = job.settings.limit.associated
    job.clock.progress("limit analysis", 0.0, 0.0, None)
    safe = limit_load(structure, friction_of(sim.joints, sim.law, heads_frictionless=True), associated)
    begun, friction = time.perf_counter(), friction_of(sim.joints, sim.law)
    most = limit_load(structure, friction, associated)
    limits = LimitLoads(structure, friction, most, None, time.perf_counter() - begun, None)
    report |= {"load": safe.multiplier, "status": safe.status, "residual": safe.residual, "associated": most.multiplier}
    if safe.status != OK or safe.multiplier is None or most.status != OK:
        report["note"] = f"limit analysis: {safe.status}; the load is raised from gravity"
        return None
    still = np.zeros((structure.model.n_blocks, structure.n_dof))
    return WarmStart(
        LIMIT, safe.multiplier, safe.normal, safe.shear, np.zeros(len(safe.normal)), still, 0.0, False, limits
    )  # fmt: skip


def _work(loads: list[float], displacements: list[float]) -> float:
    """Of a load that grew from one value to the next in proportion to its displacement [J]."""
    means = 0.5 * (np.array(loads[1:]) + loads[:-1])
    return float((means * np.diff(displacements)).sum())
