"""Comparison in space: the same boxes in MuJoCo, tilted until they fall, and in compas_cra; load, error, CPU time."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from bench import diagrams, tilting
from bench.cases import KnownStructure
from bench.others import DEM, dem_job, table
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.spatial import compas_walls, mujoco_walls
from bench.spatial.associated import associated_job, statics_error
from bench.spatial.boxes import Boxes, boxes_of
from bench.spatial.cases import KNOWN_IN_SPACE, compiled_in_space, friction_of
from bench.timing import TimedTask, in_turn
from dem_cli.version import install_command

LARGE_CASE = "wall 205"  # in MuJoCo minutes
RESOLUTIONS = (0.02, 0.005, 0.002)  # of dem
RESOLUTION, COARSE = 0.005, 0.05  # of the bisections elsewhere, and of MuJoCo's of the large case
LIMIT, EXACT = "dem limit", "exact cones"
STEP, STEPS = "MuJoCo, a step", 100  # steps after as many under half of the load
SEARCHES, STATICS = (DEM, mujoco_walls.NAME), (LIMIT, compas_walls.NAME)


class BoxProblem(NamedTuple):
    """A structure as other programs are given it."""

    known: KnownStructure
    boxes: Boxes
    friction: float
    direction: tuple[float, float]


class Row(NamedTuple):
    """What is measured: a structure in a program under a setting."""

    known: KnownStructure
    program: str
    setting: str
    job: TimedTask


def problem_of(known: KnownStructure) -> BoxProblem:
    """The boxes of a benchmark structure, their friction and the direction in plan of the load."""
    case, model = known.build()
    x, y, _ = case.analysis.direction
    return BoxProblem(known, boxes_of(model), friction_of(case), (x, y))


def measure(options: BenchOptions) -> GroupResult:
    """One record per structure, program and setting; axis: the program, value: the setting."""
    compiled_in_space()
    found = GroupResult()
    names = list(KNOWN_IN_SPACE)[:1] if options.quick else list(KNOWN_IN_SPACE)
    problems = [problem_of(KNOWN_IN_SPACE[name]) for name in names]
    rows = [row for problem in problems for row in _in_dem(problem.known, options)]
    for program, rows_of in ((mujoco_walls, _in_mujoco), (compas_walls, _in_compas)):
        if find_spec(program.PACKAGE) is None:
            found.notes.append(f"{program.NAME} was left out: not installed ({install_command('bench')})")
        else:
            rows += [row for problem in problems for row in rows_of(problem, options)]
    if not options.long:
        found.notes.append(f"the load of {LARGE_CASE} in MuJoCo was left out (`--long` measures it, in ten minutes)")
    in_turn([row.job for row in rows], options.rounds(2), long=1.0)
    for row in rows:
        times, unit = row.job.seconds, "s"
        if row.program == STEP:
            times, unit = [1000.0 * seconds / STEPS for seconds in times], "ms"
        found.records.append(record(row.known.name, row.program, row.setting, times, unit, **row.job.result))
    return found


def _in_dem(known: KnownStructure, options: BenchOptions) -> list[Row]:
    resolutions = RESOLUTIONS[:1] if options.quick else RESOLUTIONS
    searches = [Row(known, DEM, f"resolution {r:g}", dem_job(known, r)) for r in resolutions]
    return [*searches, Row(known, LIMIT, EXACT, associated_job(known))]


def _in_mujoco(problem: BoxProblem, options: BenchOptions) -> list[Row]:
    large = problem.known.name == LARGE_CASE
    resolution = 0.1 if options.quick else COARSE if large else RESOLUTION
    chosen = [s for s in mujoco_walls.SETTINGS if (s.wide and options.long) or not large]
    rows = [
        Row(problem.known, mujoco_walls.NAME, setting.name, tilted(problem, setting, resolution))
        for setting in (chosen[:1] if options.quick else chosen)
    ]
    best = mujoco_walls.SETTINGS[-1]
    return [*rows, Row(problem.known, STEP, best.name, stepped(problem, best))]


def tilted(problem: BoxProblem, setting: tilting.EngineSettings, resolution: float) -> TimedTask:
    """From the boxes to the failure load in MuJoCo; a new world for each trial."""
    known, boxes, friction, direction = problem

    def run() -> dict[str, Any]:
        found = tilting.failure_load(
            lambda: mujoco_walls.MujocoWorld(boxes, friction, direction, setting), setting, friction, resolution
        )
        return found | {"error": known.error(found["load"])}

    return TimedTask(run)


def stepped(problem: BoxProblem, setting: tilting.EngineSettings) -> TimedTask:
    """Steps of MuJoCo under half of the load that the structure carries."""
    worlds: list[mujoco_walls.MujocoWorld] = []

    def prepare() -> None:
        worlds[:] = [mujoco_walls.MujocoWorld(problem.boxes, problem.friction, problem.direction, setting)]
        worlds[0].tilt(0.5 * problem.known.load)
        worlds[0].step(STEPS)

    def run() -> dict[str, Any]:
        worlds[0].step(STEPS)
        return {}

    return TimedTask(run, prepare)


def _in_compas(problem: BoxProblem, options: BenchOptions) -> list[Row]:
    tensions = compas_walls.TENSIONS[:1] if options.quick else compas_walls.TENSIONS
    return [
        Row(problem.known, compas_walls.NAME, compas_walls.setting(tension), balanced(problem, tension))
        for tension in tensions
    ]


def balanced(problem: BoxProblem, tension: float) -> TimedTask:
    """From the boxes to the highest load that compas_cra balances."""
    known, boxes, friction, direction = problem

    def run() -> dict[str, Any]:
        found = compas_walls.failure_load(boxes, friction, direction, tension, RESOLUTION)
        return found | {"error": statics_error(known, found["load"])}

    return TimedTask(run)


def page(records: list[Measurement]) -> list[str]:
    """What was done, a table of failure loads, one of associated loads, and what a step of MuJoCo costs."""
    names = tuple(KNOWN_IN_SPACE)
    lines = [*PAGE_TEXT]
    for title, programs in (("Failure loads", SEARCHES), ("Associated loads: statics alone", STATICS)):
        chosen = [r for r in records if r.axis in programs]
        lines += ["", f"{title}: error · CPU seconds.", "", *table(chosen, names)]
    return [*lines, "", _steps(records)]


def _steps(records: list[Measurement]) -> str:
    """CPU time of a step in MuJoCo."""
    costs = ", ".join(f"{r.case} {r.best:.2g} ms" for r in records if r.axis == STEP)
    return f"A step of MuJoCo under half of the load, with its last setting: {costs}." if costs else ""


def picture(records: list[Measurement], path: Path) -> None:
    """Error against CPU seconds, a panel per structure, a mark per program and setting."""
    programs = [name for name in (*SEARCHES, *STATICS) if any(r.axis == name for r in records)]
    panels = {
        name: {p: [(r.best, r.found["error"]) for r in records if (r.case, r.axis) == (name, p)] for p in programs}
        for name in KNOWN_IN_SPACE
        if any(r.case == name for r in records)
    }
    diagrams.work_precision(path, panels, joined={DEM})


PICTURES = {"peers": picture}

PAGE_TEXT = f"""\
The same boxes in two programs that can be installed from a package registry: MuJoCo, an engine for robots, and
compas_cra, which solves the statics of rigid blocks.

* MuJoCo: gravity is tilted and the load found by bisection, by the same trial as in the plane (above), to
  {100 * RESOLUTION:g} % ({LARGE_CASE}: {100 * COARSE:g} %). Newton's solver, friction without torsion or rolling.
  Contacts are springs whose friction creeps: time constant, `impratio` and the length of the smallest edge in its
  units decide how much of that is taken for failure. It moves the structure for real, with no proof at the end.
* compas_cra: rigid-block equilibrium (RBE). Friction is a pyramid of eight sides around the cone, which allows up to
  8 % more of it. Tension is allowed and punished: the load depends on how much of it, over the largest compression,
  is taken for failure. Bisection to {100 * RESOLUTION:g} %, joints found once.
* Its loads are associated ones, and so are those of `dem limit`, whose cones are exact: statics alone, without a flow
  rule. Where friction has to hold a wall out of its plane they are far above what a wall carries (table above), which
  is why they are never taken for failure loads here; errors are those of the statics.
* dem's seconds of a failure load hold everything from the case file; the others start from the model.""".splitlines()
