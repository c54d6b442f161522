"""Ctrl-C, SIGTERM: noted at once, answered at a look; no hang where a library holds a lock; all commands end tidily."""

from __future__ import annotations

import importlib
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager

import pytest
from studies.interrupts.commands import COMMANDS
from studies.interrupts.trial import gone_on, interrupted, started

from dem_cli.app.sweep.pool import GRACE, each_done
from dem_cli.interrupts import Interrupts, asked, at_once, insist, look

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals as POSIX has them")


def press(number=signal.SIGINT):
    """A signal to this process, whose handler has run when this returns."""
    os.kill(os.getpid(), number)
    time.sleep(0.0)


@pytest.fixture(autouse=True)
def _handlers_come_back():
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    yield
    assert {number: signal.getsignal(number) for number in before} == before
    assert not asked()


@contextmanager
def raised():
    """A KeyboardInterrupt comes out of this block, from wherever it was."""
    with pytest.raises(KeyboardInterrupt):
        yield


def here(**options):
    return Interrupts(ends_program=False, **options)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_noted_and_raised_once_at_a_look(number, request):
    if signal.getsignal(number) is signal.SIG_IGN:  # as under nohup; what is ignored is left alone
        request.addfinalizer(lambda: signal.signal(number, signal.SIG_IGN))
        signal.signal(number, signal.SIG_DFL)
    with here():
        look()
        press(number)
        assert asked()
        with raised():
            look()
        look()  # what follows is finished
        press(number)
        look()
        with raised():
            insist()  # but no other run begins
    look()


def test_what_comes_too_late_is_raised_when_all_is_done():
    done = False
    with raised(), here():
        press()
        done = True
    assert done


def test_inside_of_another():
    with here():
        with Interrupts():
            press()
        with raised(), Interrupts():
            pytest.fail("it looks first")


def test_other_threads_always_hear_of_it():
    heard = []

    def run():
        for _ in range(2):
            try:
                look()
            except KeyboardInterrupt:
                heard.append(True)

    with raised(), here():
        press()
        thread = threading.Thread(target=run)
        thread.start()
        thread.join()
    assert heard == [True, True]


def test_a_long_call_is_left_at_once():
    with here():
        with raised(), at_once():
            press()
            pytest.fail("the handler raises")
        look()


@pytest.mark.parametrize("what", ["swallowed", "ImportError"])
def test_what_a_library_makes_of_it_does_not_matter(what):
    with here(), raised(), at_once():
        try:
            press()
        except KeyboardInterrupt:
            if what == "ImportError":
                raise ImportError("initialization failed") from None


def test_pressed_again_while_the_first_unwinds():
    with here(at_once=True), raised():
        try:
            press()
        finally:
            press()
            insist()


def test_nohup_stays_nohup():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with here():
            press(signal.SIGHUP)
            assert not asked()
    finally:
        signal.signal(signal.SIGHUP, before)


# -- waits -----------------------------------------------------------------------------------------

HELD = """
import concurrent.futures._base as futures, os, signal, time
from dem_cli.analyses.ensembles.batch import Batch, Batcher, ShakingTrial, each
from dem_cli.interrupts import Interrupts

class Endless:
    def shaken(self, motions, cancelled):
        while not cancelled():
            time.sleep(0.01)
        raise RuntimeError("cancelled")

enter, presses = futures._AcquireFutures.__enter__, []

def interrupted_with_all_locks(self):
    enter(self)
    if not presses:
        presses.append(True)
        os.kill(os.getpid(), signal.SIGINT)
        for _ in range(1000):  # between these lines the handler runs
            pass

futures._AcquireFutures.__enter__ = interrupted_with_all_locks
batcher = Batcher([Endless()], lambda trial: [], Batch(threads=2))
try:
    with Interrupts():
        batcher.work([*each([ShakingTrial(0, i, 1.0) for i in range(4)])], lambda done: None)
except KeyboardInterrupt:
    print("interrupted", presses)
"""


def test_while_the_conditions_of_all_futures_are_held():
    """A KeyboardInterrupt there leaves them locked: workers wait to report, and everybody waits for them."""
    done = subprocess.run([sys.executable, "-c", HELD], capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("interrupted [True]\n", "")


def sleep_long(seconds):
    time.sleep(seconds)
    return seconds


def press_soon(seconds):
    threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)).start()


@pytest.mark.parametrize("seconds", [0.0, 0.6])
def test_processes_that_do_not_listen_are_ended(seconds):
    """Started or not yet: their items would take an hour."""
    begun = time.monotonic()
    with raised(), here():
        press_soon(seconds)
        list(each_done(sleep_long, [3600.0, 3600.0, 3600.0], 2))
    assert multiprocessing.active_children() == []
    assert time.monotonic() - begun < 60.0 + GRACE


def answers_ctrl_c(number):
    """As a run does, with what it has so far."""
    press()
    try:
        look()
    except KeyboardInterrupt:
        return "interrupted"


def test_the_next_item_is_not_begun():
    found = []
    with here(), raised():
        found += each_done(answers_ctrl_c, [1, 2, 3], 1)
    assert found == []


# -- commands --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", COMMANDS)
def test_commands_end_tidily(name, tmp_path):
    """As soon as they have begun, in turn by Ctrl-C in a terminal and by `kill`; what goes on has the same answer."""
    command, of_all = COMMANDS[name], list(COMMANDS).index(name) % 2 == 0

    def wait(process):
        while process.poll() is None and not any((tmp_path / "it").glob(command.begun)):
            time.sleep(0.005)

    trial = interrupted(command, tmp_path / "it", signal.SIGINT if of_all else signal.SIGTERM, wait, whole_group=of_all)
    assert trial is not None, "it was done before it could be interrupted"
    assert (trial.code, trial.problems) == (130, [])
    if name == "fragility":
        assert started(command, tmp_path / "straight").wait() == 0
        assert gone_on(command, tmp_path / "it", tmp_path / "straight") == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_before_anything_has_begun(number, tmp_path):
    """While it reads its case: exit code 130 and nothing there, by SIGTERM too."""
    os.mkfifo(tmp_path / "case.toml")  # it waits for somebody to write
    command = [sys.executable, "-m", "dem_cli", "run", "case.toml", "-o", "out"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    writer = os.open(tmp_path / "case.toml", os.O_WRONLY)  # it has opened it
    try:
        process.send_signal(number)
        assert process.wait(60.0) == 130
    finally:
        os.close(writer)
    assert process.stderr.read().strip() == "interrupted"
    process.stderr.close()
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def test_the_test_run_has_a_time_limit(pytestconfig):
    assert importlib.util.find_spec("pytest_timeout")
    assert float(pytestconfig.getini("timeout")) > 0.0


def test_looks_cost_nothing():
    """Beside a compiled call of 100 steps, 20 µs at least."""
    begun = time.process_time()
    for _ in range(100_000):
        look()
    assert time.process_time() - begun < 0.5
