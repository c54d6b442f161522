"""The one door to numba: `@kernel` for compiled entry points, `@inline` for what they call.

Numba is loaded when a kernel is first compiled (kernels/compilation/machine_code.py), a third of a second: what was
kept of an earlier process (kept_code.py), or is called `uncompiled`, does without.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np

from dem_cli.kernels.compilation.kept_code import OtherTypes, kept_kernel

__all__ = [
    "CompiledKernel",
    "always_inline",
    "built_in",
    "inline",
    "kernel",
    "literal_unroll",
    "named",
    "overload",
    "uncompiled",
]

Declaration = tuple[str, Callable, Any]  # name of a function in machine_code.py, and what it is given


class _Door:
    """What was declared before numba was there, and whether kernels are to run without it."""

    def __init__(self) -> None:
        self.open, self.uncompiled, self.lock = False, 0, threading.RLock()
        self.waiting: list[Declaration] = []

    def declare(self, *declaration: Any) -> None:
        """Tells numba of a function, at once or when it comes."""
        with self.lock:
            if self.open:
                self._tell(*declaration)
            else:
                self.waiting.append(declaration)

    def kept(self, function: Callable, arguments: tuple[Any, ...]) -> Callable | None:
        """The function as machine code from an earlier process, for such arguments, without numba."""
        with self.lock:
            return kept_kernel(function, arguments)

    def compiled(self, function: Callable) -> Callable:
        """The function as machine code; loads numba."""
        from dem_cli.kernels.compilation.machine_code import compiled

        with self.lock:
            self.open = True
            while self.waiting:
                self._tell(*self.waiting.pop(0))
            return compiled(function)

    @staticmethod
    def _tell(how: str, function: Any, given: Any) -> None:
        from dem_cli.kernels.compilation import machine_code

        if function.__globals__.get("literal_unroll") is literal_unroll:
            function.__globals__["literal_unroll"] = machine_code.literal_unroll  # which numba knows by itself
        getattr(machine_code, how)(function, given)


_door = _Door()


class CompiledKernel:
    """A compiled function, and the Python function that it is compiled from."""

    def __init__(self, function: Callable) -> None:
        self.py_func = function
        self._kept: list[Callable] = []  # for arguments of some types each
        self._machine_code: Any = None

    def __call__(self, *arguments: Any) -> Any:
        """Runs the compiled code; compiles it, or loads it, at the first call with these types."""
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
        return (self._machine_code or self._made())(*arguments)

    def bound(self) -> Callable:
        """The compiled code itself, for more calls with the objects of the last one: it does not look at types, 7 µs.

        Numbers may be others of the same type; in the place of an array of another type it would read nonsense.
        """
        if _door.uncompiled:
            return self
        if self._machine_code is None and self._kept:
            return self._kept[0] if len(self._kept) == 1 else self
        overloads = list((self._machine_code or self._made()).overloads.values())
        return overloads[0].entry_point if len(overloads) == 1 else self

    def _made(self) -> Any:
        self._machine_code = _door.compiled(self.py_func)
        return self._machine_code

    def __getattr__(self, name: str) -> Any:
        """What numba knows of it."""
        return getattr(self._machine_code or self._made(), name)


def kernel(function: Callable) -> CompiledKernel:
    """Compile once, keep on disk. IEEE division, no fast-math: same input, same bytes."""
    return CompiledKernel(function)


@contextmanager
def uncompiled() -> Iterator[None]:
    """Kernels inside of it run as the Python that they are written in: a hundred times slower, but at once.

    For a few blocks in all that is not worth loading numba. Python does not divide by zero, nor take roots of negative
    numbers: it raises ArithmeticError or ValueError where compiled code goes on with inf and nan.
    """
    _door.uncompiled += 1
    try:
        yield
    finally:
        _door.uncompiled -= 1


def inline(function: Callable) -> Callable:
    """For what kernels call."""
    _door.declare("declare_callee", function, False)
    return function


def always_inline(function: Callable) -> Callable:
    """For what is called for each point of the contact loop."""
    _door.declare("declare_callee", function, True)
    return function


def overload(function: Callable) -> Callable:
    """What compiled code takes for a plain function: the decorated one returns it, by the types of its arguments."""

    def declared(implementation: Callable) -> Callable:
        _door.declare("declare_overload", function, implementation)
        return implementation

    return declared


def built_in(function: Callable) -> Callable:
    """For what compiled code has LLVM code for: kernels/compilation/views.py, by its name."""
    _door.declare("declare_built_in", function, None)
    return function


def literal_unroll(links: tuple) -> tuple:
    """For loops over tuples of records of several types."""
    return links


def named(function: Callable, *parts: Callable | str) -> Callable:
    """The same closure, with a name that says what it was made of.

    Numba tells functions of one name and types apart by a count that starts anew in each process. Of two closures
    that were compiled in two processes and come from the cache in a third, one may otherwise run for the other.
    """
    words = [part if isinstance(part, str) else part.__qualname__.rpartition(".")[2] for part in parts]
    function.__qualname__ = "_".join([function.__qualname__, *words])
    return function
