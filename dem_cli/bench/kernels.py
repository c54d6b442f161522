"""Cost of a step: ns per contact point and step, for both geometries and four sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.bench.cases import SIZES, KnownStructure
from dem_cli.bench.record import BenchOptions, GroupResult, Measurement, record
from dem_cli.bench.table import count, lines_of
from dem_cli.bench.timing import TimedTask, in_turn

if TYPE_CHECKING:
    from dem_cli.engine.simulation import Simulation

PICTURES: dict[str, Any] = {}
LOAD = 0.3  # multiplier at which the walls stand, with sticking, sliding and open points
POINT_STEPS = 2_000_000  # points × steps of one timing, about 20 ms
FIRST_STEPS = 300
BLOCK_COUNTS = (21, 231, 2275, 20100)
QUICK_BLOCKS = (21,)


def simulation(known: KnownStructure, kinematics: str) -> Simulation:
    """A compiled simulation of a structure under LOAD, some hundred steps old."""
    from dem_cli.engine.properties import joint_properties, law_of
    from dem_cli.engine.simulation import Simulation
    from dem_cli.kernels import records as slot

    case, model = known.build()
    sim = Simulation(model, law_of(case), joint_properties(case, model), kinematics)
    sim.compile()
    sim.set_load(LOAD)
    sim.advance(FIRST_STEPS, slot.HOLD_LOAD)
    return sim


def stepping(sim: Simulation) -> tuple[TimedTask, int]:
    """A job that does the same steps each time, and point-steps of one run."""
    from dem_cli.kernels import records as slot

    points, start = len(sim.joints.kn), sim.save()
    steps = max(POINT_STEPS // points, 10)
    return TimedTask(lambda: sim.advance(steps, slot.HOLD_LOAD), lambda: sim.restore(start)), points * steps


def measure(options: BenchOptions) -> GroupResult:
    """One record per size and geometry; unit: ns per point and step, ledger on."""
    wanted = QUICK_BLOCKS if options.quick else BLOCK_COUNTS
    rows, jobs = [], []
    for known in SIZES:
        for kinematics in ("fixed", "large"):
            sim = simulation(known, kinematics) if blocks_of(known) in wanted else None
            if sim is not None:
                rows.append((known, kinematics, sim))
                jobs.append(stepping(sim))
    in_turn([job for job, _ in jobs], options.rounds(15))
    found = GroupResult()
    for (known, kinematics, sim), (job, work) in zip(rows, jobs, strict=True):
        times = [1e9 * seconds / work for seconds in job.seconds]
        points, blocks = len(sim.joints.kn), len(sim.free)
        found.records.append(record(known.name, "geometry", kinematics, times, "ns", blocks=blocks, points=points))
    return found


def blocks_of(known: KnownStructure) -> int:
    """Free blocks of a wall of SIZES, from its name."""
    return int(known.name.removeprefix("wall ").replace(",", ""))


def page(records: list[Measurement]) -> list[str]:
    """The table."""
    head = ("blocks", "contact points", "geometry", "best", "median")
    rows = [
        (count(r.found["blocks"]), count(r.found["points"]), r.value, f"{r.best:.2f}", f"{r.median:.2f}")
        for r in records
    ]
    text = (
        "CPU ns per contact point and step of walls under a load that they stand, with the energy ledger, in float64"
        " on one core. *fixed*: geometry of the start, used for failure loads; *large*: geometry that moves, used where"
        " joints have gaps or are soft, and after failure."
    )
    return [text, "", *lines_of(head, rows)]
