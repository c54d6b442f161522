"""Frozen dataclasses without functions that Python writes and compiles at each start.

Thirty groups of settings cost a tenth of the time of `dem check` otherwise. All else of a dataclass is as it was:
`fields`, `replace`, equality, the hash, and what is written of one.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(*, frozen: bool):
        """Decorate a class as a frozen dataclass, in place of the decorator of `dataclasses`; frozen: True."""
        assert frozen

        def made(of: type) -> type:
            dataclasses.dataclass(init=False, repr=False, eq=False)(of)
            for own in (__init__, __repr__, __eq__, __hash__, __setattr__, __delattr__):
                setattr(of, own.__name__, own)
            return of

        return made


def __init__(self: Any, *values: Any, **named: Any) -> None:
    """Set the fields. Raises TypeError where a value is missing, unknown or given twice."""
    of, fields = type(self).__name__, self.__dataclass_fields__
    if len(values) > len(fields) or not named.keys() <= set(list(fields)[len(values) :]):
        raise TypeError(f"{of}: values of {', '.join(fields)} are expected, each once at most")
    given = self.__dict__
    given.update(zip(fields, values, strict=False))
    given.update(named)
    for name, field in fields.items():
        if name not in given:
            factory = field.default_factory
            given[name] = field.default if factory is dataclasses.MISSING else factory()
            if given[name] is dataclasses.MISSING:
                raise TypeError(f"{of}: no value of {name}")


def _values(record: Any) -> tuple[Any, ...]:
    return tuple(getattr(record, name) for name in record.__dataclass_fields__)


def __repr__(self: Any) -> str:
    pairs = zip(self.__dataclass_fields__, _values(self), strict=True)
    return f"{type(self).__qualname__}({', '.join(f'{name}={value!r}' for name, value in pairs)})"


def __eq__(self: Any, other: object) -> Any:
    return _values(self) == _values(other) if type(other) is type(self) else NotImplemented


def __hash__(self: Any) -> int:
    return hash(_values(self))


def __setattr__(self: Any, name: str, value: Any) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot assign to field '{name}'")


def __delattr__(self: Any, name: str) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot delete field '{name}'")
