"""Shortcuts through numba: remembered answers that it works out again for every instruction, half of its compile time.

Each gives what numba would. It asks all that know an operator, text and sets among them, what it is for some types, at
each place where it stands, and twice. Where it looks for what arrays might be wrapped in, it finds nothing and loads
all of its extensions once more to look again. Options of a function are compared with all others, by value. Whether
its own functions take a place in the source is asked of their signatures, each time they are called.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from numba.core import base, types
from numba.core.base import BaseContext
from numba.core.targetconfig import ConfigStack, TargetConfig
from numba.core.types.functions import BaseFunction
from numba.core.typing.templates import _OverloadFunctionTemplate
from numba.extending import lower_builtin

__all__ = ["leave_shortcuts", "take_shortcuts"]

_compared_by_value = TargetConfig.__eq__
_asked_of_all = BaseFunction.get_call_type
_asked_of_llvm, _sizes = BaseContext.get_abi_sizeof, dict[str, int]()
_call_types: dict[int, tuple[BaseFunction, dict]] = {}  # by the function's id, which it keeps as long as it is here
_before: list[tuple[Any, str, Any]] = []  # whose, name and value of what was put into numba, to put back


def _equal(one: TargetConfig, other: object) -> bool:
    """Compare two sets of compiler options; options that neither has set are equal."""
    if type(one) is not type(other):
        return _compared_by_value(one, other)
    ours, theirs = one._values, other._values
    return ours == theirs or all(getattr(one, name) == getattr(other, name) for name in {**ours, **theirs})


@cache
def _hash_of(kind: type[TargetConfig]) -> int:
    """Hash the names of all options, as numba does, not their values."""
    return hash(tuple(sorted(kind.options)))


def _itself(context: Any, builder: Any, signature: Any, arguments: tuple) -> Any:
    """Lower the wrapper of an array to the array itself."""
    return arguments[0]


def _call_type(function: BaseFunction, context: Any, args: tuple, kws: dict) -> Any:
    """Find the signature of a call; remembered for numba's own operators, where options of the caller do not matter."""
    _, known = _call_types.setdefault(id(function), (function, {}))
    place = tuple(args)
    if not kws and place in known:
        return known[place]
    found = _asked_of_all(function, context, args, kws)
    if found is not None and not kws and function.get_impl_key(found) is function.typing_key:
        known[place] = found
    return found


def _size_of(context: BaseContext, kind: Any) -> int:
    """Return the size of a type [bytes]; remembered, as LLVM reads a module for it."""
    word = str(kind)
    if word not in _sizes:
        _sizes[word] = _asked_of_llvm(context, kind)
    return _sizes[word]


def take_shortcuts(compiler: type) -> None:
    """Install the shortcuts before anything is compiled; compiler: of callees.

    Numba compiles what is called anew for callers of other options. Callees have options of their own, but for the
    one that puts all into the place of a call.
    """
    if _before:
        return
    anew = _OverloadFunctionTemplate._get_impl

    def implementation(template: Any, args: Any, kws: Any) -> Any:
        if template._jit_options.get("pipeline_class") is not compiler:
            return anew(template, args, kws)
        caller = ConfigStack.top_or_none()
        key = template.context, tuple(args), tuple(kws.items()), caller is not None and caller.forceinline
        return template._impl_cache.get(key) or template._build_impl(key, args, kws)

    _put(_OverloadFunctionTemplate, "_get_impl", implementation)
    _put(BaseContext, "get_abi_sizeof", _size_of)
    _put(BaseFunction, "get_call_type", _call_type)
    _put(TargetConfig, "__eq__", _equal)
    _put(TargetConfig, "__hash__", lambda one: _hash_of(type(one)))  # type: ignore[arg-type]
    _put(base, "_has_loc", cache(base._has_loc))
    lower_builtin("__array__", types.Array)(_itself)


def _put(owner: Any, name: str, shortcut: Any) -> None:
    _before.append((owner, name, getattr(owner, name)))
    setattr(owner, name, shortcut)


def leave_shortcuts() -> None:
    """Restore numba as it was before `take_shortcuts`."""
    while _before:
        setattr(*_before.pop())
