"""Structures in pymunk (Chipmunk 2D): polygons, point masses and friction as in our model."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bench.tilting import EngineSettings
from dem_cli.core.model.model import Model

NAME, PACKAGE = "pymunk", "pymunk"
TIGHT = {"collision_slop": 1e-3}  # of the smallest edge, which is 1; the library's own is 0.1
SETTINGS = (
    EngineSettings("defaults: 1/60 s, 10 iterations, slop 0.1; edge 17.5 (pixels)", 17.5, 981.0, 1 / 60, (10,), True),
    EngineSettings("1/60 s, 30 iterations, slop 0.001", 1.0, 9.81, 1 / 60, (30,), options=TIGHT),
    EngineSettings("1/240 s, 10 iterations, slop 0.001", 1.0, 9.81, 1 / 240, (10,), options=TIGHT),
    EngineSettings("1/240 s, 30 iterations, slop 0.001", 1.0, 9.81, 1 / 240, (30,), options=TIGHT),
    EngineSettings("1/240 s, 100 iterations, slop 0.001", 1.0, 9.81, 1 / 240, (100,), options=TIGHT),
    EngineSettings("1/960 s, 10 iterations, slop 0.001", 1.0, 9.81, 1 / 960, (10,), True, options=TIGHT),
    EngineSettings("1/1920 s, 10 iterations, slop 0.001", 1.0, 9.81, 1 / 1920, (10,), options=TIGHT),
)


class PymunkWorld:
    """A space; friction of two shapes is multiplied by Chipmunk, so that each has √μ."""

    def __init__(self, model: Model, friction: float, setting: EngineSettings, smallest: float):
        import pymunk

        self.setting = setting
        self.space = space = pymunk.Space()
        space.iterations = setting.iterations[0]
        for name, value in setting.options.items():
            setattr(space, name, value)
        scale, unit = setting.edge / smallest, float(model.masses[~model.fixed].mean())
        bodies = []
        for i in range(model.n_blocks):
            if model.fixed[i]:
                body = pymunk.Body(body_type=pymunk.Body.STATIC)
            else:
                body = pymunk.Body(model.masses[i] / unit, scale**2 * model.inertias[i, 0] / unit)
            body.position = pair(scale * model.centroids[i])
            space.add(body)
            bodies.append(body)
        for p, i in enumerate(model.part_blocks.tolist()):
            corners = scale * model.vertices[model.part_starts[p] : model.part_starts[p + 1]]
            shape: Any = pymunk.Poly(bodies[i], [pair(corner) for corner in corners])
            shape.friction, shape.elasticity = math.sqrt(friction), 0.0
            space.add(shape)
        self.free = [body for body, fixed in zip(bodies, model.fixed, strict=True) if not fixed]

    def tilt(self, load: float) -> None:
        """Turn gravity so that its horizontal part is the load multiplier."""
        self.space.gravity = (load * self.setting.gravity, -self.setting.gravity)

    def step(self, steps: int) -> None:
        """Advance by so many steps."""
        for _ in range(steps):
            self.space.step(self.setting.step)

    def places(self) -> np.ndarray:
        """Places of the free blocks, in units of the engine, (n, 2)."""
        return np.array([body.position for body in self.free])


def pair(place: np.ndarray) -> tuple[float, float]:
    """A point as pymunk takes it."""
    return float(place[0]), float(place[1])


make = PymunkWorld
