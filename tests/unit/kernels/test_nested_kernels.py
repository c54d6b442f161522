"""Kernels that other kernels call, by way of a callee: optimised once, and called as they are."""

from __future__ import annotations

import re

import numpy as np
from numba.core import config

from dem_cli.kernels.compilation.callees import is_of_kernel
from dem_cli.kernels.jit import inline, kernel

NUMBERS = np.arange(5.0) + 0.1


@kernel
def weigh_one(place, numbers):
    """So small that LLVM would put it in the place of a call."""
    return numbers[place] / 3.0


@inline
def weigh(place, numbers):
    return weigh_one(np.int64(place), numbers)


@kernel
def weigh_all(numbers):
    """Calls the other kernel, through a callee, at two places."""
    total = 0.0
    for place in range(numbers.size):
        total += weigh(place, numbers)
    return total - weigh(0, numbers)


def library(made):
    (compiled,) = made.overloads.values()
    return compiled.library


def test_a_kernel_inside_of_another_is_called_as_it_was_compiled(tmp_path, monkeypatch):
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))  # compiled here, not read from an earlier run
    made = weigh_all._made()
    assert made(NUMBERS) == weigh_all.py_func(NUMBERS)
    text = str(library(made)._final_module)
    bodies = re.split(r"^define ", text, flags=re.MULTILINE)[1:]
    body = next(part for part in bodies if "weigh_all" in part.split("(")[0])
    assert re.search(r"call .*weigh_one", body)
    assert re.search(r"^define linkonce_odr .*weigh_one", text, flags=re.MULTILINE)


def test_one_from_the_disk_is_known_as_a_kernel():
    one = weigh_one._made()
    expected = one(1, NUMBERS)
    again = kernel(weigh_one.py_func)._made()
    assert again(1, NUMBERS) == expected
    assert sum(again.stats.cache_hits.values()) == 1
    assert is_of_kernel(library(again))
