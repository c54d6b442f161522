"""Verdicts on the answers of all methods on one structure: bounds that are broken, disagreements that nobody is told.

A finding is a name and a sentence. `reported` is the one place that knows how a run says that other methods disagree.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

from studies.stress.random_structures.methods import DEFAULT, Answer

RESOLUTION = 0.002  # of analysis.resolution: methods that are as near as that agree
SLACK = 1e-3  # of a bound, that the accuracy of equilibria may take
SAME = 1e-3  # associated and lowest load as near as that: the load is known
FALLS, LOCKED, SOLVED = "does not stand", "no failure", "ok"
ZERO_DILATION = "dem limit"  # its path of joints that do not dilate
EXISTS = "an equilibrium exists"  # of a start that claims no failure load

Finding = tuple[str, str]
ABOVE, BELOW, STANDS_OR_FALLS = "above the associated load", "below the lowest load", "stands or falls"
UNFINISHED, CRASHED, ASSOCIATED, SILENT = "no answer", "crashed", "associated loads differ", "silent disagreement"
FAULTS = (ABOVE, BELOW, STANDS_OR_FALLS, CRASHED, ASSOCIATED, SILENT)  # what must not be; without UNFINISHED


def reported(summary: Mapping[str, Any], load: float) -> bool:
    """Whether a run says itself that another method may come to such a load: in its range, or below an open bound."""
    span = summary.get("load_range")
    near = 2.0 * RESOLUTION  # loads are the middle of brackets, ranges end where one begins
    inside = span and span["lowest"] * (1.0 - near) <= load <= span["highest"] * (1.0 + near)
    low, _ = summary.get("failure_load_bracket") or (None, None)
    bound = summary.get("bound")
    left_open = (
        summary.get("unique") is False and None not in (low, bound) and low <= load <= bound * (1.0 + RESOLUTION)
    )
    return bool(inside or left_open)


def claimed(found: Answer) -> float | None:
    """The load that an answer says is carried: the failure load, an equilibrium, the highest that was tried."""
    if found["status"].startswith(LOCKED):
        return found["failure_load_bracket"][0]
    return found.get("failure_load") or found.get("equilibrium_load")


def bracket(found: Answer) -> tuple[float, float] | None:
    """Highest load that stands and lowest that fails, of an answer that has both."""
    low, high = found.get("failure_load_bracket") or (None, None)
    return None if low is None or high is None or found["status"] != SOLVED else (low, high)


def apart(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Relative distance of two brackets; 0 where they meet."""
    gap = max(one[0] - other[1], other[0] - one[1], 0.0)
    return gap / max(one[1], other[1], 1e-9)


def claims(row: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """Failure loads of all methods that give one, each as a bracket.

    Limit analysis says itself that it closes no gaps: where geometry moves, its path is that of another structure.
    """
    known = {name: found for name, answer in row["answers"].items() if (found := bracket(answer))}
    moves = row["answers"].get(DEFAULT, {}).get("kinematics") == "large"
    path = None if moves else row["limit"].get("non_associated")
    return known if path is None else known | {ZERO_DILATION: (path, path)}


def disagreements(row: Mapping[str, Any]) -> list[tuple[str, str, float]]:
    """Pairs of methods whose brackets are further apart than the resolution, and by how much of the load."""
    known = claims(row)
    pairs = ((a, b, apart(known[a], known[b])) for a, b in combinations(known, 2))
    return [(a, b, gap) for a, b, gap in pairs if gap > RESOLUTION]


def findings(row: Mapping[str, Any]) -> list[Finding]:
    """All that is wrong with the answers in a record of the study."""
    found: list[Finding] = []
    for name, answer in row["answers"].items():
        found += of_bounds(name, answer, bound_of(row), row["lowest"])
    found += of_limit_analysis(row["limit"], bound_of(row))
    return [*found, *unsaid(row)]


def bound_of(row: Mapping[str, Any]) -> float | None:
    """Associated load of a record; infinite: no load makes it fail, None: it does not stand."""
    load = row["associated"]
    return math.inf if load is None and row["stands"] else load


def of_bounds(name: str, answer: Answer, associated: float | None, lowest: float | None) -> Iterator[Finding]:
    """An answer against the range of admissible loads. bounds: as bound_of."""
    status, load = answer["status"], claimed(answer)
    if status.startswith("crashed"):
        yield CRASHED, f"{name}: {status}"
    elif status.startswith(FALLS):
        if lowest is not None:
            yield STANDS_OR_FALLS, f"{name}: {status}, but stands up to {lowest:.5g} at least"
    elif associated is None:
        if status.startswith((SOLVED, LOCKED, EXISTS)):
            yield STANDS_OR_FALLS, f"{name}: {status}, {load}; no forces carry the dead loads"
    elif load is not None and load > associated * (1.0 + SLACK):
        yield ABOVE, f"{name}: {load:.5f} > {associated:.5f} ({load / associated - 1.0:+.2%})"
    elif bracket(answer) and lowest is not None and answer["failure_load_bracket"][1] < lowest * (1.0 - SLACK):
        high = answer["failure_load_bracket"][1]
        yield BELOW, f"{name}: fails at {high:.5g}, stands up to {lowest:.5g} at least ({high / lowest - 1.0:+.2%})"
    elif not status.startswith((SOLVED, LOCKED, EXISTS)):
        yield UNFINISHED, f"{name}: {status}, load {load}, {answer.get('steps')} steps"


def of_limit_analysis(answer: Answer, associated: float | None) -> Iterator[Finding]:
    """The associated load of the program against ours."""
    ours, said = answer["associated"], answer["associated_status"]
    if said.startswith("crashed"):
        yield CRASHED, f"dem limit: {said}"
    elif associated is None:
        if FALLS not in said:
            yield ASSOCIATED, f"dem limit: {said}, {ours}; it does not stand"
    elif math.isinf(associated):
        if ours is not None:
            yield ASSOCIATED, f"dem limit: {ours}; no load makes it fail"
    elif ours is None:
        yield UNFINISHED, f"dem limit: {said}; {associated:.5g}"
    elif abs(ours - associated) > 2e-4 * associated:
        yield ASSOCIATED, f"dem limit: {ours:.6g}, ours {associated:.6g} ({ours / associated - 1.0:+.2%})"


def unsaid(row: Mapping[str, Any]) -> Iterator[Finding]:
    """Methods that disagree with any other while the default run does not say so."""
    pairs, known = disagreements(row), claims(row)
    loads = {name: sum(known[name]) / 2.0 for pair in pairs for name in pair[:2]}
    if loads and not all(reported(row["answers"][DEFAULT], load) for load in loads.values()):
        widest = max(gap for *_, gap in pairs)
        named = ", ".join(f"{name} {load:.5g}" for name, load in loads.items())
        of_default = sum(known.get(DEFAULT, ())) / 2.0
        others = [name for name in loads if known[name] != known.get(DEFAULT)]
        saying = [name for name in others if speaks(row, name, of_default)]
        yield SILENT, f"{named}: up to {widest:.2%} apart" + (f"; said by {', '.join(saying)} alone" if saying else "")


def speaks(row: Mapping[str, Any], name: str, load: float) -> bool:
    """Whether the run of a start says of itself that another method comes to such a load."""
    return name in row["answers"] and reported(row["answers"][name], load)
