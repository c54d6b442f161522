"""Bracket of a failure load: between a proven equilibrium and a proven failure, with the search that led there."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dem_cli.core.engine.state import SavedState
    from dem_cli.core.statics.equilibrium import Verdict
    from dem_cli.core.statics.rigid_limits import RigidLimits


OK, NOT_CONVERGED, NO_FAILURE = "ok", "not converged", "no failure"
EXISTS = "an equilibrium exists at this load"  # of a requested start, which nothing says is reached


@dataclass(frozen=True)
class LoadPass:
    """Creep or constant load tried in the search; multipliers as users know them."""

    kind: str  # "creep" | "start" | "load" | "impossible"
    steps: int
    load: float  # estimate of the creep, or the constant load
    state: str  # "estimate" | "equilibrium" | "failure" | "unknown"


@dataclass
class FailureLoad:
    """Failure load between two proofs, and the search for it; multipliers as users know them unless said otherwise."""

    low: float | None = None  # highest proven equilibrium
    high: float | None = None  # lowest proven failure
    scale: float = 1.0  # of users' multipliers over internal ones (Simulation.live_scale)
    status: str = NOT_CONVERGED  # OK | NOT_CONVERGED | NO_FAILURE | EXISTS | "does not stand"
    compliance: float = 0.0  # q·u per unit of internal multiplier while elastic [J]
    elastic: float = 0.0  # largest displacement per unit of internal multiplier while elastic [m]
    settled: float = 0.0  # largest displacement of a block under the dead loads alone [m]
    onset: float | None = None  # lowest held load at which blocks had moved by more than joints deform
    peak_displacement: float = 0.0  # largest displacement of a block at the highest equilibrium [m]
    held: SavedState | None = None  # state of the highest equilibrium
    found: bool = False  # the load is known, to the requested resolution or `wide`
    wide: bool = False  # the bracket is wider than the requested resolution
    failing: Verdict | None = None
    impossible: bool = False  # limit analysis proved that nothing is in equilibrium there; the motion shows it
    failed_from: SavedState | None = None  # equilibrium from which the lowest failure began
    failed_state: SavedState | None = None  # of the lowest failure
    crept: float | None = None  # internal multiplier of the equilibrium in which the creep ended, if it did
    crept_state: SavedState | None = None
    limit: float = 0.0  # multiplier above which nothing was tried
    passes: list[LoadPass] = field(default_factory=list)
    earlier: tuple[float, float] | None = None  # bracket of loads raised in larger steps, where that made a difference
    undecided: list[float] = field(default_factory=list)  # loads at which neither was proved
    start: dict[str, Any] = field(default_factory=dict)  # how the structure came next to failure
    limits: RigidLimits | None = None  # limit analysis of the same structure
    raised: float | None = None  # highest load that was raised from gravity beside an implicit history
    path_of_start: float | None = None  # where blocks move: load of the zero-dilation path in the geometry of the start
    alone: str = ""  # why no second history stands beside the load, where one was looked for

    @property
    def carried(self) -> float:
        """Return the highest proven equilibrium, where there is one."""
        assert self.low is not None
        return self.low

    @property
    def failed(self) -> float:
        """Return the lowest proven failure, where there is one."""
        assert self.high is not None
        return self.high

    @property
    def standing(self) -> SavedState:
        """State of the highest equilibrium, where there is one."""
        assert self.held is not None
        return self.held

    @property
    def bound(self) -> float | None:
        """Multiplier above which limit analysis proved equilibrium impossible, where it is known."""
        return self.limits.bound if self.limits is not None else None

    @property
    def width(self) -> float | None:
        """Width of the bracket, relative; None where one side is missing or nothing is carried."""
        return None if self.high is None or not self.low else (self.high - self.low) / abs(self.low)

    def begin_again(self, at_rest: SavedState) -> None:
        """Forget the bracket, but for its loads; at_rest: state under the dead loads alone."""
        self.earlier = (self.carried, self.failed)
        self.low, self.high, self.held = 0.0, None, at_rest
        self.found, self.wide, self.status, self.undecided = False, False, NOT_CONVERGED, []
        self.failing = self.failed_from = self.failed_state = self.onset = None

    def withdraw_failure(self) -> None:
        """Forget the lowest failure, as a load above it is carried now: the step to it had been too large."""
        self.high, self.failing, self.failed_from, self.failed_state, self.impossible = None, None, None, None, False

    def ends_beyond_its_path(self, resolution: float) -> bool:
        """Test whether a search from the path carries more than its plateau: blocks that wedged."""
        path = self.limits.path if self.limits is not None and self.start.get("kind") == "path" else None
        load = None if path is None or not path.finished else path.load
        return self.found and load is not None and self.carried > (1.0 + 2.0 * resolution) * load

    def end_undecided(self, widest: float) -> None:
        """Close a search before the bracket is narrow: both sides are the answer, if they are not too far apart.

        widest: bracket, relative, that still is an answer. What limit analysis proved impossible is a side as well.
        """
        bound = self.bound
        if bound is not None and (self.high is None or bound < self.high) and bound > (self.low or 0.0):
            self.high, self.failing, self.failed_from, self.failed_state = bound, None, None, None
        self.wide = True
        if self.width is not None and self.width <= widest:
            self.found, self.status = True, OK

    @property
    def crept_beyond(self) -> bool:
        """Test whether the creep came to rest above the proven failure: the load carried depends on the way of
        loading."""
        if not self.found or self.crept is None or self.high is None:
            return False
        return self.crept * self.scale > self.high


@dataclass(frozen=True)
class SearchRange:
    """Resolution and largest load of the search for a failure load; multipliers as users know them."""

    resolution: float  # width of the bracket, relative
    max_load: float | None = None  # above it the structure counts as self-locking; None: a hundred times the dead loads
    longest: float | None = None  # step of the load that is never exceeded; then nothing is estimated first
