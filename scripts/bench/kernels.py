"""Cost of a step: ns per contact point and step, and bytes per block, in the plane and in space, by size.

In pseudo-time and, where blocks move, in time histories without and with dashpots; and what a detection takes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.cases import SIZES, KnownStructure, prisms, wall_of
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import count, lines_of
from bench.timing import TimedTask, in_turn

if TYPE_CHECKING:
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.engine.simulation import Simulation

PICTURES: dict[str, Any] = {}
LOAD = 0.3  # multiplier at which the walls stand, with sticking, sliding and open points
POINT_STEPS = 2_000_000  # points × steps of one timing, about 20 ms
FIRST_STEPS = 300
BLOCK_COUNTS = (21, 231, 2275, 20100)
BETWEEN = wall_of(100, 50, 5050)
COMPARED = (231, 5050)  # blocks, for which everything is measured
ALL_SIZES = (*BLOCK_COUNTS, 5050)
IN_SPACE = (21, *COMPARED)  # with the geometry of the start
QUICK_BLOCKS = (21,)
FIXED, LARGE = "fixed", "large"


@dataclass(frozen=True)
class StepKind:
    """What a step does: geometry, pseudo-time or a time history, in the plane or in space."""

    name: str
    kinematics: str
    in_space: bool = False
    dashpots: float | None = None  # of critical, in time histories; None: pseudo-time
    sizes: tuple[int, ...] = COMPARED

    def start(self, known: KnownStructure) -> tuple[Simulation, TimedTask, int]:
        """A structure some hundred steps old, the job to be timed, and how many points × steps it does."""
        structure = prisms(known) if self.in_space else known
        if self.dashpots is None:
            sim = simulation(structure, self.kinematics)
            return sim, *stepping(sim)
        moving = history(structure, self.dashpots)
        return moving, *waiting(moving)


DASHPOTS = 0.35  # of critical, as time histories have without a [damping] table
KINDS = (
    StepKind(FIXED, FIXED, sizes=ALL_SIZES),
    StepKind(LARGE, LARGE, sizes=ALL_SIZES),
    StepKind("time history", LARGE, dashpots=0.0),
    StepKind("time history, dashpots", LARGE, dashpots=DASHPOTS),
    StepKind("fixed, 3D", FIXED, in_space=True, sizes=IN_SPACE),
    StepKind("large, 3D", LARGE, in_space=True),
    StepKind("time history, 3D", LARGE, in_space=True, dashpots=0.0),
    StepKind("time history, dashpots, 3D", LARGE, in_space=True, dashpots=DASHPOTS),
)


def simulation(known: KnownStructure, kinematics: str) -> Simulation:
    """A compiled simulation of a structure under LOAD, some hundred steps old."""
    from dem_cli.core.engine.properties import joint_properties, law_of
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.kernels import records as slot
    from dem_cli.masonry.assembly.solver_request import solver_request

    case, model = known.build()
    request = solver_request(case)
    sim = Simulation(model, law_of(request), joint_properties(request, model), kinematics)
    sim.compile()
    sim.set_load(LOAD)
    sim.advance(FIRST_STEPS, slot.HOLD_LOAD)
    return sim


def history(known: KnownStructure, fraction: float) -> DynamicSimulation:
    """A compiled time history under gravity on ground at rest, some hundred steps old."""
    from dem_cli.core.dynamics.history import shaken
    from dem_cli.core.dynamics.time_step import time_step
    from dem_cli.core.engine.viscous import Damping
    from dem_cli.core.kernels import records as slot
    from dem_cli.masonry.assembly.solver_request import solver_request

    case, model = known.build()
    sim = shaken(solver_request(case), model, Damping(fraction=fraction))
    sim.compile()
    sim.advance(FIRST_STEPS, slot.HOLD_LOAD)
    sim.begin(time_step(sim).step)
    wait(sim, FIRST_STEPS)
    return sim


def wait(sim: DynamicSimulation, n_steps: int) -> None:
    """Steps of a time history while the ground is at rest."""
    from dem_cli.core.dynamics.ground import GroundMotion
    from dem_cli.core.kernels.records import Watch

    nothing = Watch(np.zeros(0, np.int64), 1, np.zeros((n_steps, 0, 3, sim.bodies.velocities.shape[1])))
    sim.shake(GroundMotion([], sim.model).stretch(0.0, n_steps, sim.dt), n_steps, nothing)


def stepping(sim: Simulation) -> tuple[TimedTask, int]:
    """A job that does the same steps each time, and point-steps of one run."""
    from dem_cli.core.kernels import records as slot

    points, start = points_of(sim), sim.save()
    steps = max(POINT_STEPS // points, sim.settings.relaxation.chunk)  # as many as there are between two looks
    return TimedTask(lambda: sim.advance(steps, slot.HOLD_LOAD), lambda: sim.restore(start)), points * steps


def waiting(sim: DynamicSimulation) -> tuple[TimedTask, int]:
    """A job that goes on with a time history, and point-steps of one run."""
    points = points_of(sim)
    steps = max(POINT_STEPS // points, 10)
    return TimedTask(lambda: wait(sim, steps)), points * steps


def detecting(sim: Simulation) -> TimedTask:
    """A job that looks for the faces that touch and carries over what their points remember."""
    start = sim.save()
    return TimedTask(sim.detect, lambda: sim.restore(start))


def points_of(sim: Simulation) -> int:
    """Contact points: where blocks move in space joints have room for more than they have."""
    return int((sim.joints.kn > 0.0).sum())


def bytes_per_block(sim: Simulation) -> int:
    """Memory of all arrays of a simulation that a step or a detection works on, per free block."""
    records: tuple[Any, ...] = (sim.bodies, sim.shape, sim.loads, sim.joints, sim.geometry, sim.contacts)
    dampers = [array for array in getattr(sim, "dampers", ()) if isinstance(array, np.ndarray)]
    records += (getattr(sim.joints, "tiles", ()),)
    arrays = (array for each in (*records, dampers) for array in each if isinstance(array, np.ndarray))
    return round(sum(array.nbytes for array in arrays) / len(sim.free))


def measure(options: BenchOptions) -> GroupResult:
    """One record per size and kind of step; unit: ns per point and step, ledger on."""
    rows: list[tuple[KnownStructure, StepKind, Simulation, TimedTask, int, TimedTask | None]] = []
    timed: list[TimedTask] = []
    for known, kind in rows_of(options):
        sim, step, work = kind.start(known)
        finds = detecting(sim) if kind.kinematics == LARGE and kind.dashpots is None else None
        rows.append((known, kind, sim, step, work, finds))
        timed += [job for job in (step, finds) if job is not None]
    in_turn(timed, options.rounds(15))
    found = GroupResult()
    for known, kind, sim, step, work, finds in rows:
        times = [1e9 * seconds / work for seconds in step.seconds]
        sizes = {"blocks": len(sim.free), "points": points_of(sim), "bytes": bytes_per_block(sim)}
        if finds is not None:
            sizes["detections"] = round(1.0 / min(finds.seconds))
        found.records.append(record(known.name, "geometry", kind.name, times, "ns", **sizes))
    return found


def rows_of(options: BenchOptions) -> Iterator[tuple[KnownStructure, StepKind]]:
    """What is measured, by size."""
    for known in sorted((*SIZES, BETWEEN), key=blocks_of):
        blocks = blocks_of(known)
        for kind in KINDS:
            if blocks in (QUICK_BLOCKS if options.quick else kind.sizes):
                yield known, kind


def blocks_of(known: KnownStructure) -> int:
    """Free blocks of a wall of SIZES, from its name."""
    return int(known.name.removeprefix("wall ").replace(",", ""))


def page(records: list[Measurement]) -> list[str]:
    """The table."""
    head = ("blocks", "contact points", "geometry", "best", "median", "bytes a block", "detections a second")
    rows = [
        (
            count(r.found["blocks"]), count(r.found["points"]), r.value, f"{r.best:.2f}", f"{r.median:.2f}",
            count(r.found.get("bytes")), count(r.found.get("detections")),
        )
        for r in records
    ]  # fmt: skip
    text = (
        "CPU ns per contact point and step of walls under a load that they stand, with the energy ledger, in float64"
        " on one core. *fixed*: geometry of the start, used for failure loads; *large*: geometry that moves, used where"
        " joints have gaps or are soft, and after failure; *time history*: geometry that moves in real time, under"
        f" gravity while the ground is at rest, without damping or with dashpots of {DASHPOTS:g} of critical; *3D*: the"
        " same blocks as prisms. Last, the memory of all arrays that a step or a detection works on, and how many"
        " detections (which faces touch, and what their points remember) fit in a second."
    )
    return [text, "", *lines_of(head, rows)]
