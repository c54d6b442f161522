"""Failure loads by tilting gravity in a game engine: does the structure stand, and bisection of the load.

One trial: the structure settles under gravity, gravity is tilted to λ slowly (horizontal = λ × vertical), and
is held. It stands if while it is held no block moves farther than MOVED. Times are in √(h/g), h the smallest
edge, so that a trial does not depend on the scale that an engine likes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

SETTLE, RAMP, HOLD = 10.0, 30.0, 30.0  # in √(h/g)
RAMP_STEPS, LOOKS = 50, 20
MOVED = 0.1  # smallest edges; an excess of 2.2e-4 g along a plane covers that in HOLD
COLLAPSED = 1.0  # smallest edges during the ramp
LOWEST_LOAD = 0.01  # a structure that does not even stand at this load counts as falling by itself
TWICE = 1.1  # × friction: first load tried as the upper one, because a joint that lies flat slides at μ


@dataclass(frozen=True)
class EngineSettings:
    """Settings of a game engine: how it is run."""

    name: str
    edge: float  # length of the smallest edge in the engine's units
    gravity: float  # in the engine's units
    step: float  # s
    iterations: tuple[int, ...]
    wide: bool = False  # run on all structures
    options: Mapping[str, Any] = field(default_factory=dict)  # what else the engine is told


class EngineWorld(Protocol):
    """A structure in an engine."""

    def tilt(self, load: float) -> None:
        """Gravity with a horizontal part of `load` times the vertical one."""

    def step(self, steps: int) -> None:
        """Go on by so many time steps."""

    def places(self) -> np.ndarray:
        """Centroids of the free blocks in the engine's units, (n_free, d)."""


def stands(world: EngineWorld, setting: EngineSettings, load: float) -> bool:
    """One trial in a new world."""
    second = np.sqrt(setting.edge / setting.gravity) / setting.step  # steps in one √(h/g)
    world.tilt(0.0)
    world.step(round(SETTLE * second))
    settled = world.places()
    for i in range(RAMP_STEPS):
        world.tilt(load * (i + 1) / RAMP_STEPS)
        world.step(max(1, round(RAMP * second / RAMP_STEPS)))
    begun = world.places()
    if not _near(begun, settled, COLLAPSED * setting.edge):
        return False
    for _ in range(LOOKS):
        world.step(max(1, round(HOLD * second / LOOKS)))
        if not _near(world.places(), begun, MOVED * setting.edge):
            return False
    return True


def _near(places: np.ndarray, before: np.ndarray, limit: float) -> bool:
    return bool(np.sqrt(((places - before) ** 2).sum(axis=1)).max() <= limit)


def failure_load(
    make: Callable[[], EngineWorld], setting: EngineSettings, friction: float, resolution: float
) -> dict[str, Any]:
    """Highest load that stood, the lowest that fell above it, and the number of trials and steps."""
    low, high, trials = 0.0, TWICE * friction, 1
    while stands(make(), setting, high):
        low, high, trials = high, 2.0 * high, trials + 1
    while high - low > resolution * max(low, LOWEST_LOAD):
        middle = 0.5 * (low + high)
        trials += 1
        if stands(make(), setting, middle):
            low = middle
        else:
            high = middle
    return {"load": low, "bracket": [low, high], "trials": trials}
