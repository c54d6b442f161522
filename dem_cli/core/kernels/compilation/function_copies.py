"""Copies of functions that name one another, so that numba takes each for one that it has never seen.

What it was told of a function, it cannot be told otherwise. Where the own way fails after it has told numba of the
functions that kernels call, copies of them are declared, and copies of kernels that call these are compiled.
"""

from __future__ import annotations

from collections.abc import Iterable
from types import CellType, FunctionType
from typing import Any

__all__ = ["FunctionCopies"]


class FunctionCopies:
    """Copies of functions: wherever one names another, in its module or closure, it names the copy."""

    def __init__(self) -> None:
        self._modules: set[int] = set()  # ids of the names in each module whose functions are copied
        self._names: dict[int, dict[str, Any]] = {}  # of the copies, by the names that the functions see
        self._copies: dict[int, tuple[FunctionType, FunctionType]] = {}  # each with its original, which keeps its id

    def include(self, declared: Iterable[Any]) -> None:
        """Include functions of the modules of these, which have to be loaded to their end by now."""
        self._modules |= {id(each.__globals__) for each in declared}

    def of(self, function: Any) -> Any:
        """Return the copy of a function; anything else as it is."""
        if isinstance(function, tuple) and type(function) is tuple:
            return tuple(map(self.of, function))
        if not isinstance(function, FunctionType):
            return function
        if id(function) not in self._copies:
            if id(function.__globals__) not in self._modules:
                return function
            self._copy(function)
        return self._copies[id(function)][1]

    def _copy(self, function: FunctionType) -> None:
        names, cells = function.__globals__, tuple(CellType() for _ in function.__closure__ or ())
        known = id(names) in self._names
        seen = self._names.setdefault(id(names), dict(names))
        copy = FunctionType(function.__code__, seen, function.__name__, function.__defaults__, cells or None)
        copy.__qualname__, copy.__module__ = function.__qualname__, function.__module__
        copy.__kwdefaults__ = function.__kwdefaults__
        self._copies[id(function)] = function, copy
        for cell, held in zip(cells, function.__closure__ or (), strict=True):
            cell.cell_contents = self.of(held.cell_contents)
        if not known:
            seen |= {name: self.of(value) for name, value in names.items()}
