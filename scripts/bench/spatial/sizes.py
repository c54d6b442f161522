"""Growth in space: failure loads of walls pushed out of their plane, associated loads, and memory, by size."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

from bench import diagrams
from bench.cases import KnownStructure, solve
from bench.kernels import blocks_of
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.spatial.associated import associated_job
from bench.spatial.cases import MANY, SIZES_IN_SPACE, compiled_in_space
from bench.table import count, lines_of, seconds
from bench.timing import TimedTask, in_turn

PUSHED, ASSOCIATED, MEMORY = "failure load", "associated load", "memory"
RESOLUTION = 0.01
LARGEST = 2000  # blocks of a wall that is pushed to failure; larger ones take many minutes
QUICK_SIZES = 1
STEP_LIMIT = "analysis.max_steps=2000000"


def measure(options: BenchOptions) -> GroupResult:
    """Records of three axes; value: blocks."""
    compiled_in_space()
    found = GroupResult()
    sizes = [known for known in SIZES_IN_SPACE if options.long or blocks_of(known) < LARGEST]
    if not options.long:
        found.notes.append(f"walls of more than {LARGEST:,} blocks were not pushed to failure (`--long` does)")
    pushed = sizes[:QUICK_SIZES] if options.quick else sizes
    solved = pushed if options.quick else [*SIZES_IN_SPACE, MANY]
    rows = [(PUSHED, known, _pushed(known)) for known in pushed]
    rows += [(ASSOCIATED, known, associated_job(known)) for known in solved]
    in_turn([job for *_, job in rows], options.rounds(2))
    for axis, known, job in rows:
        found.records.append(record(known.name, axis, blocks_of(known), job.seconds, **job.result))
    for known in solved:
        most, points = building(known)
        found.records.append(
            record(known.name, MEMORY, blocks_of(known), [most / blocks_of(known)], "B", points=points)
        )
    return found


def _pushed(known: KnownStructure) -> TimedTask:
    case, model = known.build(f"analysis.resolution={RESOLUTION}", STEP_LIMIT)

    def run() -> dict[str, Any]:
        summary = solve(case, model)
        said = {key: summary.get(key) for key in ("joints", "steps", "status")}
        return said | {"load": summary["failure_load"], "bracket": summary.get("failure_load_bracket")}

    return TimedTask(run)


def building(known: KnownStructure) -> tuple[int, int]:
    """The most bytes that it takes to build a model and its simulation, and how many contact points there are."""
    from dem_cli.core.engine.properties import joint_properties, law_of
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.masonry.assembly.solver_request import solver_request

    tracemalloc.start()
    try:
        case, model = known.build()
        sim = Simulation(model, law_of(solver_request(case)), joint_properties(solver_request(case), model))
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    return most, len(sim.contacts.gaps)


def page(records: list[Measurement]) -> list[str]:
    """A table of walls, each with what was measured on it."""
    by_axis = {(r.axis, r.value): r for r in records}
    head = ("blocks", "points", "failure load", "bracket", "steps", "CPU", "associated load", "CPU", "memory per block")
    rows = []
    for blocks in dict.fromkeys(r.value for r in records):
        pushed, statics, held = (by_axis.get((axis, blocks)) for axis in (PUSHED, ASSOCIATED, MEMORY))
        rows.append((count(blocks), "" if held is None else count(held.found["points"]),
                     *_pushed_cells(pushed), *_associated_cells(statics), _memory_cell(held)))  # fmt: skip
    return [*PAGE_TEXT, "", *lines_of(head, rows)]


def _pushed_cells(r: Measurement | None) -> tuple[str, ...]:
    if r is None:
        return ("",) * 4
    bracket = " – ".join(_load(load) for load in r.found["bracket"] or ())
    load = _load(r.found["load"]) if r.found["load"] is not None else str(r.found["status"])
    return load, bracket, count(r.found["steps"]), seconds(r.best)


def _associated_cells(r: Measurement | None) -> tuple[str, ...]:
    return ("", "") if r is None else (_load(r.found["load"]), seconds(r.best))


def _memory_cell(r: Measurement | None) -> str:
    return "" if r is None else f"{r.best / 1000:.1f} kB"


def _load(load: float | None) -> str:
    return "?" if load is None else f"{load:.4f}"


def picture(records: list[Measurement], path: Path) -> None:
    """CPU seconds of both loads, and steps, against blocks."""
    pushed, statics = ([r for r in records if r.axis == axis] for axis in (PUSHED, ASSOCIATED))
    panels = {
        "CPU seconds": {PUSHED: [(r.value, r.best) for r in pushed], ASSOCIATED: [(r.value, r.best) for r in statics]},
        "steps": {PUSHED: [(r.value, r.found["steps"]) for r in pushed if r.found["steps"]]},
    }
    diagrams.growth(path, panels, "blocks")


PICTURES = {"spatial": picture}
PAGE_TEXT = f"""\
A wall of 20 × 10 × 0.8 m in running bond, φ = 35°, of ever smaller blocks, pushed out of its plane against fixed
columns behind its ends (`dimension = 3`). Failure loads to a resolution of {RESOLUTION:g}, from the model to the proof;
associated loads by exact cones, joints of the start included: statics alone, which overrates walls that friction holds.
Memory: the most that building model and simulation took; what a step works on is less (*Cost of a step*). Joints are
stiffer where blocks are smaller, as one elastic stone is.""".splitlines()
