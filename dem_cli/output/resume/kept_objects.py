"""Objects of a run as bytes and back, for checkpoints: what changes of them, while what lasts is only named.

A class of things that change while a solver works says in LASTING which of its attributes stay the objects that they
are: the model of a simulation, the simulation of a track. Everything else of it is kept, so that a new attribute cannot
be forgotten. The bytes are those of pickle, held to data: classes of this package, arrays, plain containers.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Protocol

_DATA = {
    "builtins": {"set", "frozenset", "complex", "slice"},
    "copyreg": {"_reconstructor"},
    "numpy": {"ndarray", "dtype"},
}
_ARRAYS = ("numpy._core.", "numpy.core.")  # as numpy 2 and 1 call it
_OF_ARRAYS = {"_reconstruct", "scalar", "_frombuffer"}
_PLAIN = (type(None), bool, int, float, complex, str, bytes, tuple, frozenset)  # which others may share by chance
_known: dict[type, bool] = {}  # which classes change


class Changing(Protocol):
    """What changes while a solver works."""

    LASTING: frozenset[str]  # attributes that stay the objects that they are


def _changes(one: Any) -> bool:
    """Whether it is `Changing`; Python takes 30 µs to say so of a protocol."""
    kind = type(one)
    if kind not in _known:
        _known[kind] = hasattr(kind, "LASTING")
    return _known[kind]


def all_changing(objects: Iterable[Any]) -> list[Changing]:
    """Those of some objects that change, and those that they lead to by what lasts of them; each once, in order."""
    found: dict[int, Changing] = {}
    waiting = list(objects)
    while waiting:
        one = waiting.pop(0)
        if _changes(one) and id(one) not in found:
            found[id(one)] = one
            waiting += [value for _, value in _lasting(one)]
    return list(found.values())


def encoded(changing: list[Changing], more: Any) -> bytes:
    """What changes of some objects, and more data that may refer to them."""
    stream = io.BytesIO()
    names = {id(value): name for name, value in _names(changing).items()}
    pickler = _Pickler(stream, protocol=5)
    pickler.names = names
    pickler.dump(([_state(one) for one in changing], more))
    return stream.getvalue()


def decoded(data: bytes, changing: list[Changing]) -> Any:
    """Puts back what `encoded` kept of the same objects, and gives the other data."""
    unpickler = _Unpickler(io.BytesIO(data))
    unpickler.names = _names(changing)
    states, more = unpickler.load()
    for one, state in zip(changing, states, strict=True):
        put_back(one, state)
    return more


def put_back(one: Any, state: Mapping[str, Any]) -> None:
    """Gives an object the attributes of a kept state; those that it got since go."""
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
    """Everything that is named instead of kept."""
    found: dict[str, Any] = {}
    for number, one in enumerate(changing):
        found[str(number)] = one
        found |= {f"{number}.{name}": value for name, value in _lasting(one) if type(value) not in _PLAIN}
    return found


class _Pickler(pickle.Pickler):
    names: Mapping[int, str]

    def persistent_id(self, one: Any) -> str | None:
        return self.names.get(id(one))


class _Unpickler(pickle.Unpickler):
    names: Mapping[str, Any]

    def persistent_load(self, name: str) -> Any:
        return self.names[name]

    def find_class(self, module: str, name: str) -> Any:
        """Classes of this package and what arrays are made of; nothing else is called."""
        of_arrays = module.startswith(_ARRAYS) and name in _OF_ARRAYS
        if of_arrays or name in _DATA.get(module, ()):
            return super().find_class(module, name)
        found = super().find_class(module, name) if module.startswith("dem_cli.") else None
        if not isinstance(found, type):
            raise pickle.UnpicklingError(f"{module}.{name} is no data")
        return found
