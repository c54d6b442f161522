"""The clock of a run: compilation is said when it happens, and only then."""

from __future__ import annotations

import numba
import pytest

from dem_cli.core.engine.clock import Clock
from dem_cli.core.kernels.compilation.compile_time import Compilation
from dem_cli.core.kernels.compilation.numba_setup import set_up_numba
from dem_cli.core.records.ports import Observer


@pytest.fixture(autouse=True, scope="module")
def numba_tells():
    """As it does once a kernel of dem is compiled."""
    set_up_numba()


class Said(Observer):
    """Keeps the stages."""

    def __init__(self):
        self.stages = []

    def progress(self, stage, load, displacement, fraction):
        self.stages.append(stage)


class Loop:
    """A simulation as far as the clock knows it, whose loop is compiled when it is first called."""

    def __init__(self):
        self.inner = numba.njit(lambda x: x + 1)
        inner = self.inner
        self.loop = numba.njit(lambda x: inner(x) * 2)

    def compile(self):
        self.loop(1)


def test_what_is_compiled_is_said_once_and_counted():
    said, sim = Said(), Loop()
    clock = Clock(said)
    assert clock.compiled(lambda: sim) is sim
    assert said.stages == ["compiling (once)"]  # with what it calls
    assert clock.compiling > 0.01
    before = clock.compiling
    clock.compiled(lambda: sim)  # of these types it is there
    assert said.stages == ["compiling (once)"]
    assert clock.compiling - before < 0.01


def test_another_loop_is_compiled_in_a_cache_that_holds_some():
    """Only an empty cache was said; a time history after a pushover kept silent for half a minute."""
    said = Said()
    clock = Clock(said)
    for _ in range(2):
        clock.compiled(Loop)
    assert said.stages == ["compiling (once)"] * 2


def test_an_interrupt_while_it_is_said_is_heard():
    def interrupt():
        raise KeyboardInterrupt

    compilation = Compilation(interrupt)
    with pytest.raises(KeyboardInterrupt), compilation.heard():
        Loop().compile()
    told = []
    again = Compilation(lambda: told.append(1))
    with again.heard():
        Loop().compile()
    assert told == [1]
