"""Comparison in space: the same boxes in MuJoCo, tilted until they fall, and in compas_cra; load, error, CPU time."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from dem_cli.bench import diagrams, tilting
from dem_cli.bench.cases import KnownStructure
from dem_cli.bench.others import DEM, cell, dem_job
from dem_cli.bench.record import BenchOptions, GroupResult, Measurement, record
from dem_cli.bench.spatial import compas_walls, mujoco_walls
from dem_cli.bench.spatial.boxes import Boxes, boxes_of
from dem_cli.bench.spatial.cases import KNOWN_IN_SPACE, friction_of
from dem_cli.bench.table import count, lines_of
from dem_cli.bench.timing import TimedTask, in_turn
from dem_cli.version import install_command

LARGE_CASE = "wall 205"  # minutes in MuJoCo
RESOLUTIONS = (0.02, 0.005, 0.002)  # of dem
RESOLUTION, COARSE = 0.005, 0.02  # of the bisections elsewhere, and on the large case
ASSOCIATED = "dem limit"
EXACT = "associated, exact cones"
PUSHED = "failure load"
STATICS = "statics"  # programs whose load is the associated one


class BoxProblem(NamedTuple):
    """A structure as other programs are given it."""

    known: KnownStructure
    boxes: Boxes
    friction: float
    direction: tuple[float, float]

    @property
    def resolution(self) -> float:
        """Of a bisection, relative to the load."""
        return COARSE if self.known.name == LARGE_CASE else RESOLUTION


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
    found = GroupResult()
    names = list(KNOWN_IN_SPACE)[:1] if options.quick else list(KNOWN_IN_SPACE)
    problems = [problem_of(KNOWN_IN_SPACE[name]) for name in names]
    rows = [row for problem in problems for row in (*_searches(problem.known, options), _limit(problem.known))]
    for program, add in ((mujoco_walls, _in_mujoco), (compas_walls, _in_compas)):
        if find_spec(program.PACKAGE) is None:
            found.notes.append(f"{program.NAME} was left out: not installed ({install_command('bench')})")
        else:
            rows += [row for problem in problems for row in add(problem, options)]
    in_turn([row.job for row in rows], options.rounds(2), long=1.0)
    for row in rows:
        found.records.append(record(row.known.name, row.program, row.setting, row.job.seconds, **row.job.result))
    return found


def _searches(known: KnownStructure, options: BenchOptions) -> list[Row]:
    resolutions = RESOLUTIONS[:1] if options.quick else RESOLUTIONS
    return [Row(known, DEM, f"resolution {r:g}", dem_job(known, r)) for r in resolutions]


def _limit(known: KnownStructure) -> Row:
    from dem_cli.bench.spatial.associated import associated_job

    return Row(known, ASSOCIATED, EXACT, associated_job(known))


def _in_mujoco(problem: BoxProblem, options: BenchOptions) -> list[Row]:
    rows = []
    for setting in mujoco_walls.SETTINGS[-1:] if options.quick else mujoco_walls.SETTINGS:
        if setting.wide or problem.known.name != LARGE_CASE:
            resolution = 0.1 if options.quick else problem.resolution
            rows.append(Row(problem.known, mujoco_walls.NAME, setting.name, tilted(problem, setting, resolution)))
    return rows


def tilted(problem: BoxProblem, setting: tilting.EngineSettings, resolution: float) -> TimedTask:
    """From the boxes to the failure load in MuJoCo; a new world for each trial."""
    known, boxes, friction, direction = problem

    def run() -> dict[str, Any]:
        found = tilting.failure_load(
            lambda: mujoco_walls.make(boxes, friction, direction, setting), setting, friction, resolution
        )
        return found | {"error": known.error(found["load"]), "kind": PUSHED}

    return TimedTask(run)


def _in_compas(problem: BoxProblem, options: BenchOptions) -> list[Row]:
    rows = []
    for tension in compas_walls.TENSIONS[:1] if options.quick else compas_walls.TENSIONS:
        job = balanced(problem, tension, 0.1 if options.quick else problem.resolution)
        rows.append(Row(problem.known, compas_walls.NAME, compas_walls.setting(tension), job))
    return rows


def balanced(problem: BoxProblem, tension: float, resolution: float) -> TimedTask:
    """From the boxes to the highest load that compas_cra balances."""
    known, boxes, friction, direction = problem

    def run() -> dict[str, Any]:
        found = compas_walls.failure_load(boxes, friction, direction, tension, resolution)
        return found | {"error": found["load"] / (known.upper or known.load) - 1.0, "kind": STATICS}

    return TimedTask(run)
