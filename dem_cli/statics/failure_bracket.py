"""The failure load as it was found: between a proven equilibrium and a proven failure, and the way to both."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dem_cli.engine.state import SavedState
    from dem_cli.limit.analysis import LimitLoads
    from dem_cli.statics.equilibrium import Verdict


@dataclass(frozen=True)
class LoadPass:
    """One creep or one constant load; multipliers as users know them."""

    kind: str  # "creep" | "start" | "load" | "impossible"
    steps: int
    load: float  # estimate of the creep, or the constant load
    state: str  # "estimate" | "equilibrium" | "failure"


@dataclass
class FailureLoad:
    """The failure load between two proofs, and the way to it; multipliers as users know them unless said otherwise."""

    low: float | None = None  # highest proven equilibrium
    high: float | None = None  # lowest proven failure
    scale: float = 1.0  # of users' multipliers over internal ones (Simulation.live_scale)
    status: str = "not converged"  # "ok" | "not converged" | "no failure" | "does not stand"
    compliance: float = 0.0  # q·u per unit of internal multiplier while elastic [J]
    elastic: float = 0.0  # largest displacement per unit of internal multiplier while elastic [m]
    settled: float = 0.0  # largest displacement of a block under the dead loads alone [m]
    onset: float | None = None  # lowest held load at which blocks had moved by more than joints deform
    peak_displacement: float = 0.0  # largest displacement of a block at the highest equilibrium [m]
    held: SavedState | None = None  # state of the highest equilibrium
    found: bool = False  # the bracket is as narrow as it was asked for
    failing: Verdict | None = None
    crept: float | None = None  # internal multiplier of the equilibrium in which the creep ended, if it did
    crept_state: SavedState | None = None
    limit: float = 0.0  # multiplier above which nothing was tried
    passes: list[LoadPass] = field(default_factory=list)
    start: dict[str, Any] = field(default_factory=dict)  # how the structure came next to failure
    limits: LimitLoads | None = None  # limit analysis that the start needed

    @property
    def carried(self) -> float:
        """The highest proven equilibrium, where there is one."""
        assert self.low is not None
        return self.low

    @property
    def failed(self) -> float:
        """The lowest proven failure, where there is one."""
        assert self.high is not None
        return self.high

    @property
    def standing(self) -> SavedState:
        """State of the highest equilibrium, where there is one."""
        assert self.held is not None
        return self.held

    @property
    def crept_beyond(self) -> bool:
        """Whether the creep came to rest above the proven failure: what is carried depends on the way of loading."""
        if not self.found or self.crept is None or self.high is None:
            return False
        return self.crept * self.scale > self.high


@dataclass(frozen=True)
class SearchRange:
    """How closely and how far a failure load is sought; multipliers as users know them."""

    resolution: float  # width of the bracket, relative
    max_load: float | None = None  # above it the structure counts as self-locking; None: a hundred times the dead loads
    longest: float | None = None  # step of the load that is never exceeded; then nothing is estimated first
