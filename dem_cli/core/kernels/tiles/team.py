"""Threads that step together: each calls the same compiled loop, takes a number, and waits for the others (barrier).

A wait lasts a microsecond or less, so that threads spin; who waits for long gives its core away again and again, as
there may be fewer cores than threads.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.kernels.jit import built_in, inline

MEMBERS, TICKET, ARRIVED = 0, 8, 16  # of `team`, each in a cache line of its own
N_TEAM = 24
SPINS = 2000  # about 5 µs


@built_in
def add_at_once(array, index, amount):
    """Add to array[index] atomically; returns what was there before."""
    before = array[index]
    array[index] += amount
    return before


@built_in
def now_at(array, index):
    """Read array[index] atomically; what others wrote before they wrote that is seen as well."""
    return array[index]


@built_in
def give_way():
    """Yield this processor core to other threads."""


def new_team(members: int = 1) -> np.ndarray:
    """Make the shared counters of a team of so many threads, none of which has come yet."""
    team = np.zeros(N_TEAM, dtype=np.int64)
    team[MEMBERS] = members
    return team


@inline
def join(team):
    """Join a team: returns the number of this thread, and how many there are."""
    members = team[MEMBERS]
    return (add_at_once(team, TICKET, 1) if members > 1 else 0), members


@inline
def wait(team, members, met):
    """Wait until all threads of the team are here (barrier). met: arrivals of the waits before; returns them with those
    of this one.
    """
    met += members
    add_at_once(team, ARRIVED, 1)
    spins = 0
    while now_at(team, ARRIVED) < met:
        spins += 1
        if spins > SPINS:
            give_way()
    return met
