"""Atomic operations for compiled code: addition and reading of what threads share, and yielding a processor core."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, cast

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

__all__ = ["ATOMICS"]

_YIELD = "SwitchToThread" if os.name == "nt" else "sched_yield"


def _place(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Compute the address of an entry of an array."""
    array = make_array(signature.args[0])(context, builder, arguments[0])
    return cgutils.gep(builder, array.data, arguments[1])


@intrinsic
def add(typing_context: Any, array: Any, index: Any, amount: Any) -> Any:
    """Add to array[index] atomically, for integers; returns the value before."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.atomic_rmw("add", _place(context, builder, signature, arguments), arguments[2], "seq_cst")

    return types.int64(array, types.int64, types.int64), code


@intrinsic
def seen(typing_context: Any, array: Any, index: Any) -> Any:
    """Read array[index] atomically, for integers."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load_atomic(_place(context, builder, signature, arguments), "seq_cst", 8)

    return types.int64(array, types.int64), code


@intrinsic
def give_core_away(typing_context: Any) -> Any:
    """Yield the processor core to another thread."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        function = cgutils.get_or_insert_function(
            builder.module, cgutils.ir.FunctionType(cgutils.ir.IntType(32), []), _YIELD
        )
        builder.call(function, [])
        return context.get_dummy_value()

    return types.void(), code


_add, _seen, _give_core_away = (cast(Callable, each) for each in (add, seen, give_core_away))
ATOMICS: dict[str, Callable] = {  # what the types of arguments make of functions of kernels/tiles/team.py
    "add_at_once": lambda array, index, amount: lambda array, index, amount: _add(array, index, amount),
    "now_at": lambda array, index: lambda array, index: _seen(array, index),
    "give_way": lambda: lambda: _give_core_away(),
}
