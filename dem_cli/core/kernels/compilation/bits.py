"""Bits of whole numbers for compiled code: one instruction of the processor."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

__all__ = ["BITS"]


@intrinsic
def lowest(typing_context: Any, bits: Any) -> Any:
    """Find the place of the lowest set bit of a whole number that is not zero."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], cgutils.true_bit)

    return types.int64(types.int64), code


_lowest = cast(Callable, lowest)
BITS: dict[str, Callable] = {"lowest_bit": lambda bits: lambda bits: _lowest(bits)}  # of kernels/tiles/lanes.py
