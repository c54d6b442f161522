"""Maxwell elements against closed forms where joints close, open or start with a velocity: second order in the step."""

from __future__ import annotations

import math

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables
from oracle import maxwell

WIDTH, MASS, KN, SPEED = 0.5, 500.0, 2e7, 0.02  # of a block 0.5 m × 0.5 m × 1 m; joint [Pa/m]; [m/s]
STIFFNESS = KN * WIDTH
HERTZ = math.sqrt(STIFFNESS / MASS) / (2.0 * math.pi)
RATIO = 0.1  # the element loses the more at closures, the more it carries
EXACT = maxwell.Joint(STIFFNESS, MASS, 4.0 * RATIO, 2.0 * math.pi * HERTZ)
MARGINS = (0.25, 0.1, 0.05)


def falls(margin: float, gap: float, **more) -> tuple[np.ndarray, np.ndarray]:
    """Times and heights of a block thrown at a joint from `gap` above it, or moving on it under gravity."""
    blocks = [
        block("base", rectangle(-1.0, -1.0, 1.5, 0.0), fixed=True), block("b", rectangle(0.0, 0.0, WIDTH, 0.5))
    ]  # fmt: skip
    start = {"block": "b", "velocity": [0.0, -SPEED, 0.0]}
    case = tables(
        *blocks,
        joints={"j": {"friction": 0.5, "kn": KN, "ks": KN}},
        damping={"maxwell": [{"ratio": RATIO, "frequency": HERTZ}]},
        initial=[start | ({"displacement": [0.0, gap]} if gap else {})],
        monitor=[{"block": "b", "component": "y"}],
        output={"frames": 0, "rate": 1e5},
        **{"gravity": 0.0, **more},
        analysis={"kind": "time-history", "margin": margin, "duration": 1.2 / HERTZ, "settle": "gravity" in more},
    )
    _, records = engine.solve(case)
    return records.history.times, records.history.monitors[:, 0]


def bounce(margin: float, gap: float) -> tuple[float, float]:
    """Errors of the way into the joint, over its depth, and of the speed of leaving, over the speed of coming."""
    times, heights = falls(margin, gap)
    met = gap / SPEED
    end, _, leaves = maxwell.leaving(EXACT, SPEED)
    closed = (times > met) & (times < met + end)
    exact = maxwell.motion(EXACT, SPEED, times[closed] - met)[:, 0]
    after = np.flatnonzero(times > met + 1.1 * end)
    speed = np.diff(heights[after[[0, -1]]])[0] / np.diff(times[after[[0, -1]]])[0]
    return np.abs(heights[closed] + exact).max() / exact.max(), (speed - leaves) / SPEED


def test_the_oracle_without_an_element_is_a_spring():
    free = maxwell.Joint(STIFFNESS, MASS, 0.0, 1.0)
    end, u, speed = maxwell.leaving(free, SPEED)
    assert end == pytest.approx(0.5 / HERTZ, rel=1e-9)
    assert speed == pytest.approx(SPEED, rel=1e-9)
    assert abs(u) < 1e-12
    locked = maxwell.Joint(STIFFNESS, MASS, 0.4, 1e-9)  # never relaxes: a stiffer spring
    assert maxwell.leaving(locked, SPEED)[0] == pytest.approx(0.5 / HERTZ / math.sqrt(1.4), rel=1e-7)


def second_order(errors: list[float], least: float = 3.0) -> None:
    """Errors of MARGINS fall with the square of the step: fourfold from the second to the last, but for chance."""
    assert errors[1] > least * errors[2]


def test_a_joint_that_closes_and_opens_within_steps():
    """1.5, 2.4 and 1.1 % off the depth when an element acted for the whole of the step in which its joint closed."""
    gaps = (1.0e-4, 1.3e-4, 1.6e-4)  # closed at other shares of a step
    depths, speeds = np.abs([[bounce(margin, gap) for gap in gaps] for margin in MARGINS]).max(axis=1).T
    second_order(depths)
    second_order(speeds)
    assert depths[2] < 4e-4
    assert speeds[2] < 3e-4


def test_a_pressed_joint_that_starts_with_a_velocity_has_nothing_in_its_elements_yet():
    """About the state of rest under gravity; 5.2, 2.4 and 1.2 % off when they had acted for a step before."""
    errors = []
    for margin in MARGINS:
        times, heights = falls(margin, 0.0, gravity=9.81)
        first = times < 0.3 / HERTZ  # still pressed
        exact = -maxwell.motion(EXACT, SPEED, times[first])[:, 0]
        errors.append(np.abs(heights[first] - heights[0] - exact).max() / np.abs(exact).max())
    second_order(errors)
    assert errors[2] < 1e-3
