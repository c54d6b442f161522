"""What the benchmark of time histories measures errors by."""

from __future__ import annotations

import numpy as np
import pytest
from bench.time_histories import LANDINGS, FirstMonitor, distance, landing_error
from oracle.housner import Block, rock

from dem_cli.core.records.history_rows import Samples


def history(times: np.ndarray, values: np.ndarray) -> FirstMonitor:
    made = FirstMonitor()
    half = len(times) // 2
    for part in (slice(None, half), slice(half, None)):
        made.samples(Samples(times[part], np.zeros((len(times[part]), 3, 2)), values[part, None]))
    return made


def test_landings_are_the_oracles():
    exact = rock(Block(0.5, 1.0), angle=0.25, duration=1.6)
    assert exact.impacts[:3] == pytest.approx(LANDINGS, abs=2e-8)
    exact = rock(Block(0.5, 1.0), angle=0.25, duration=1.6, step=1e-4)
    assert landing_error(exact.times, exact.angles) < 3e-5  # a sample on either side of a landing
    late = landing_error(1.01 * exact.times, exact.angles)
    assert late == pytest.approx(0.01, abs=5e-5)
    assert landing_error(exact.times[:500], exact.angles[:500]) is None


def test_distance_of_histories():
    times = np.linspace(0.0, 2.0, 4001)
    sine = history(times, np.sin(np.pi * times))
    assert distance(sine, sine) == 0.0
    assert distance(history(times, 1.03 * np.sin(np.pi * times)), sine) == pytest.approx(0.03)
    coarse = np.linspace(0.0, 2.0, 2001)
    assert distance(history(coarse, np.sin(np.pi * coarse)), sine) < 1e-6
