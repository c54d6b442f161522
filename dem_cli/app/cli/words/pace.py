"""Estimate the remaining time of a stage of a run, only where it is known."""

from __future__ import annotations

import re
from bisect import bisect_left

WATCHED = 10.0  # s that a stage must have run: what takes less has no estimate
SHARE = 0.05  # of the work of a stage that must be done
STEADY = 1.5  # the second half of the time did at most so many times the work of the first: else it accelerates
_EVERY = 0.1  # s between looks that are kept
_MOST = 512  # looks that are kept; then every other one goes
_COUNT = re.compile(r"[\d,.]+")


class Pace:
    """Progress rate of the current stage of a run; another stage begins anew."""

    def __init__(self) -> None:
        self.stage: str | None = None
        self.times: list[float] = []  # [s]
        self.shares: list[float] = []  # of the work, at these times

    def look(self, now: float, stage: str, share: float | None) -> None:
        """Record the share of the work that is done at a time [s]; None if unknown. `runs 3 of 9` is one stage."""
        stage = _COUNT.sub("", stage)
        if stage != self.stage or share is None or (self.shares and share < self.shares[-1]):
            self.stage, self.times, self.shares = stage, [], []
        if share is None or (self.times and now < self.times[-1] + _EVERY):
            return
        self.times.append(now)
        self.shares.append(share)
        if len(self.times) > _MOST:
            del self.times[1:-1:2], self.shares[1:-1:2]

    def left(self) -> float | None:
        """Estimate the remaining seconds of the stage; None where it is young, hardly begun or accelerates."""
        if not self.times:
            return None
        took, done = self.times[-1] - self.times[0], self.shares[-1] - self.shares[0]
        if took < WATCHED or done < SHARE:
            return None
        middle = bisect_left(self.times, self.times[0] + 0.5 * took)
        first = (self.shares[middle] - self.shares[0]) / (self.times[middle] - self.times[0])
        second = (self.shares[-1] - self.shares[middle]) / max(self.times[-1] - self.times[middle], _EVERY)
        if second <= 0.0 or second > STEADY * first:
            return None
        return (1.0 - self.shares[-1]) / second
