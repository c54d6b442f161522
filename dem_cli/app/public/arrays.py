"""Named arrays with their units: histories, contact forces, energies, monitors of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from difflib import get_close_matches
from typing import NamedTuple, TypeVar

import numpy as np

Record = TypeVar("Record")  # what stands under a name


class ArrayTable(Mapping[str, np.ndarray]):
    """Arrays of equal length by name; `units` has the unit of each: SI; "" for a pure number or text."""

    def __init__(self, units: Mapping[str, str], values: Callable[[str], np.ndarray]):
        self.units = dict(units)
        self._values = values

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.units:
            raise KeyError(unknown(name, list(self.units)))
        return self._values(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.units)

    def __len__(self) -> int:
        return len(self.units)

    def __repr__(self) -> str:
        return f"<{', '.join(f'{name} [{unit}]' if unit else name for name, unit in self.units.items())}>"


class NamedRecords(dict[str, Record]):
    """Monitors or tables by name; an unknown name raises an error that lists the known ones."""

    def __missing__(self, name: str) -> Record:
        raise KeyError(unknown(name, list(self)))


class MonitorHistory(NamedTuple):
    """History of a [[monitor]]: along the time of a time history, else state by state, in the order of `history`."""

    values: np.ndarray  # (n,)
    unit: str
    quantity: str  # "displacement", "rotation", "velocity", "acceleration", "opening" or "slip"
    absolute: bool  # with the motion of the base
    time: np.ndarray | None  # of each value, since the start of a time history [s]; None: a static analysis
    load: np.ndarray | None  # load multiplier at each value of a static analysis; None: a time history

    def __repr__(self) -> str:
        kind = f"absolute {self.quantity}" if self.absolute else self.quantity
        return f"<{len(self.values)} values of {kind} [{self.unit}]>"


def unknown(name: object, names: list[str]) -> str:
    """Return the message for an unknown name."""
    close = get_close_matches(str(name), names, 1)
    hint = f", did you mean '{close[0]}'?" if close else ""
    return f"no '{name}'{hint} (there are: {', '.join(names) or 'none'})"
