"""Post-peak path: the collapse at a prescribed rate or under the load of failure, with geometry that moves.

Where the live load keeps prescribing the rate of its own displacement, the multiplier is found along the whole
way, down to nothing where a wall overturns by itself. Where the load stays, blocks that slide leave the others
behind, as on a tilting table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.core.engine.track import Track
from dem_cli.core.kernels import records as slot
from dem_cli.core.records.ports import stage
from dem_cli.core.statics.equilibrium import check_finite, relax, settle_or_fail

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.engine.static_settings import PostPeakSettings


class CurvePeak(NamedTuple):
    """Peak of the load–displacement curve of a collapse."""

    load: float | None = None  # highest multiplier, internal
    displacement: float | None = None  # where the curve first came close to it or to the failure load [m]
    followed: float = 0.0  # how far the curve goes [m]
    hardens: bool = False  # more was carried after failure, however slowly it was followed


def softness(
    ratio: float, elastic: float, load: float, edge: float, until: float, settings: Settings = DEFAULT
) -> float:
    """Return the stiffness ratio kn·h/W for "auto" joints in a collapse.

    As stiff as the elastic displacement at failure asks, unless the way would take more than the most steps.
    ratio: kn·h/W in the search; elastic: largest elastic displacement per unit of multiplier there [m]; edge: smallest
    edge [m]; until: displacement to be followed [m].
    """
    post_peak = settings.post_peak
    softer = max(
        post_peak.elastic * edge / (elastic * max(load, settings.load_search.probe)),
        post_peak.steps * until / (elastic * post_peak.most),
    )
    return min(max(ratio / softer, post_peak.softest), post_peak.stiffest)


@dataclass
class _Following:
    """Progress of a collapse that is followed."""

    start: int  # steps before
    ceiling: float  # internal multiplier above which it is inertia
    chunk: int  # steps to the next look
    stage: str = "loading"
    next_frame: float = 0.0  # [m]
    highest: float = 0.0  # internal multiplier
    slowed: bool = False
    curve: list[tuple[float, float]] = field(default_factory=list)  # internal multipliers and displacements [m]

    def enter(self, load: float, failure: float, settings: PostPeakSettings) -> None:
        """Enter the mean internal multiplier of another look; a collapse begins where the load is that of failure."""
        if load > self.ceiling:
            self.ceiling = math.inf  # however slowly: it carries more, now that it has moved
        self.highest = max(self.highest, load)
        falls = self.highest > settings.falls_from * failure and load < settings.near_peak * self.highest
        if falls or load >= settings.near_peak * failure:
            self.stage = "collapse"

    def peak(self, failure: float, at_peak: float) -> CurvePeak:
        """Return the peak of the curve, once it is at its end."""
        close, end = at_peak * min(self.highest, failure), self.curve[-1][1]
        reached = next((moved for load, moved in self.curve if load >= close), end)
        return CurvePeak(self.highest, reached, end, self.ceiling == math.inf)


@stage
def follow(
    sim: Simulation, track: Track, rate: float, failure: float, until: float, frames: int, budget: Budget
) -> CurvePeak:
    """Creep at `rate` [J per step] until a block moved by `until` [m]; returns the peak of the curve.

    failure: internal multiplier of failure; rows and frames go to the track as they come. Where inertia lifts the
    load above it, the way goes on more slowly; after very many steps it ends where it is.
    """
    post_peak = sim.settings.post_peak
    way = _Following(sim.steps, post_peak.ceiling * failure, post_peak.first_look)
    if not sim.stages.resumed(way):
        relax(sim, 0.0, sim.settings.relaxation.gravity_tolerance)
        track.write("gravity")
        sim.use_combined_damping()
        soften_falls(sim, until)
        sim.prescribe_rate(rate / post_peak.growth**post_peak.start_up)
        way.start = sim.steps
    while True:
        sim.stages.offer(way)
        before = measures.largest_displacement(sim)
        way.slowed = _creep(sim, way.chunk, way.ceiling, budget) or (way.slowed and sim.rate < rate)
        moved = measures.largest_displacement(sim)
        load = sim.over_share(sim.mean_load)
        way.enter(load, failure, post_peak)
        done = moved >= until or sim.steps > way.start + post_peak.patience
        shown = load if way.slowed or sim.load > way.ceiling else sim.load  # that of an instant may be inertia
        track.write(way.stage, shown)
        way.curve.append((shown, moved))
        if done or (way.stage == "collapse" and moved >= way.next_frame):
            track.frame("collapse")
            way.next_frame = moved + until / max(frames - 3, 1)
        track.observer.progress("following the collapse", load * sim.live_scale, moved, min(moved / until, 1.0))
        if done:
            return way.peak(failure, post_peak.at_peak)
        sim.prescribe_rate(min((post_peak.growth_again if way.slowed else post_peak.growth) * sim.rate, rate))
        pace = abs(moved - before) / way.chunk
        wanted = until / post_peak.rows / pace if pace > 0.0 else 2 * way.chunk
        longest = post_peak.longest_look_before_peak if way.stage == "loading" else post_peak.longest_look
        longest = min(longest, post_peak.longest_look_slowed) if way.slowed else longest
        way.chunk = int(min(max(wanted, post_peak.shortest_look), 2 * way.chunk, longest))


def _creep(sim: Simulation, steps: int, ceiling: float, budget: Budget) -> bool:
    """Creep for so many steps; repeated more slowly, some times, as long as their mean load is above the ceiling.

    What is above the failure load is inertia and damping of blocks that are hurried. Returns whether it was slowed.
    """
    post_peak = sim.settings.post_peak
    for tries in range(post_peak.tries + 1):
        last = tries == post_peak.tries or ceiling == math.inf
        saved, rate = None if last else sim.save(), sim.rate
        sim.advance(steps, sim.creep_mode)
        budget.spend(steps, "following the collapse")
        check_finite(sim)
        if saved is None or sim.mean_load <= ceiling * sim.dead_share:
            break
        sim.restore(saved)
        sim.prescribe_rate(post_peak.slower * rate)
    return tries > 0


def soften_falls(sim: Simulation, until: float, steps: int | None = None) -> None:
    """Limit the speed of blocks that fall while others go a way of `until` [m] in so many steps (None: a collapse)."""
    post_peak = sim.settings.post_peak
    steps = post_peak.fewest if steps is None else steps
    sim.limit_speed(max(post_peak.fall_speed * sim.smallest, post_peak.fall_pace * until / steps))


def follow_load(sim: Simulation, track: Track, failure: float, until: float, frames: int, budget: Budget) -> None:
    """Follow the collapse under a constant load until a block moved by `until` [m]; where it is carried, a little
    more.

    failure: internal multiplier that was proved impossible. Rows and frames of the way up are those of the search.
    """
    post_peak = sim.settings.post_peak
    relax(sim, 0.0, sim.settings.relaxation.gravity_tolerance)
    soften_falls(sim, until)
    for share in post_peak.steps_up:
        if settle_or_fail(sim, share * failure, budget, measures.dead_scale(sim)).state != "equilibrium":
            break
    fall_under(sim, track, failure, until, frames, budget, post_peak.harder)


@dataclass
class _Falling:
    """Progress of a collapse under a constant load."""

    load: float  # internal multiplier
    calm: int = 0  # looks in a row at which forces balanced
    next_row: float = 0.0  # [m]
    next_frame: float = 0.0  # [m]


@stage
def fall_under(
    sim: Simulation, track: Track, load: float, until: float, frames: int, budget: Budget, harder: float | None = None
) -> bool:
    """Advance under a constant load until a block moved by `until` [m]; rows and frames of that.

    load: internal multiplier. harder: factor on the load wherever it holds after all; None: False is returned then.
    """
    relaxation, way = sim.settings.relaxation, _Falling(load)
    if not sim.stages.resumed(way):
        sim.use_combined_damping()
        sim.set_load(load)
    while measures.largest_displacement(sim) < until:
        sim.stages.offer(way)
        sim.advance(relaxation.chunk, slot.HOLD_LOAD)
        budget.spend(relaxation.chunk, "following the collapse")
        check_finite(sim)
        way.calm = way.calm + 1 if sim.unbalanced < relaxation.tolerance else 0
        if way.calm == relaxation.looks_at_rest:
            if harder is None:
                return False
            way.load, way.calm = harder * way.load, 0
            sim.set_load(way.load)
        moved = measures.largest_displacement(sim)
        if moved >= way.next_row:
            track.write("collapse")
            way.next_row = moved + until / sim.settings.post_peak.rows
        if moved >= way.next_frame:
            track.frame("collapse")
            way.next_frame = moved + until / max(frames - 3, 1)
        share = min(moved / until, 1.0)
        track.observer.progress("following the collapse", way.load * sim.live_scale, moved, share)
    track.write("collapse")
    track.frame("collapse")
    return True
