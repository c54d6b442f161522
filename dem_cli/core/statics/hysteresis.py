"""Hysteresis loops of a load path: energy dissipated in each cycle, and the viscous damping of as much.

A loop goes from a turning point of the path to one at the same value, the start, 0, included. Its damping is that of a
linear oscillator of the same amplitudes F, u that loses as much energy E in a cycle:

    ζ = E / (2π F u)

A rectangle through its corners has the energy 4 F u, of which the loop fills E / (4 F u) = π ζ / 2. What is left of the
displacement when the load is taken away is half the distance between its branches where their load is 0.

Between two states of rest the load did at least what friction and springs took, at most all that it gave in the run;
in between, damping of the run, are motion of the solver and not of the structure, and what snaps. Within these
bounds its work is that of a multiplier that is straight in the displacement.

Source: Chopra, Dynamics of Structures, equivalent viscous damping, ζ = E_D/(4π E_S0) with E_S0 = F u/2. Of an elastic,
perfectly plastic system of ductility μ this is 2/π (1 − 1/μ).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.core.engine import measures
from dem_cli.core.kernels import records as slot

if TYPE_CHECKING:
    from dem_cli.core.engine.simulation import Simulation


class PathState(NamedTuple):
    """State of rest on a load path."""

    displacement: float  # of the live load [m]
    load: float  # its multiplier
    share: float  # of loads that a tilting table leaves them
    given: float  # work of the live load since the start [J]
    damped: float  # what numerical damping took of it [J]


class HysteresisLoop(NamedTuple):
    """Hysteresis loop of one cycle: energy, amplitudes and equivalent viscous damping."""

    first: int  # turning point that it begins at, from 1; 0: the start of the path
    last: int  # and ends at
    energy: float  # dissipated [J]
    displacement: float  # amplitude: half of its range [m]
    load: float  # amplitude: half of its range [-]
    damping: float  # equivalent damping ratio [-]
    filled: float  # energy over that of the rectangle through its corners [-]
    residual: float | None  # displacement that is left without load [m]; None: the load keeps its sign


def pairs_of(path: Sequence[float]) -> list[tuple[int, int]]:
    """Turning points between which a path makes loops, none over another, short ones first; 0 is its start, at 0."""
    values = [0.0, *path]
    found: list[tuple[int, int]] = []
    for span in range(2, len(values)):
        for first in range(len(values) - span):
            free = all(first + span <= one or first >= other for one, other in found)
            if free and np.isclose(values[first], values[first + span], rtol=1e-9, atol=0.0):
                found.append((first, first + span))
    return sorted(found)


def state_of(sim: Simulation, at_rest: float) -> PathState:
    """Read the state of a simulation on its path; at_rest: `measures.live_travel` at the start of the path [m]."""
    travel, ledger = measures.live_travel(sim) - at_rest, sim.ledger
    load, share = sim.load * sim.live_scale, sim.dead_share
    return PathState(travel, load, share, float(ledger[slot.LIVE]), float(ledger[slot.DAMPING]))


def energy_between(states: Sequence[PathState], force: float) -> float:
    """Compute the work of the live load from the first state to the last [J]. force: of it at a multiplier of 1
    [N]."""
    u, loads, shares, given, damped = np.array(states).T
    straight = force * float(np.trapezoid(shares * loads, u))
    most = float(given[-1] - given[0])
    least = most - float(damped[-1] - damped[0])
    return min(max(straight, min(least, most)), max(least, most))


def residual_of(displacements: np.ndarray, loads: np.ndarray) -> float | None:
    """Compute the displacement that a loop keeps without load [m]: half the distance between its ends at load 0.

    displacements, loads: those of its states, (n,); straight between them. None where the load keeps its sign.
    """
    before, after = loads[:-1], loads[1:]
    through = np.flatnonzero((before != after) & (before * after <= 0.0))
    if not len(through):
        return None
    part = before[through] / (before[through] - after[through])
    found = displacements[through] + part * (displacements[through + 1] - displacements[through])
    return 0.5 * float(np.ptp(found))


def loops(
    path: Sequence[float], turns: Sequence[int], states: Sequence[PathState], force: float
) -> list[HysteresisLoop]:
    """Compute the hysteresis loops of a path, as far as it was followed, from all its states.

    turns: number of the state at the start of the path and at each turning point that was reached. force: of the live
    load at a multiplier of 1 [N].
    """
    found = []
    displacements, loads = np.array(states).T[:2]
    for first, last in pairs_of(path[: len(turns) - 1]):
        rows = slice(turns[first], turns[last] + 1)
        u, load = displacements[rows], loads[rows]
        energy = energy_between(states[rows], force)
        sizes = 0.5 * float(np.ptp(u)), 0.5 * float(np.ptp(load))
        corners = 4.0 * force * sizes[0] * sizes[1]
        filled, damping = (energy / corners, energy / (0.5 * np.pi * corners)) if corners > 0.0 else (0.0, 0.0)
        found.append(HysteresisLoop(first, last, energy, *sizes, damping, filled, residual_of(u, load)))
    return found
