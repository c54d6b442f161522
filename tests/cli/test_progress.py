"""What a user sees of many runs under way."""

from __future__ import annotations

import io
import re

import pytest
from synthetic.clock import HandClock

from dem_cli.app.cli.words import run_counter
from dem_cli.app.cli.words.run_counter import RunCounter


@pytest.fixture
def clock(monkeypatch):
    clock = HandClock()
    monkeypatch.setattr(run_counter, "time", clock)
    return clock


def test_a_line_says_where_it_stands(clock):
    bar = RunCounter(1000, 400, stream=io.StringIO())
    for _ in range(20):
        clock.now += 0.5
        bar.update(failed=False)
    assert bar.line() == "420 of 1,000 runs, 2 runs/s, about 5 min left"
    bar.update(failed=True)
    assert "421 of 1,000 runs, 1 failed" in bar.line()


def test_slow_runs_have_their_time(clock):
    bar = RunCounter(10, stream=io.StringIO())
    clock.now += 90.0
    bar.update()
    assert bar.line() == "1 of 10 runs, 90 s a run, about 14 min left"


def test_lines_come_every_ten_seconds_and_never_when_quiet(clock):
    for quiet in (False, True):
        stream = io.StringIO()
        with RunCounter(100, quiet=quiet, stream=stream) as bar:
            for _ in range(50):
                clock.now += 0.5
                bar.update()
        assert stream.getvalue().count("\n") == (0 if quiet else 2)


def test_a_bar_on_a_terminal_says_which_time_is_which(clock, monkeypatch):
    stream = io.StringIO()
    stream.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setenv("COLUMNS", "120")
    with RunCounter(5, stream=stream) as bar:
        for _ in range(3):
            clock.now += 6.0
            bar.update(failed=True)
    shown = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", stream.getvalue())
    assert re.search(r"3/5 runs, 3 failed  6.0 s a run \d:\d\d:\d\d so far  about 12 s left\n", shown)
