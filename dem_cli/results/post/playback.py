"""Playback of frames as a movie: their choice and duration; time histories run in real time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.records.frames import Frame
from dem_cli.results.output.reader import Results

EACH = 0.08  # s that a frame stays where it has no time of its own
SHORTEST = 0.02  # s: players slow down what is shorter


class Playback(NamedTuple):
    """Frames of a movie and their durations."""

    frames: list[Frame]
    stays: list[float]  # s that each is shown, but for the last one


def playback(results: Results, each: float | None = None) -> Playback:
    """Choose the distinguishable frames of a run. each: duration of one [s]; None: real time, or EACH."""
    frames = list(results.frames)
    if not kind_of(results.kind).timed or each is not None:
        return Playback(frames, [each or EACH] * len(frames))
    shown = _apart([frame.time for frame in frames], int(np.argmax([frame.displacement for frame in frames])))
    times = [frames[i].time for i in shown]
    return Playback([frames[i] for i in shown], [*np.diff(times).tolist(), EACH])


def _apart(times: list[float], farthest: int) -> list[int]:
    """Select frames that are not too close for a movie, always with the first, the farthest and the last."""
    shown = [0]
    for i in range(1, len(times)):
        if times[i] - times[shown[-1]] >= SHORTEST:
            shown.append(i)
        elif i in (farthest, len(times) - 1):
            shown[-1:] = [i] if shown[-1] not in (0, farthest) else [shown[-1], i]
    return shown


def ticks(stays: list[float], least: float = 12.5, most: float = 50.0) -> tuple[float, list[int]]:
    """Compute the frame rate of a movie at constant rate, and the picture that each of its frames shows."""
    rate = float(np.clip(1.0 / np.median(stays), least, most))
    ends = np.cumsum(stays)
    instants = (np.arange(max(1, round(ends[-1] * rate))) + 0.5) / rate
    return rate, np.minimum(np.searchsorted(ends, instants), len(stays) - 1).tolist()


def milliseconds(stays: list[float]) -> list[int]:
    """Round the durations of GIF pictures to 10 ms; the rounding error of one is carried to the next."""
    ends = 10.0 * np.rint(100.0 * np.cumsum(stays))
    return np.maximum(np.diff(ends, prepend=0.0), 10.0).astype(int).tolist()
