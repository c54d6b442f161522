"""Records by reference: kernels hand on a named tuple of arrays as one address, not as every number of every array.

Numba takes a tuple of arrays apart wherever it goes: a call with the blocks of a structure had 200 arguments, a loop
with all its records 600, and most of what was compiled did nothing but pass them. Here a record is a struct that the
entry of a kernel fills in. It does not change while the kernel runs, so that what is read may stay in registers.
"""

from __future__ import annotations

import hashlib
from functools import cache
from typing import Any

import numpy as np
from numba.core import cgutils, types
from numba.core.datamodel import default_manager, models
from numba.core.imputils import impl_ret_borrowed, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, register_model, typeof_impl, unbox
from numba.np import numpy_support

from dem_cli.core.kernels.compilation.switch import SWITCH

__all__ = ["Record", "pass_records_by_reference"]

_PACKAGE = __name__.partition(".")[0]
_UNCHANGED = "invariant.load"


class Record(types.Type):
    """Numba type of a named tuple: its fields with their types. Two with the same fields of the same types are one."""

    def __init__(self, word: str, fields: tuple[tuple[str, types.Type], ...]) -> None:
        self.fields, self.types = tuple(name for name, _ in fields), dict(fields)
        digest = hashlib.sha256(repr([(name, str(kind)) for name, kind in fields]).encode()).hexdigest()
        super().__init__(f"{word}_{digest[:16]}")


@cache
def _record(word: str, fields: tuple[tuple[str, types.Type], ...]) -> Record:
    """Make the type of a record once: numba asks at each call of a kernel."""
    return Record(word, fields)


@register_model(Record)
class RecordModel(models.OpaqueModel):
    """Memory model of a record: an address."""


def _struct(context: Any, record: Record) -> Any:
    return context.get_value_type(types.Tuple(tuple(record.types.values())))


@unbox(Record)
def _filled_in(record: Record, named_tuple: Any, c: Any) -> NativeValue:
    """Fill the struct of a record from Python; it lives as long as the call."""
    builder = c.builder
    struct = cgutils.alloca_once(builder, _struct(c.context, record))
    failed = cgutils.false_bit
    borrowed = c.context.subtarget(enable_nrt=False).get_python_api(builder)  # the caller holds the arrays
    for place, kind in enumerate(record.types.values()):
        value, slot = c.pyapi.tuple_getitem(named_tuple, place), cgutils.gep_inbounds(builder, struct, 0, place)
        if isinstance(kind, types.Array):
            code = borrowed.numba_array_adaptor(value, builder.bitcast(slot, c.pyapi.voidptr))
            wrong = cgutils.is_not_null(builder, code)
        else:
            native = c.unbox(kind, value)
            assert native.cleanup is None, kind
            builder.store(native.value, slot)
            wrong = native.is_error
        failed = builder.or_(failed, wrong)
    with builder.if_then(failed, likely=False):
        c.pyapi.err_set_string("PyExc_TypeError", f"no {record.name}")
    return NativeValue(builder.bitcast(struct, c.pyapi.voidptr), is_error=failed)


@infer_getattr
class RecordFields(AttributeTemplate):
    """Types of the fields that are read from a record."""

    key = Record

    def generic_resolve(self, record: Record, name: str) -> types.Type | None:  # type: ignore[override]
        """Return the type of one field."""
        return record.types.get(name)


@lower_getattr_generic(Record)
def _field(context: Any, builder: Any, record: Record, address: Any, name: str) -> Any:
    """Read a field of a record."""
    kind = record.types[name]
    struct = builder.bitcast(address, _struct(context, record).as_pointer())
    slot = cgutils.gep_inbounds(builder, struct, 0, record.fields.index(name))
    if isinstance(kind, types.Array) and kind.layout == "C":
        value = _array(context, builder, kind, slot)
    else:
        value = _unchanged(builder, slot)
    return impl_ret_borrowed(context, builder, kind, value)


def _unchanged(builder: Any, slot: Any) -> Any:
    """Load a value that stays unchanged during the whole run of a kernel."""
    loaded = builder.load(slot)
    loaded.set_metadata(_UNCHANGED, builder.module.add_metadata([]))
    return loaded


def _array(context: Any, builder: Any, kind: types.Array, slot: Any) -> Any:
    """Read address and shape of an array; what follows from these need not be read."""
    members = default_manager[kind]
    where = {
        member: members.get_field_position(member) for member in ("itemsize", "nitems", "data", "shape", "strides")
    }
    itemsize = context.get_constant(types.intp, numpy_support.as_dtype(kind.dtype).itemsize)
    data = _unchanged(builder, cgutils.gep_inbounds(builder, slot, 0, where["data"]))
    shape = [_unchanged(builder, cgutils.gep_inbounds(builder, slot, 0, where["shape"], k)) for k in range(kind.ndim)]
    stride, strides = itemsize, []
    for extent in reversed(shape):
        strides.append(stride)
        stride = builder.mul(stride, extent)
    nitems = shape[0]
    for extent in shape[1:]:
        nitems = builder.mul(nitems, extent)
    array = context.get_constant_null(kind)
    for name, value in (("itemsize", itemsize), ("nitems", nitems), ("data", data)):
        array = builder.insert_value(array, value, where[name])
    for k in range(kind.ndim):
        array = builder.insert_value(array, shape[k], [where["shape"], k])
        array = builder.insert_value(array, strides[-1 - k], [where["strides"], k])
    return array


_kinds: dict[tuple, types.Type] = {}  # of arrays that are alike in all that numba asks of one


def _kind_of(field: Any, context: Any) -> types.Type | None:
    """Return numba's type of a field; remembered, as numba takes 20 µs for each array."""
    if type(field) is not np.ndarray:
        return typeof_impl(field, context)
    flags = field.flags
    alike = (field.dtype, field.ndim, flags.c_contiguous, flags.f_contiguous, flags.writeable, flags.aligned)
    if alike not in _kinds:
        _kinds[alike] = typeof_impl(field, context)
    return _kinds[alike]


@cache
def pass_records_by_reference() -> None:
    """Let numba pass named tuples of this package by reference, as long as kernels are compiled the own way."""
    by_numba = typeof_impl.dispatch(tuple)

    @typeof_impl.register(tuple)
    def type_of(value: tuple, context: Any) -> types.Type | None:
        names = getattr(value, "_fields", None)
        if names is None or type(value).__module__.partition(".")[0] != _PACKAGE or not SWITCH.own_way():
            return by_numba(value, context)
        kinds = [_kind_of(field, context) for field in value]
        if any(kind is None for kind in kinds):
            return None
        return _record(type(value).__name__, tuple(zip(names, kinds, strict=True)))
