"""Machine code of kernels: the side of the door behind which numba is, loaded when a kernel is to be compiled."""

from __future__ import annotations

import gc
import importlib
import os
import sys
import uuid
from collections.abc import Callable
from typing import Any, cast

import numba
from llvmlite.binding import parse_bitcode
from numba import literal_unroll, types
from numba.core import event
from numba.core.caching import FunctionCache
from numba.core.runtime.nrt import rtsys
from numba.extending import lower_builtin, register_jitable, type_callable
from numba.extending import overload as numba_overload

from dem_cli.kernels.compilation.cache_folder import cache_folder, fingerprint
from dem_cli.kernels.compilation.callees import CALLEE, KERNEL
from dem_cli.kernels.compilation.compile_time import LISTENING
from dem_cli.kernels.compilation.entries import keep_compiled
from dem_cli.kernels.compilation.views import CODE, TYPES

__all__ = ["compiled", "declare_built_in", "declare_callee", "declare_overload", "literal_unroll"]


class Outermost(event.Listener):
    """Hears where compilation of a kernel begins and ends, not that of what it calls, and tells who asked.

    Python collects no garbage meanwhile: it would look at a million live objects again and again, which was a fifth of
    the time of compilation.
    """

    _depth, _collecting = 0, False

    def on_start(self, event: event.Event) -> None:
        """A kernel, or something inside of it."""
        if not self._depth:
            for each in LISTENING:
                each.begins()
            self._collecting = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: event.Event) -> None:
        """A kernel, or something inside of it."""
        self._depth -= 1
        if not self._depth:
            if self._collecting:
                gc.enable()
            for each in LISTENING:
                each.ends()


event.register("numba:compile", Outermost())


def _load_numba_without_blas() -> None:
    """numba imports scipy.linalg when it first meets an array, only to learn whether there is a BLAS: 0.2 s.

    No kernel here multiplies matrices.
    """
    if "scipy.linalg" not in sys.modules:
        sys.modules["scipy.linalg"] = None  # type: ignore[assignment]  # makes the import fail
        try:
            importlib.import_module("numba.np.arraymath")
        finally:
            del sys.modules["scipy.linalg"]


CACHE = str(cache_folder())
# Numba reads its settings again whenever a variable of its part of the environment has changed, and would from then on
# keep compiled code beside the sources, where nothing tells old code from new.
vars(numba.config)["CACHE_DIR"] = os.environ["NUMBA_CACHE_DIR"] = CACHE


class KernelCache(FunctionCache):
    """Compiled code on disk, found again by what the closure of a kernel was made of.

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
        """For numba and, where it can, for itself."""
        super().save_overload(sig, data)
        if KERNEL:
            library = data.library
            keep_compiled(self._py_func, data.fndesc, library._get_compiled_object(), library._final_module)

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        """As numba's own; what is here only for numba is kept as well: it would not be asked for it otherwise."""
        found = self._cache_file.load(self._index_key(sig, target_context.codegen()))
        if found is None:
            return None
        if KERNEL:
            (_, _, (code, bitcode)), of = found[:2]
            keep_compiled(self._py_func, of, code, parse_bitcode(bitcode))
        return self._impl.rebuild(target_context, found)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """As numba's own, which first gets ready to compile all that it knows: that takes as long as to load numba.

        Kernels call nothing outside of themselves but numba's runtime and functions of C, which are there from the
        start: it would make symbols of others, hashes of strings and threads of its own, known as well.
        """
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            if (found := self._load_overload(sig, target_context)) is not None:
                return found
        _load_numba_without_blas()
        return None


def compiled(function: Callable) -> Callable:
    """The function as machine code, from the disk where it is there. IEEE division, no fast-math."""
    found: Any = numba.njit(error_model="numpy", fastmath=False, nogil=True, **KERNEL)(function)
    found._cache = KernelCache(function)  # as its `enable_caching` does with numba's own
    return cast(Callable, found)


def declare_callee(function: Callable, forced: bool) -> None:
    """Kernels may call this function; forced: it is put in the place of each call, which numba decides otherwise.

    What kernels call allocates nothing and keeps no array, so that references to arrays need no counting: counted at
    each call inside a branching loop, they cost several times the work of a law. (`_nrt`: numba's runtime for them.)
    """
    register_jitable(_nrt=False, **({"forceinline": True} if forced else {}), **CALLEE)(function)


def declare_overload(function: Callable, implementation: Callable) -> None:
    """Kernels may call this function, and get what `implementation` returns for the types of its arguments."""
    numba_overload(function, jit_options=cast(Any, {"_nrt": False, **CALLEE}))(implementation)


def declare_built_in(function: Callable, _: None) -> None:
    """Kernels may call this function, whose LLVM code views.py has."""
    name = function.__name__
    type_callable(function)(TYPES[name])
    lower_builtin(function, *[types.Array] * function.__code__.co_argcount)(CODE[name])
