"""Values of checkpoints: what comes back is what was kept, and bytes that hold anything else are refused as data."""

from __future__ import annotations

import json
import os
import pickle
import struct
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from dem_cli.core.records.history_rows import Energy, HistoryRow
from dem_cli.core.statics.equilibrium import Verdict
from dem_cli.results.output.resume.kept_values import Damaged, NotKept, packed, unpacked

DTYPES = ["bool", "i1", "u1", "i4", "u4", "i8", "u8", "f4", "f8", "c16"]
ENERGY = Energy(*np.arange(7.0))
ROW = HistoryRow("loading", 3, 0.1, 1e-9, 0.0, 0.0, ENERGY, (1.5, float("nan")))
PLAIN = st.one_of(
    st.none(), st.booleans(), st.integers(-(10**40), 10**40), st.floats(), st.complex_numbers(), st.text(), st.binary(),
    st.builds(slice, st.none() | st.integers(), st.none() | st.integers()),
    st.sampled_from(DTYPES).map(np.dtype), st.floats().map(np.float64), st.just(ROW),
)  # fmt: skip
KEYS = st.one_of(st.text(), st.integers(), st.tuples(st.integers(), st.text()), st.frozensets(st.integers()))
ARRAYS = hnp.arrays(st.sampled_from(DTYPES), hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4)).flatmap(
    lambda array: st.sampled_from([array, np.asfortranarray(array), array.T, array[::2] if array.ndim else array])
)
NESTED = st.recursive(
    PLAIN | ARRAYS | st.sets(st.integers()),
    lambda inner: st.lists(inner) | st.lists(inner).map(tuple) | st.dictionaries(KEYS, inner),
    max_leaves=20,
)


def said(value):
    """A value in words that tell every bit, and which of its objects are the same."""
    numbers = {}

    def word(one):
        kind = type(one)
        if isinstance(one, np.ndarray):
            order = one.flags.f_contiguous and not one.flags.c_contiguous
            found = [one.dtype.str, one.shape, order, one.flags.writeable, one.tobytes()]
        elif kind in (set, frozenset):
            return [kind.__name__, sorted(one)]
        elif kind is dict:
            found = [[word(key), word(each)] for key, each in one.items()]
        elif isinstance(one, (list, tuple)):
            found = [word(each) for each in one]
        else:
            if isinstance(one, (float, complex)):
                parts = (one.real, one.imag)
                return [kind.__name__, *(struct.pack("<d", part).hex() for part in parts)]
            return [kind.__name__, repr(one)]
        known = numbers.get(id(one))
        numbers.setdefault(id(one), len(numbers))
        return [kind.__name__, known, found]

    return word(value)


@settings(max_examples=60, deadline=None)
@given(NESTED)
def test_what_was_kept_comes_back(value):
    value = [value, {"again": value}, value]
    again = unpacked(packed(value))
    assert said(again) == said(value)
    assert again[0] is again[2] is again[1]["again"] or type(value[0]) not in (list, dict, np.ndarray)


def test_what_is_one_object_stays_one():
    array = np.arange(6.0).reshape(2, 3)
    array.flags.writeable = False
    loop = [array, {"of": array}]
    loop.append(loop)
    verdict = Verdict("failure", 0.5)
    again = unpacked(packed([loop, verdict, verdict]))
    assert again[0][0] is again[0][1]["of"]
    assert again[0][2] is again[0]
    assert again[1] == verdict
    assert again[1] is again[2]
    assert not again[0][0].flags.writeable


UNKEPT = {
    "an object": object(),
    "a function": len,
    "an error": Damaged("x"),
    "an array of objects": np.array([object()]),
    "an array of text": np.array(["text"]),
    "an array of records": np.zeros(1, "f8,i4"),
    "a kind of array": np.ma.zeros(2),
    "an endless number": 1 << 2000,
    "another class of a known name": type("Energy", (), {})(),
    "a range": range(3),
    "a record of text": Energy(*"abcdefg"),
}


@pytest.mark.parametrize("value", UNKEPT.values(), ids=UNKEPT)
def test_what_cannot_be_kept_is_said(value):
    with pytest.raises(NotKept):
        packed([1, value])


def test_too_deep():
    value = []
    for _ in range(101):
        value = [value]
    with pytest.raises(NotKept, match="too deep"):
        packed(value)


def bytes_of(node, numbers=b""):
    text = node if isinstance(node, bytes) else json.dumps(node).encode()
    return struct.pack("<Q", len(text)) + text + numbers


class Shell:
    """Runs a command where pickle reads it."""

    def __reduce__(self):
        return os.system, ("touch /tmp/dem-was-here",)


RECORD = [1.0] * 11
HOSTILE = {
    "a pickle": pickle.dumps(Shell()),
    "a dotted name": b"\x80\x04\x8c\x19dem_cli.output.checkpoint\x8c\tos.system\x93\x8c\x02id\x85R.",
    "nothing": b"",
    "no text": struct.pack("<Q", 1 << 60),
    "text that is cut": bytes_of([1.0])[:-2],
    "no JSON": bytes_of(b"{'a'"),
    "no UTF-8": bytes_of(b'"\xff"'),
    "an object of JSON": bytes_of({"a": 1}),
    "NaN": bytes_of(b"NaN"),
    "a deep text": bytes_of(b"[" * 100_000 + b"]" * 100_000),
    "values too deep": bytes_of(json.loads('["list",' * 150 + "1" + "]" * 150)),
    "an endless number": bytes_of(b"9" * 5000),
    "no kind": bytes_of([]),
    "an unknown kind": bytes_of(["call", "os.system", "id"]),
    "a list as a kind": bytes_of([["list"]]),
    "a module": bytes_of(["object", "os", "system", 1]),
    "an unknown record": bytes_of(["record", "CompletedProcess", "id", 0]),
    "a record by its place": bytes_of(["record", "dem_cli.core.records.history_rows.Energy", *RECORD]),
    "a name within": bytes_of(["object", "Verdict.__init__", "state", "x"]),
    "a list as a name": bytes_of(["record", ["list"], *RECORD]),
    "a record that is too short": bytes_of(["record", "Energy", 1.0]),
    "a record of text": bytes_of(["record", "Energy", *["1.0"] * 11]),
    "a record as an object": bytes_of(["object", "Energy", "kinetic", 1.0]),
    "an object as a record": bytes_of(["record", "Verdict", "failure", 0.5]),
    "an object without a field": bytes_of(["object", "Verdict", "state", "x"]),
    "a field that hides a method": bytes_of(["object", "JointTracking", "detect", 1]),
    "a field of its class": bytes_of(["object", "JointTracking", "__class__", 1]),
    "a field that is no text": bytes_of(["object", "JointTracking", 3, 1]),
    "half a pair": bytes_of(["dict", 1]),
    "a key that is a list": bytes_of(["dict", ["list"], 1]),
    "a set of lists": bytes_of(["set", ["list"]]),
    "an object in itself": bytes_of(["tuple", ["same", 0]]),
    "an object that comes later": bytes_of(["list", ["same", 5]]),
    "an object before the first": bytes_of(["list", ["same", -1]]),
    "an object of no number": bytes_of(["list", ["same", True]]),
    "a name that nobody has": bytes_of(["named", "0.model"]),
    "an array of objects": bytes_of(["array", "|O", [1], "C", True], bytes(8)),
    "an array of records": bytes_of(["array", "f8,O", [1], "C", True], bytes(16)),
    "an array of a huge shape": bytes_of(["array", "<f8", [1 << 40, 1 << 20], "C", True], bytes(8)),
    "an array of many axes": bytes_of(["array", "<f8", [1] * 200, "C", True], bytes(8)),
    "an empty array of a huge shape": bytes_of(["array", "<f8", [0, 1 << 62, 1 << 62], "C", True]),
    "an array of a negative shape": bytes_of(["array", "<f8", [-1], "C", True], bytes(8)),
    "an array of two negative lengths": bytes_of(["array", "<f8", [-1, -1], "C", True], bytes(8)),
    "an array of half a shape": bytes_of(["array", "<f8", [0.5], "C", True], bytes(4)),
    "an array of no shape": bytes_of(["array", "<f8", 1, "C", True], bytes(8)),
    "an array of another order": bytes_of(["array", "<f8", [1], "K", True], bytes(8)),
    "an array without its numbers": bytes_of(["array", "<f8", [2], "C", True], bytes(8)),
    "truth that is neither": bytes_of(["array", "|b1", [1], "C", True], b"\x02"),
    "one truth that is neither": bytes_of(["scalar", "|b1", "02"]),
    "a number of another size": bytes_of(["scalar", "<f8", "00"]),
    "a number of no digits": bytes_of(["scalar", "<f8", 8]),
    "an object dtype": bytes_of(["dtype", "O"]),
    "a slice of lists": bytes_of(["slice", ["list"], None, None]),
    "bytes without end": bytes_of(["bytes", 1 << 62], b"x"),
    "bytes before the beginning": bytes_of(["bytes", -1], b"x"),
    "numbers that nobody named": bytes_of(["list"], b"more"),
}


@pytest.mark.parametrize("data", HOSTILE.values(), ids=HOSTILE)
def test_what_is_no_data_is_refused(data):
    with pytest.raises(Damaged):
        unpacked(data)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_changed_byte_gives_a_value_or_is_refused(data):
    kept = bytearray(packed([ROW, np.arange(4), {"a": (1, "b")}, Verdict("failure", 0.5)]))
    for _ in range(data.draw(st.integers(1, 3))):
        kept[data.draw(st.integers(0, len(kept) - 1))] = data.draw(st.integers(0, 255))
    with suppress(Damaged):
        unpacked(bytes(kept))
