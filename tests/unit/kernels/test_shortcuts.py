"""Shortcuts through numba say what numba says."""

from __future__ import annotations

import operator
from itertools import product

import pytest
from numba.core import types
from numba.core.compiler import Flags
from numba.core.errors import TypingError
from numba.core.registry import cpu_target

from dem_cli.core.kernels.compilation import shortcuts

NUMBERS = (types.int64, types.uint64, types.float64, types.boolean, types.literal(2), types.float64[:, ::1])


def _options() -> list[Flags]:
    made = []
    for set_to in ({}, {"nrt": False}, {"nrt": True}, {"nrt": True, "error_model": "numpy"}, {"error_model": "python"}):
        made.append(Flags())
        for name, value in set_to.items():
            setattr(made[-1], name, value)
    return made


def test_options_are_compared_as_numba_does():
    for one, other in product(_options(), repeat=2):
        assert (one == other) is shortcuts._compared_by_value(one, other)
        assert hash(one) == hash(other) or one != other


@pytest.mark.parametrize("name", ["add", "truediv", "lt", "getitem"])
def test_operators_are_what_all_that_know_them_say(name: str):
    context = cpu_target.typing_context
    context.refresh()
    asked = context.resolve_value_type(getattr(operator, name))
    for pair in product(NUMBERS, repeat=2):
        said = []
        for ask in (shortcuts._asked_of_all, shortcuts._call_type, shortcuts._call_type):
            try:
                said.append(ask(asked, context, pair, {}))
            except TypingError:
                said.append(None)
        assert said[0] == said[1] == said[2], pair
