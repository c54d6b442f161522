"""Decorators of compiled functions: `@kernel` for compiled entry points, `@inline` for what they call.

Numba is loaded when a kernel is first compiled (kernels/compilation/door.py), a third of a second: what was kept of an
earlier process (kept_code.py), or is called `uncompiled`, does without.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np

from dem_cli.core.kernels.compilation.door import Door, literal_unroll
from dem_cli.core.kernels.compilation.kinds import OtherTypes
from dem_cli.core.kernels.compilation.switch import SWITCH

__all__ = [
    "CompiledKernel",
    "always_inline",
    "built_in",
    "inline",
    "kernel",
    "literal_unroll",
    "named",
    "overload",
    "threads_may_share",
    "uncompiled",
]

_door = Door()


class CompiledKernel:
    """Compiled function, and the Python function that it is compiled from."""

    def __init__(self, function: Callable) -> None:
        self.py_func = function
        self._kept: list[Callable] = []  # for arguments of some types each
        self._machine_code: Any = None
        self._way: Any = None  # that it was made

    def __call__(self, *arguments: Any) -> Any:
        """Run the compiled code; compiles it, or loads it, at the first call with these types."""
        if _door.uncompiled:
            with np.errstate(all="ignore"):  # as compiled code does
                return self.py_func(*arguments)
        if self._machine_code is None:
            for kept in self._kept:
                with suppress(OtherTypes):
                    return kept(*arguments)
            found = _door.kept(self.py_func, arguments)
            if found is not None:
                self._kept.append(found)
                return found(*arguments)
        made = self._made()
        try:
            return made(*arguments)
        except Exception as error:
            if not _door.fails(self._way, made, arguments, error):
                raise
        return self._made()(*arguments)

    def bound(self) -> Callable:
        """Return the compiled code itself, for more calls with the objects of the last one: it does not look at types,
        7 µs.

        Numbers may be others of the same type; in the place of an array of another type it would read nonsense.
        """
        if _door.uncompiled:
            return self
        if self._machine_code is None and self._kept:
            return self._kept[0] if len(self._kept) == 1 else self
        made = self._made()
        bound: Callable = self._way.bound(made)
        return self if bound is made else bound

    def _made(self) -> Any:
        if self._machine_code is None or self._way is not _door.way:
            self._machine_code, self._way = _door.compiled(self.py_func)
        return self._machine_code

    def __deepcopy__(self, known: dict[int, Any]) -> CompiledKernel:
        return self

    def __getattr__(self, name: str) -> Any:
        """Return attributes that numba's compiled function has."""
        return getattr(self._made(), name)


def kernel(function: Callable) -> CompiledKernel:
    """Declare a compiled entry point, kept on disk. IEEE division, no fast-math: same input, same bytes."""
    return CompiledKernel(function)


@contextmanager
def uncompiled() -> Iterator[None]:
    """Run kernels as plain Python inside of a `with` block: a hundred times slower, but at once.

    For a few blocks in all that is not worth loading numba. Python does not divide by zero, nor take roots of negative
    numbers: it raises ArithmeticError or ValueError where compiled code goes on with inf and nan.
    """
    _door.uncompiled += 1
    try:
        yield
    finally:
        _door.uncompiled -= 1


def threads_may_share() -> bool:
    """Test whether threads in one compiled loop may add to the same arrays: plain numba has no atomic operations."""
    return SWITCH.own_way()


def inline(function: Callable) -> Callable:
    """Declare a function that kernels call."""
    _door.declare("declare_callee", function, False)
    return function


def always_inline(function: Callable) -> Callable:
    """Declare a function that is always inlined, as it is called for each point of the contact loop."""
    _door.declare("declare_callee", function, True)
    return function


def overload(function: Callable) -> Callable:
    """Declare what compiled code runs for a plain function: the decorated one returns it, by the types of its
    arguments.
    """

    def declared(implementation: Callable) -> Callable:
        _door.declare("declare_overload", function, implementation)
        return implementation

    return declared


def built_in(function: Callable) -> Callable:
    """Declare a function with LLVM code under its name in kernels/compilation/views.py, atomics.py or bits.py.

    Where kernels are compiled by numba as it comes, it does what it does in Python.
    """
    _door.declare("declare_built_in", function, None)
    return function


def named(function: Callable, *parts: Callable | str) -> Callable:
    """Rename a closure by what it was made of.

    Numba tells functions of one name and types apart by a count that starts anew in each process. Of two closures
    that were compiled in two processes and come from the cache in a third, one may otherwise run for the other.
    """
    words = [part if isinstance(part, str) else part.__qualname__.rpartition(".")[2] for part in parts]
    function.__qualname__ = "_".join([function.__qualname__, *words])
    return function
