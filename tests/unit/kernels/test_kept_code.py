"""Kernels from the disk without numba: the same answers, and numba where anything is other than it was."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy

import numpy as np
import pytest

from dem_cli.core.kernels.compilation import cache_folder, kept_code
from dem_cli.core.kernels.compilation.kept_code import kept_kernel, may_be_kept
from dem_cli.core.kernels.compilation.kinds import OtherTypes, kind_of
from dem_cli.core.kernels.jit import kernel
from dem_cli.core.kernels.records import Loads
from dem_cli.core.kernels.vec import in_a_row, shaped_as

pytestmark = pytest.mark.skipif(not may_be_kept(), reason="code is kept on Linux and x86-64 alone")


@kernel
def add_up(n, factor, loads, rows, pair, links):
    """Uses every kind of argument."""
    total, flat = 0.0, in_a_row(rows)
    for i in range(n):
        total += factor * loads.dead[i, 1] + flat[i] + pair[0] * pair[1]
    shaped_as(flat, rows)[-1, -1] = total
    if total < 0.0:
        raise ValueError
    return total


def arguments(n=3, factor=2.0):
    loads = Loads(*(np.arange(6.0).reshape(3, 2) + k for k in range(len(Loads._fields))))
    return n, factor, loads, np.arange(6.0).reshape(2, 3), (0.5, 3.0), ()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the code of the kernel is kept."""
    place, before = tmp_path_factory.mktemp("kept"), os.environ.get("DEM_CACHE_DIR")
    os.environ["DEM_CACHE_DIR"] = str(place)
    add_up._made()._cache.flush()  # what is compiled is kept, not what numba kept
    add_up._made()(*arguments())
    yield cache_folder.cache_folder() / "kept"
    os.environ.pop("DEM_CACHE_DIR")
    os.environ |= {"DEM_CACHE_DIR": before} if before is not None else {}


def test_kept_code_gives_what_compiled_code_gives(folder):
    kept = deepcopy(kept_kernel(add_up.py_func, arguments()))  # of a simulation that is copied
    for given in (arguments(), arguments(2), arguments(1, np.float64(-0.25))):
        once, again = given, arguments()
        expected = add_up._made()(*once[:3], again[3], *once[4:])
        assert kept(*once) == expected == add_up.py_func(*once[:3], np.arange(6.0).reshape(2, 3), *once[4:])
        assert once[3].tobytes() == again[3].tobytes()
        assert once[3][-1, -1] == expected


def test_what_numba_alone_has_is_kept_as_well(folder):
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    for file in folder.iterdir():
        file.unlink()
    kernel(add_up.py_func)._made()(*arguments())  # by numba, from its own cache
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before


def test_each_thread_has_arguments_of_its_own(folder):
    kept = kept_kernel(add_up.py_func, arguments())
    expected = [add_up._made()(*arguments(3, float(k))) for k in range(40)]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda k: kept(*arguments(3, float(k))), range(40))) == expected


def test_other_types_are_for_numba(folder):
    kept, given = kept_kernel(add_up.py_func, arguments()), list(arguments())
    others = {0: 2.0, 1: 1, 2: given[2]._replace(dead=np.zeros(3)), 3: given[3].T, 4: (1.0,), 5: (1.0,)}
    for place, other in others.items():
        with pytest.raises(OtherTypes):
            kept(*given[:place], other, *given[place + 1 :])
        assert kept(*given) == kept(*arguments())


def test_an_error_in_compiled_code_is_one(folder):
    with pytest.raises(RuntimeError, match="compiled code failed"):
        kept_kernel(add_up.py_func, arguments())(*arguments(3, -100.0))


def test_a_damaged_file_or_another_processor_is_for_numba(folder, monkeypatch):
    from llvmlite import binding

    (file,) = folder.glob("*.code")
    whole = file.read_bytes()
    for damaged in (whole[:-1], b"", whole[:-100] + b"?" * 100, b"{}" + whole,
                    whole.replace(b'"entry": "', b'"entry": "x')):  # fmt: skip
        file.write_bytes(damaged)
        assert kept_kernel(add_up.py_func, arguments()) is None
    file.write_bytes(whole.replace(b'"needed": [', b'"needed": ["no_such_function", '))
    assert kept_kernel(add_up.py_func, arguments()) is None
    file.write_bytes(whole)
    assert kept_kernel(add_up.py_func, arguments()) is not None
    monkeypatch.setattr(binding, "get_host_cpu_name", lambda: "another")
    assert kept_kernel(add_up.py_func, arguments()) is None


def test_options_of_numba_are_for_numba(folder, monkeypatch):
    monkeypatch.setenv("NUMBA_OPT", "0")
    monkeypatch.setattr(kept_code, "may_be_kept", may_be_kept.__wrapped__)
    assert kept_kernel(add_up.py_func, arguments()) is None


def test_numba_says_the_same_of_types():
    from numba import typeof

    from dem_cli.core.kernels.compilation.entries import kind_of_type

    read_only = np.zeros(2, np.int8)
    read_only.flags.writeable = False
    given = (*arguments(), read_only, np.zeros((0, 3), np.uint32), np.zeros(1, bool), (given_record(),), np.int64(3))
    assert [kind_of(each) for each in given] == [kind_of_type(typeof(each)) for each in given]


def given_record():
    return arguments()[2]
