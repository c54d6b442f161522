"""How long a run still takes: what is said of a stage, and what is not."""

from __future__ import annotations

import io

import pytest
from synthetic.clock import HandClock

from dem_cli.app.cli.words import console
from dem_cli.app.cli.words.pace import Pace


@pytest.fixture
def clock(monkeypatch):
    clock = HandClock()
    monkeypatch.setattr(console, "time", clock)
    return clock


def left(shares, stage="shaking", every=1.0):
    """What is said after looks at even times."""
    pace = Pace()
    for i, share in enumerate(shares):
        pace.look(every * i, stage, share)
    return pace.left()


def test_a_steady_stage():
    assert left([0.01 * i for i in range(21)]) == pytest.approx(80.0)
    assert left([0.0005 * i for i in range(2001)], every=0.5) == pytest.approx(0.0)  # with looks that were dropped


def test_nothing_of_what_is_young_or_hardly_begun():
    assert left([0.1 * i for i in range(10)]) is None  # 9 s
    assert left([0.0049 * i for i in range(11)]) is None  # 4.9 % in 10 s
    assert left([0.0051 * i for i in range(11)]) == pytest.approx(0.949 / 0.0051)


def test_nothing_of_what_accelerates():
    """A collapse goes as the square of time, or faster."""
    assert left([(i / 100) ** 2 for i in range(60)]) is None
    assert left([2.0 ** (i - 40) for i in range(40)]) is None


def test_what_slows_down_goes_by_its_second_half():
    assert left([min(0.04 * i, 0.4 + 0.02 * (i - 10)) for i in range(21)]) == pytest.approx(0.4 / 0.02)


def test_stages_begin_anew():
    pace = Pace()
    for i in range(60):
        pace.look(float(i), "compiling (once)", None)
    for i in range(8):
        pace.look(60.0 + i, "gravity", 0.1 * i)
    assert pace.left() is None
    for i in range(1, 31):
        pace.look(100.0 + i, f"runs {i:,} of 1,000", i / 1000)
    assert pace.left() is None  # 3 %
    for i in range(31, 101):
        pace.look(100.0 + i, f"runs {i:,} of 1,000", i / 1000)
    assert pace.left() == pytest.approx(900.0)


def test_a_minute_of_compiling_is_no_pace(clock):
    """The first command of the README said "about 3.6 h left", of a run of 2.5 s."""
    stream = io.StringIO()
    bar = console.Progress(stream=stream)
    bar.update("compiling (once)", 0.0, 0.0, None)
    clock.now += 60.0
    bar.update("gravity", 0.0, 0.0, 0.02)
    clock.now += 1.0
    for share in (0.0045, 0.01, 0.04, 0.2, 0.9):
        clock.now += 0.3
        bar.update("following the collapse", 0.6, 0.2 * share, share)
    said = stream.getvalue().splitlines()
    assert said == ["compiling (once)", "gravity: load 0.0000, displacement 0 µm, 2 %, 60 s so far"]


def test_lines_of_a_long_run(clock):
    stream = io.StringIO()
    bar = console.Progress(stream=stream)
    for i in range(241):
        bar.update("shaking", 0.1, 0.001, i / 800)
        clock.now += 0.125
    assert stream.getvalue().splitlines() == [
        "shaking: base +0.100 g, displacement 1 mm, 10 %, about 90 s left",
        "shaking: base +0.100 g, displacement 1 mm, 20 %, about 80 s left",
        "shaking: base +0.100 g, displacement 1 mm, 30 %, about 70 s left",
    ]


def test_the_bar_of_a_terminal_says_the_same(clock):
    stream = io.StringIO()
    stream.isatty = lambda: True  # type: ignore[method-assign]
    with console.Progress(stream=stream) as bar:
        clock.now += 60.0
        for i in range(20):
            bar.update("following the collapse", 0.1, 0.001, 2.0 ** (i - 25))
            clock.now += 0.5
        assert "left" not in stream.getvalue()
        assert bar._bar is not None
        for i in range(400):
            bar.update("shaking", 0.1, 0.001, i / 1000)
            clock.now += 0.1
        assert bar._bar.tasks[0].fields["left"] == "about 60 s left"
