"""Agreement of methods: loads of other histories and the bound of limit analysis beside a failure load.

Joints that slide without dilating leave the failure load to the history of loading: several loads may be true. Where
the bracket holds the bound by limit analysis and nothing slides in any of its mechanisms, the load is the only one.
Else a second history from gravity, by another method, says whether the first one can be trusted; where they differ by
more than the resolution, a run says so.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from dem_cli.core.statics.failure_bracket import FailureLoad
from dem_cli.core.statics.warm_start import CURVE, IMPLICIT
from dem_cli.core.statics.warm_start import PATH as AT_PATH

RAISED, IN_LARGE_STEPS, PATH, CREEP = "raised from gravity", "in larger steps", "zero-dilation path", "creep"
IN_IMPLICIT_STEPS = "implicit steps under load"
FROM_CURVE, PATH_OF_START = "displacement control", "zero-dilation path of the start"
HOLDS = 2e-4  # of the bound, that it may lie outside a bracket that holds it: failure is shown a little above
LIMIT = "limit analysis"  # where nothing slides in its mechanism: then rigid blocks carry its load on any history


class History(NamedTuple):
    """Load history from gravity to failure, and the load at its end; multiplier as users know it."""

    method: str  # one of the names above; PATH as well where a search began at its end
    load: float
    finished: bool  # False: at least this load

    def summary(self) -> dict[str, Any]:
        """Return the entries of summary.json about the history."""
        return self._asdict()


def at_the_bound(search: FailureLoad, resolution: float) -> bool:
    """Test whether the failure load is the bound of a mechanism without sliding, so that no second history is due."""
    bound, high, limits = search.bound, search.high, search.limits
    if bound is None or high is None or limits is None:
        return False
    return bool(bound <= high + resolution * abs(high)) and not limits.slides


def unique(search: FailureLoad) -> bool:
    """Test whether no other failure load is possible: the bracket contains the bound, and no mechanism of it
    slides."""
    bound, low, high, limits = search.bound, search.low, search.high, search.limits
    if bound is None or low is None or high is None or limits is None or not search.found:
        return False
    margin = HOLDS * abs(bound)
    return bool(low - margin <= bound <= high + margin) and limits.none_slides


def histories(search: FailureLoad) -> list[History]:
    """List all histories to failure that were tried, that of the answer first."""
    way = {CURVE: FROM_CURVE, AT_PATH: PATH, IMPLICIT: IN_IMPLICIT_STEPS}.get(str(search.start.get("kind")), RAISED)
    found = [] if search.low is None else [History(way, search.low, search.found and not search.wide)]
    if way == IN_IMPLICIT_STEPS and search.raised is not None:
        found.append(History(RAISED, search.raised, False))
    if search.earlier is not None:
        found.append(History(IN_LARGE_STEPS, search.earlier[0], True))
    limits = search.limits
    path = limits.path if way != PATH and limits is not None and limits.followed else None
    if path is not None and path.load is not None:
        found.append(History(PATH, path.load, path.finished))
    if search.path_of_start is not None:
        found.append(History(PATH_OF_START, search.path_of_start, True))
    if limits is not None and search.bound is not None and not limits.slides:
        found.append(History(LIMIT, search.bound, True))
    if search.crept_beyond and search.crept is not None:
        found.append(History(CREEP, search.crept * search.scale, False))
    return found


def load_range(search: FailureLoad, resolution: float) -> dict[str, Any] | None:
    """Return the range of loads at which histories end, where they differ by more than the resolution; None: they
    agree."""
    if not search.found or search.high is None:
        return None
    low, high = search.carried, search.high
    margin = resolution * max(abs(low), abs(high))
    first, *others = found = histories(search)
    if any(one.method == PATH and one.finished and low - margin <= one.load <= high + margin for one in found):
        # Where joints lock because they dilate, nothing slides in the mechanism of the bound, far above any history.
        others = [one for one in others if one.method != LIMIT]
    apart = [other for other in others if other.load > high + margin or (other.finished and other.load < low - margin)]
    if not apart:
        return None
    loads = [low, *(other.load for other in apart)]
    named = ", ".join(f"{_at_least(other)}{other.load:.5g} by {_BY[other.method]}" for other in apart)
    way = _WAYS.get(first.method, "raised from gravity in steps")
    if any(other.method == PATH_OF_START for other in apart):
        way += f" (blocks have moved by {search.peak_displacement:.2g} m there)"
    why = f"{low:.5g} {way}, {named}"
    return {"lowest": float(min(loads)), "highest": float(max(loads)), "why": why}


_WAYS = {PATH: "from the end of the zero-dilation path", IN_IMPLICIT_STEPS: "in implicit steps from gravity"}


def _at_least(history: History) -> str:
    return "" if history.finished else "at least "


_BY = {
    IN_LARGE_STEPS: "larger steps",
    PATH: "the zero-dilation path",
    PATH_OF_START: "the zero-dilation path in the geometry of the start",
    LIMIT: "limit analysis without any sliding",
    CREEP: "a creep that came to rest",
}


def _reached(search: FailureLoad) -> str:
    """Describe the lower side of a wide bracket."""
    if search.start.get("kind") != AT_PATH:
        return "reached from gravity: at least"
    path = search.limits.path if search.limits is not None else None
    if path is not None and path.smoothing:
        return "reached from gravity by a smoothed path: at least"
    return "reached from the zero-dilation path: at least"


def _alone_beyond_its_path(search: FailureLoad, resolution: float) -> bool:
    """Test whether the load was raised beyond the end of a path without a plateau, so that one history stands
    alone."""
    path = search.limits.path if search.start.get("kind") == AT_PATH and search.limits is not None else None
    if path is None or path.load is None or path.finished or not search.found or search.wide:
        return False
    return search.carried > (1.0 + resolution) * path.load and not at_the_bound(search, resolution)


def percent(share: float) -> str:
    """Format a share in per cent with two digits, in full where it is large: "0.18 %", "107 %", not "1.1e+02 %"."""
    value = 100.0 * share
    return f"{value:.0f} %" if abs(value) >= 99.5 else f"{value:.2g} %"


def doubts(search: FailureLoad, resolution: float, spread: dict[str, Any] | None) -> list[str]:
    """Return the warnings where histories differ, or where the bracket is wider than the requested resolution."""
    said = []
    if spread is not None:
        share = (spread["highest"] - spread["lowest"]) / spread["highest"]
        said.append(f"methods differ by {percent(share)}, which may be the way of loading: {spread['why']}")
    if _alone_beyond_its_path(search, resolution):
        said.append(
            f"the path was not followed to its end: from there the load was raised in steps to {search.carried:.5g}, "
            "and no second history says whether others end lower"
        )
    if search.alone:
        said.append(f"no second history says whether others end lower: {search.alone}")
    if search.wide and search.width is not None and search.width > resolution:
        said.append(
            f"{_reached(search)} {search.carried:.5g}; not above {search.failed:.5g}: this bracket "
            f"of {percent(search.width)} is wider than the {percent(resolution)} asked for"
        )
    return said
