"""Search for the least load of joints that do not dilate: all collapse states of small structures, else a local
minimum.

What is proved is said with the load: `all`, the least of all collapse states, proved by branch and bound; `local`, the
least of those that differ from it in a few joints; `some`, a collapse state, and nothing about others.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem_cli.core.laws.envelope import Envelope
from dem_cli.core.limit.collapse_states import CollapseState, CollapseStates, StateSearch
from dem_cli.core.limit.matrices import LimitStructure
from dem_cli.core.limit.settings import DEFAULT_LIMIT, LeastSettings

if TYPE_CHECKING:
    from dem_cli.core.limit.path import Path

ALL, LOCAL, SOME, NONE = "all", "local", "some", "none"


class LeastLoad(NamedTuple):
    """Least load found among collapse states, and what is proved about lower ones."""

    least_of: str  # ALL, LOCAL, SOME, or NONE: no collapse state was found
    multiplier: float | None  # of the live loads, as users know it
    proved: float | None  # no collapse state of those with bounded forces and rates lies below; None: not known
    changed: int | None  # LOCAL: choices in which the states that were compared may differ
    residual: float | None  # of the state, in mean weights
    velocities: np.ndarray | None  # mechanism; the live loads have unit power, (n_blocks, n_dof)
    bounded: bool  # whether statics bounds all forces; else states with larger ones are left out
    rates: float  # largest rate of a joint, over that of the least loaded block if it moves alone; no faster ones
    nodes: int
    seconds: float

    def summary(self) -> dict[str, Any]:
        """Return the entries of summary.json about the least load."""
        return {
            "least": self.multiplier,
            "least_of": self.least_of,
            "least_proved": self.proved,
            "least_changed": self.changed,
            "least_residual": self.residual,
            "least_forces_bounded": self.bounded,
            "least_rates": self.rates,
            "least_nodes": self.nodes,
            "least_seconds": self.seconds,
        }


def least_load(
    structure: LimitStructure,
    strength: Envelope,
    upper: float,
    path: Path | None = None,
    settings: LeastSettings = DEFAULT_LIMIT.least,
) -> LeastLoad:
    """Search for the least load of the collapse states, up to the associated one (infinite: none is known).

    path: of joints that do not dilate, whose end a local search starts from.
    """
    begun = time.perf_counter()
    states = CollapseStates(structure, strength, upper, settings)
    found, nodes = StateSearch(None, 0.0, False, 0), 0
    if states.statics.n_joints <= settings.whole:
        found = _of_all(states, upper)
        nodes = found.nodes
    best = _believed(found.state, settings)
    if found.whole and (best is not None or found.state is None):
        return _told(states, best, ALL if best else NONE, found.proved, nodes, begun)
    if best is None and path is not None:
        best = _end_of(path, states)
    if best is None:
        return _told(states, None, NONE, found.proved, nodes, begun)
    best, changed, more = _locally(states, best)
    known = SOME if changed is None else LOCAL
    return _told(states, best, known, found.proved, nodes + more, begun)._replace(changed=changed)


def _of_all(states: CollapseStates, upper: float) -> StateSearch:
    """Find the least of all states with slow joints; then test whether faster ones are lower, if that search ends."""
    settings = states.settings
    slow, *faster = (rate * states.alone for rate in settings.rates)
    states.fastest = slow
    found = states.search(upper)
    for fastest in faster:
        if not found.whole:
            break
        load = upper if found.state is None else (1.0 - settings.better) * found.state.load
        before, states.fastest = states.fastest, fastest
        more = states.search(load)
        if not more.whole:
            states.fastest = before
            return found._replace(nodes=found.nodes + more.nodes)
        lower = more if more.state is not None else found
        found = lower._replace(nodes=found.nodes + more.nodes)
    return found


def _locally(states: CollapseStates, best: CollapseState) -> tuple[CollapseState, int | None, int]:
    """Search from a collapse state for lower ones, while there are any that differ in a few choices.

    Returns the last, in how many choices it was proved against others (None: in none), and the nodes of all searches.
    """
    settings, nodes = states.settings, 0
    tried = [settings.changed, 0]  # none: only what the state leaves open
    for _ in range(settings.rounds):
        near = states.search((1.0 - settings.better) * best.load, best, tried[0])
        nodes += near.nodes
        better = _believed(near.state, settings)
        if better is not None:
            best = better
        elif near.whole and near.state is None:
            return best, tried[0], nodes
        else:
            tried = tried[1:]
        if not tried:
            break
    return best, None, nodes


def _believed(state: CollapseState | None, settings: LeastSettings) -> CollapseState | None:
    return state if state is not None and state.residual <= settings.accepted else None


def _end_of(path: Path, states: CollapseStates) -> CollapseState | None:
    """Return the collapse state at the end of the path, or one close to it; None where there is none."""
    if path.normal is None or path.shear is None or path.mechanism is None:
        return None
    statics, moved = states.statics, path.mechanism.ravel()[states.structure.free]
    shear = np.bincount(statics.joint, path.shear[:, 0], statics.n_joints)
    forces = np.concatenate([path.normal, shear]) / statics.weight
    for weight in states.settings.weights:
        state = _believed(states.solved(states.chosen(forces, moved, weight)), states.settings)
        if state is not None:
            return state
    return None


def _told(
    states: CollapseStates, best: CollapseState | None, known: str, proved: float, nodes: int, begun: float
) -> LeastLoad:
    moved = None if best is None else states.structure.on_blocks(best.velocities)
    return LeastLoad(
        known,
        None if best is None else best.load,
        proved if np.isfinite(proved) and proved > 0.0 else None,
        None,
        None if best is None else best.residual,
        moved,
        states.bounded,
        states.fastest / states.alone,
        nodes,
        time.perf_counter() - begun,
    )
