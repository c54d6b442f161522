"""A million steps at rest, time steps up to and past the limit, and the books of the energy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from dem_cli.core.engine.fictitious_masses import fictitious_masses
from dem_cli.core.engine.kinematics import live_scale
from dem_cli.core.engine.loops import compiled_advance
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels import records as slot
from dem_cli.core.statics.equilibrium import relax
from dem_cli.errors import SolverError
from dem_cli.masonry.assembly.solver_request import solver_request
from studies.polygons import rectangle
from studies.stress.structures import StressScene, block, drawn, ground, named
from studies.stress.verdicts import HELD, REFUSED, WRONG, StressRecord, figure, load_record

AXIS_REST, AXIS_RELAX = "a million steps at rest", "time step of a relaxation"


def simulation(scene: StressScene, kinematics: str, settings: Settings = DEFAULT) -> Simulation:
    """As an analysis makes it."""
    case, model, _ = scene.build()
    properties = joint_properties(solver_request(case), model)
    return Simulation(model, law_of(solver_request(case)), properties, kinematics, live_scale(model), settings=settings)


def crate() -> StressScene:
    return drawn("crate at 95 % of its sliding limit", [ground(3.0), block("b", rectangle(0, 0, 1, 1))], 0.6, 0.6)


def drums() -> StressScene:
    blocks = [block(f"d{i}", rectangle(0, 0.5 * i, 1, 0.5 * i + 0.5)) for i in range(20)]
    return drawn("20 drums", [ground(3.0), *blocks], 0.1, 0.6)


def lintel() -> StressScene:
    pads = [block("left", rectangle(0, 0, 0.05, 0.05)), block("right", rectangle(1.95, 0, 2, 0.05))]
    return drawn("heavy lintel on pads", [ground(3.0), *pads, block("lintel", rectangle(0, 0.05, 2, 2.5))], 0.0, 0.6)


def rest(short: bool) -> Iterator[StressRecord]:
    """Drift in block sizes, and kinetic over elastic energy, under dead loads or at 95 % of the sliding limit."""
    steps = 100_000 if short else 1_000_000
    wall = named()["wall 0.6"]
    scenes = ((crate(), 0.57, 1.0), (drums(), 0.0, 0.5), (lintel(), 0.0, 0.05), (wall, 0.57, 0.0175))
    for scene, load, size in scenes[:2] if short else scenes:
        for kinematics in ("fixed", "large"):
            sim = simulation(scene, kinematics)
            settled = settle(sim, load)
            before, friction = sim.places(), sim.ledger[slot.FRICTION]
            sim.advance(steps, slot.HOLD_LOAD)
            structure = f"{scene.name}, {kinematics}"
            drift = float(np.abs(sim.places() - before).max()) / size
            ratio = sim.kinetic_energy() / sim.elastic_energy()
            slipped = float(sim.ledger[slot.FRICTION] - friction) / sim.elastic_energy()
            yield figure(AXIS_REST, structure, "drift in block sizes", drift if settled else np.nan, 1e-9)
            yield figure(AXIS_REST, structure, "kinetic over elastic energy", ratio, 1e-12)
            yield figure(AXIS_REST, structure, "friction work over elastic energy", slipped, 1e-12)


def settle(sim: Simulation, load: float) -> bool:
    """Equilibrium at a constant load, raised in one step from gravity, with the damping of the solver."""
    sim.use_combined_damping()
    for multiplier in (0.0, load):
        sim.set_load(multiplier)
        for _ in range(200):
            sim.advance(1000, slot.HOLD_LOAD)
            if sim.unbalanced < 1e-9:
                break
    return sim.unbalanced < 1e-6


# -- time step ---------------------------------------------------------------------------------------


def stretched(factor: float) -> Settings:
    """Time steps `factor` times as long as those of the solver."""
    return replace(DEFAULT, relaxation=DEFAULT.relaxation.stretched(factor))


def time_step(short: bool) -> Iterator[StressRecord]:
    """Pushovers with every time step 0.6 to 2 times the one of the solver (safety of 0.6, 0.75 and 0.85)."""
    scenes = named()
    for name in ("column",) if short else ("slide", "column", "wall 0.6", "wall 0.75", "trilith"):
        scene = scenes[name].having("analysis.kinematics", "fixed").having("analysis.max_steps", 200_000)
        for factor in (0.8, 2.0) if short else (0.6, 0.8, 0.9, 1.1, 1.2, 1.3, 1.4, 1.6, 2.0):
            yield load_record("time step", scene, f"{factor:g}", variant="fixed", settings=stretched(factor))
    for name in () if short else ("slide", "wall 0.6", "trilith"):  # where they fly apart every step is a detection
        scene = scenes[name].having("analysis.kinematics", "large").having("analysis.max_steps", 50_000)
        for factor in (0.8, 1.1, 1.2, 1.3, 1.4, 1.6):
            yield load_record("time step", scene, f"{factor:g}", variant="large", settings=stretched(factor))


def past_the_limit(short: bool) -> Iterator[StressRecord]:
    """Relaxation with safety 0.5 to 1.6 (the solver's: 0.6): what is called an equilibrium is one, measured again."""
    for scene, load in ((crate(), 0.5), (drums(), 0.05)):
        for kinematics in ("fixed", "large"):
            for factor in (1.0, 2.0) if short else (0.83, 1.0, 1.2, 1.4, 1.6, 2.0, 2.67):
                structure, value = f"{scene.name}, {kinematics}", f"{factor:g}"
                sim = simulation(scene, kinematics, stretched(factor))
                try:
                    state = relax(sim, load, 1e-5).state
                except SolverError as error:
                    yield StressRecord(AXIS_RELAX, structure, value, REFUSED, "–", message=str(error))
                    continue
                if state != "equilibrium":
                    yield StressRecord(AXIS_RELAX, structure, value, REFUSED, "–", message="no equilibrium claimed")
                    continue
                wrong = residual(sim)
                verdict = HELD if wrong < 1e-4 else WRONG
                yield StressRecord(AXIS_RELAX, structure, value, verdict, f"{wrong:.1e}", wrong, f"{wrong:.1e}")


def residual(sim: Simulation) -> float:
    """Largest unbalanced force of a state held without motion, in weights of each block."""
    sim.rest()
    sim.advance(1, slot.HOLD_LOAD)
    return sim.unbalanced


# -- energy ------------------------------------------------------------------------------------------


def work_identity(short: bool) -> Iterator[StressRecord]:
    """external + contact − damping = change of kinetic energy, over the largest of them, in every mode."""
    modes = {"constant load": slot.HOLD_LOAD, "creep": slot.CREEP, "relaxation": slot.FIRE}
    scenes = named()
    for name in ("wall 0.6",) if short else ("wall 0.6", "arch", "column"):
        for kinematics in ("fixed", "large"):
            for what, mode in modes.items():
                sim = simulation(scenes[name], kinematics)
                sim.use(0.6, 0.3, 0.3)
                sim.set_load(scenes[name].exact[1] * 1.05)
                sim.prescribe_rate(1e-6)
                sim.ledger[:] = 0.0
                error = worst_identity(sim, mode, 20 if short else 200)
                structure = f"{scenes[name].name}, {kinematics}"
                yield figure("work identity", structure, what, error, 1e-10)


def worst_identity(sim: Simulation, mode: int, looks: int) -> float:
    """Largest error over the largest sum so far; the run leaves the structure failing."""
    error, largest, before = 0.0, 0.0, sim.kinetic_energy()
    for _ in range(looks):
        sim.advance(50, mode)
        sums = sim.ledger
        change = sums[slot.EXTERNAL] + sums[slot.CONTACT] - sums[slot.DAMPING]
        largest = max(largest, sim.kinetic_energy(), *np.abs(sums))
        error = max(error, abs(sim.kinetic_energy() - before - change))
    return error / largest


def state_closure(short: bool) -> Iterator[StressRecord]:
    """Energy of the state in a free motion with real masses: the error falls with the square of the step."""
    for slide, what in ((0.2, "sticking"), (8.0, "sliding and lifting")):
        for kinematics in ("fixed", "large"):
            fractions = (0.2, 0.1) if short else (0.2, 0.1, 0.05, 0.025)
            errors = [closure(kinematics, fraction, slide) for fraction in fractions]
            # Impacts of lifting blocks come at other instants for every step: order on the average only.
            order = float(np.log2(errors[0] / errors[-1]) / (len(errors) - 1))
            needed = 1.8 if slide < 1.0 else 1.4
            said = ", ".join(f"{e:.1e}" for e in errors)
            yield StressRecord(
                "energy of the state", f"three blocks, {what}, {kinematics}",
                f"dt ω/2 = {fractions[0]:g} … {fractions[-1]:g}", HELD if order > needed else WRONG,
                f"order {order:.2f}", errors[-1], f"order {order:.2f}", f"errors {said}",
            )  # fmt: skip


def closure(kinematics: str, fraction: float, slide: float) -> float:
    """Largest change of kinetic + elastic + gravity energy + friction in a free motion, over the energy thrown in.

    fraction  time step over the largest stable one
    slide     speed of the throw in elastic penetrations × frequency
    """
    scene = drawn("", [ground(2.0), *(block(f"b{i}", rectangle(0, i, 1, i + 1)) for i in range(3))], 0.6, 0.6)
    sim = simulation(scene.joint(kn=1e9), kinematics)
    sim.advance(8000, slot.HOLD_LOAD)
    sim.rest()
    model = sim.model
    masses = np.column_stack([model.masses, model.masses, model.inertias[:, 0]])
    needed = np.zeros_like(masses)
    fictitious_masses(model, sim.joints, sim.bodies, sim.shape, 1.0, needed)
    free = ~model.fixed
    sim.loads.inverse_masses[:] = np.where(free[:, None], 1.0 / masses, 0.0)
    highest = 2.0 * np.sqrt((1.0 / masses[free] / needed[free]).max())
    sim.control[slot.DAMP] = sim.control[slot.DAMP_CHANGE] = 0.0
    sim.ledger[:] = 0.0
    dt = fraction * 2.0 / highest
    frequency = np.sqrt(1e9 / model.masses[free].mean())
    sunk = model.masses[free].mean() * 9.81 / 1e9
    sim.bodies.velocities[free, 0] = slide * sunk * frequency * np.array([1.0, -0.5, 0.7])
    weights, energies, total = model.masses * 9.81, [], sim.kinetic_energy()
    for _ in range(round(60 / fraction)):
        heights, before = sim.bodies.positions[:, 1].copy(), sim.kinetic_energy()
        compiled_advance(kinematics, sim.law)(
            1, slot.HOLD_LOAD, dt, sim.bodies, sim.shape, sim.joints, sim.geometry, sim.contacts, sim.links, sim.loads,
            sim.control, sim.ledger, sim.like, sim.like_rotation,
        )  # fmt: skip
        kinetic = 0.5 * (before + sim.kinetic_energy())
        potential = (weights * (heights - model.centroids[:, 1]))[free].sum()
        energies.append(kinetic + sim.elastic_energy() + potential + sim.ledger[slot.FRICTION])
    return float(np.ptp(energies) / total)
