"""Peaks of ground motions in words, for `dem check`."""

from __future__ import annotations

from dem_cli.analyses.estimate_shaking import ground_words
from dem_cli.core.motion.motion import Motion
from dem_cli.core.motion.pulses import SineWave


def motion(peak, *direction):
    return Motion(SineWave(peak, 1.0, 1.0), direction)


def test_several_motions_are_told_by_their_direction():
    assert ground_words([]) == "peak 0 m/s²"
    assert ground_words([motion(2.5, 1.0, 0.0)]) == "peak 2.5 m/s²"
    three = [motion(6.0, 1.0, 0.0, 0.0), motion(3.0, 0.0, -1.0, 0.0), motion(1.25, 0.0, 0.6, 0.8)]
    assert ground_words(three) == "peaks 6 m/s² along x, 3 m/s² along −y, 1.25 m/s² along [0, 0.6, 0.8]"
    assert ground_words([*three, *three, motion(1.0, 0.0, 0.0, 1.0)]).endswith("[0, 0.6, 0.8], 1 more")
