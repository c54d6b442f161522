"""Modal analysis, kind = "modes": natural frequencies and shapes under gravity, and calibration of joint stiffness.

Gravity comes first, with geometry that moves, because it says which contact points are closed and where the blocks
are; a time history starts from the same state. Then all is linear: closed points are springs, open ones nothing.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.analyses.ensembles.case_job import CaseJob
from dem_cli.core.arithmetic.functions import agreed
from dem_cli.core.arithmetic.products import norm
from dem_cli.core.dynamics.frequencies import Modes, highest_frequency, modes, system
from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.job import Outcome
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import mean_weight
from dem_cli.core.records.frames import Frame
from dem_cli.core.records.ports import Observer
from dem_cli.core.records.statuses import FALLS
from dem_cli.core.statics.equilibrium import settle, stand
from dem_cli.errors import CaseError, CaseProblem, SolverError

if TYPE_CHECKING:
    from dem_cli.case.schema import Case

AXES = "xyz"


def run(case: Case, model: Model, observer: Observer, settings: Settings = DEFAULT) -> Outcome:
    """Run a modal analysis. Raises CaseError where the structure lacks the requested mode."""
    job = CaseJob.of_case(case, model, observer, settings)
    sim = _simulation(job)
    track = job.track(sim)
    found: dict[str, Any] = {}
    try:
        stands = settle(sim, track, job.budget).state == "equilibrium"
        found = {"status": "ok", **_answer(job, sim)} if stands else {"status": FALLS}
    except SolverError as error:
        found["status"] = "not converged"
        job.warnings.append(str(error))
    track.flush()
    return job.outcome([sim], found)


def _simulation(job: CaseJob) -> Simulation:
    """Create the simulation of a modal analysis, on joints with their stiffness as springs.

    With a measured frequency that stiffness is a property of the structure, which has the contact points of such
    joints (core/laws/stiffness.py).
    """
    sim = job.moving_simulation(elastic=True)
    if job.case.analysis.measured is None or not sim.properties.rigid.any():
        return sim
    return job.with_case(_scaled_case(job.case, sim, 1.0)).moving_simulation(elastic=True)


def _answer(job: CaseJob, sim: Simulation) -> dict[str, Any]:
    """Compute modes and calibration as keys of the summary; mode shapes go to the observer as frames."""
    wanted, model = job.case.analysis, sim.model
    job.clock.progress("modes", 0.0, 0.0, None)
    springs = {name: _springs(sim, name) for name in ("pressed", "touching")}
    count = max(wanted.count, wanted.mode if wanted.measured is not None else 1)
    found = _modes(sim, springs[wanted.contacts], count)
    if wanted.measured is not None and len(found.frequencies) < wanted.mode:
        text = f"{wanted.mode} is too high: the structure has {len(found.frequencies)} natural frequencies above 0"
        raise CaseError([CaseProblem(("analysis", "mode"), text)])
    for number in range(min(len(found.frequencies), wanted.count) if job.case.output.snapshots else 0):
        job.clock.frame(_frame(sim, found.shapes[number], number + 1))
    answer = {
        "frequencies": found.frequencies[: wanted.count],
        "effective_masses": {
            AXES[axis]: found.effective_masses[: wanted.count, axis] for axis in range(model.dimension)
        },
        "total_mass": float(model.masses[~model.fixed].sum()),
        "highest_frequency": agreed(highest_frequency(sim)) / (2.0 * math.pi),
        "springs": {name: int(points.sum()) for name, points in springs.items()},
        "first_frequency": {name: _first(_modes(sim, points, 1)) for name, points in springs.items()},
        "mechanisms": found.mechanisms,
        "loose_blocks": [model.block_ids[i] for i in found.loose],
    }
    _doubts(job, found, sim)
    if wanted.measured is not None:
        answer["calibration"] = _calibration(job, sim, float(found.frequencies[wanted.mode - 1]))
    return answer


def _first(found: Modes) -> float | None:
    return float(found.frequencies[0]) if len(found.frequencies) else None


def _springs(sim: Simulation, contacts: str) -> np.ndarray:
    """Select the active contact points of the modal stiffness, (n_points,) bool."""
    points = closed_points(sim) if contacts == "pressed" else touching_points(sim)
    corners = sim.tracking.narrow.end_to_end(sim.model, sim.geometry)
    return points & ~corners[sim.joints.owners]


def _modes(sim: Simulation, closed: np.ndarray, count: int) -> Modes:
    found = system(sim, closed, geometric=sim.kinematics == "large")
    return modes(found, count, sim.model.dimension, sim.model.n_blocks).agreed()


def closed_points(sim: Simulation) -> np.ndarray:
    """Select the contact points that resist any small motion: pressed together, or bonded, (n_points,) bool."""
    free, d = sim.free, sim.model.dimension
    weight = mean_weight(sim.loads.dead[free], sim.loads.live[free], d) if len(free) else 1.0
    closed = sim.contacts.normal > sim.settings.modes.pressed * weight
    if sim.law.bonded:
        closed |= _bonds(sim, np.flatnonzero(~closed & (sim.joints.kn > 0.0)), weight)
    return closed


def touching_points(sim: Simulation) -> np.ndarray:
    """Select closed contact points and those without a gap, such as unloaded head joints, (n_points,) bool."""
    near = sim.measured().gaps <= sim.settings.modes.closes * sim.smallest
    return closed_points(sim) | (near & (sim.joints.kn > 0.0))


def _bonds(sim: Simulation, points: np.ndarray, weight: float) -> np.ndarray:
    """Test which open points are bonded, by their tension under a small separation, (n_points,) bool."""
    joints, contacts, memory = sim.joints, sim.measured(), sim.contacts.memory.copy()
    owner = joints.owners
    still = (0.0,) * (sim.model.dimension - 1)
    holds = np.zeros(len(joints.kn), bool)
    for i in points:
        gap = contacts.gaps[i] + sim.settings.modes.pull * weight / joints.kn[i]
        normal = sim.law.function(
            gap, still, tuple(contacts.shear[i]), joints.kn[i], joints.ks[i], joints.law, owner[i], memory, i
        )[0]
        holds[i] = normal != 0.0
    return holds


def _frame(sim: Simulation, shape: np.ndarray, number: int) -> Frame:
    """Create the frame of a visibly scaled mode shape; `step` is the number of the mode."""
    settings = sim.settings.modes
    model, d, rotations = sim.model, sim.model.dimension, sim.model.rotations
    free = ~model.fixed
    turns = np.linalg.norm(shape[:, rotations], axis=1)
    reach = np.sqrt((shape[:, :d] ** 2).sum(axis=1)) + turns * sim.shape.radii
    reach = reach + np.abs(shape[:, rotations.stop :]).sum(axis=1)
    size = float(norm(np.ptp(model.centroids[free], axis=0) + 2.0 * sim.shape.radii[free].mean()))
    turn = float(turns.max())
    amplitude = min(settings.visible * size / reach.max(), settings.largest_turn / turn if turn > 0.0 else math.inf)
    rest = measures.frame(sim, "mode")
    return rest.moved(amplitude * shape[:, : rotations.stop])._replace(
        step=number,
        displacement=float(amplitude * np.sqrt((shape[:, :d] ** 2).sum(axis=1)).max()),
        velocities=np.zeros_like(rest.velocities),
    )


def _doubts(job: CaseJob, found: Modes, sim: Simulation) -> None:
    tables, rigid = job.case.joints, dict(zip(sim.properties.names, sim.properties.rigid, strict=True))
    names = [name for name, table in tables.items() if rigid[name] or (table.ks == "auto" and table.kn != "auto")]
    if names:
        key = "kn and ks" if tables[names[0]].kn == "auto" else "ks"
        job.warnings.append(
            f"{key} of joint '{names[0]}' is chosen by the program (auto): the frequencies follow from that choice, "
            "not from the structure; give kn and ks, or a measured frequency (analysis.measured)"
        )
    if found.mechanisms:
        ids = [job.model.block_ids[i] for i in found.loose[:5]]
        more = f" and {len(found.loose) - 5} more" if len(found.loose) > 5 else ""
        job.warnings.append(
            f"{found.mechanisms} motions strain no joint and have no frequency; blocks in them: {', '.join(ids)}{more}"
        )


def _calibration(job: CaseJob, sim: Simulation, computed: float) -> dict[str, Any]:
    """Calibrate the joint stiffness to the measured frequency: all kn and ks times (measured/computed)².

    That is exact where gravity closes the same points and its forces do not count. So gravity and modes are run again
    with the new stiffness, and the factor is corrected until the frequency is met.
    """
    settings = sim.settings.modes
    wanted = job.case.analysis
    tried: list[float] = []
    factor, found, sinks = 1.0, computed, measures.largest_overlap(sim) / sim.smallest
    while len(tried) < settings.rounds and abs(found / wanted.measured - 1.0) > settings.agrees:
        factor *= (wanted.measured / found) ** 2
        frequency = _frequency_with(job, sim, factor) if sinks / factor < settings.sinks else None
        if frequency is None:
            job.warnings.append(
                f"joints as soft as {wanted.measured:g} Hz asks for ({factor:.3g} times kn and ks) do not carry the "
                "structure: the measured frequency does not belong to this mode, or not to this structure"
            )
            break
        found = frequency
        tried.append(found)
    moduli = _scaled_moduli(job.case, factor)
    met = abs(found / wanted.measured - 1.0) <= settings.agrees
    if not met and len(tried) == settings.rounds:
        job.warnings.append(f"the calibrated frequency is {found:.4g} Hz instead of {wanted.measured:g} Hz")
    return {
        "mode": wanted.mode,
        "measured": wanted.measured,
        "computed": computed,
        "factor": factor,
        "joints": _with_points(job.case, sim, _scaled(sim, factor)),
        **({"young": moduli} if moduli else {}),
        "frequencies_tried": tried,
        "met": met,
    }


def _scaled(sim: Simulation, factor: float) -> dict[str, dict[str, float]]:
    """Return kn and ks [Pa/m] of each named joint that has them, times a factor; others are as stiff as their
    blocks.
    """
    properties = sim.properties
    free = np.zeros(len(properties.names), bool)
    if properties.compliance is not None:
        free = properties.compliance.free[:, 0] & ~properties.rigid
    return {
        name: {"kn": float(factor * kn), "ks": float(factor * ks)}
        for name, kn, ks, no in zip(properties.names, properties.kn, properties.ks, free, strict=True)
        if not no
    }


def _with_points(case: Case, sim: Simulation, found: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    """Add the number of contact points to calibrated kn and ks where the case does not give it.

    Time histories have other contact points by default (core/laws/stiffness.py).
    """
    layouts = zip(sim.properties.names, sim.properties.layouts, strict=True)
    points = {
        name: layout.points
        for name, layout in layouts
        if name in found and layout and layout.sides is None and case.joints[name].points is None
    }
    return {name: more | ({"points": points[name]} if name in points else {}) for name, more in found.items()}


def _scaled_moduli(case: Case, factor: float) -> dict[str, float]:
    """Return Young's modulus [Pa] of each deformable material, times a factor."""
    return {
        name: factor * material.young
        for name, material in case.materials.items()
        if material.young is not None and (material.strains or math.isfinite(material.moduli[0]))
    }


def _scaled_case(case: Case, sim: Simulation, factor: float) -> Case:
    """Scale the stiffness of all joints and blocks of a case by a factor."""
    joints = {name: case.joints[name].model_copy(update=more) for name, more in _scaled(sim, factor).items()}
    moduli = {n: case.materials[n].model_copy(update={"young": e}) for n, e in _scaled_moduli(case, factor).items()}
    return case.model_copy(update={"joints": case.joints | joints, "materials": case.materials | moduli})


def _frequency_with(job: CaseJob, sim: Simulation, factor: float) -> float | None:
    """Return the frequency of the measured mode [Hz] with scaled stiffness; None where the structure does not stand."""
    wanted = job.case.analysis
    again = _simulation(job.with_case(_scaled_case(job.case, sim, factor)))
    try:
        if stand(again, Budget(min(sim.settings.modes.most_steps, wanted.max_steps))).state != "equilibrium":
            return None
    except SolverError:
        return None
    frequencies = _modes(again, _springs(again, wanted.contacts), wanted.mode).frequencies
    return float(frequencies[wanted.mode - 1]) if len(frequencies) >= wanted.mode else None
