"""Seeded pairs of a block and a record, for comparisons of ensembles: single records of rocking are ill-conditioned."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.signal import butter, sosfiltfilt

from oracle.base_motion import Record
from oracle.housner import Block

STEP, LENGTH = 0.01, 20.0  # [s]
BAND = (0.3, 6.0)  # [Hz]
RISE, FALL = 2.0, 12.0  # [s]: noise grows as t² up to the one, decays from the other on
ASPECTS, HEIGHTS, STRENGTHS = (2.0, 6.0), (1.0, 4.0), (1.2, 4.0)  # h/b, [m], peak over g tan α


class Pair(NamedTuple):
    """A block and what shakes it."""

    seed: int
    block: Block
    record: Record


def pair(seed: int) -> Pair:
    """Band-limited Gaussian noise under an envelope; block and strength are drawn evenly from the ranges above."""
    random = np.random.default_rng(seed)
    aspect, height, strength = (random.uniform(*ends) for ends in (ASPECTS, HEIGHTS, STRENGTHS))
    block = Block(height / aspect, height)
    times = STEP * np.arange(round(LENGTH / STEP) + 1)
    noise = sosfiltfilt(butter(2, BAND, "bandpass", fs=1.0 / STEP, output="sos"), random.normal(size=len(times)))
    noise *= np.minimum(1.0, (times / RISE) ** 2) * np.exp(-0.4 * np.maximum(times - FALL, 0.0))
    noise[[0, -1]] = 0.0
    return Pair(seed, block, Record(STEP, strength * block.gravity * np.tan(block.alpha) * noise / np.abs(noise).max()))


def scaled(record: Record, factor: float) -> Record:
    return Record(record.dt, factor * record.values)
