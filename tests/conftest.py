"""Shared by all tests: one cache of compiled code, no display, `python -m dem_cli` from any folder, what is slow."""

from __future__ import annotations

import gc
import os
import signal
import sys
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

os.environ.setdefault("DEM_CACHE_DIR", str(ROOT / ".numba_cache"))
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.setdefault("DEM_STRICT_KERNELS", "1")  # no kernel is compiled another way, or never kept, in silence
os.environ.setdefault("DEM_TRACEBACK", "1")  # a fault of the program that a command turned into exit code 70
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # each process of a test would compile the whole package: 1.5 s
sys.dont_write_bytecode = False
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell starts what runs behind it so: tests press Ctrl-C
    signal.signal(signal.SIGINT, signal.default_int_handler)
FOLDERS = [str(ROOT), str(ROOT / "tests"), str(ROOT / "scripts")]  # of what tests and their processes import
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (*FOLDERS, os.environ.get("PYTHONPATH"))))
# As scripts/benchmark has it: threads of libraries beside two workers of the tests gain nothing.
for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(name, "1")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Ten thousand tests stay to the end: Python need not look for garbage among them, now or later."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def quarter(name: str) -> int:
    """Which quarter of the slow tests one is of, by its name; 172 begins the sum with which all take about as long."""
    return zlib.crc32(name.encode(), 172) % 4


@pytest.hookimpl(tryfirst=True)  # before -m chooses
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks as slow what tests/slow_tests.txt names, and as one quarter of it, by its name."""
    named = set(Path(__file__).with_name("slow_tests.txt").read_text(encoding="utf-8").splitlines())
    for item in items:
        name = item.nodeid.split("[")[0]
        if named & {item.nodeid, name}:
            item.add_marker(pytest.mark.slow)
            item.add_marker(f"quarter_{quarter(name)}")
