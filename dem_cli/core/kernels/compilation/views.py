"""Views of whole arrays in another shape, for compiled code: numba's own may copy or raise, and ask its runtime."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import types
from numba.core import cgutils
from numba.np.arrayobj import make_array, populate_array

__all__ = ["CODE", "TYPES"]


def _flat(context: Any) -> Callable:
    """Type the function `in_a_row`."""
    return lambda array: array.copy(ndim=1)


def _like(context: Any) -> Callable:
    """Type the function `shaped_as`."""
    return lambda array, like: array.copy(ndim=like.ndim)


def _in_a_row(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Lower `in_a_row`: all numbers of an array in C order."""
    source = make_array(signature.args[0])(context, builder, arguments[0])
    return _view(context, builder, signature.return_type, source, [source.nitems])


def _shaped_as(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Lower `shaped_as`: the numbers of an array in the shape of another one."""
    source, like = (make_array(kind)(context, builder, value) for kind, value in zip(signature.args, arguments))
    shape = cgutils.unpack_tuple(builder, like.shape, signature.args[1].ndim)
    return _view(context, builder, signature.return_type, source, shape)


def _view(context: Any, builder: Any, kind: types.Array, source: Any, shape: list[Any]) -> Any:
    """Build an array over the memory of another one, without a reference count."""
    strides = [source.itemsize]
    for extent in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], extent))
    view = make_array(kind)(context, builder)
    populate_array(view, source.data, shape=shape, strides=strides, itemsize=source.itemsize, meminfo=None)
    return view._getvalue()


TYPES: dict[str, Callable] = {"in_a_row": _flat, "shaped_as": _like}
CODE: dict[str, Callable] = {"in_a_row": _in_a_row, "shaped_as": _shaped_as}
