"""Compiled code stays in the folder with the hash of its sources, whatever happens to the environment of numba."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from types import FunctionType

import pytest
from numba.core.registry import cpu_target

import dem_cli
from dem_cli.core.engine.loops import compiled_advance, compiled_shake
from dem_cli.core.kernels.compilation.cache_folder import _place
from dem_cli.core.kernels.compilation.machine_code import KernelCache
from dem_cli.core.kernels.jit import CompiledKernel, kernel
from dem_cli.core.laws.registry import LAWS

PROGRAM = """
import os
from dem_cli.core.kernels.compilation.machine_code import cache_folder
from dem_cli.core.kernels.planar_geometry import measure  # any kernel
import numba
os.environ["NUMBA_NUM_THREADS"] = "1"  # as scripts/benchmark does
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
        assert not [found for found in named_by(loop.py_func, set()) if isinstance(found, CompiledKernel)]


KEYS = """
from numba.core.registry import cpu_target
from dem_cli.core.engine.loops import compiled_advance, compiled_shake
from dem_cli.core.laws.registry import LAWS
law, codegen = LAWS["coulomb"], cpu_target.target_context.codegen()
for loop in (compiled_advance("fixed", law), compiled_shake(law, False, True, 3)):
    print(loop._cache._index_key((), codegen)[-1])
"""


def test_modules_that_were_compiled_before_make_no_difference(tmp_path):
    """The first process of a fresh checkout compiles the modules, all others read them: both find the same kernels."""
    package = Path(dem_cli.__file__).parent
    shutil.copytree(package, tmp_path / "dem_cli", ignore=shutil.ignore_patterns("__pycache__"))
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, "-c", KEYS]
    first, second = (
        subprocess.run(command, env=environment, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
        for _ in range(2)
    )
    assert next((tmp_path / "dem_cli").rglob("jit.*.pyc"), None) is not None  # the second one read it
    assert len(set(first.split())) == 2
    assert first == second


def key(kernel: CompiledKernel) -> str:
    return kernel._cache._index_key((), cpu_target.target_context.codegen())[-1]


def test_each_loop_is_found_as_itself():
    laws, flags, dimensions = LAWS.values(), (False, True), (2, 3)
    loops = [compiled_advance("fixed", law) for law in laws]
    loops += [compiled_advance("large", *each) for each in product(laws, flags, dimensions)]
    loops += [compiled_shake(*each) for each in product(laws, flags, flags, dimensions)]
    assert len({key(loop) for loop in loops}) == len(loops)


def test_what_a_closure_holds_tells_kernels_apart():
    def made(held: float, constant: int) -> CompiledKernel:
        names: dict = {"__name__": __name__}
        exec(f"def inner(held):\n    def add(x):\n        return held + x + {constant}\n    return add\n", names)
        add = names["inner"](held)
        return kernel(lambda x: add(x))

    keys = [key(made(held, constant)) for held, constant in ((1, 2), (1, 3), (1.5, 2), (1, 2))]
    assert len(set(keys)) == 3
    assert keys[0] == keys[3]


def test_no_two_kernels_are_written_to_one_file():
    """Two processes that save at one time know nothing of each other."""
    one, other = (KernelCache(compiled_advance("fixed", LAWS["coulomb"]).py_func) for _ in range(2))
    assert one._cache_file._data_name(1) != other._cache_file._data_name(1)


def test_a_temporary_folder_that_others_may_write_is_not_used(tmp_path, monkeypatch):
    """Machine code that another user laid there would run here."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    (tmp_path / "file").touch()
    home = str(tmp_path / "file" / "home")  # where nothing can be made
    own = _place(home, "sources")
    assert own.parent.parent == tmp_path
    assert _place.__wrapped__(home, "sources") == own
    own.parent.chmod(0o777)
    assert _place.__wrapped__(home, "sources").parent != own.parent
