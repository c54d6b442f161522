"""Time step of a time history: a share of the largest stable one, 2/ω_max, and what limits it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dem_cli.core.arithmetic.functions import agreed
from dem_cli.core.dynamics.frequencies import limiting
from dem_cli.core.dynamics.landing import landing
from dem_cli.errors import CaseError, CaseProblem

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation

DEFAULT_MARGIN = 0.5  # of the limit: joints that blocks meet later may be stiffer, and the error goes with the square


class TimeStep(NamedTuple):
    """Stable time step, its limit and the blocks that set it."""

    step: float  # [s]
    limit: float  # the largest stable one, 2/ω_max [s]
    highest: float  # ω_max [rad/s]
    exact: bool  # False: ω_max is a bound above the eigenvalue
    blocks: tuple[str, ...]  # the block that moves most in the fastest vibration, and the one across its joint, if any
    held: bool = True  # False: no joint holds any block yet

    @property
    def cause(self) -> str:
        """Describe which vibration limits the time step."""
        if not self.blocks:
            return "nothing can vibrate"
        named = " on ".join(f"'{name}'" for name in self.blocks)
        named += " where it lands on a face" if len(self.blocks) == 1 else ""
        return f"{named} vibrates at {'' if self.exact else 'no more than '}{self.highest / (2 * math.pi):.4g} Hz"


def time_step(
    sim: Simulation, margin: float = DEFAULT_MARGIN, forced: float | None = None, stiffer: float = 1.0
) -> TimeStep:
    """Compute the time step: `forced` [s] where it is given, else margin · 2/ω_max.

    stiffer: what Maxwell elements multiply frequencies by. Dashpots do not come into it: they are implicit
    (docs/numerics.md). All contact points in the list count as
    closed; a block that no joint holds counts as lying on the face on which it vibrates fastest. Both times are
    infinite where nothing can vibrate. Raises CaseError where `forced` is not stable.
    """
    highest, (loose, pebble) = limiting(sim), landing(sim)
    highest = highest._replace(frequency=agreed(highest.frequency))
    names: tuple[str, ...] = ()
    if loose > highest.frequency:
        names = (sim.model.block_ids[pebble],)
    elif highest.block >= 0:
        a, b = sim.joints.blocks[highest.joint].tolist() if highest.joint >= 0 else (highest.block, -1)
        other = b if a == highest.block else a
        names = tuple(sim.model.block_ids[i] if i >= 0 else "a tie" for i in (highest.block, other))
    frequency = max(highest.frequency, loose)
    limit = 2.0 / (stiffer * frequency) if frequency > 0.0 else math.inf
    exact = highest.exact or loose > highest.frequency
    found = TimeStep(margin * limit, limit, frequency, exact, names, highest.frequency > 0.0)
    if forced is None:
        return found
    if forced > limit:
        message = (
            f"{forced:g} s is above the largest stable step, {limit:.4g} s: {found.cause}; "
            f"leave it out for {found.step:.4g} s, or soften the joints"
        )
        raise CaseError([CaseProblem(("analysis", "time_step"), message)])
    return found._replace(step=forced)
