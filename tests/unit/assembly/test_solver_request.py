"""What a case asks of the solvers: the numbers of its tables, and the defaults where it has none."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from engine import block, rectangle, scene, tables

from dem_cli.core.records.requests import (
    DEFAULT_FRACTION,
    DampingRequest,
    MaxwellRequest,
    MonitorRequest,
    RayleighRequest,
)

BASE = block("base", rectangle(0, -1, 2, 0), fixed=True)
BLOCK = block("b", rectangle(0.2, 0, 1.2, 1))
SHAKEN = {"kind": "time-history", "duration": 1.0}


def request(*blocks, **more):
    return scene(tables(BASE, BLOCK, *blocks, **more)).request


def test_a_failure_load_is_searched_for_where_the_load_grows():
    asked = request(analysis={"kind": "pushover", "resolution": 0.01, "step": 0.02}).analysis
    assert (asked.searches, asked.resolution, asked.step, asked.start) == (True, 0.01, 0.02, "auto")
    asked = request(analysis={"kind": "pushover", "control": "displacement", "follow": 0.1}).analysis
    assert (asked.searches, asked.tilting, asked.step) == (False, False, None)
    asked = request(analysis={"kind": "pushover", "pattern": "tilt"}).analysis
    assert (asked.searches, asked.tilting) == (True, True)
    asked = request(analysis={"kind": "gravity", "kinematics": "large", "max_steps": 5000}).analysis
    assert (asked.searches, asked.resolution, asked.kinematics, asked.max_steps) == (False, None, "large", 5000)


@pytest.mark.parametrize(
    ("keys", "free"), [({}, True), ({"margin": 0.1}, False), ({"time_step": 1e-5}, False), ({"margin": 0.25}, True)]
)
def test_a_time_history_whose_step_is_free(keys, free):
    found = request(analysis=SHAKEN | keys)
    assert found.in_seconds
    assert found.shaking.free_step == free
    assert (found.shaking.duration, found.shaking.kinematics) == (1.0, "large")


def test_without_a_table_joints_are_damped_by_the_default_fraction():
    assert request(analysis=SHAKEN).damping == DampingRequest(contact_fraction=DEFAULT_FRACTION)
    assert request(analysis=SHAKEN, damping={"none": True}).damping == DampingRequest()


def test_rayleigh_damping_at_one_frequency_and_at_two():
    """a1 = 2ζ/ω of stiffness alone; a0 = 2ζω₁ω₂/(ω₁ + ω₂) and a1 = 2ζ/(ω₁ + ω₂) of both (Clough and Penzien)."""
    found = request(analysis=SHAKEN, damping={"rayleigh": {"ratio": 0.02, "frequency": 10.0}}).damping
    assert found.rayleigh == RayleighRequest(0.02, 0.0, 0.04 / (20.0 * math.pi))
    two = {"ratio": 0.05, "frequencies": [2.0, 8.0]}
    found = request(analysis=SHAKEN, damping={"rayleigh": two, "maxwell": [{"ratio": 0.1, "frequency": 3.0}]}).damping
    assert found.maxwell == (MaxwellRequest(0.1, 3.0),)
    assert found.rayleigh.two_frequencies
    assert found.rayleigh.mass == pytest.approx(0.1 * 4.0 * 16.0 * math.pi / 20.0)
    assert found.rayleigh.stiffness == pytest.approx(0.1 / (20.0 * math.pi))


def test_blocks_that_start_tilted_or_moving():
    start = {"block": "b", "tilt": 0.1, "velocity": [1.0, 0.0, 0.5]}
    (one,) = request(analysis=SHAKEN, initial=[start]).initial
    assert (one.names, one.turn, one.displacement, one.velocity) == (("b",), (0.1,), (0.0, 0.0), (1.0, 0.0, 0.5))


def test_monitors():
    given = [{"point": [0.7, 1.0], "component": "x"}, {"block": "b", "quantity": "rotation", "name": "lean"}]
    assert request(monitor=given).monitors == (
        MonitorRequest("displacement", "x", point=(0.7, 1.0)),
        MonitorRequest("rotation", selected="b"),
    )
    (held,) = request(monitor=[{"block": "base", "quantity": "reaction", "component": "y"}]).monitors
    assert held.of_what_holds


def test_joints_and_materials_by_number():
    """The wood lies on other joints; its blocks deform in their joints, those of stone strain uniformly."""
    stone = {"density": 2000.0, "young": 5e9, "deformation": "uniform-strain"}
    wood = {"density": 500.0, "young": 1e9, "poisson": 0.25}
    made = tables(
        BASE | {"material": "stone"},
        block("beam", rectangle(0.2, 0, 1.2, 0.5), material="wood"),
        materials={"stone": stone, "wood": wood},
        joints={"dry": {"friction": 0.6, "head": "seat"}, "seat": {"friction": 0.4}},
        interface=[{"between": ["wood", "stone"], "joint": "seat"}],
        seed=7,
    )
    found = scene(made).request.joints
    assert list(found.named) == ["dry", "seat"]
    assert found.by_material.tolist() == [[0, 1], [1, 0]]
    assert found.heads.tolist() == [1, 1]
    np.testing.assert_allclose(found.moduli, [[math.inf, math.inf], [1e9, 0.4e9]])
    assert found.uniform.tolist() == [5e9, math.inf]
    assert (found.bends.tolist(), found.dimension, found.seed) == ([False, False], 2, 7)


def test_nobody_changes_a_request():
    with pytest.raises(dataclasses.FrozenInstanceError):
        request().gravity = 1.0
