"""Serialise objects of a run for checkpoints: their changing attributes, while lasting ones are only named.

A class of things that change while a solver works says in LASTING which of its attributes stay the objects that they
are: the model of a simulation, the simulation of a track. Everything else of it is kept, so that a new attribute cannot
be forgotten. The bytes are data (kept_values.py), and what they hold goes only where there is the like of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from typing import Any, Protocol

from dem_cli.core.records.likeness import alike
from dem_cli.results.output.resume.kept_values import Damaged, packed, unpacked

_PLAIN = (type(None), bool, int, float, complex, str, bytes, tuple, frozenset)  # which others may share by chance
_known: dict[type, bool] = {}  # which classes change


class Changing(Protocol):
    """Protocol of objects that change while a solver works."""

    LASTING: frozenset[str]  # attributes that stay the objects that they are


def _changes(one: Any) -> bool:
    """Test whether an object is `Changing`, faster than the 30 µs that a protocol takes."""
    kind = type(one)
    if kind not in _known:
        _known[kind] = hasattr(kind, "LASTING")
    return _known[kind]


def all_changing(objects: Iterable[Any]) -> list[Changing]:
    """Collect the changing objects, also those reached through lasting attributes; each once, in order."""
    found: dict[int, Changing] = {}
    waiting = list(objects)
    while waiting:
        one = waiting.pop(0)
        if _changes(one) and id(one) not in found:
            found[id(one)] = one
            waiting += [value for _, value in _lasting(one)]
    return list(found.values())


def encoded(changing: list[Changing], more: Any) -> bytes:
    """Serialise the changing attributes of objects, with data that may refer to them. Raises NotKept."""
    names = {id(value): name for name, value in _names(changing).items()}
    return packed(([_state(one) for one in changing], more), names)


def decoded(data: bytes, changing: list[Changing]) -> Any:
    """Restore what `encoded` stored of the same objects, and return the other data. Raises Damaged.

    Objects that have a `guard_of_kept` look at what came back to them, and at records that have a geometry.
    """
    records: list[Any] = []
    found = unpacked(data, _names(changing), records.append)
    if not (type(found) is tuple and len(found) == 2 and type(found[0]) is list and len(found[0]) == len(changing)):
        raise Damaged("it is of other objects")
    states, more = found
    for one, state in zip(changing, states, strict=True):
        check_like(one, state)
    guards = [one.guard_of_kept() for one in changing if hasattr(one, "guard_of_kept")]
    for one, state in zip(changing, states, strict=True):
        put_back(one, state)
    try:
        for guard in guards:
            guard(None)
        for record in records:
            if guards and hasattr(record, "geometry"):
                _accepted(record, guards)
    except (ValueError, AttributeError) as error:  # of attributes that are not there
        raise Damaged(str(error)) from None
    return more


def _accepted(record: Any, guards: list[Callable[[Any], None]]) -> None:
    """Raise ValueError where a record fits none of several scenes."""
    for guard in guards[:-1]:
        with suppress(ValueError):
            return guard(record)
    guards[-1](record)


def check_like(one: Any, state: Any) -> None:
    """Raise Damaged where a stored state does not belong to such an object."""
    if type(state) is not dict:
        raise Damaged(f"no state of {type(one).__name__}")
    lasting: frozenset[str] = getattr(one, "LASTING", frozenset())
    here = vars(one)
    for name, value in state.items():
        if not isinstance(name, str) or name in lasting or callable(getattr(type(one), name, None)):
            raise Damaged(f"{name!r} is nothing that changes of {type(one).__name__}")
        if name in here and not alike(here[name], value):
            raise Damaged(f"{name} of {type(one).__name__} is of another kind")


def put_back(one: Any, state: Mapping[str, Any]) -> None:
    """Restore the attributes of a stored state; later ones are removed."""
    here = vars(one)
    for name in here.keys() - state.keys() - getattr(one, "LASTING", frozenset()):
        del here[name]
    here.update(state)


def _state(one: Changing) -> dict[str, Any]:
    return {name: value for name, value in vars(one).items() if name not in one.LASTING}


def _lasting(one: Changing) -> Iterator[tuple[str, Any]]:
    here = vars(one)
    return ((name, here[name]) for name in sorted(one.LASTING) if name in here)


def _names(changing: list[Changing]) -> dict[str, Any]:
    """Return everything that is named instead of stored."""
    found: dict[str, Any] = {}
    for number, one in enumerate(changing):
        found[str(number)] = one
        found |= {f"{number}.{name}": value for name, value in _lasting(one) if type(value) not in _PLAIN}
    return found
