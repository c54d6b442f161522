"""Cost of a step: ns per contact point and step, and bytes per block, in the plane and in space, by size."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dem_cli.bench.cases import SIZES, KnownStructure, prisms, wall_of
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
BETWEEN = wall_of(100, 50, 5050)
IN_SPACE = (21, 231, 5050)  # as prisms too
QUICK_BLOCKS = (21,)
FIXED, LARGE, SPACE = "fixed", "large", "fixed, 3D"


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


def bytes_per_block(sim: Simulation) -> int:
    """Memory of all arrays of a simulation that a step or a detection works on, per free block."""
    records: tuple[Any, ...] = (sim.bodies, sim.shape, sim.loads, sim.joints, sim.geometry, sim.contacts)
    return round(sum(array.nbytes for arrays in records for array in arrays) / len(sim.free))


def measure(options: BenchOptions) -> GroupResult:
    """One record per size and geometry; unit: ns per point and step, ledger on."""
    rows = []
    for known in sorted((*SIZES, BETWEEN), key=blocks_of):
        blocks = blocks_of(known)
        if blocks in (QUICK_BLOCKS if options.quick else (*BLOCK_COUNTS, blocks_of(BETWEEN))):
            wanted = [(FIXED, known), (LARGE, known), *[(SPACE, prisms(known))] * (blocks in IN_SPACE)]
            for geometry, structure in wanted:
                sim = simulation(structure, LARGE if geometry == LARGE else FIXED)
                rows.append((known, geometry, sim, *stepping(sim)))
    in_turn([job for *_, job, _ in rows], options.rounds(15))
    found = GroupResult()
    for known, geometry, sim, job, work in rows:
        times = [1e9 * seconds / work for seconds in job.seconds]
        sizes = {"blocks": len(sim.free), "points": len(sim.joints.kn), "bytes": bytes_per_block(sim)}
        found.records.append(record(known.name, "geometry", geometry, times, "ns", **sizes))
    return found


def blocks_of(known: KnownStructure) -> int:
    """Free blocks of a wall of SIZES, from its name."""
    return int(known.name.removeprefix("wall ").replace(",", ""))


def page(records: list[Measurement]) -> list[str]:
    """The table."""
    head = ("blocks", "contact points", "geometry", "best", "median", "bytes a block")
    rows = [
        (
            count(r.found["blocks"]), count(r.found["points"]), r.value, f"{r.best:.2f}", f"{r.median:.2f}",
            count(r.found.get("bytes")),
        )
        for r in records
    ]  # fmt: skip
    text = (
        "CPU ns per contact point and step of walls under a load that they stand, with the energy ledger, in float64"
        " on one core. *fixed*: geometry of the start, used for failure loads; *large*: geometry that moves, used where"
        " joints have gaps or are soft, and after failure; *3D*: the same blocks as prisms. Last, the memory of all"
        " arrays that a step or a detection works on."
    )
    return [text, "", *lines_of(head, rows)]
