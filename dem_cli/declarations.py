"""Declared parameters of laws, links and motions: meaning, unit, range, default and example, in plain Python.

A class of `Parameters` names them; its instances are frozen records that need nothing else. The table of a case file,
its messages and its pages follow from the declaration (case/tables/declared.py).
"""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Callable, Collection, Mapping
from functools import cache
from inspect import get_annotations
from types import MappingProxyType, UnionType
from typing import (
    Annotated,
    Any,
    ClassVar,
    Literal,
    NamedTuple,
    Self,
    Union,
    dataclass_transform,
    get_args,
    get_origin,
)

REQUIRED: Any = ...  # in place of a default: the parameter must be given
KEEPS: dict[str, Callable[[Any, Any], bool]] = {  # whether a value keeps each of `Limits`
    "gt": operator.gt,
    "ge": operator.ge,
    "lt": operator.lt,
    "le": operator.le,
    "min_length": lambda value, least: len(value) >= least,
}


class KeyProblem(ValueError):
    """Error for a parameter whose value is not allowed, by itself or beside others; raised while a table is checked.

    `raise KeyProblem("0 is not allowed; must be ...", "openings", 2, "width")`: keys below that table.
    """

    def __init__(self, message: str, *keys: str | int):
        super().__init__(message)
        self.keys = keys


class Limits(NamedTuple):
    """Annotation with the limits of a number, or of the length of a text or tuple; None: no limit."""

    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None
    min_length: int | None = None

    @property
    def named(self) -> dict[str, Any]:
        """Limits that are set, by name."""
        return {name: limit for name, limit in self._asdict().items() if limit is not None}


class SpaceLength(NamedTuple):
    """Annotation with the lengths of a tuple of numbers in the plane and in space."""

    planar: int
    spatial: int


Positive = Annotated[float, Limits(gt=0.0)]
NonNegative = Annotated[float, Limits(ge=0.0)]
Share = Annotated[float, Limits(gt=0.0, lt=1.0)]
Name = Annotated[str, Limits(min_length=1)]
SpaceVector = Annotated[tuple[float, ...], SpaceLength(2, 3)]  # a point, vector or force in the space of the case


class Parameter(NamedTuple):
    """Declaration of one parameter.

    words: description, with the unit in brackets, and examples; annotation: its type as it is written in `module`.
    """

    default: Any = REQUIRED
    words: Mapping[str, Any] = MappingProxyType({})
    limits: Limits = Limits()
    annotation: str = "Any"
    module: str = __name__

    @property
    def kind(self) -> Any:
        """Annotated type of the parameter."""
        return _evaluated(self.annotation, self.module)


def parameter(
    *,
    description: str,
    default: Any = REQUIRED,
    examples: list[Any] | None = None,
    **limits: float,
) -> Any:
    """Declare a parameter of a class of `Parameters`; its conventions: case/keys.py.

    limits: gt, ge, lt, le; examples: where there is no default to show.
    """
    bounds: dict[str, Any] = limits
    words = {"description": description} | ({"examples": examples} if examples else {})
    return Parameter(default, words, Limits(**bounds))


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(parameter,))
class Parameters:
    """Frozen values of declared parameters by name; subclasses check relations among them with `check`."""

    declared: ClassVar[dict[str, Parameter]] = {}

    def __init_subclass__(cls, **options: Any) -> None:
        """Collect the parameters, with their annotations, from the body of a subclass."""
        super().__init_subclass__(**options)
        cls.declared = {name: one for base in reversed(cls.__mro__[1:]) for name, one in _of(base).items()}
        annotations = get_annotations(cls)
        if not all(isinstance(written, str) for written in annotations.values()):
            raise TypeError(f"{cls.__module__} declares parameters: begin it with `from __future__ import annotations`")
        for name in [name for name, written in annotations.items() if not written.startswith("ClassVar")]:
            value = vars(cls).get(name, REQUIRED)
            one = value if isinstance(value, Parameter) else Parameter(value)
            cls.declared[name] = one._replace(annotation=annotations.pop(name), module=cls.__module__)
            if name in vars(cls):
                delattr(cls, name)
        cls.__annotations__ = annotations  # those that are left: else a table would evaluate all of them anew

    def __init__(self, **values: Any) -> None:
        """Set and check all values."""
        unknown = values.keys() - self.declared.keys()
        missing = {name for name, one in self.declared.items() if one.default is REQUIRED} - values.keys()
        if unknown or missing:
            said = [f"'{name}' is no parameter" for name in sorted(unknown)]
            said += [f"'{name}' is missing" for name in sorted(missing)]
            raise TypeError(f"{type(self).__name__}: {', '.join(said)} (there are {', '.join(self.declared)})")
        vars(self).update({name: one.default for name, one in self.declared.items()} | values, _given=frozenset(values))
        try:
            for name, value in values.items():
                one = self.declared[name]
                if not _fits(value, one.kind) or not (value is None or _within(value, one.limits)):
                    said = one.words.get("description", one.annotation)
                    raise KeyProblem(f"{show(value)} is not allowed: {said}", name)
            self.check()
        except KeyProblem as problem:
            problem.add_note(f"{type(self).__name__}: {'.'.join(map(str, problem.keys))}")
            raise

    @property
    def names_given(self) -> set[str]:
        """Names of the values that were given; the others are defaults."""
        return set(vars(self)["_given"])

    def check(self) -> None:
        """Check relations among the values."""

    def with_values(self, **values: Any) -> Self:
        """Return a copy with some values replaced, unchecked."""
        return self._unchecked(_values(self) | values, self.names_given | values.keys())

    @classmethod
    def _unchecked(cls, values: Mapping[str, Any], given: Collection[str]) -> Self:
        made = cls.__new__(cls)
        vars(made).update(values, _given=frozenset(given))
        return made

    @property
    def alone(self) -> Parameters:
        """Record of the same values without the table class of a case file."""
        declaring: Any = next(base for base in type(self).__mro__ if "declared" in vars(base))
        values = {n: one.alone if isinstance(one, Parameters) else one for n, one in _values(self).items()}
        made: Parameters = declaring._unchecked(values, self.names_given)
        return made

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and _values(self) == _values(other)

    def __hash__(self) -> int:
        return hash(tuple(_values(self).values()))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in _values(self).items())})"

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"cannot assign to '{name}': {type(self).__name__} is frozen")


def show(value: Any) -> str:
    """Format a value as it stands in the file, shortened to be read at a glance."""
    if isinstance(value, str):
        text = "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in f"'{value}'")
    elif isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, float):
        text = f"{value:.12g}"
    elif isinstance(value, dict):
        text = "a table" if value else "an empty table"
    elif isinstance(value, (list, tuple)):
        text = f"[{', '.join(show(item) for item in value)}]"
    else:
        text = str(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _of(base: Any) -> dict[str, Parameter]:
    return getattr(base, "declared", {})


def _values(record: Any) -> dict[str, Any]:
    return {name: getattr(record, name) for name in record.declared}


@cache
def _evaluated(annotation: str, module: str) -> Any:
    """Evaluate the text of a type annotation with the names of its module."""
    return eval(annotation, vars(sys.modules[module]))


@cache
def _taken_apart(kind: Any) -> tuple[Any, tuple[Any, ...]]:
    return get_origin(kind), get_args(kind)


@cache
def _bounds(limits: Limits) -> tuple[tuple[Callable[[Any, Any], bool], float], ...]:
    return tuple((KEEPS[name], bound) for name, bound in limits.named.items())


def _fits(value: Any, kind: Any) -> bool:
    """Test whether a value is of an annotated type and within its limits."""
    origin, parts = _taken_apart(kind)
    if origin is Annotated:
        return _fits(value, parts[0]) and all(_within(value, limit) for limit in parts[1:])
    if origin in (Union, UnionType):
        return any(_fits(value, part) for part in parts)
    if origin is Literal:
        return value in parts
    if origin is tuple:
        many = parts[-1] is Ellipsis
        kinds = parts[:1] * len(value) if many and isinstance(value, tuple) else parts
        return isinstance(value, tuple) and len(value) == len(kinds) and all(map(_fits, value, kinds))
    if kind in (float, int):
        number = isinstance(value, (int, kind)) and not isinstance(value, bool)
        return number and math.isfinite(value)
    return isinstance(value, kind)


def _within(value: Any, limits: Limits | SpaceLength) -> bool:
    """Test whether a value, or its length, keeps within limits."""
    if isinstance(limits, SpaceLength):
        return len(value) in limits
    return all(keeps(value, bound) for keeps, bound in _bounds(limits))
