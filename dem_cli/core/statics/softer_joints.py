"""Check of joint stiffness in a pushover with large displacements: whether ten times softer joints carry the load
as well.

Joints of "auto" stiffness are the program's choice: a structure where all are is checked, one with a given kn is not.
Closure is taken back where the structure rests (engine/rigid_joints.py), so that what is held hangs on it through the
way there alone. What is lost by compliance is lost tenfold on joints ten times as soft: a load that holds there, less
ten times the resolution, is known as closely as the resolution says.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.core.engine.budget import Budget
from dem_cli.core.statics.compliance import compliance
from dem_cli.core.statics.equilibrium import settle_or_fail, stand, unexpected
from dem_cli.core.statics.warm_start import CURVE, GRAVITY
from dem_cli.errors import SolverError

if TYPE_CHECKING:
    from dem_cli.core.engine.job import Job
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.statics.failure_bracket import FailureLoad


def checked(job: Job, sim: Simulation, search: FailureLoad, resolution: float) -> dict[str, Any]:
    """Keys of the summary about a failure load on "auto" joints; what is doubtful goes to the warnings of the job."""
    settings = job.settings.load_search
    kind = search.start.get("kind")
    if not (search.found and kind in (GRAVITY, CURVE) and _checkable(sim)):
        return {}
    softer = f"on joints {settings.softer:g} times as soft"
    wanted = (1.0 - settings.softer * resolution) * search.carried
    carried = {one.load for one in search.passes if one.state == "equilibrium" and 0.0 < one.load < wanted}
    steps = {share * wanted for share in settings.shares} if kind == CURVE else set()  # no loads led to its peak
    loads = sorted(carried | steps | {wanted})
    job.clock.progress(softer, 0.0, 0.0, None)
    budget = Budget(int(settings.softer_steps * max(sim.steps, settings.trial)))
    try:
        held = _held(job.softer(sim, settings.softer), loads, budget)
    except SolverError:
        job.skipped.append(f"the same loads {softer}: too long")
        return {"softer_joints_hold": None}
    if held < wanted:
        above = min(load for load in loads if load > held)
        job.warnings.append(
            f"{softer} the structure fails between {held:.5g} and {above:.5g}: the failure load {search.carried:.5g} "
            "may hang on the stiffness of the joints, which only a given kn says"
        )
    return {"softer_joints_hold": bool(held >= wanted)}


def _checkable(sim: Simulation) -> bool:
    """Test whether geometry moves over joints whose stiffness is the program's choice."""
    return sim.kinematics == "large" and not sim.properties.given


def _held(sim: Simulation, loads: list[float], budget: Budget) -> float:
    """Return the last of these loads, as users know them, up to which all are carried one after the other; 0: none
    is."""
    if stand(sim, budget).state != "equilibrium":
        return 0.0
    elastic = compliance(sim, budget)[1]
    carried = 0.0
    for load in loads:
        inner = load / sim.live_scale
        if settle_or_fail(sim, inner, budget, elastic * inner, ahead=unexpected(sim)).state != "equilibrium":
            break
        carried = load
    return carried
