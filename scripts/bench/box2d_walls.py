"""Structures in Box2D 2.3: polygons, masses and friction as in our model.

Box2D gives every polygon a skin of b2_polygonRadius and lets shapes sink into each other by b2_linearSlop, both
fixed when the library was built. Polygons are made smaller by the skin, so that blocks start where they touch; the
larger the blocks, the less this matters, which is why `edge` is a setting. A thin skin is the other way.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from bench.tilting import EngineSettings
from dem_cli.core.model.model import Model

NAME, PACKAGE = "Box2D", "Box2D"
THIN = {"radius": 1e-3}  # m, for edges of 10 m; the library's own is 0.01
SETTINGS = (
    EngineSettings("defaults: 1/60 s, 8 + 3 iterations; edge 1 m", 1.0, 9.81, 1 / 60, (8, 3), True),
    EngineSettings("1/240 s, 10 + 4 iterations; edge 10 m", 10.0, 98.1, 1 / 240, (10, 4)),
    EngineSettings("1/240 s, 50 + 20 iterations; edge 1 m", 1.0, 9.81, 1 / 240, (50, 20)),
    EngineSettings("1/240 s, 50 + 20 iterations; edge 10 m", 10.0, 98.1, 1 / 240, (50, 20)),
    EngineSettings("1/240 s, 50 + 20 iterations; edge 10 m, thin skin", 10.0, 98.1, 1 / 240, (50, 20), options=THIN),
    EngineSettings("1/960 s, 10 + 4 iterations; edge 10 m", 10.0, 98.1, 1 / 960, (10, 4), True),
    EngineSettings("1/960 s, 10 + 4 iterations; edge 100 m", 100.0, 981.0, 1 / 960, (10, 4)),
    EngineSettings("1/1920 s, 10 + 4 iterations; edge 10 m", 10.0, 98.1, 1 / 1920, (10, 4)),
)


class Box2DWorld:
    """A world without sleep, which has to be switched off for every body."""

    def __init__(self, model: Model, friction: float, setting: EngineSettings, smallest: float):
        box2d = library()
        self.setting = setting
        self.world = box2d.b2World(gravity=(0.0, -setting.gravity), doSleep=False)
        scale, unit = setting.edge / smallest, float(model.masses[~model.fixed].mean())
        radius = setting.options.get("radius", box2d.b2_polygonRadius)
        bodies: list[Any] = []
        for i in range(model.n_blocks):
            make_body = self.world.CreateStaticBody if model.fixed[i] else self.world.CreateDynamicBody
            body = make_body(position=tuple(map(float, scale * model.centroids[i])))
            body.sleepingAllowed = False
            bodies.append(body)
        for p, i in enumerate(model.part_blocks.tolist()):
            corners = scale * model.vertices[model.part_starts[p] : model.part_starts[p + 1]]
            shape = box2d.b2PolygonShape(vertices=[tuple(map(float, c)) for c in inset(corners, radius)])
            shape.radius = radius
            bodies[i].CreateFixture(shape=shape, density=1.0, friction=friction, restitution=0.0)
        self.free = []
        for i in np.flatnonzero(~model.fixed).tolist():
            mass, inertia = model.masses[i] / unit, scale**2 * model.inertias[i, 0] / unit
            bodies[i].massData = box2d.b2MassData(mass=float(mass), center=(0, 0), I=float(inertia))
            self.free.append(bodies[i])

    def tilt(self, load: float) -> None:
        """Turn gravity so that its horizontal part is the load multiplier."""
        self.world.gravity = (load * self.setting.gravity, -self.setting.gravity)

    def step(self, steps: int) -> None:
        """Advance by so many steps."""
        for _ in range(steps):
            self.world.Step(self.setting.step, *self.setting.iterations)

    def places(self) -> np.ndarray:
        """Places of the free blocks, in units of the engine, (n, 2)."""
        return np.array([tuple(body.position) for body in self.free])


def library() -> Any:
    """Box2D. Its bindings warn while they are loaded, and crash the process where warnings are errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import Box2D

    return Box2D


def inset(corners: np.ndarray, distance: float) -> np.ndarray:
    """A convex polygon with every edge moved inwards by `distance`, (n, 2), counter-clockwise."""
    along = np.roll(corners, -1, axis=0) - corners
    along /= np.sqrt((along**2).sum(axis=1))[:, None]
    inward = np.column_stack([-along[:, 1], along[:, 0]])
    before = np.roll(inward, 1, axis=0)
    both = np.stack([before, inward], axis=1)
    return corners + np.linalg.solve(both, np.full((len(corners), 2, 1), distance))[:, :, 0]


make = Box2DWorld
