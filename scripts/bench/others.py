"""Comparison with game engines: structures in pymunk and Box2D, tilted until they fall; load, error, CPU time."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from bench import diagrams, tilting
from bench.cases import KNOWN_STRUCTURES, KnownStructure, answer, solve
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import lines_of, percent, seconds
from bench.timing import TimedTask, in_turn
from dem_cli.version import install_command

ENGINES = ("pymunk_walls", "box2d_walls")
NARROW_CASES = ("T21 μ 0.6", "T21 μ 0.75", "COL14", "ARCH μ 0.6")  # all settings
WIDE_CASES = (*NARROW_CASES, "T21 μ 0.5", "T21 μ 0.65", "T21 μ 1", "ARCH μ 0.4", "T231")  # the wide settings
RESOLUTIONS = (0.02, 0.005, 0.002, 0.0005)  # of dem
RESOLUTION = 0.002  # of the bisection in the engines
DEM = "dem"


def measure(options: BenchOptions) -> GroupResult:
    """One record per structure, program and setting; axis: the program, value: the setting."""
    found, rows = GroupResult(), []
    structures = WIDE_CASES[:1] if options.quick else WIDE_CASES
    for name in structures:
        for resolution in RESOLUTIONS[:1] if options.quick else RESOLUTIONS:
            rows.append(
                (KNOWN_STRUCTURES[name], DEM, f"resolution {resolution:g}", dem_job(KNOWN_STRUCTURES[name], resolution))
            )
    for module in ENGINES:
        engine = import_module(f"bench.{module}")
        if find_spec(engine.PACKAGE) is None:
            found.notes.append(f"{engine.NAME} was left out: not installed ({install_command('bench')})")
            continue
        for setting in engine.SETTINGS[:1] if options.quick else engine.SETTINGS:
            for name in structures:
                if setting.wide or name in NARROW_CASES:
                    job = engine_job(KNOWN_STRUCTURES[name], engine, setting, 0.1 if options.quick else RESOLUTION)
                    rows.append((KNOWN_STRUCTURES[name], engine.NAME, setting.name, job))
    in_turn([job for *_, job in rows], options.rounds(2), long=1.0)
    for known, program, setting, job in rows:
        found.records.append(record(known.name, program, setting, job.seconds, **job.result))
    return found


def dem_job(known: KnownStructure, resolution: float) -> TimedTask:
    """From the case file to the failure load."""

    def run() -> dict[str, Any]:
        case, model = known.build(f"analysis.resolution={resolution}")
        return answer(known, solve(case, model))

    return TimedTask(run)


def engine_job(known: KnownStructure, engine: Any, setting: tilting.EngineSettings, resolution: float) -> TimedTask:
    """From the model to the failure load; a new world for each trial."""
    from dem_cli.core.model.scales import smallest_edge

    case, model = known.build()
    friction = case.joints[case.default_joint].friction
    smallest = smallest_edge(model)

    def run() -> dict[str, Any]:
        found = tilting.failure_load(
            lambda: engine.make(model, friction, setting, smallest), setting, friction, resolution
        )
        return found | {"error": known.error(found["load"])}

    return TimedTask(run)


def page(records: list[Measurement]) -> list[str]:
    """What was done, then a table of structures against settings, then the wider set."""
    lines = [*PAGE_TEXT]
    for title, names in (
        ("All settings", NARROW_CASES),
        ("More structures, with the wide settings", WIDE_CASES[len(NARROW_CASES) :]),
    ):
        chosen = [r for r in records if r.case in names]
        if chosen:
            lines += ["", f"{title}: error · CPU seconds.", "", *table(chosen, names)]
    best = [line for program in dict.fromkeys(r.axis for r in records) for line in _best(records, program)]
    return [*lines, "", *best]


def table(records: list[Measurement], names: tuple[str, ...]) -> list[str]:
    """Programs and settings against structures: error · CPU seconds."""
    cells = {(r.axis, r.value, r.case): cell(r) for r in records}
    shown = [name for name in names if any(r.case == name for r in records)]
    rows = [
        (program, str(setting), *(cells.get((program, setting, name), "") for name in shown))
        for program, setting in dict.fromkeys((r.axis, r.value) for r in records)
    ]
    return lines_of(("program", "setting", *shown), rows)


def cell(r: Measurement) -> str:
    """Error and CPU seconds of a load."""
    load = r.found["load"]
    error = r.found["error"]
    what = "falls by itself" if load == 0.0 else percent(error) if error is not None else r.found["status"]
    return f"{what} · {seconds(r.best)}"


def worst_errors(records: list[Measurement], program: str) -> dict[str, float]:
    """Largest |error| over the structures that every setting was run on, by setting."""
    worst: dict[str, float] = {}
    for r in records:
        if r.axis == program and r.case in NARROW_CASES:
            error = 1.0 if r.found["error"] is None else abs(r.found["error"])
            worst[r.value] = max(worst.get(r.value, 0.0), error)
    return worst


def _best(records: list[Measurement], program: str) -> list[str]:
    worst = worst_errors(records, program)
    if not worst:
        return []
    setting = min(worst, key=lambda name: worst[name])
    total = sum(r.best for r in records if r.axis == program and r.value == setting and r.case in NARROW_CASES)
    text = f"* {program}, best setting: {setting}; largest error {100 * worst[setting]:.2g} %, {seconds(total)} in all"
    return [f"{text} ({', '.join(name for name in NARROW_CASES if any(r.case == name for r in records))})."]


def picture(records: list[Measurement], path: Path) -> None:
    """Error against CPU seconds, a panel per structure, a mark per program and setting."""
    names = [n for n in (*NARROW_CASES, "T231") if any(r.case == n for r in records)]
    programs = list(dict.fromkeys(r.axis for r in records))
    panels = {
        name: {p: [(r.best, r.found["error"]) for r in records if (r.case, r.axis) == (name, p)] for p in programs}
        for name in names
    }
    diagrams.work_precision(path, panels, joined={DEM})


PICTURES = {"others": picture}

PAGE_TEXT = f"""\
What a user would otherwise take from a package registry: pymunk (Chipmunk) and Box2D, two engines for games, given
the polygons, masses, inertias and friction of our model. Both are made to look right at 60 frames a second, not to
give failure loads; they are measured here because they are what there is.

* Gravity alone for {tilting.SETTLE:g} √(h/g), h the smallest edge; then tilted in {tilting.RAMP_STEPS} steps over
  {tilting.RAMP:g} √(h/g) to λ (horizontal = λ × vertical, as in dem); then held for {tilting.HOLD:g} √(h/g). The
  structure *stands* if no centroid moves more than {tilting.MOVED:g} h while held (an excess of 2.2e-4 g slides that
  far). λ by bisection in new worlds to {100 * RESOLUTION:g} % of itself; the load is the highest that stood.
* Time step, iterations, lengths and collision slop or skin are varied; sleep and restitution are off, warm starting
  is on, as both have it. Friction of a contact is μ (Chipmunk multiplies that of both shapes: √μ each).
* Limits of the comparison: an engine can do in the same world what dem cannot (impacts, free flight, thousands of
  loose bodies in real time); its answer is a yes or no after a time that somebody has to choose, without a proof; its
  stepping runs in C as dem's does, building the world and the loop over steps run in Python, where they take little.
  Box2D is version 2.3, as the package `box2d` ships it.
* dem's seconds hold everything from the case file to the failure load; theirs start from our model.""".splitlines()
