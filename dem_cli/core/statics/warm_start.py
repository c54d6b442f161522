"""Warm start: a requested state next to failure; the explicit solver proves it and goes on from it.

A static solver knows where failure is: the zero-dilation path of limit.path, a state that the structure reaches from
gravity, or the forces of limit analysis, which nothing says that it reaches. Its forces become the springs of the
contact points; nothing is claimed before the explicit solver held it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.core.engine.placement import moves
from dem_cli.core.statics.rigid_limits import RigidLimits

if TYPE_CHECKING:
    from dem_cli.core.engine.job import Job
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.state import SavedState

GRAVITY, PATH, LIMIT = "gravity", "path", "limit"  # analysis.start
IMPLICIT = "implicit history"  # under load, from gravity
CURVE = "curve"  # of displacement control


class WarmStart(NamedTuple):
    """State in equilibrium from which a search starts."""

    kind: str  # PATH, LIMIT or IMPLICIT
    load: float  # its multiplier, as users know it
    normal: np.ndarray  # [N], (n_points,)
    shear: np.ndarray  # [N], (n_points, d − 1)
    gaps: np.ndarray  # [m], (n_points,)
    displacements: np.ndarray  # since before gravity, (n_blocks, n_dof)
    work: float  # of the live loads on the way [J]
    plateau: bool = False  # the load grows no more with displacement

    def put_into(self, sim: Simulation) -> None:
        """Put the simulation into this state; work on the way that is not stored counts as friction.

        Where the forces come without a way (limit analysis), what they store was put in from outside.
        """
        sim.set_load(self.load / sim.live_scale)
        share = sim.dead_share  # a tilted table has less of all loads
        gaps = np.where(self.normal > 0.0, -share * self.normal / sim.joints.kn, self.gaps)
        moves.place_at_rest(sim, share * self.normal, share * self.shear, gaps, self.displacements)
        for link, drawn in zip(sim.links, sim.model.links, strict=True):
            link.state[:] = drawn.state
            link.follow(self.displacements, None)
        given = float((sim.loads.dead * self.displacements).sum()) + self.work
        sim.open_books(max(given - sim.elastic_energy(), 0.0))


class CurveStart(NamedTuple):
    """Highest point of a capacity curve, as the explicit solver left it."""

    load: float  # its multiplier, as users know it
    state: SavedState
    kind: str = CURVE
    plateau: bool = False

    def put_into(self, sim: Simulation) -> None:
        """Put the simulation into the state at the highest point of the curve."""
        sim.restore(self.state)


def find_start(job: Job, sim: Simulation, limits: RigidLimits) -> tuple[WarmStart | None, dict[str, Any]]:
    """Find the requested start (None: gravity), and its entries in summary.json."""
    wanted = job.request.analysis.start
    kind = GRAVITY if wanted == "auto" else wanted
    report: dict[str, Any] = {"kind": kind, "chosen": "automatically" if wanted == "auto" else "by the case"}
    if kind != GRAVITY and limits.why_not is not None:
        report |= {"kind": GRAVITY, "note": limits.why_not}
    if kind != GRAVITY and sim.integrates:
        report |= {"kind": GRAVITY, "note": "a state found elsewhere is of rigid joints, these have a stiffness"}
    if kind != GRAVITY and sim.links and (kind == LIMIT or limits.path is None):
        report |= {"kind": GRAVITY, "note": "a state found elsewhere knows no forces of these ties and bars"}
    if kind != GRAVITY and job.request.analysis.step is not None:
        report |= {"kind": GRAVITY, "note": "every step of the load is asked for"}
    if report["kind"] == GRAVITY:
        return None, report
    start = start_by_path(limits, report) if kind == PATH else _by_limit_analysis(job, limits, report)
    if start is None:
        report["kind"] = GRAVITY
    report.setdefault("note", limits.why_not)
    return start, {key: value for key, value in report.items() if value is not None}


def start_by_path(limits: RigidLimits, report: dict[str, Any]) -> WarmStart | None:
    """Return the state at the highest load of the path, None where that says little; notes go to `report`."""
    from dem_cli.core.limit.path import OK

    warm_start, path = limits.job.settings.warm_start, limits.path
    if path is None:
        return None
    report |= path.summary() | {"seconds": limits.seconds["path"]}
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
    normal, shear, gaps, displacements = path.state
    normal, shear, gaps = limits.on_points(normal), limits.on_points(shear), limits.on_points(gaps, limits.gaps)
    return WarmStart(PATH, path.load, normal, shear, gaps, displacements, work, path.flat(warm_start.at_the_end))


def starts_by_history(limits: RigidLimits, report: dict[str, Any], small: bool = False) -> list[WarmStart]:
    """Return the equilibria of an implicit history from gravity, upwards; none where it did not come to failure.

    small: in small steps of the load. What is said of it goes to `report`.
    """
    found = limits.history_in_small_steps if small else limits.history
    if found is None:
        return []
    report |= {"kind": IMPLICIT, **found.summary(), "seconds": limits.seconds["history"]}
    starts = []
    for held in found.held:
        normal, shear = limits.on_points(held.normal), limits.on_points(held.shear)
        gaps, displacements = limits.on_points(held.gaps, limits.gaps), limits.on_blocks(held.displacements)
        starts.append(WarmStart(IMPLICIT, held.load, normal, shear, gaps, displacements, held.work, plateau=True))
    return starts


def _by_limit_analysis(job: Job, limits: RigidLimits, report: dict[str, Any]) -> WarmStart | None:
    """Forces in equilibrium without friction in head joints, whose wedging no real joint can be trusted with."""
    from dem_cli.core.limit.associated import OK

    safe = limits.without_head_friction
    most = limits.associated
    if safe is None or most is None:
        return None
    report |= {"load": safe.multiplier, "status": safe.status, "residual": safe.residual, "associated": most.multiplier}
    report["seconds"] = limits.seconds["safe"]
    if safe.status != OK or safe.multiplier is None or most.status != OK:
        report["note"] = f"limit analysis: {safe.status}; the load is raised from gravity"
        return None
    still = np.zeros(job.model.dead_loads.shape)
    normal, shear = limits.on_points(safe.normal), limits.on_points(safe.shear)
    return WarmStart(LIMIT, safe.multiplier, normal, shear, limits.gaps, still, 0.0)


def _work(loads: list[float], displacements: list[float]) -> float:
    """Compute the work of a load that grew from one value to the next in proportion to its displacement [J]."""
    means = 0.5 * (np.array(loads[1:]) + loads[:-1])
    return float((means * np.diff(displacements)).sum())
