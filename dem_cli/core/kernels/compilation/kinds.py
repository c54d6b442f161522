"""Kinds of kernel arguments as strings, and how arguments lie in memory; without loading numba."""

from __future__ import annotations

import struct
from array import array
from typing import Any

import numpy as np

__all__ = ["WORD", "OtherTypes", "kind_of", "words_of", "words_of_kind"]

WORD = 8  # bytes
_PACKAGE = __name__.partition(".")[0]
_NUMBERS = {"i": (int, np.int64), "d": (float, np.float64)}
_KINDS = {kind: word for word, of in _NUMBERS.items() for kind in of}


class OtherTypes(TypeError):
    """Error: arguments of other types than the code was compiled for."""


def kind_of(value: Any) -> str:
    """Name the type of an argument as machine code knows it: `entries.kind_of_type` names the same of numba's types.

    Raises OtherTypes for what is never kept.
    """
    kind = type(value)
    if kind is np.ndarray:
        flags = value.flags
        if flags.c_contiguous and flags.aligned:
            return f"{value.dtype.str}{value.ndim}{'' if flags.writeable else 'r'}"
        raise OtherTypes
    if kind in _KINDS:
        return _KINDS[kind]
    if kind is tuple:
        return f"({' '.join(map(kind_of, value))})"
    if isinstance(value, tuple) and kind.__module__.partition(".")[0] == _PACKAGE:
        return f"{kind.__name__}[{' '.join(map(kind_of, value))}]"
    raise OtherTypes


def words_of(value: Any, held: list[Any]) -> list[int]:
    """Lay out an argument in machine words as numba does; held: what must live as long as that is used."""
    kind = type(value)
    if kind is np.ndarray:
        held.append(value)
        address = value.__array_interface__["data"][0]
        return [0, 0, value.size, value.itemsize, address, *value.shape, *value.strides]
    if kind in _NUMBERS["d"]:
        return [_as_word(value)]
    if kind in _NUMBERS["i"]:
        return [int(value)]
    members = [word for each in value for word in words_of(each, held)]
    if kind is tuple:
        return members
    record = array("q", members)
    held.append(record)
    return [record.buffer_info()[0]]


def _as_word(value: float) -> int:
    return int(struct.unpack("q", struct.pack("d", value))[0])


def words_of_kind(kind: str) -> int:
    """Count the machine words of an argument of a kind."""
    if kind in _NUMBERS or kind.endswith("]"):
        return 1
    if kind.startswith("("):
        return sum(map(words_of_kind, _members(kind[1:-1])))
    return 5 + 2 * int(kind.rstrip("r")[3:])


def _members(kinds: str) -> list[str]:
    """Split a tuple kind into the kinds of its members, which may be tuples."""
    found, depth = [""], 0
    for letter in kinds:
        depth += (letter in "([") - (letter in ")]")
        if letter == " " and not depth:
            found.append("")
        else:
            found[-1] += letter
    return [kind for kind in found if kind]
