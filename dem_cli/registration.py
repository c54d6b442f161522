"""Registry of kinds by name: joint laws, links and the like, each imported on first use."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Generic, TypeVar

Kind = TypeVar("Kind")


class Registered(Mapping[str, Kind], Generic[Kind]):
    """Registry of kinds by name; a place is a module and the name of the kind in it."""

    def __init__(self, places: Mapping[str, tuple[str, str]]) -> None:
        self._places = dict(places)

    def __getitem__(self, name: str) -> Kind:
        module, attribute = self._places[name]
        found: Kind = getattr(import_module(module), attribute)
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def __contains__(self, name: object) -> bool:
        return name in self._places
