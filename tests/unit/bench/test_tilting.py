"""Bisection by tilting: against a world whose answer is known, and in the engines themselves."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest
from bench import tilting
from bench.box2d_walls import inset
from bench.cases import KNOWN_STRUCTURES
from bench.others import engine_job

SETTING = tilting.EngineSettings("a block", edge=1.0, gravity=10.0, step=0.01, iterations=(1,))


class SlidingBlock:
    """One block on a plane, exactly: v grows by (λ − μ) g."""

    def __init__(self, friction: float):
        self.friction, self.load, self.x, self.v = friction, 0.0, 0.0, 0.0

    def tilt(self, load):
        self.load = load

    def step(self, steps):
        for _ in range(steps):
            self.v = max(0.0, self.v + SETTING.step * SETTING.gravity * (self.load - self.friction))
            self.x += SETTING.step * self.v

    def places(self):
        return np.array([[self.x, 0.5]])


@pytest.mark.parametrize("friction", [0.1, 0.6, 1.5])
def test_sliding_load_is_the_friction(friction):
    found = tilting.failure_load(lambda: SlidingBlock(friction), SETTING, 0.6, 0.002)
    low, high = found["bracket"]
    assert low - 1e-9 <= friction * (1 + 3e-3)
    assert high >= friction
    assert found["load"] == low == pytest.approx(friction, rel=0.003)


def test_what_falls_by_itself_has_no_load():
    found = tilting.failure_load(lambda: SlidingBlock(-0.1), SETTING, 0.6, 0.002)
    assert found["load"] == 0.0


@pytest.mark.parametrize("module", ["pymunk_walls", "box2d_walls"])
def test_engines_get_our_model(module):
    engine = import_module(f"bench.{module}")
    pytest.importorskip(engine.PACKAGE)
    case, model = KNOWN_STRUCTURES["COL14"].build()
    world = engine.make(model, case.joints["dry"].friction, engine.SETTINGS[0], 0.0175)
    scale = engine.SETTINGS[0].edge / 0.0175
    free = ~model.fixed
    assert world.places() == pytest.approx(scale * model.centroids[free], rel=1e-6)
    masses = np.array([body.mass for body in world.free])
    assert masses == pytest.approx(model.masses[free] / model.masses[free].mean(), rel=1e-5)
    inertias = np.array([body.moment if module == "pymunk_walls" else body.inertia for body in world.free])
    assert inertias == pytest.approx(scale**2 * model.inertias[free, 0] / model.masses[free].mean(), rel=1e-5)


@pytest.mark.parametrize("module", ["pymunk_walls", "box2d_walls"])
def test_engines_find_the_sliding_load(module):
    """With a short time step both slide the top course at the friction, to a few per cent."""
    engine = import_module(f"bench.{module}")
    pytest.importorskip(engine.PACKAGE)
    job = engine_job(KNOWN_STRUCTURES["T21 μ 0.6"], engine, engine.SETTINGS[2], 0.02)
    job.once()
    assert abs(job.result["error"]) < 0.04


def test_inset_moves_edges_inwards():
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    assert inset(square, 0.1) == pytest.approx(np.array([[0.1, 0.1], [1.9, 0.1], [1.9, 0.9], [0.1, 0.9]]))
