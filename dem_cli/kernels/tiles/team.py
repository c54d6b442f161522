"""Threads that step together: each calls the same compiled loop, takes a number, and waits for the others (barrier).

A wait lasts a microsecond or less, so that threads spin; who waits for long gives its core away again and again, as there
may be fewer cores than threads.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

from dem_cli.kernels.jit import inline

MEMBERS, TICKET, ARRIVED = 0, 8, 16  # of `team`, each in a cache line of its own
N_TEAM = 24
SPINS = 2000  # about 5 µs
_YIELD = "SwitchToThread" if os.name == "nt" else "sched_yield"


def _place(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Where an entry of an array of integers is."""
    array = make_array(signature.args[0])(context, builder, arguments[0])
    return cgutils.gep(builder, array.data, arguments[1])


@intrinsic
def _add_at_once(typing_context, array, index, amount):
    """array[index] += amount, whoever else adds to it; returns what was there before."""

    def code(context, builder, signature, arguments):
        return builder.atomic_rmw("add", _place(context, builder, signature, arguments), arguments[2], "seq_cst")

    return types.int64(array, types.int64, types.int64), code


@intrinsic
def _now_at(typing_context, array, index):
    """array[index] as others see it; what they wrote before is seen as well."""

    def code(context, builder, signature, arguments):
        place = _place(context, builder, signature, arguments)
        return builder.load_atomic(place, "seq_cst", 8)

    return types.int64(array, types.int64), code


@intrinsic
def _give_way(typing_context):
    """Lets others have this core."""

    def code(context, builder, signature, arguments):
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(ir.IntType(32), []), _YIELD)
        builder.call(function, [])
        return context.get_dummy_value()

    return types.void(), code


def new_team(members: int = 1) -> np.ndarray:
    """Of so many threads, none of which has come yet."""
    team = np.zeros(N_TEAM, dtype=np.int64)
    team[MEMBERS] = members
    return team


@inline
def join(team):
    """Number of this thread among those of the team, and how many there are."""
    members = team[MEMBERS]
    return (_add_at_once(team, TICKET, 1) if members > 1 else 0), members


@inline
def wait(team, members, met):
    """Waits until all are here. met: arrivals of the waits before; returns them with those of this one."""
    met += members
    _add_at_once(team, ARRIVED, 1)
    spins = 0
    while _now_at(team, ARRIVED) < met:
        spins += 1
        if spins > SPINS:
            _give_way()
    return met
