"""Compiled code stays in the folder with the hash of its sources, whatever happens to the environment of numba."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from types import FunctionType

import pytest
from numba.core.dispatcher import Dispatcher

from dem_cli.engine.loops import compiled_advance, compiled_shake
from dem_cli.laws.registry import LAWS

PROGRAM = """
import os
from dem_cli.kernels.jit import cache_folder
from dem_cli.kernels.planar_geometry import measure  # any kernel
import numba
os.environ["NUMBA_NUM_THREADS"] = "1"  # as `dem bench` does
numba.config.reload_config()
assert numba.config.CACHE_DIR == str(cache_folder()), numba.config.CACHE_DIR
"""


def test_settings_that_are_read_again_keep_it(tmp_path):
    environment = os.environ | {"DEM_CACHE_DIR": str(tmp_path)}
    environment.pop("NUMBA_NUM_THREADS", None)
    subprocess.run([sys.executable, "-c", PROGRAM], env=environment, check=True)


def named_by(function: FunctionType, seen: set[int]) -> Iterator[object]:
    """What the functions that a closure holds name, all that the cache of numba tells them apart by."""
    for cell in function.__closure__ or ():
        inner = cell.cell_contents
        yield inner
        if isinstance(inner, FunctionType) and id(inner) not in seen:
            seen.add(id(inner))
            yield from (inner.__globals__[name] for name in inner.__code__.co_names if name in inner.__globals__)
            yield from named_by(inner, seen)


@pytest.mark.parametrize("dimension", [2, 3])
def test_loops_come_from_the_cache(dimension):
    """A kernel has another name in each process: a loop whose closures name one is compiled in each anew."""
    law = LAWS["coulomb"]
    for loop in (
        compiled_advance("fixed", law),
        compiled_advance("large", law, False, dimension),
        compiled_shake(law, False, True, dimension),
    ):
        assert not [found for found in named_by(loop.py_func, set()) if isinstance(found, Dispatcher)]
