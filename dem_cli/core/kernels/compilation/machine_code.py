"""Machine code of kernels by the package's own way: declared, compiled and kept by what this folder adds to numba."""

from __future__ import annotations

import importlib
import sys
import uuid
from collections.abc import Callable
from pickle import UnpicklingError
from typing import Any, cast

import numba
from llvmlite.binding import parse_bitcode
from numba import types
from numba.core.caching import FunctionCache
from numba.core.runtime.nrt import rtsys
from numba.extending import lower_builtin, register_jitable, type_callable
from numba.extending import overload as numba_overload

from dem_cli.core.kernels.compilation.atomics import ATOMICS
from dem_cli.core.kernels.compilation.bits import BITS
from dem_cli.core.kernels.compilation.cache_folder import cache_folder, fingerprint
from dem_cli.core.kernels.compilation.callees import CALLEE, KERNEL, CalleeCompiler
from dem_cli.core.kernels.compilation.entries import keep_compiled
from dem_cli.core.kernels.compilation.numba_setup import UNDER_WAY, set_up_numba
from dem_cli.core.kernels.compilation.references import pass_records_by_reference
from dem_cli.core.kernels.compilation.shortcuts import take_shortcuts
from dem_cli.core.kernels.compilation.switch import SWITCH
from dem_cli.core.kernels.compilation.views import CODE, TYPES

__all__ = [
    "bound",
    "cache_folder",
    "compiled",
    "declare_built_in",
    "declare_callee",
    "declare_overload",
    "is_compiled_for",
    "literal_unroll",
    "take_own_way",
]


def _load_numba_without_blas() -> None:
    """Load numba without scipy.linalg, which it imports only to learn whether there is a BLAS: 0.2 s.

    No kernel here multiplies matrices.
    """
    if "scipy.linalg" not in sys.modules:
        sys.modules["scipy.linalg"] = None  # type: ignore[assignment]  # makes the import fail
        try:
            importlib.import_module("numba.np.arraymath")
        finally:
            del sys.modules["scipy.linalg"]


set_up_numba()


class KernelCache(FunctionCache):
    """Cache of compiled code on disk, found by a fingerprint of the closure of a kernel.

    Numba finds it by the closure as it is pickled, which depends on whether Python had compiled the modules itself or
    read them from `__pycache__`: the second process of a fresh checkout would compile everything again. And it
    numbers files, so that two processes that save two kernels at one time may write one file: here no two share a name.
    """

    def __init__(self, function: Callable) -> None:
        super().__init__(function)
        pattern = self._cache_file._data_name_pattern
        self._cache_file._data_name = lambda number: pattern.format(number=uuid.uuid4().int >> 64)

    def _index_key(self, sig: Any, codegen: Any) -> tuple:
        return sig, codegen.magic_tuple(), fingerprint(self._py_func)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save compiled code for numba and, where possible, for use without it. What cannot be saved is compiled all
        the same.
        """
        try:
            super().save_overload(sig, data)
            library = data.library
            if not UNDER_WAY:  # else another kernel calls it, not Python
                keep_compiled(self._py_func, data.fndesc, library._get_compiled_object(), library._final_module)
        except OSError as error:
            SWITCH.remark(f"{self._py_func.__qualname__} is not kept: {error}")
        except Exception as error:
            SWITCH.throw(error)

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load compiled code as numba does; code that is here only for numba is kept for use without it as well."""
        found = self._cache_file.load(self._index_key(sig, target_context.codegen()))
        if found is None:
            return None
        if not UNDER_WAY:
            (_, _, (code, bitcode)), of = found[:2]
            keep_compiled(self._py_func, of, code, parse_bitcode(bitcode))
        return self._impl.rebuild(target_context, found)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load compiled code without preparing numba to compile all that it knows, which takes as long as to load
        numba.

        Kernels call nothing outside of themselves but numba's runtime and functions of C, which are there from the
        start: it would make symbols of others, hashes of strings and threads of its own, known as well.
        """
        rtsys.initialize(target_context)
        try:
            with self._guard_against_spurious_io_errors():
                if (found := self._load_overload(sig, target_context)) is not None:
                    return found
        except (OSError, EOFError, UnpicklingError):  # damaged files: made anew
            self._cache_file.flush()
        _load_numba_without_blas()
        return None


def take_own_way() -> None:
    """Set numba up for the package's own way, before anything is declared or compiled."""
    take_shortcuts(CalleeCompiler)
    pass_records_by_reference()


def literal_unroll(function: Any, name: str) -> None:
    """Bind numba's loop over a tuple of several types to a name that a function sees."""
    function.__globals__[name] = numba.literal_unroll


def compiled(function: Callable) -> Callable:
    """Compile a function, or load its machine code from disk. IEEE division, no fast-math."""
    found: Any = numba.njit(error_model="numpy", fastmath=False, nogil=True, **KERNEL)(function)
    found._cache = KernelCache(function)  # as its `enable_caching` does with numba's own
    return cast(Callable, found)


def bound(kernel: Any) -> Callable:
    """Code that a kernel ran for its last arguments, without a check of types; the kernel where there are several."""
    overloads = list(kernel.overloads.values())
    return cast(Callable, overloads[0].entry_point) if len(overloads) == 1 else cast(Callable, kernel)


def is_compiled_for(kernel: Any, arguments: tuple[Any, ...]) -> bool:
    """Test whether there is machine code for such arguments: then an error of a call is the kernel's own."""
    try:
        return tuple(map(numba.typeof, arguments)) in kernel.overloads
    except Exception:
        return False


def declare_callee(function: Callable, forced: bool) -> None:
    """Let kernels call this function; forced: it is always inlined, which numba decides otherwise.

    What kernels call allocates nothing and keeps no array, so that references to arrays need no counting: counted at
    each call inside a branching loop, they cost several times the work of a law. (`_nrt`: numba's runtime for them.)
    """
    register_jitable(_nrt=False, **({"forceinline": True} if forced else {}), **CALLEE)(function)


def declare_overload(function: Callable, implementation: Callable) -> None:
    """Let kernels call this function, and get what `implementation` returns for the types of its arguments."""
    numba_overload(function, jit_options=cast(Any, {"_nrt": False, **CALLEE}))(implementation)


def declare_built_in(function: Callable, _: None) -> None:
    """Let kernels call this function, whose LLVM code is in views.py, atomics.py or bits.py under its name."""
    name = function.__name__
    if name in TYPES:
        type_callable(function)(TYPES[name])
        lower_builtin(function, *[types.Array] * function.__code__.co_argcount)(CODE[name])
    else:
        declare_overload(function, {**ATOMICS, **BITS}[name])
