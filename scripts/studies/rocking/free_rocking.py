"""Free rocking from a tilt, against Housner: peaks, times, and the ratio of speeds at the first impact."""

from __future__ import annotations

from typing import Any

import numpy as np
from oracle.housner import Block, rock

from studies.rocking.single_block import one_block, solve

ASPECTS = (2.0, 2.9, 3.6, 5.0)
FRACTIONS = (0.1, 0.35, 1.0, 2.0)
HEIGHT, START = 1.0, 0.6  # [m], of α
LEAST, WIDE = 0.02, 0.1  # of α: smaller peaks than the first are elastic as much as rocking


def compared(aspect: float, **how: Any) -> dict[str, Any]:
    """Errors of all peaks above LEAST α: one over the one before (wide: of those above WIDE α), size, times of peaks
    and of impacts.
    """
    block = Block(HEIGHT / aspect, HEIGHT)
    exact = rock(block, duration=12.0, angle=START * block.alpha, step=2e-4)
    times, peaks = exact.extremes()
    peaks = np.abs(peaks)
    count = int((peaks > LEAST * block.alpha).sum())
    found = solve(one_block(block, duration=float(times[count - 1]) + 0.5, tilt=START * block.alpha, **how))
    dem_times, dem_peaks = found.extremes()
    assert len(dem_peaks) >= count, f"h/b {aspect}: only {len(dem_peaks)} of {count} swings"
    start = START * block.alpha
    decay = np.diff(np.log(np.concatenate([[start], peaks[:count]])))
    dem_decay = np.diff(np.log(np.concatenate([[start], dem_peaks[:count]])))
    return {
        "aspect": aspect,
        "swings": count,
        "decay": worst(np.exp(dem_decay - decay) - 1.0),
        "wide": worst((np.exp(dem_decay - decay) - 1.0)[peaks[:count] > WIDE * block.alpha]),
        "peaks": worst(dem_peaks[:count] / peaks[:count] - 1.0),
        "times": worst(dem_times[:count] / times[:count] - 1.0),
        "impacts": worst(found.zeros()[:count] / exact.impacts[:count] - 1.0),
        "turns": [dem_times[:count].tolist(), dem_peaks[:count].tolist()],
    }


def restitution(aspect: float, damping: dict[str, Any], **how: Any) -> float:
    """Speed after over speed before the first impact, from the heights of the swings before and after it."""
    block = Block(HEIGHT / aspect, HEIGHT)
    start = START * block.alpha
    found = solve(one_block(block, duration=2.5, tilt=start, damping=damping, **how))
    after = found.extremes()[1][0]
    return float(np.sqrt(lifted(block, after) / lifted(block, start)))


def lifted(block: Block, angle: float) -> float:
    """Height of the centroid above rest, over R."""
    return float(np.cos(block.alpha - angle) - np.cos(block.alpha))


def worst(errors: np.ndarray) -> float:
    """The one that is largest in size, with its sign."""
    return float(errors[np.abs(errors).argmax()])
