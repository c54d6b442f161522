"""After failure: the collapse at a prescribed rate, with geometry that moves.

The live load keeps prescribing the rate of its own displacement, so that the multiplier is found along
the whole way, down to nothing where a wall overturns by itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dem_cli.kernels import records as slot
from dem_cli.model.model import Model
from dem_cli.solve.equilibrium import COMBINED, CREEP_SAFETY, GRAVITY_TOLERANCE, Budget, check_finite, relax
from dem_cli.solve.joints import FIXED_RATIO
from dem_cli.solve.run import simulation
from dem_cli.solve.track import Track

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.solve.simulation import Simulation

ELASTIC = 2e-3  # elastic displacement at failure that "auto" joints may show, in smallest edges
STEPS = 200  # steps in which the rate passes the elastic displacement of a multiplier of one
ROWS = 250  # history rows
SOFTEST, STIFFEST = 1e3, 1e7  # kn·h/W
NEAR_PEAK = 0.97  # share of the failure load at which loading counts as over


def simulate(case: Case, model: Model, elastic: float, load: float, scale: float) -> tuple[Simulation, float]:
    """A simulation with moving geometry, and how much softer its joints are.

    elastic: largest elastic displacement at failure of the stiff simulation [m]; scale: smallest edge [m].
    """
    ratio = min(max(FIXED_RATIO * elastic * load / (ELASTIC * scale), SOFTEST), STIFFEST)
    automatic = any(joint.kn == "auto" for joint in case.joints.values())
    return simulation(case, model, "large", ratio), (FIXED_RATIO / ratio if automatic else 1.0)


def follow(
    sim: Simulation, track: Track, rate: float, failure: float, until: float, frames: int, budget: Budget
) -> dict[str, float]:
    """Creep at `rate` [J per step] until a block moved by `until` [m]; returns the peak of the curve.

    failure: internal multiplier of failure; rows and frames go to the track as they come.
    """
    relax(sim, 0.0, GRAVITY_TOLERANCE)
    track.write("gravity")
    sim.use(CREEP_SAFETY, COMBINED, COMBINED)
    sim.control[slot.RATE] = rate
    stage, next_frame, chunk = "loading", 0.0, 50
    peak = {"load": 0.0, "displacement": 0.0}
    while True:
        before = sim.largest_displacement()
        sim.advance(chunk, sim.creep_mode)
        budget.spend(chunk, "following the collapse")
        check_finite(sim)
        moved = sim.largest_displacement()
        load = sim.control[slot.MEAN_LOAD] / sim.control[slot.DEAD_FACTOR]
        if load > peak["load"] and stage == "loading":
            peak = {"load": load, "displacement": moved}
        done = moved >= until
        wants_frame = done or moved >= next_frame
        if stage == "loading" and load >= NEAR_PEAK * failure:
            stage, wants_frame = "collapse", True
        track.write(stage, frame=wants_frame)
        track.observer.progress("following the collapse", load * sim.live_scale, moved, min(moved / until, 1.0))
        if done:
            return peak
        if wants_frame:
            next_frame = moved + until / max(frames - 2, 1)
        pace = abs(moved - before) / chunk
        chunk = int(min(max(until / ROWS / pace if pace > 0.0 else 2 * chunk, 20), 2 * chunk, 20_000))

