"""Estimate of what a run costs, for `dem check`: CPU seconds on one core as a range, and what compiling adds once.

Ranges hold runs that were measured, on a core like that of docs/benchmarks.md. They are wide, as how many steps a
structure takes to come to rest and to fail is not known before it does: nine in ten fresh cases should lie within.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dem_cli.engine.clock import duration_words

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.dynamics.time_step import TimeStep
    from dem_cli.engine.dynamic import DynamicSimulation
    from dem_cli.engine.simulation import Simulation


class Span(NamedTuple):
    """The least and the most of what a run may take."""

    least: float
    most: float

    def plus(self, least: float, most: float) -> Span:
        """With so much more."""
        return Span(self.least + least, self.most + most)

    def times(self, least: float, most: float) -> Span:
        """So often."""
        return Span(self.least * least, self.most * most)

    def words(self) -> str:
        """CPU seconds in words."""
        low, high = duration_words(self.least), duration_words(self.most)
        return f"{low} to {high} of CPU time on one core"


START = Span(0.33, 0.65)  # s of every run beside its steps: what is imported, loaded, looked at and written
STEPS = {  # kind of analysis -> fewest and most steps
    "gravity": (400, 50_000),
    "pushover": (30_000, 2_000_000),
    "cycle": (10_000, 1_000_000),
    "settlement": (15_000, 150_000),
    "safety": (1_500, 60_000),  # each of its runs
    "modes": (400, 50_000),
}
IN_SPACE = {"pushover": (13_000, 1_000_000)}  # where that differs
CURVE = (60_000, 1_500_000)  # of a pushover under displacement control
# Of a pushover on joints whose stiffness is a property, or whose profile is:
GIVEN = {2: (100_000, 3_000_000), 3: (80_000, 900_000)}
COLLAPSE = "; where it collapses, ten to thirty times that: how far it stands is sought then"  # of a settlement
FOLLOW_STEPS = (30_000, 120_000)  # to follow a collapse
NANOSECONDS = {  # per contact point and step (scripts/benchmark), by dimension
    2: {"fixed": 10, "large": 20},
    3: {"fixed": 10, "large": 90},
}
SHAKEN = {  # ns per contact point and step of a time history, by dimension, without and with dashpots
    2: {False: 20, True: 55},
    3: {False: 60, True: 110},  # about: a third less where blocks stand, a third more where all of them rock
}
PER_STEP = 0.4  # µs beside them
SHOWN = {2: (0.06, 0.5), 3: (0.08, 0.9)}  # s of a time history beside its steps: looks, frames, samples
ENDS_EARLY, ROCKS = 0.5, 1.3  # of the seconds of all steps: a structure that collapses, one whose blocks all rock
FIRST = {  # s of compiling by dimension: geometry of the start, geometry that moves, time histories
    2: {"fixed": (2, 5), "large": (2, 6), "shaken": (5, 10)},
    3: {"fixed": (4, 8), "large": (20, 35), "shaken": (20, 35)},
}


def cost_of(case: Case, sim: Simulation, of_property: bool) -> list[tuple[str, str]]:
    """Lines of an analysis that ends at rest; of_property: the stiffness or profile of its joints is one of theirs."""
    points, d, analysis = sim.first_points, sim.model.dimension, case.analysis
    costs = NANOSECONDS[d]
    few, many = (min(steps, analysis.max_steps) for steps in _steps(case, d, of_property))
    if analysis.kind == "safety":
        from dem_cli.ensembles.static_values import expected

        few, many = (steps * runs for steps, runs in zip((few, many), expected(case)))
    moves = sim.kinematics != "fixed" or (of_property and analysis.kinematics == "auto")
    each = costs[sim.kinematics], costs["large" if moves else "fixed"]
    span = START.plus(*Span(few, many).times(1e-9 * points * each[0], 1e-9 * points * each[1]))
    said = f"{each[0]}" if each[0] == each[1] else f"{each[0]} to {each[1]}"
    basis = f"{few:,} to {many:,} steps × {points:,} points × {said} ns"
    if follows := getattr(analysis, "follow", 0.0) > 0.0 and getattr(analysis, "control", "load") == "load":
        fewest, most = FOLLOW_STEPS
        each_step = 1e-9 * points * costs["large"]
        span = span.plus(fewest * each_step, most * each_step)
        basis += f", then {fewest:,} to {most:,} × {costs['large']} ns for the collapse"
    collapse = COLLAPSE if analysis.kind == "settlement" else ""
    first = FIRST[d]["large" if moves or follows else "fixed"]
    return [("cost", f"{span.words()} ({basis}){collapse}"), ("first run", _first(first))]


def _steps(case: Case, dimension: int, of_property: bool) -> tuple[int, int]:
    """Fewest and most steps of such an analysis."""
    if case.analysis.kind == "pushover":
        if case.analysis.control == "displacement":
            return CURVE
        if of_property:
            return GIVEN[dimension]
    kind = case.analysis.kind
    return IN_SPACE[kind] if dimension == 3 and kind in IN_SPACE else STEPS[kind]


def _first(seconds: tuple[int, int]) -> str:
    """CPU time of compiling, once, in words."""
    return (
        f"{seconds[0]} to {seconds[1]} s more, once: its loops are compiled and kept, for this kind of analysis, "
        "these joints and this version of dem"
    )


def cost_of_shaking(
    sim: DynamicSimulation, step: TimeStep, steps: int, coda: int, runs: int, softer: float | None
) -> list[tuple[str, str]]:
    """Lines of time histories: so many runs, each of so many steps, with up to `coda` steps after the motion.

    softer: how much softer the joints of the check of stiffness are, whose steps are longer by the root of that; None:
    there is no such run.
    """
    points, d = sim.first_points, sim.model.dimension
    each_point = SHAKEN[d][sim.damping.in_joints]
    each_step = 1e-9 * each_point * points + 1e-6 * PER_STEP
    span = Span(steps, steps + coda).times(each_step * ENDS_EARLY * runs, each_step * ROCKS * runs)
    again = "" if softer is None else " and once more on softer joints"
    if softer is not None:
        span = span.plus(0.0, each_step * ROCKS * (steps + coda) / softer**0.5)
    each = f"{runs:,} runs × " if runs > 1 else ""
    basis = f"{each}{steps:,} steps × ({points:,} points × {each_point} ns + {PER_STEP} µs){again}"
    return [
        ("cost", f"{span.plus(*START).plus(*SHOWN[d]).words()} ({basis})"),
        ("first run", _first(FIRST[d]["shaken"])),
    ]
