"""Kinds of analysis: the properties of each kind, by name; their solvers are in analyses/."""

from __future__ import annotations

from typing import NamedTuple


class AnalysisKind(NamedTuple):
    """Properties of a kind of analysis that are known without running it."""

    title: str  # for people
    shakes: bool = False  # it takes place in time, on a base that moves
    timed: bool = False  # its frames are instants of one motion; others are counted
    real_masses: bool = False  # blocks have their masses, in time or for frequencies
    rests: bool = False  # it ends in an equilibrium, in which monitors have their values
    shapes: bool = False  # its frames are shapes: displacements have no size, and none follows another
    moves: str = ""  # why its geometry moves visibly, where it always does


KINDS: dict[str, AnalysisKind] = {
    "pushover": AnalysisKind("Pushover", rests=True),
    "gravity": AnalysisKind("Own weight", rests=True),
    "settlement": AnalysisKind("Settlement", rests=True, moves="supports move visibly"),
    "cycle": AnalysisKind("Load path", rests=True),
    "time-history": AnalysisKind("Time history", shakes=True, timed=True, real_masses=True),
    "fragility": AnalysisKind("Fragility", shakes=True, real_masses=True),
    "modes": AnalysisKind(
        "Natural modes", real_masses=True, shapes=True, moves="the forces of gravity turn and shift with the blocks"
    ),
    "safety": AnalysisKind("Factor of safety"),
    "limit": AnalysisKind("Limit analysis", shapes=True),  # of `dem limit`, which is no kind of a case
}
UNKNOWN = AnalysisKind("Run")


def kind_of(name: object) -> AnalysisKind:
    """Return the record of an analysis kind by its name; that of any run where there is no such kind."""
    return KINDS.get(name, UNKNOWN) if isinstance(name, str) else UNKNOWN
