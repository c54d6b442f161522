"""Access to numba: declaration of functions before or after it is loaded, and choice of the way to compile kernels."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from typing import Any

from dem_cli.core.kernels.compilation.function_copies import FunctionCopies
from dem_cli.core.kernels.compilation.kept_code import kept_kernel
from dem_cli.core.kernels.compilation.switch import SWITCH
from dem_cli.errors import DemError

__all__ = ["Door", "literal_unroll"]

Declaration = tuple[str, Callable, Any]  # name of a function of a way, and what it is given
_ROOM = __name__.rpartition(".")[0]


def literal_unroll(links: tuple) -> tuple:
    """Loop over tuples of records of several types, as numba's function of this name."""
    return links


class Door:
    """State of kernel compilation: declared functions, the way to compile once one is chosen, and whether numba is
    bypassed.

    way: the module machine_code.py or a PlainNumba; None while numba was not needed.
    """

    def __init__(self) -> None:
        self.way: Any = None
        self.uncompiled, self.lock = 0, threading.RLock()
        self._declared: list[Declaration] = []
        self._untold: list[Declaration] = []  # of what was declared, to the copies that the other way takes
        self._copies: FunctionCopies | None = None  # where numba was told of the functions themselves the own way
        self._told = False  # whether it was

    def declare(self, *declaration: Any) -> None:
        """Declare a function to numba, at once or when numba is loaded."""
        with self.lock:
            self._declared.append(declaration)
            if self._copies is not None:  # the module of this one may be half loaded
                self._untold.append(declaration)
            elif self.way is not None:
                self._guarded(self._tell, *declaration)

    def kept(self, function: Callable, arguments: tuple[Any, ...]) -> Callable | None:
        """Return machine code of the function from an earlier process, for such arguments, without numba."""
        with self.lock:
            return self._guarded(kept_kernel, function, arguments) if SWITCH.own_way() else None

    def compiled(self, function: Callable) -> tuple[Any, Any]:
        """Compile the function, and return the way that it was made; loads numba."""
        with self.lock:
            if self.way is None:
                self._guarded(self._open)
            elif not SWITCH.own_way() and not self._is_plain(self.way):
                self._open_plain()
            self._tell_copies()
            made = self._guarded(lambda: self.way.compiled(function))
            if made is None:
                self._tell_copies()
                made = self.way.compiled(function)
            return made, self.way

    def fails(self, way: Any, made: Any, arguments: tuple[Any, ...], error: Exception) -> bool:
        """Test whether an error of a call comes from its compilation; if so, plain numba compiles from now on."""
        with self.lock:
            if self._is_plain(way) or isinstance(error, DemError | MemoryError):
                return False
            if way.is_compiled_for(made, arguments):
                return False
            self._surprised(error)
            return True

    def _guarded(self, work: Callable, *given: Any) -> Any:
        """Run some work of the package's own way; None where it fails, after which plain numba is used."""
        try:
            return work(*given)
        except (DemError, MemoryError):
            raise
        except Exception as error:
            if self._is_plain(self.way):
                raise
            self._surprised(error)
            return None

    @staticmethod
    def _is_plain(way: Any) -> bool:
        return way is not None and way is not sys.modules.get(f"{_ROOM}.machine_code")

    def _surprised(self, error: Exception) -> None:
        SWITCH.throw(error)
        if not self._is_plain(self.way):
            self._open_plain()

    def _open(self) -> None:
        """Load numba, and declare all functions to it."""
        if not SWITCH.own_way():
            self._open_plain()
            return
        from dem_cli.core.kernels.compilation.private_names import check_private_names

        check_private_names()
        from dem_cli.core.kernels.compilation import machine_code
        from dem_cli.core.kernels.compilation.self_check import check_small_kernel

        machine_code.take_own_way()
        check_small_kernel()
        self._told = True
        self.way = machine_code
        for declaration in self._declared:
            self._tell(*declaration)

    def _open_plain(self) -> None:
        from dem_cli.core.kernels.compilation.plain_numba import PlainNumba

        shortcuts = sys.modules.get(f"{_ROOM}.shortcuts")
        if shortcuts is not None:
            shortcuts.leave_shortcuts()
        self._copies = FunctionCopies() if self._told else None
        self.way = PlainNumba(self._copies)
        if self._copies is not None:
            self._untold = list(self._declared)
        else:
            for declaration in self._declared:
                self._tell(*declaration)

    def _tell_copies(self) -> None:
        """Declare to numba copies of the functions declared up to now."""
        if self._copies is not None:
            self._copies.include(each for _, each, _ in self._untold)
            while self._untold:
                self._tell(*self._untold.pop(0))

    def _tell(self, how: str, function: Any, given: Any) -> None:
        for name, value in function.__globals__.items():
            if value is literal_unroll:
                self.way.literal_unroll(function, name)
                break
        getattr(self.way, how)(function, given)
