"""Serialise values of a run for checkpoints: JSON, followed by the numbers of its arrays.

What is read is data. A value is made as its kind says, a record of a class that kept_records.py names without a call
of it; nothing in the bytes says what to run, and nothing is made that is larger than they are. What is the same object
twice stays one.

Plain values stand in the JSON as they are, all others as a list that begins with their kind: ["tuple", 1, 2.5],
["array", "<f8", [3, 2], "C", true], ["record", "Energy", ...], ["same", 7] for the object of number 7 so far.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Mapping
from math import isfinite, prod
from typing import Any, Literal

import numpy as np

from dem_cli.results.output.resume.kept_records import RECORDS, unfit

MOST_TEXT = 1 << 26  # bytes of the JSON of one kept state
_DEEPEST = 100  # of values in values
_LARGEST = 1 << 1000  # whole number
_LENGTH, _FLOAT = struct.Struct("<Q"), struct.Struct("<d")
_DTYPES = {
    each: np.dtype(each)
    for each in ("|b1", "|i1", "|u1", "<i2", "<u2", "<i4", "<u4", "<i8", "<u8", "<f4", "<f8", "<c8", "<c16")
}
_PLAIN = (type(None), bool, str)
_KINDS = {kind: kind.__name__ for kind in (list, tuple, set, frozenset)}


class NotKept(TypeError):
    """Error of a value of a run that no checkpoint can hold."""


class Damaged(ValueError):
    """Error of bytes that are no valid checkpoint."""


def packed(value: Any, names: Mapping[int, str] | None = None) -> bytes:
    """Serialise a value. names: of objects that are only named, by their id. Raises NotKept."""
    packing = _Packing(names or {})
    text = json.dumps(packing.node(value, 0), ensure_ascii=False, separators=(",", ":")).encode(
        "utf-8", "surrogatepass"
    )
    if len(text) > MOST_TEXT:
        raise NotKept(f"{len(text):,} bytes of plain values are more than the {MOST_TEXT:,} that are kept")
    return b"".join([_LENGTH.pack(len(text)), text, *packing.numbers])


def unpacked(
    data: bytes, named: Mapping[str, Any] | None = None, see: Callable[[Any], None] = lambda record: None
) -> Any:
    """Restore a value serialised by `packed`. Raises Damaged.

    named: objects by the names that they had; see: is shown each record that is made.
    """
    try:
        (length,) = _LENGTH.unpack_from(data)
        begin = _LENGTH.size + length
        if length > MOST_TEXT or begin > len(data):
            raise Damaged("its text is not there")
        node = json.loads(data[_LENGTH.size : begin].decode("utf-8", "surrogatepass"), parse_constant=_no_number)
        unpacking = _Unpacking(memoryview(data)[begin:], named or {}, see)
        value = unpacking.value(node, 0)
        if unpacking.at != len(unpacking.numbers):
            raise Damaged("it holds more than it names")
    except (ValueError, TypeError, KeyError, IndexError, OverflowError, RecursionError, struct.error) as error:
        raise Damaged(f"{error}") from None
    return value


def _no_number(word: str) -> float:
    raise Damaged(f"{word} is no number")


class _Packing:
    """Serialisation of one value."""

    def __init__(self, names: Mapping[int, str]):
        self.names, self.numbers = names, list[bytes]()
        self._known: dict[int, int] = {}  # of objects so far, by their id
        self._objects: list[Any] = []  # so that no other gets the id of one

    def node(self, value: Any, depth: int) -> Any:
        """Convert a value to its JSON form."""
        kind = type(value)
        if kind in _PLAIN:
            return value
        if kind in _SIMPLE:
            return _SIMPLE[kind](value)
        if (name := self.names.get(id(value))) is not None:
            return ["named", name]
        if (number := self._known.get(id(value))) is not None:
            return ["same", number]
        if depth > _DEEPEST:
            raise NotKept("values in values in values: too deep")
        self._known[id(value)] = len(self._objects)
        self._objects.append(value)
        return self._of_kind(kind, value, depth + 1)

    def _of_kind(self, kind: type, value: Any, depth: int) -> list[Any]:
        if kind is np.ndarray:
            return self._array(value)
        if kind is bytes:
            self.numbers.append(value)
            return ["bytes", len(value)]
        if kind in _KINDS:
            return [_KINDS[kind], *(self.node(each, depth) for each in value)]
        if kind is dict:
            return ["dict", *(self.node(each, depth) for pair in value.items() for each in pair)]
        name = kind.__name__
        if name not in RECORDS or RECORDS[name] is not kind:
            raise NotKept(f"{kind.__module__}.{kind.__qualname__} is not among the records that checkpoints hold")
        state = value._asdict() if issubclass(kind, tuple) else vars(value)
        if wrong := unfit(kind, state):
            raise NotKept(f"{name}: {wrong}")
        if issubclass(kind, tuple):
            return ["record", name, *(self.node(each, depth) for each in value)]
        return ["object", name, *(self.node(each, depth) for pair in state.items() for each in pair)]

    def _array(self, value: np.ndarray) -> list[Any]:
        if value.dtype.str not in _DTYPES:
            raise NotKept(f"an array of {value.dtype} is not kept")
        order: Literal["C", "F"] = "F" if value.flags.f_contiguous and not value.flags.c_contiguous else "C"
        self.numbers.append(value.tobytes(order))
        return ["array", value.dtype.str, list(value.shape), order, value.flags.writeable]


class _Unpacking:
    """Deserialisation of one value."""

    def __init__(self, numbers: memoryview, named: Mapping[str, Any], see: Callable[[Any], None]):
        self.numbers, self.named, self.see, self.at = numbers, named, see, 0
        self._objects: list[Any] = []

    def value(self, node: Any, depth: int) -> Any:
        """Convert a part of the JSON to its value."""
        if type(node) is not list:
            if type(node) is dict:
                raise Damaged("a value of no kind")
            return node
        if depth > _DEEPEST:
            raise Damaged("values in values in values: too deep")
        kind, parts = node[0], node[1:]
        if kind in _READ:
            return _READ[kind](*parts)
        if kind == "named":
            return self.named[parts[0]]
        if kind == "same":
            return self._same(*parts)
        number = len(self._objects)
        self._objects.append(_UNDER_WAY)
        return _MAKE[kind](self, number, parts, depth + 1)

    def _same(self, number: int) -> Any:
        if type(number) is not int or number < 0 or self._objects[number] is _UNDER_WAY:
            raise Damaged("an object in itself")
        return self._objects[number]

    def _all(self, parts: list[Any], depth: int) -> list[Any]:
        return [self.value(each, depth) for each in parts]

    def _pairs(self, parts: list[Any], depth: int) -> Any:
        values = self._all(parts, depth)
        return zip(values[::2], values[1::2], strict=True)

    def _list(self, number: int, parts: list[Any], depth: int) -> list[Any]:
        self._objects[number] = found = list[Any]()
        found += self._all(parts, depth)
        return found

    def _set(self, number: int, parts: list[Any], depth: int) -> set[Any]:
        self._objects[number] = found = set[Any]()
        found.update(self._all(parts, depth))
        return found

    def _dict(self, number: int, parts: list[Any], depth: int) -> dict[Any, Any]:
        self._objects[number] = found = dict[Any, Any]()
        found.update(self._pairs(parts, depth))
        return found

    def _tuple(self, number: int, parts: list[Any], depth: int) -> tuple[Any, ...]:
        self._objects[number] = found = tuple(self._all(parts, depth))
        return found

    def _frozenset(self, number: int, parts: list[Any], depth: int) -> frozenset[Any]:
        self._objects[number] = found = frozenset(self._all(parts, depth))
        return found

    def _array(self, number: int, parts: list[Any], depth: int) -> np.ndarray:
        name, shape, order, writeable = parts
        dtype = _DTYPES[name]
        if not all(type(n) is int and n >= 0 for n in shape) or order not in ("C", "F") or type(writeable) is not bool:
            raise Damaged("an array without a shape")
        flat = np.frombuffer(self._taken(prod(shape) * dtype.itemsize), dtype)
        if dtype.kind == "b" and flat.view(np.uint8).max(initial=0) > 1:
            raise Damaged("truth that is neither true nor false")
        self._objects[number] = found = flat.reshape(shape, order=order).copy(order)
        found.flags.writeable = writeable
        return found

    def _bytes(self, number: int, parts: list[Any], depth: int) -> bytes:
        (length,) = parts
        if type(length) is not int or length < 0:
            raise Damaged("bytes without a length")
        self._objects[number] = found = bytes(self._taken(length))
        return found

    def _taken(self, length: int) -> memoryview:
        """Take the next bytes of the data behind the JSON."""
        begin, self.at = self.at, self.at + length
        if self.at > len(self.numbers):
            raise Damaged("more numbers are named than there are")
        return self.numbers[begin : self.at]

    def _record(self, number: int, parts: list[Any], depth: int) -> Any:
        of = RECORDS[parts[0]]
        values = self._all(parts[1:], depth)
        if not issubclass(of, tuple) or len(values) != len(of._fields):  # type: ignore[attr-defined]
            raise Damaged(f"no {of.__name__}")
        _check(of, dict(zip(of._fields, values, strict=True)))  # type: ignore[attr-defined]
        self._objects[number] = found = tuple.__new__(of, values)
        self.see(found)
        return found

    def _object(self, number: int, parts: list[Any], depth: int) -> Any:
        of = RECORDS[parts[0]]
        if issubclass(of, tuple):
            raise Damaged(f"no {of.__name__}")
        self._objects[number] = found = object.__new__(of)
        state = dict(self._pairs(parts[1:], depth))
        _check(of, state)
        vars(found).update(state)
        self.see(found)
        return found


def _check(of: type, state: Mapping[str, Any]) -> None:
    if wrong := unfit(of, state):
        raise Damaged(f"{of.__name__}: {wrong}")


_UNDER_WAY = object()
_MAKE = {
    "list": _Unpacking._list, "tuple": _Unpacking._tuple, "set": _Unpacking._set, "dict": _Unpacking._dict,
    "frozenset": _Unpacking._frozenset, "array": _Unpacking._array, "record": _Unpacking._record,
    "object": _Unpacking._object, "bytes": _Unpacking._bytes,
}  # fmt: skip


def _of_whole(value: int) -> int:
    if abs(value) >= _LARGEST:
        raise NotKept("a whole number of more than 300 digits")
    return value


def _of_scalar(value: Any) -> list[Any]:
    return ["scalar", value.dtype.str, value.tobytes().hex()]


def _scalar(name: str, digits: str) -> Any:
    dtype, data = _DTYPES[name], bytes.fromhex(digits)
    if len(data) != dtype.itemsize or (dtype.kind == "b" and data[0] > 1):
        raise Damaged("a number of another size")
    return np.frombuffer(data, dtype)[0]


def _of_dtype(value: Any) -> list[Any]:
    if value.str not in _DTYPES:
        raise NotKept(f"{value} is not kept")
    return ["dtype", value.str]


def _slice(*ends: Any) -> slice:
    if not all(end is None or type(end) is int for end in ends):
        raise Damaged("a slice without ends")
    return slice(*ends)


_SIMPLE: dict[type, Callable[[Any], Any]] = {
    int: _of_whole,
    float: lambda value: value if isfinite(value) else ["float", _FLOAT.pack(value).hex()],
    complex: lambda value: ["complex", _FLOAT.pack(value.real).hex(), _FLOAT.pack(value.imag).hex()],
    slice: lambda value: ["slice", value.start, value.stop, value.step],
    **{dtype.type: _of_scalar for dtype in _DTYPES.values()},
    **{type(dtype): _of_dtype for dtype in _DTYPES.values()},
}
_READ: dict[str, Callable[..., Any]] = {
    "float": lambda digits: _FLOAT.unpack(bytes.fromhex(digits))[0],
    "complex": lambda *digits: complex(*(_FLOAT.unpack(bytes.fromhex(each))[0] for each in digits)),
    "slice": _slice,
    "scalar": _scalar,
    "dtype": _DTYPES.__getitem__,
}
