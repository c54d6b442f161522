"""Constants of the solver with other values for a while: what a case file does not offer, only benchmarks ask for."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from importlib import import_module
from inspect import isfunction
from types import ModuleType
from typing import Any

HOME = "dem_cli.statics.equilibrium"
TOLERANCES = ("TOLERANCE", "GRAVITY_TOLERANCE")
SAFETIES = ("RELAX_SAFETY", "CREEP_SAFETY", "COMBINED_SAFETY")


class Missing(Exception):
    """The solver has no such constant any more."""


@contextmanager
def tolerance(value: float) -> Iterator[None]:
    """Another unbalanced force of a claimed equilibrium, over the block's own weight."""
    with changed(dict.fromkeys(TOLERANCES, value)):
        yield


@contextmanager
def time_step(factor: float) -> Iterator[None]:
    """Time steps longer by `factor` than usual, by lighter fictitious masses."""
    home = _home()
    with changed({name: factor * _value(home, name) for name in SAFETIES}):
        yield


@contextmanager
def changed(values: dict[str, Any]) -> Iterator[None]:
    """Constants of HOME with other values, in every module of the solver that imported them by name.

    Raises Missing where there is no such constant. Defaults of parameters that are the constant change as well.
    """
    home = _home()
    solver = [m for name, m in sys.modules.items() if name.startswith("dem_cli.solve.") and m is not None]
    with ExitStack() as undo:
        for name, value in values.items():
            old = _value(home, name)
            for module in solver:
                if getattr(module, name, None) is old:
                    undo.callback(setattr, module, name, old)
                    setattr(module, name, value)
                for function in [f for f in vars(module).values() if isfunction(f) and f.__module__ == module.__name__]:
                    defaults = function.__defaults__ or ()
                    if any(default is old for default in defaults):
                        undo.callback(setattr, function, "__defaults__", defaults)
                        function.__defaults__ = tuple(value if default is old else default for default in defaults)
        yield


def _home() -> ModuleType:
    import_module("dem_cli.analyses.pushover")  # brings everything that a failure search needs
    return import_module(HOME)


def _value(home: ModuleType, name: str) -> Any:
    if not hasattr(home, name):
        raise Missing(f"{HOME} has no {name}")
    return getattr(home, name)
