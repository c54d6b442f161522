"""Trial loads: choice of the next load on the way to a bracket of the failure load.

Up in steps until one fails, back by halves until the bracket is narrow, and round loads that stay undecided: one that
happens to lie within 1e-4 of the failure load creeps for ever.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from dem_cli.core.engine.static_settings import LoadSearchSettings


@dataclass
class TrialLoads:
    """Bracket of the failure load that is proved so far, and the next load to try; internal multipliers."""

    settings: LoadSearchSettings
    resolution: float  # width of the bracket, relative
    low: float  # highest load that is carried
    levels: list[float]  # to be tried first, upwards
    step: float  # from the last of them on
    longest: float = float("inf")  # step of the load that is never exceeded
    limit: float = float("inf")  # load above which nothing is tried
    goal: float = 0.0  # load that is known to be carried, to which steps of one length lead
    high: float | None = None  # lowest load that fails
    undecided: list[float] = field(default_factory=list)  # between them
    jumped: bool = False  # the failure came after a jump, which may break what a gentler step does not
    leaps: bool = False  # the last load was one of the levels: right below a failure there is the next trial

    def __post_init__(self) -> None:
        self._first_step = self.step

    @property
    def width(self) -> float:
        """Requested width of the bracket."""
        return self.resolution * max(abs(self.low), self.settings.least)

    @property
    def closed(self) -> bool:
        """Test whether the bracket is as narrow as requested."""
        return self.high is not None and self.high - self.low <= self.width

    @property
    def to_come(self) -> float:
        """Return the number of load steps that remain to its goal."""
        return max(self.goal - self.low, 0.0) / self.longest if self.high is None else 0.0

    def next(self) -> float | None:
        """Return the next load to try; None where the bracket is narrow enough, or cannot be made any narrower."""
        if self.high is None:
            return self._upwards()
        if self.closed:
            return self.high if self.jumped else None
        if not self.undecided:
            return self._next_below() or 0.5 * (self.low + self.high)
        if len(self.undecided) > self.settings.most_undecided:
            return None
        aside = self.settings.aside * self.width * 2.0 ** (len(self.undecided) - 1)
        below, above = min(self.undecided) - aside, max(self.undecided) + aside
        nearest = 0.1 * aside  # the rest of the bracket is not worth a trial
        if below - self.low > nearest:
            return below
        return above if self.high - above > nearest else None

    def _next_below(self) -> float | None:
        """Return once, after a jump to a level that failed, the load of bisection that closes the bracket."""
        leaps, self.leaps = self.leaps, False
        if self.high is None or not (leaps and self.jumped and self.high - self.low <= self.settings.leap * self.low):
            return None
        load = self.low
        while self.high - load > self.resolution * max(abs(load), self.settings.least):
            load = 0.5 * (load + self.high)
        return load

    def _upwards(self) -> float | None:
        if self.low >= self.limit or len(self.undecided) > self.settings.most_undecided:
            return None
        reached = max([self.low, *self.undecided])
        self.levels = [load for load in self.levels if load > reached]
        self.leaps = bool(self.levels)
        if self.levels:
            return min(self.levels.pop(0), self.limit)
        load = reached + self.step
        self.step = min(self.settings.growth * self.step, self.longest)
        return min(load, self.limit)

    def carries(self, load: float) -> None:
        """Enter a load that is carried; where it had failed after a jump, the search goes on upwards."""
        if self.high is not None and load >= self.high:
            self.high, self.step, self.jumped = None, self._first_step, False
        self.low = load
        self.undecided = [other for other in self.undecided if other > load]

    def fails(self, load: float, for_certain: bool = False) -> None:
        """Enter a load that fails; for_certain: whatever the step to it."""
        far = self.settings.jump * self.resolution * max(abs(self.low), self.settings.least)
        self.high, self.jumped = load, not for_certain and load - self.low > far
        self.undecided = [other for other in self.undecided if other < load]

    def leaves(self, load: float) -> None:
        """Enter a load that was neither carried nor failed in as many steps as a trial may take."""
        if self.high is not None and load >= self.high:
            self.jumped = False  # it failed before
        else:
            self.undecided = sorted([*self.undecided, load])
