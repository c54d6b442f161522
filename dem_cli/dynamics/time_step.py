"""The time step of a time history: a share of the largest stable one, 2/ω_max, and what limits it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dem_cli.dynamics.frequencies import limiting
from dem_cli.errors import CaseError, CaseProblem

if TYPE_CHECKING:
    from dem_cli.engine.simulation import Simulation

DEFAULT_MARGIN = 0.5  # of the limit: joints that blocks meet later may be stiffer, and the error goes with the square


class TimeStep(NamedTuple):
    """A stable time step."""

    step: float  # [s]
    limit: float  # the largest stable one, 2/ω_max [s]
    highest: float  # ω_max [rad/s]
    exact: bool  # False: ω_max is a bound above the eigenvalue
    blocks: tuple[str, ...]  # the block that moves most in the fastest vibration, and the one across its joint

    @property
    def cause(self) -> str:
        """What sets the limit, in words."""
        if not self.blocks:
            return "no joint holds any block"
        named = " on ".join(f"'{name}'" for name in self.blocks)
        return f"{named} vibrates at {'' if self.exact else 'no more than '}{self.highest / (2 * math.pi):.4g} Hz"


def time_step(
    sim: Simulation, margin: float = DEFAULT_MARGIN, forced: float | None = None, stiffer: float = 1.0
) -> TimeStep:
    """The step to use: `forced` [s] where it is given, else margin · 2/ω_max.

    stiffer: what Maxwell elements multiply frequencies by. Dashpots do not come into it: they are implicit
    (docs/numerics.md). All contact points in the list count as
    closed. Both times are infinite where no joint holds any block. Raises CaseError where `forced` is not stable.
    """
    highest = limiting(sim)
    limit = 2.0 / (stiffer * highest.frequency) if highest.frequency > 0.0 else math.inf
    names: tuple[str, ...] = ()
    if highest.block >= 0:
        a, b = sim.joints.blocks[highest.joint].tolist()
        names = tuple(sim.model.block_ids[i] for i in (highest.block, b if a == highest.block else a))
    found = TimeStep(margin * limit, limit, highest.frequency, highest.exact, names)
    if forced is None:
        return found
    if forced > limit:
        message = (
            f"{forced:g} s is above the largest stable step, {limit:.4g} s: {found.cause}; "
            f"leave it out for {found.step:.4g} s, or soften the joints"
        )
        raise CaseError([CaseProblem(("analysis", "time_step"), message)])
    return found._replace(step=forced)
