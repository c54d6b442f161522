"""Snapshots of time histories: the farthest is the peak of the answer, and no motion that is seen is aliased."""

from __future__ import annotations

from dataclasses import replace

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables

from dem_cli.core.dynamics.snapshots import Snapshots
from dem_cli.core.engine.settings import DEFAULT

GROUND = block("base", rectangle(-3, -1, 3, 0), fixed=True)
PULSE = {"kind": "pulse", "shape": "sine", "amplitude": 3.6, "frequency": 1.0}
MONITORS = [{"block": "b", "component": axis} for axis in "xy"]


def shaken(width: float, height: float, duration: float, **more) -> dict:
    """A block on the ground, with the path of its centroid."""
    made = tables(
        GROUND, block("b", rectangle(-0.5 * width, 0.0, 0.5 * width, height)),
        **{
            "joints": {"j": {"friction": 0.7, "kn": 1e8}}, "monitor": MONITORS, "damping": {"restitution": "housner"},
            "analysis": {"kind": "time-history", "duration": duration}, "output": {}, **more,
        },
    )  # fmt: skip
    return made


@pytest.mark.parametrize("output", [{}, {"frames": 5}])
def test_the_farthest_is_the_peak_of_the_answer(output):
    """Of twenty frames at even times none was: 285 mm where the answer said 326 mm."""
    _, records = engine.solve(shaken(0.5, 1.5, 3.0, motion=PULSE, output=output))
    moved = np.hypot(*records.history.monitors.T)
    farthest = max(records.frames, key=lambda frame: frame.displacement)
    assert farthest.displacement == pytest.approx(moved.max(), rel=1e-12)
    assert farthest.time == pytest.approx(records.history.times[moved.argmax()], rel=1e-12)
    times = [frame.time for frame in records.frames]
    assert (np.diff(times) > 0.0).all()
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(3.0, abs=1e-3)
    if output:
        even = np.linspace(0.0, 3.0, 5)
        assert max(np.abs(np.array(times) - time).min() for time in even) < 0.0051  # a look
        assert len(times) <= 5 + 4  # and turning points


def test_looking_changes_no_bit():
    plain, seen = (
        engine.solve(shaken(0.5, 1.5, 1.0, motion=PULSE, output=output))[1].history for output in ({"frames": 0}, {})
    )
    assert (plain.monitors == seen.monitors).all()


@pytest.mark.parametrize(("frequency", "amplitude"), [(1.0, 7.5), (6.0, 15.0)])
def test_frames_follow_the_ground_under_what_moves(frequency, amplitude):
    """Eight in a cycle, and never fewer than a movie needs, from where a block slides on; it sticks in between."""
    motion = {"kind": "harmonic", "amplitude": amplitude, "frequency": frequency, "cycles": 2 * frequency}
    _, records = engine.solve(shaken(0.5, 0.5, 2.0, motion=motion))
    slides = [frame.displacement > 2.5e-4 for frame in records.frames].index(True)  # m, a quarter of what is visible
    gaps = np.diff([frame.time for frame in records.frames[slides:]])
    assert records.frames[slides].time < 0.5
    assert gaps.max() <= 1.0 / max(8.0 * frequency, 12.5) + 0.0051  # a look


def test_what_stands_still_needs_few_frames():
    """A frame takes as long as a thousand steps: 249 of three drums that nothing moved took a third of a run."""
    motion = {"kind": "harmonic", "amplitude": 3.0, "frequency": 6.0, "cycles": 12.0}
    _, records = engine.solve(shaken(0.5, 0.5, 2.0, motion=motion))
    gaps = np.diff([frame.time for frame in records.frames])
    assert gaps.max() <= 1.0 / DEFAULT.snapshots.per_second_still + 0.0051
    assert len(gaps) < 2.5 * 2.0 * DEFAULT.snapshots.per_second_still  # with those of turning points


def test_looks_are_few_where_no_snapshot_is_near(monkeypatch):
    """A look takes as long as a hundred steps: 4,200 of them took a tenth of a run of three drums."""
    motion = {"kind": "harmonic", "amplitude": 7.5, "frequency": 1.0, "cycles": 2.0}
    looks: list[float] = []
    kept: list[float] = []
    look, keep = Snapshots.look, Snapshots._keep
    monkeypatch.setattr(Snapshots, "look", lambda self: (looks.append(self.sim.time), look(self)))
    monkeypatch.setattr(Snapshots, "_keep", lambda self, frame: (kept.append(frame.time), keep(self, frame)))
    engine.solve(shaken(0.5, 0.5, 4.0, motion=motion))
    close = 0.005  # s: two samples; closer looks are those of books
    afterwards = {round(time, 9) for time in looks if time > 2.5}  # the ground is at rest
    assert len(afterwards) < 0.45 * 1.5 / close
    assert np.diff([time for time in kept if time > 2.5]).max() <= 1.0 / DEFAULT.snapshots.per_second + 0.0051


def test_frames_follow_what_moves_faster_than_the_ground():
    """A block of 2 cm rocks eight times a second: at 12.5 frames per second it seems to do anything."""
    start = {"motion": {"kind": "none"}, "initial": [{"block": "b", "tilt": 0.1}], "damping": {"none": True}}
    _, records = engine.solve(shaken(0.006, 0.02, 0.8, **start))
    times, path = records.history.times, records.history.monitors[:, 0]
    each = round(0.08 / times[1])
    kept = [frame.time for frame in records.frames], [frame.positions[1, 0] for frame in records.frames]
    off, off_evenly = (
        np.abs(np.interp(times, at, places) - path).max() / np.abs(path).max()
        for at, places in (kept, (times[::each], path[::each]))
    )
    assert off < 0.45
    assert off_evenly > 1.0


def test_frames_follow_what_turns():
    """A square that spins as it flies: 25 frames per second of a collapse, 1.2 rad apart, are too few."""
    spin = 30.0
    start = {"motion": {"kind": "none"}, "initial": [{"block": "b", "velocity": [0.0, 2.0, spin]}]}
    _, records = engine.solve(shaken(0.1, 0.1, 0.35, **start))
    turned = np.diff([frame.orientations[1, 0] for frame in records.frames])
    assert turned.sum() == pytest.approx(0.35 * spin, rel=0.02)
    assert turned.max() <= DEFAULT.snapshots.turn + 0.0051 * spin  # a look


def test_frames_have_a_limit_on_disk():
    small = replace(DEFAULT, snapshots=replace(DEFAULT.snapshots, bytes=20_000, fewest=10))
    _, records = engine.solve(shaken(0.5, 1.5, 3.0, motion=PULSE), settings=small)
    assert len(records.frames) <= 2 * 10  # even ones, and turning points between them
    assert max(frame.displacement for frame in records.frames) == pytest.approx(
        np.hypot(*records.history.monitors.T).max(), rel=1e-12
    )
