"""Entries of kernels: functions by which compiled kernels are called without numba, and which of them may be kept.

An entry takes one address, that of a frame: a word for errors, then the arguments as numba lays them out, one after the
other. It is compiled with its kernel, into the same object code, which kept_code.py keeps and calls.
"""

from __future__ import annotations

import re
import struct
import sys
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.compiler_machinery import register_pass
from numba.core.lowering import Lower
from numba.core.typed_passes import NativeLowering
from numba.np import numpy_support

from dem_cli.core.kernels.compilation.kept_code import Header, keep, may_be_kept
from dem_cli.core.kernels.compilation.kinds import WORD, words_of_kind
from dem_cli.core.kernels.compilation.references import Record
from dem_cli.core.kernels.compilation.switch import SWITCH

__all__ = ["KernelLowering", "keep_compiled"]

_RESULTS = {types.int64: "i", types.float64: "d", types.boolean: "b", types.none: ""}
_OF_PYTHON = re.compile(r"(NRT_|numba_|Py|_Py|\.numba)")  # names of what only numba and Python have
_NEVER_DONE = {"NRT_incref", "NRT_decref", "NRT_MemInfo_call_dtor"}  # to arrays whose memory somebody else counts
_TAKES = "it takes "  # which is for who calls it to mend, not for who wrote it
_NAMES = re.compile(r'@"?([\w.$]+)"?')


def kind_of_type(kind: types.Type) -> str | None:
    """Name the kind of a numba type as `kinds.kind_of` does for a value; None where there is no such kind."""
    if isinstance(kind, types.Array):
        if kind.layout != "C" or not kind.aligned:
            return None
        return f"{numpy_support.as_dtype(kind.dtype).str}{kind.ndim}{'' if kind.mutable else 'r'}"
    if kind in (types.int64, types.float64):
        return _RESULTS[kind]
    if isinstance(kind, Record):
        members = [kind_of_type(each) for each in kind.types.values()]
        word = kind.name.rpartition("_")[0]
        return None if None in members else f"{word}[{' '.join(map(str, members))}]"
    if isinstance(kind, types.UniTuple | types.Tuple):
        members = [kind_of_type(each) for each in kind.types]
        return None if None in members else f"({' '.join(map(str, members))})"
    return None


def _hindrance(of: Any) -> str:
    """Explain why a function gets no entry, by its arguments and result; empty where it gets one."""
    if of.restype not in _RESULTS:
        return f"it returns {of.restype}"
    return next((f"{_TAKES}{each}" for each in of.argtypes if kind_of_type(each) is None), "")


class KernelLower(Lower):
    """Lowering of a kernel, with an entry in the place of numba's own function for C."""

    def create_cfunc_wrapper(self) -> None:
        """Add the entry of the kernel."""
        of, context = self.fndesc, self.context
        if _hindrance(of) or not may_be_kept():
            return
        kinds = [str(kind_of_type(each)) for each in of.argtypes]
        module = context.create_module("entry")
        kernel = ir.Function(module, context.call_conv.get_function_type(of.restype, of.argtypes), of.llvm_func_name)
        result = {"": ir.VoidType(), "b": ir.IntType(64)}.get(_RESULTS[of.restype], context.get_value_type(of.restype))
        entry = ir.Function(module, ir.FunctionType(result, [ir.IntType(64).as_pointer()]), of.llvm_cfunc_wrapper_name)
        builder = ir.IRBuilder(entry.append_basic_block("entry"))
        (frame,), here, values = entry.args, 1, []
        for argument, kind in zip(of.argtypes, kinds, strict=True):
            like = context.get_value_type(argument)
            assert context.get_abi_sizeof(like) == WORD * words_of_kind(kind), argument
            place = builder.bitcast(builder.gep(frame, [ir.Constant(ir.IntType(64), here)]), like.as_pointer())
            values.append(builder.load(place))
            here += words_of_kind(kind)
        status, found = context.call_conv.call_function(
            builder, kernel, of.restype, of.argtypes, values, attrs=("noinline",)
        )
        builder.store(builder.sext(status.code, ir.IntType(64)), frame)
        found = builder.zext(found, result) if _RESULTS[of.restype] == "b" else found
        builder.ret(found) if _RESULTS[of.restype] else builder.ret_void()
        self.library.add_ir_module(module)


@register_pass(mutates_CFG=True, analysis_only=False)
class KernelLowering(NativeLowering):
    """Compiler pass: numba's own lowering, with an entry."""

    _name = "kernel_lowering"

    @property
    def lowering_class(self) -> type[Lower]:
        """Class that lowers kernels."""
        return KernelLower


def keep_compiled(function: Callable, of: Any, code: bytes, module: Any) -> None:
    """Keep the object code of a kernel on disk, if it can run without numba: it neither allocates nor raises. Says it
    where it cannot.

    of: numba's description of the function; code, module: of its object code, and LLVM's module that this was made of.
    """
    if not may_be_kept():
        return
    entry, hindrance = of.llvm_cfunc_wrapper_name, _hindrance(of)
    called = set() if hindrance else _called(str(module), entry) - _NEVER_DONE
    of_python = sorted(name for name in called if _OF_PYTHON.match(name))
    if hindrance or of_python or entry not in called:
        why = hindrance or (f"it calls {of_python[0]}" if of_python else "it has no entry")
        name = f"{function.__module__}.{function.__qualname__}"
        fault = name.partition(".")[0] == __name__.partition(".")[0] and not why.startswith(_TAKES)
        SWITCH.remark(f"numba is loaded in each process for {name}: {why}", fault)
        return
    undefined = _undefined(code)
    needed = sorted(name for name in undefined if name in called or not _OF_PYTHON.match(name))
    kinds = [str(kind_of_type(each)) for each in of.argtypes]
    keep(function, Header(kinds, _RESULTS[of.restype], entry, needed, sorted(undefined - set(needed)), 0), code)


def _called(text: str, entry: str) -> set[str]:
    """Find the names that a function of an LLVM module uses, directly or through others."""
    bodies: dict[str, set[str]] = {}
    for part in re.split(r"^define ", text, flags=re.MULTILINE)[1:]:
        name, *names = _NAMES.findall(part[: part.find("\n}")])
        bodies[name] = set(names)
    found, waiting = set(), [entry] if entry in bodies else []
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += bodies.get(name, ())
    return found


def _undefined(code: bytes) -> set[str]:
    """List undefined symbols of object code: symbols of no section in an ELF file of 64 bits."""
    assert (code[:5], sys.byteorder) == (b"\x7fELF\x02", "little")
    (sections,), (size, count) = struct.unpack_from("<Q", code, 40), struct.unpack_from("<HH", code, 58)
    table = [struct.unpack_from("<IIQQQQIIQQ", code, sections + size * k) for k in range(count)]
    found = set()
    for _, kind, _, _, offset, length, link, _, _, each in table:
        if kind != 2:  # symbols
            continue
        names = table[link][4]
        for place in range(offset + each, offset + length, each):  # the first one is none
            name, _, _, section = struct.unpack_from("<IBBH", code, place)
            if section == 0:
                found.add(code[names + name : code.index(b"\0", names + name)].decode())
    return found
