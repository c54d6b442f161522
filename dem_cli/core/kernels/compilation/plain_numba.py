"""Kernels compiled by unmodified numba: its public names alone, for versions and machines where the package's own way
fails.

Records are taken apart, callees compiled as machine code of their own, references counted: compilation takes several
times as long, and each process loads numba. The arithmetic is the same, and so are the answers, to the last digit.
Threads cannot share one structure, which takes atomic operations (`engine/simulation.py` asks for that).
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from types import FunctionType
from typing import Any, cast

import numba
from numba.extending import overload, register_jitable

from dem_cli.core.kernels.compilation.cache_folder import fingerprint
from dem_cli.core.kernels.compilation.function_copies import FunctionCopies
from dem_cli.core.kernels.compilation.kinds import OtherTypes, kind_of
from dem_cli.core.kernels.compilation.numba_setup import set_up_numba
from dem_cli.core.kernels.compilation.switch import SWITCH

__all__ = ["PlainKernel", "PlainNumba"]

_OPTIONS: dict[str, Any] = {
    "error_model": "numpy",
    "fastmath": False,
    "nogil": True,
}  # IEEE division: same input, same bytes


class PlainNumba:
    """Way to compile kernels by unmodified numba. copies: declared instead of functions that numba knows already.
    copies: what to tell it of instead of the functions, where it knows these already.
    """

    def __init__(self, copies: FunctionCopies | None = None) -> None:
        set_up_numba()
        self._copies = copies

    def _mine(self, function: Callable) -> Any:
        return function if self._copies is None else self._copies.of(function)

    def declare_callee(self, function: Callable, forced: bool) -> None:
        """Let kernels call this function; forced: it is always inlined."""
        (register_jitable(forceinline=True) if forced else register_jitable)(self._mine(function))

    def declare_overload(self, function: Callable, implementation: Callable) -> None:
        """Let kernels call this function, and get what `implementation` returns for the types of its arguments."""
        overload(self._mine(function))(self._mine(implementation))

    def declare_built_in(self, function: Callable, _: None) -> None:
        """Let kernels call this function: what it does in Python is what it does here."""
        self.declare_callee(function, True)

    def literal_unroll(self, function: FunctionType, name: str) -> None:
        """Bind numba's loop over a tuple of several types to a name that a function sees."""
        self._mine(function).__globals__[name] = numba.literal_unroll

    def compiled(self, function: Callable) -> PlainKernel:
        """Make a kernel that compiles the function at its first call."""
        return PlainKernel(self._mine(function), kept=self._copies is None)

    @staticmethod
    def bound(kernel: PlainKernel) -> Callable:
        """Return the callable of a kernel that checks types least."""
        return kernel

    @staticmethod
    def is_compiled_for(kernel: PlainKernel, arguments: tuple[Any, ...]) -> bool:
        """Return True: any error is the kernel's own, as there is no other way left to compile it."""
        return True


class PlainKernel:
    """Kernel with a compiled function for the types of each call; kept: in the cache of numba as well.

    Each of them has a name of its own. Numba numbers what it keeps of functions of one name, so that two processes
    that compile one kernel for different types at one time might run the code of each other.
    """

    def __init__(self, function: FunctionType, kept: bool = True) -> None:
        self._function, self._kept = function, kept
        self._made: dict[tuple[str, ...], Callable] = {}
        self._of_any_types: Any = numba.njit(**_OPTIONS)(function)

    def __call__(self, *arguments: Any) -> Any:
        """Run the kernel; compiles it at the first call with these types."""
        try:
            kinds = tuple(map(kind_of, arguments))
        except OtherTypes:
            kinds = ()
        found = self._made.get(kinds)
        if found is None:
            found = self._made[kinds] = self._for(kinds, arguments)
        return found(*arguments)

    def _for(self, kinds: tuple[str, ...], arguments: tuple[Any, ...]) -> Callable:
        if self._kept and kinds:
            try:
                types = tuple(map(numba.typeof, arguments))
                return numba.njit(types, cache=True, **_OPTIONS)(self._named_by(kinds))
            except Exception as error:  # of the cache; where it is the kernel's, it comes again
                SWITCH.remark(f"{self._function.__qualname__} is not kept: {type(error).__name__}: {error}")
        return cast(Callable, self._of_any_types)

    def __getattr__(self, name: str) -> Any:
        """Return attributes that numba needs where another kernel calls this one."""
        return getattr(self._of_any_types, name)

    def _named_by(self, kinds: tuple[str, ...]) -> FunctionType:
        """Copy the function under a name that says for which arguments it is compiled."""
        of = self._function
        copy = FunctionType(of.__code__, of.__globals__, of.__name__, of.__defaults__, of.__closure__)
        digest = hashlib.sha256(repr((fingerprint(of), kinds)).encode()).hexdigest()
        copy.__qualname__, copy.__module__ = f"{of.__qualname__}_{digest[:16]}", of.__module__
        return copy
