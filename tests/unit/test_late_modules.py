"""Modules that are loaded when something in them is first asked for."""

import importlib
import sys
from threading import Thread

import pytest

from dem_cli import late_modules
from dem_cli.late_modules import AnyArray, LateModules

SOURCE = """
loads = globals().get("loads", 0) + 1
known = "of the module"
from late_example import other
"""
OTHER = """
from late_example import known
number = 7
times = globals().get("times", 0) + 1
"""


@pytest.fixture
def late(tmp_path, monkeypatch):
    """A late package, one of whose names is known."""
    (tmp_path / "late_example").mkdir()
    (tmp_path / "late_example" / "__init__.py").write_text(SOURCE)
    (tmp_path / "late_example" / "other.py").write_text(OTHER)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(late_modules.LATE, "late_example", {"known": "before"})
    monkeypatch.setattr(sys, "meta_path", [LateModules(), *sys.meta_path])
    yield importlib.import_module("late_example")
    for name in ("late_example", "late_example.other"):
        sys.modules.pop(name, None)


def imported(name):
    """As `from late_example import name` finds it."""
    found = {}
    exec(f"from late_example import {name}", found)
    return found[name]


def test_what_is_known_loads_nothing(late):
    assert (imported("known"), "loads" in vars(late)) == ("before", False)


def test_what_is_not_known_loads_the_module_once(late):
    assert (imported("other").number, late.known, late.loads) == (7, "of the module", 1)
    with pytest.raises(AttributeError, match="nothing"):
        late.nothing  # noqa: B018
    assert late.loads == 1


def test_a_module_in_a_late_package_comes_after_it_and_once(late):
    other = importlib.import_module("late_example.other")
    assert (other.known, other.times, late.loads, late.other is other) == ("of the module", 1, 1, True)
    assert other.__spec__.origin.endswith("other.py")


def test_threads_wait_for_a_module_that_another_one_loads(late):
    found = []
    threads = [Thread(target=lambda: found.append(late.other.number)) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (found, late.loads) == ([7] * 8, 1)


def test_a_module_that_cannot_be_loaded_says_so_each_time(late, tmp_path):
    (tmp_path / "late_example" / "other.py").write_text("import not_there_at_all\n")
    for _ in range(2):
        with pytest.raises(ModuleNotFoundError, match="not_there_at_all"):
            late.loads  # noqa: B018


def test_hints_of_arrays_are_those_of_numpy():
    import numpy as np
    from numpy.typing import NDArray

    assert AnyArray[np.float64] == NDArray[np.float64]
