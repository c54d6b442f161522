"""The clock of a run: compilation is said when it happens, and only then."""

from __future__ import annotations

import time

import numba
import pytest

from dem_cli.core.engine.clock import Clock
from dem_cli.core.kernels.compilation.compile_time import Compilation
from dem_cli.core.kernels.compilation.numba_setup import set_up_numba
from dem_cli.core.records.ports import Observer, Stages


@pytest.fixture(autouse=True, scope="module")
def numba_tells():
    """As it does once a kernel of dem is compiled."""
    set_up_numba()


class Said(Observer):
    """Keeps the stages."""

    stages = Stages()

    def __init__(self):
        self.said = []

    def progress(self, stage, load, displacement, fraction):
        self.said.append(stage)


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
    assert said.said == ["compiling (once)"]  # with what it calls
    assert clock.compiling > 0.01
    before = clock.compiling
    clock.compiled(lambda: sim)  # of these types it is there
    assert said.said == ["compiling (once)"]
    assert clock.compiling - before < 0.01


def test_another_loop_is_compiled_in_a_cache_that_holds_some():
    """Only an empty cache was said; a time history after a pushover kept silent for half a minute."""
    said = Said()
    clock = Clock(said)
    for _ in range(2):
        clock.compiled(Loop)
    assert said.said == ["compiling (once)"] * 2


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


class Sleeps(Said):
    """Takes its time with a row, and works for it."""

    def row(self, row):
        time.sleep(0.05)
        begun = time.process_time()
        while time.process_time() < begun + 0.05:
            pass


def test_wall_and_cpu_time_of_solving():
    """Sleep is no CPU time, and what the observer does is neither."""
    clock = Clock(Sleeps())
    clock.row(None)
    assert clock.observing > 0.1
    assert clock.cpu_seconds() < 0.04
    time.sleep(0.05)
    begun = time.process_time()
    while time.process_time() < begun + 0.05:
        pass
    assert clock.seconds() > 0.1
    assert 0.05 <= clock.cpu_seconds() < clock.seconds() - 0.04


def test_cpu_time_of_a_run_that_was_resumed_is_not_known():
    clock = Clock(Said())
    clock.stages = Stages()
    clock.stages.before = 60.0
    assert clock.seconds() > 60.0
    assert clock.cpu_seconds() is None
