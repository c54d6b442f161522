"""Estimate the cost of a run for `dem check`: CPU seconds as a range, and the compile time added once.

How many steps a structure takes to come to rest and to fail is not known before it does. Ranges hold nine in ten cases
of `scripts/study costs`, which nothing was tuned to; how long a core takes for a loop of Python says how fast it is.
"""

from __future__ import annotations

import time
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.engine.clock import duration_words

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.dynamics.time_step import TimeStep
    from dem_cli.core.engine.dynamic import DynamicSimulation
    from dem_cli.core.engine.simulation import Simulation


class Span(NamedTuple):
    """Range of the CPU time of a run."""

    least: float
    most: float

    def plus(self, least: float, most: float) -> Span:
        """Add to both ends of the range."""
        return Span(self.least + least, self.most + most)

    def times(self, least: float, most: float) -> Span:
        """Multiply both ends of the range."""
        return Span(self.least * least, self.most * most)

    def words(self) -> str:
        """Format the range as CPU seconds in words."""
        low, high = duration_words(self.least), duration_words(self.most)
        return f"{low} to {high} of CPU time on one core"


LOOP = 42e-9  # s that a core like that of docs/benchmarks.md takes for a pass of a loop of Python
PASSES = 200_000  # of that loop: 8 ms, as a core that others use as well is fast and slow by turns
START = Span(0.33, 0.9)  # s of every run beside its steps: what is imported, loaded, looked at and written
# Fewest and most steps, with all else that takes time counted as steps: limit analysis, paths, implicit histories.
# Chosen by `scripts/study costs`, seeds 1 to 13 (28 November 2026, 0.18.0); docs/guide/warnings.md says how they hold.
STEPS = {  # of a kind of analysis
    "gravity": (400, 30_000),
    "pushover": (40_000, 500_000),  # of courses, in the plane, on rigid joints in the geometry of the start
    "cycle": (5_000, 300_000),
    "settlement": (20_000, 500_000),
    "safety": (1_500, 120_000),  # each of its runs
    "modes": (400, 30_000),
}
IN_SPACE = (120_000, 1_400_000)  # of such a pushover there, ...
HELD = (150_000, 3_500_000)  # ... where supports hold it from the side: friction wedges, and two histories differ
STONES = {2: (120_000, 2_000_000), 3: (300_000, 1_600_000)}  # where hardly a stone is like another, by dimension
LINKED = (30_000, 2_500_000)  # ties and bars that stretch: of 60 small structures 2 took more, of 4 large ones 2
MOVING = {2: (60_000, 500_000), 3: (20_000, 200_000)}  # geometry that moves
GIVEN = {2: (60_000, 400_000), 3: (150_000, 900_000)}  # joints whose stiffness is a property, or whose profile is
CURVE, LED = (100_000, 800_000), (0.8, 2.5)  # of displacement control, and s beside: rows and looks on its way
UNLIKE = 0.5  # share of stones of a weight of their own, from which on they are STONES, ...
UPRIGHT = 0.1  # vertical part of the normal of a joint that stands
BONDED = 1.5  # ... where each has so many joints
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
    """Estimate the cost of a static analysis; of_property: the stiffness or profile of its joints is given."""
    points, d, analysis = sim.first_points, sim.model.dimension, case.analysis
    costs = NANOSECONDS[d]
    few, many = (min(steps, analysis.max_steps) for steps in _steps(case, sim, of_property))
    if analysis.kind == "safety":
        from dem_cli.analyses.ensembles.static_values import expected

        few, many = (steps * runs for steps, runs in zip((few, many), expected(case)))
    moves = sim.kinematics != "fixed" or (of_property and analysis.kinematics == "auto")
    each = costs[sim.kinematics], costs["large" if moves else "fixed"]
    span = START.plus(*Span(few, many).times(1e-9 * points * each[0], 1e-9 * points * each[1]))
    if getattr(analysis, "control", "load") == "displacement" and analysis.kind == "pushover":
        span = span.plus(*LED)
    said = f"{each[0]}" if each[0] == each[1] else f"{each[0]} to {each[1]}"
    basis = f"as {few:,} to {many:,} steps × {points:,} points × {said} ns"
    if follows := getattr(analysis, "follow", 0.0) > 0.0 and getattr(analysis, "control", "load") == "load":
        fewest, most = FOLLOW_STEPS
        each_step = 1e-9 * points * costs["large"]
        span = span.plus(fewest * each_step, most * each_step)
        basis += f", then {fewest:,} to {most:,} × {costs['large']} ns for the collapse"
    collapse = COLLAPSE if analysis.kind == "settlement" else ""
    first = FIRST[d]["large" if moves or follows else "fixed"]
    return [("cost", f"{_on_this_core(span, basis)}{collapse}"), ("first run", _first(first))]


def _on_this_core(span: Span, basis: str) -> str:
    """Describe a range of time, scaled from the core of the benchmarks to this one."""
    slower = slowness()
    speed = f"{slower:.2g} times the seconds of docs/benchmarks.md"
    return f"{span.times(slower, slower).words()} ({basis}; this core takes {speed})"


@cache
def slowness() -> float:
    """Measure the slowness of this core relative to that of docs/benchmarks.md, by a short loop."""
    begun, total = time.process_time(), 0
    for i in range(PASSES):
        total += i * i
    return (time.process_time() - begun) / (LOOP * PASSES)


def _steps(case: Case, sim: Simulation, of_property: bool) -> tuple[int, int]:
    """Estimate the fewest and most steps of a static analysis."""
    kind, d = case.analysis.kind, sim.model.dimension
    if kind != "pushover":
        return STEPS[kind]
    if case.analysis.control == "displacement":
        return CURVE
    if of_property:
        return GIVEN[d]
    if sim.kinematics != "fixed":
        return MOVING[d]
    if sim.links:
        return LINKED
    if _of_stones(sim):
        return STONES[d]
    if d == 3:
        return HELD if _held_sideways(sim) else IN_SPACE
    return STEPS[kind]


def _held_sideways(sim: Simulation) -> bool:
    """Test whether some support touches blocks sideways."""
    joints, fixed = sim.joints, sim.model.fixed
    normals = joints.frames[joints.starts[:-1], sim.model.dimension - 1]
    return bool((fixed[joints.blocks].any(axis=1) & (np.abs(normals) < UPRIGHT)).any())


def _of_stones(sim: Simulation) -> bool:
    """Test whether most blocks have different masses, as in rubble, and are more than a column or an arch."""
    masses = sim.model.masses[~sim.model.fixed]
    if not len(masses) or len(sim.joints.blocks) < BONDED * len(masses):
        return False
    return len(np.unique(np.round(masses / masses.max(), 6))) > UNLIKE * len(masses)


def _first(seconds: tuple[int, int]) -> str:
    """Describe the CPU time of compiling, once."""
    return (
        f"{seconds[0]} to {seconds[1]} s more, once: its loops are compiled and kept, for this kind of analysis, "
        "these joints and this version of dem"
    )


def cost_of_shaking(
    sim: DynamicSimulation, step: TimeStep, steps: int, coda: int, runs: int, softer: float | None
) -> list[tuple[str, str]]:
    """Estimate the cost of time histories: so many runs of so many steps, with up to `coda` steps after the motion.

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
        ("cost", _on_this_core(span.plus(*START).plus(*SHOWN[d]), basis)),
        ("first run", _first(FIRST[d]["shaken"])),
    ]
