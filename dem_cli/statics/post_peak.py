"""Post-peak path: the collapse at a prescribed rate or under the load of failure, with geometry that moves.

Where the live load keeps prescribing the rate of its own displacement, the multiplier is found along the whole
way, down to nothing where a wall overturns by itself. Where the load stays, blocks that slide leave the others
behind, as on a tilting table.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dem_cli.engine import measures
from dem_cli.engine.budget import Budget
from dem_cli.engine.settings import DEFAULT, Settings
from dem_cli.engine.track import Track
from dem_cli.kernels import records as slot
from dem_cli.statics.equilibrium import check_finite, relax, settle_or_fail

if TYPE_CHECKING:
    from dem_cli.engine.simulation import Simulation


class CurvePeak(NamedTuple):
    """The peak of the curve of a collapse."""

    load: float | None = None  # highest multiplier, internal
    displacement: float | None = None  # where the curve first came close to it or to the failure load [m]
    followed: float = 0.0  # how far the curve goes [m]
    hardens: bool = False  # more was carried after failure, however slowly it was followed


def softness(
    ratio: float, elastic: float, load: float, edge: float, until: float, settings: Settings = DEFAULT
) -> float:
    """kn·h/W for "auto" joints in a collapse.

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


def follow(
    sim: Simulation, track: Track, rate: float, failure: float, until: float, frames: int, budget: Budget
) -> CurvePeak:
    """Creep at `rate` [J per step] until a block moved by `until` [m]; returns the peak of the curve.

    failure: internal multiplier of failure; rows and frames go to the track as they come. Where inertia lifts the
    load above it, the way goes on more slowly; after very many steps it ends where it is.
    """
    relaxation, post_peak = sim.settings.relaxation, sim.settings.post_peak
    relax(sim, 0.0, relaxation.gravity_tolerance)
    track.write("gravity")
    sim.use_combined_damping()
    soften_falls(sim, until)
    sim.prescribe_rate(rate / post_peak.growth**post_peak.start_up)
    stage, next_frame, chunk = "loading", 0.0, post_peak.first_look
    curve: list[tuple[float, float]] = []
    start, highest, slowed, ceiling = sim.steps, 0.0, False, post_peak.ceiling * failure
    while True:
        before = measures.largest_displacement(sim)
        slowed = _creep(sim, chunk, ceiling, budget) or (slowed and sim.rate < rate)
        moved = measures.largest_displacement(sim)
        load = sim.mean_load / sim.dead_share
        if load > ceiling:
            ceiling = math.inf  # however slowly: it carries more, now that it has moved
        done = moved >= until or sim.steps > start + post_peak.patience
        highest = max(highest, load)
        falls = highest > post_peak.falls_from * failure and load < post_peak.near_peak * highest
        if falls or load >= post_peak.near_peak * failure:
            stage = "collapse"
        shown = load if slowed or sim.load > ceiling else sim.load  # that of an instant may be inertia
        track.write(stage, shown)
        curve.append((shown, moved))
        if done or (stage == "collapse" and moved >= next_frame):
            track.frame("collapse")
            next_frame = moved + until / max(frames - 3, 1)
        track.observer.progress("following the collapse", load * sim.live_scale, moved, min(moved / until, 1.0))
        if done:
            close = post_peak.at_peak * min(highest, failure)
            reached = next((moved for load, moved in curve if load >= close), moved)
            return CurvePeak(highest, reached, moved, ceiling == math.inf)
        sim.prescribe_rate(min((post_peak.growth_again if slowed else post_peak.growth) * sim.rate, rate))
        pace = abs(moved - before) / chunk
        wanted = until / post_peak.rows / pace if pace > 0.0 else 2 * chunk
        longest = post_peak.longest_look_before_peak if stage == "loading" else post_peak.longest_look
        longest = min(longest, post_peak.longest_look_slowed) if slowed else longest
        chunk = int(min(max(wanted, post_peak.shortest_look), 2 * chunk, longest))


def _creep(sim: Simulation, steps: int, ceiling: float, budget: Budget) -> bool:
    """So many steps of a creep; done again more slowly, some times, as long as their mean load is above the ceiling.

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
    """Limits the speed of blocks that fall while others go a way of `until` [m] in so many steps (None: a collapse)."""
    post_peak = sim.settings.post_peak
    steps = post_peak.fewest if steps is None else steps
    sim.limit_speed(max(post_peak.fall_speed * sim.smallest, post_peak.fall_pace * until / steps))


def follow_load(sim: Simulation, track: Track, failure: float, until: float, frames: int, budget: Budget) -> None:
    """The collapse under a constant load until a block moved by `until` [m]; where it holds after all, a little more.

    failure: internal multiplier that was proved impossible. Rows and frames of the way up are those of the search.
    """
    post_peak = sim.settings.post_peak
    relax(sim, 0.0, sim.settings.relaxation.gravity_tolerance)
    soften_falls(sim, until)
    for share in post_peak.steps_up:
        if settle_or_fail(sim, share * failure, budget, measures.dead_scale(sim)).state != "equilibrium":
            break
    fall_under(sim, track, failure, until, frames, budget, post_peak.harder)


def fall_under(
    sim: Simulation, track: Track, load: float, until: float, frames: int, budget: Budget, harder: float | None = None
) -> bool:
    """On from the present state under a constant load until a block moved by `until` [m]; rows and frames of that.

    load: internal multiplier. harder: factor on the load wherever it holds after all; None: False is returned then.
    """
    relaxation = sim.settings.relaxation
    sim.use_combined_damping()
    calm, next_row, next_frame = 0, 0.0, 0.0
    sim.set_load(load)
    while measures.largest_displacement(sim) < until:
        sim.advance(relaxation.chunk, slot.HOLD_LOAD)
        budget.spend(relaxation.chunk, "following the collapse")
        check_finite(sim)
        calm = calm + 1 if sim.unbalanced < relaxation.tolerance else 0
        if calm == relaxation.looks_at_rest:
            if harder is None:
                return False
            load, calm = harder * load, 0
            sim.set_load(load)
        moved = measures.largest_displacement(sim)
        if moved >= next_row:
            track.write("collapse")
            next_row = moved + until / sim.settings.post_peak.rows
        if moved >= next_frame:
            track.frame("collapse")
            next_frame = moved + until / max(frames - 3, 1)
        track.observer.progress("following the collapse", load * sim.live_scale, moved, min(moved / until, 1.0))
    track.write("collapse")
    track.frame("collapse")
    return True
