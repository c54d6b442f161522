"""Work-precision diagrams: error of the failure load against CPU time, one knob at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path
from typing import Any

from bench import diagrams
from bench.cases import KNOWN_STRUCTURES, KnownStructure, answer, solve
from bench.points import points_per_joint
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import lines_of, percent, seconds
from bench.timing import TimedTask, in_turn
from dem_cli.core.engine.settings import DEFAULT, Settings

CASES = tuple(KNOWN_STRUCTURES)
NOT_DRAWN = ("T21 μ 0.6", "T21 μ 0.7")  # in the tables only: enough lines
FIRST_INSIDE = "2 inside"
DEAR = "T231"  # of some knobs only the cheaper values
LONG = 0.5  # s: what takes longer is measured once
QUICK_CASES = ("T21 μ 0.5", "COL14")
FINE = "analysis.resolution=0.0005"  # for the other knobs, so that it does not hide them
STEPS = 1_000_000  # about five times what usual settings need: a hopeless one ends there
BUDGET = f"analysis.max_steps={STEPS}"


@dataclass(frozen=True)
class Axis:
    """One knob: its values, the usual one first, and what a value means for a run."""

    name: str
    text: str
    usual: Any
    values: tuple[Any, ...]
    overrides: Callable[[KnownStructure, Any], list[str]]
    inside: Callable[[Any], AbstractContextManager] = lambda value: nullcontext()
    settings: Callable[[Any], Settings] = lambda value: DEFAULT
    cheap: tuple[Any, ...] | None = None  # values for DEAR; None: all


def stiffness(known: KnownStructure, ratio: float) -> list[str]:
    """A given kn with kn·h/W = ratio for a mean block of weight W and smallest edge h."""
    from dem_cli.core.model.scales import stiffness_scale

    return [FINE, BUDGET, f"joints.dry.kn={ratio * stiffness_scale(known.build()[1])!r}", "joints.dry.points=2"]


def fine(known: KnownStructure, value: Any) -> list[str]:
    """Nothing but a narrow bracket."""
    return [FINE, BUDGET]


def tolerance(value: float) -> Settings:
    """Another unbalanced force of a claimed equilibrium, over the block's own weight."""
    return replace(DEFAULT, relaxation=replace(DEFAULT.relaxation, tolerance=value, gravity_tolerance=value))


def time_step(factor: float) -> Settings:
    """Time steps longer by `factor` than usual, by lighter fictitious masses."""
    return replace(DEFAULT, relaxation=DEFAULT.relaxation.stretched(factor))


AXES = (
    Axis(
        "resolution",
        "`analysis.resolution`: width of the bracket between proven equilibrium and proven failure, relative.",
        0.002,
        (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005),
        lambda known, value: [f"analysis.resolution={value}"],
    ),
    Axis(
        "stiffness",
        "`joints.*.kn` as kn·h/W, h the smallest edge and W the mean weight; given values, so that `kinematics = "
        '"auto"` turns to moving geometry where blocks move visibly before failure (marked *large*). "auto" is 1e6.',
        1e6,
        (1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9),
        stiffness,
        cheap=(1e5, 1e6, 1e7, 1e8, 1e9),
    ),
    Axis(
        "tolerance",
        "Largest unbalanced force of a claimed equilibrium, over the block's own weight.",
        1e-5,
        (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
        fine,
        settings=tolerance,
    ),
    Axis(
        "time step",
        "Time-step factor, times the usual one (which keeps a margin to the stable step); fictitious masses grow with"
        " its inverse square.",
        1.0,
        (0.25, 0.5, 0.75, 1.0, 1.1, 1.2, 1.3, 1.5),
        fine,
        settings=time_step,
    ),
    Axis(
        "points per joint",
        "Contact points of a joint: both ends and equally spaced between (n), or only inside, in the middle of n equal"
        " parts (n inside). Two at the ends are exact for rigid blocks; geometry of the start.",
        "2",
        ("2", "3", "5", "9", "2 inside", "4 inside", "8 inside", "16 inside"),
        fine,
        points_per_joint,
        cheap=("2", "3", "2 inside", "4 inside"),
    ),
)


def measure(options: BenchOptions) -> GroupResult:
    """One record per knob, value and case."""
    found = GroupResult()
    for axis in AXES:
        rows = list(_jobs(axis, options.quick))
        in_turn([job for *_, job in rows], options.rounds(2), LONG)
        for known, value, job in rows:
            found.records.append(record(known.name, axis.name, value, job.seconds, **job.result))
    return found


def _jobs(axis: Axis, quick: bool) -> Iterator[tuple[KnownStructure, Any, TimedTask]]:
    for value in (axis.values[0], axis.usual) if quick else axis.values:
        for name in QUICK_CASES if quick else CASES:
            if name == DEAR and axis.cheap is not None and value not in axis.cheap:
                continue
            yield KNOWN_STRUCTURES[name], value, _job(KNOWN_STRUCTURES[name], axis, value)


def _job(known: KnownStructure, axis: Axis, value: Any) -> TimedTask:
    case, model = known.build(*axis.overrides(known, value))

    def run() -> dict[str, Any]:
        with axis.inside(value):
            return answer(known, solve(case, model, settings=axis.settings(value)))

    return TimedTask(run)


def page(records: list[Measurement]) -> list[str]:
    """A table per knob: values against structures."""
    text = (
        "One knob at a time, everything else as usual; for all knobs but the first `analysis.resolution` is 0.0005, so"
        f" that it does not hide them, and a run gives up after {STEPS:,} steps (usually 4,000,000). Cells: error · CPU"
        " seconds; the usual value is bold; *warned*: the program says itself that something is wrong."
        f" What takes longer than {LONG:g} s is measured once."
    )
    lines = [text]
    for axis in AXES:
        chosen = [r for r in records if r.axis == axis.name]
        if chosen:
            lines += ["", f"**{axis.name}.** {axis.text}", "", *_table(axis, chosen)]
    return lines


def _table(axis: Axis, records: list[Measurement]) -> list[str]:
    cells = {(r.value, r.case): _cell(r) for r in records}
    measured = {r.case for r in records}
    cases = [name for name in CASES if name in measured]
    rows = []
    for value in dict.fromkeys(r.value for r in records):
        label = value if isinstance(value, str) else f"{value:g}"
        label = f"**{label}**" if value == axis.usual else label
        rows.append((label, *(cells.get((value, case), "") for case in cases)))
    return lines_of((axis.name, *cases), rows)


def _cell(r: Measurement) -> str:
    error, status = r.found["error"], r.found.get("status")
    what = percent(error) if error is not None else status or "no answer"
    if error is not None and r.found.get("warning"):
        what += " (warned)"
    if r.axis == "stiffness" and r.found.get("kinematics") == "large":
        what += " *large*"
    return f"{what} · {seconds(r.best)}"


def picture(records: list[Measurement], path: Path) -> None:
    """A panel per knob, a line per structure, along the values of the knob."""
    panels: dict[str, dict[str, list[tuple[float, float | None]]]] = {}
    for r in records:
        if r.case not in NOT_DRAWN:
            line = panels.setdefault(r.axis, {}).setdefault(r.case, [])
            if r.value == FIRST_INSIDE:
                line.append((nan, nan))  # another line of the same colour
            line.append((r.best, r.found["error"]))
    diagrams.work_precision(path, panels)


PICTURES = {"precision": picture}
