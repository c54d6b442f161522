"""Joints over areas that dilate, in space, against closed forms: blocks lift as they slide or spin, as far as they may.

A point slips and opens on its way to rest, under a normal force that still swings: paths in 60 parts come within 2e-4,
in 20 parts within 6e-4, in one within 6e-3.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from engine import MU, scene
from scipy.optimize import brentq
from studies.space.structures import box, tables

from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.geometry.rotation import rotation_vectors
from dem_cli.core.statics.compliance import compliance
from dem_cli.core.statics.displacement_control import DisplacementControl
from dem_cli.core.statics.equilibrium import relax, stand

A, T, H = 0.4, 0.15, 0.2  # length, thickness, height [m]
AREA, WEIGHT = A * T, 2000.0 * 9.81 * A * T * H
PSI, REACH = 0.3, 2e-4  # tan ψ, and slip up to which the joint dilates [m]
KN, KS, ROOF = 2e9, 1e9, 5e8  # Pa/m
PARTS = 60  # of each way
BED = {
    "law": "mohr-coulomb", "friction": MU, "dilation_deg": math.degrees(math.atan(PSI)), "kn": KN, "ks": KS,
    "points": 3,
}  # fmt: skip
CLOSE = replace(DEFAULT, displacement_control=replace(DEFAULT.displacement_control, tolerance=1e-8))
BASE = box("base", (-0.2, -0.2, -H), (A + 0.2, T + 0.2, 0.0), fixed=True)
BLOCK = box("b", (0.0, 0.0, 0.0), (A, T, H))


def roof(low: Sequence[float], high: Sequence[float]) -> dict:
    """A fixed block over part of the plan, on a joint without friction: a spring of ROOF Pa/m against lifting."""
    return box("roof", (*low, H), (*high, 2.0 * H), fixed=True, material="smooth")


def sliding(direction: Sequence[float], *blocks: dict, loads: Sequence[dict] = (), **joint) -> dict:
    """A block pushed at the level of its bed."""
    push = {"kind": "live", "block": "b", "at": [A / 2, T / 2, 0.0], "force": [1000.0 * x for x in (*direction, 0.0)]}
    smooth = {"law": "coulomb", "friction": 0.0, "kn": ROOF, "ks": ROOF, "points": 3}
    keys = {"kind": "pushover", "pattern": "live", "control": "displacement", "follow": 1e-3, "kinematics": "large"}
    return tables(
        BASE, {**BLOCK, "material": "stone"}, *blocks, load=[push, *loads], analysis=keys,
        materials={"stone": {"density": 2000.0}, "smooth": {"density": 2000.0}},
        joints={"bed": BED | joint, "smooth": smooth}, interface=[{"between": ["stone", "smooth"], "joint": "smooth"}],
    ) | {"block": [{**b, "material": b.get("material", "stone")} for b in (BASE, BLOCK, *blocks)]}  # fmt: skip


class Pushed:
    """A case under displacement control to 1e-8 of the own weights, state by state."""

    def __init__(self, case: dict, kinematics: str = "large") -> None:
        made = scene(case)
        properties = joint_properties(made.request, made.model, 1e6)
        self.sim = Simulation(made.model, law_of(made.request), properties, kinematics,
                              live_scale=1.0, settings=CLOSE)  # fmt: skip
        self.block = made.number("b")
        budget = Budget(2_000_000)
        assert stand(self.sim, budget).state == "equilibrium"
        if measures.live_force(self.sim) > 0.0:  # no couple
            self.control = DisplacementControl(self.sim, budget, compliance(self.sim, budget)[0])

    def to(self, displacement: float) -> tuple[float, float]:
        """Load [N] and rise of the block since its place in the drawing [m] at a displacement of the load."""
        for left in range(PARTS, 0, -1):
            assert self.control.go((displacement - self.control.displacement) / left)
        return self.sim.load * self.control.forces, float(measures.displacements(self.sim)[self.block, 2])


def on_bed(turned_deg: float) -> tuple[float, float]:
    angle = math.radians(turned_deg)
    return math.cos(angle), math.sin(angle)


@pytest.mark.parametrize("azimuth", [90.0, 30.0])
def test_a_loaded_block_lifts_as_it_slides(azimuth):
    """v = tan ψ min(u, zdil) − N/kn A under constant N, u = δ − μ N/ks A; the load is μ N; on its way back it sinks."""
    surcharge = {"kind": "dead", "block": "b", "force": [0.0, 0.0, -5000.0]}
    pushed = Pushed(sliding(on_bed(azimuth), loads=[surcharge], dilation_slip=REACH))
    pressed = WEIGHT + 5000.0
    for far in (1e-4, 1.5e-4, 3e-4, 5e-4):
        load, rise = pushed.to(far)
        slip = far - MU * pressed / (KS * AREA)
        assert load == pytest.approx(MU * pressed, rel=2e-5)
        near = (2e-4 if slip < REACH else 1e-9) * PSI * REACH
        assert rise == pytest.approx(PSI * min(slip, REACH) - pressed / (KN * AREA), abs=near)
    load, rise = pushed.to(1e-4)
    slip = 1e-4 + MU * pressed / (KS * AREA)
    assert load == pytest.approx(-MU * pressed, rel=1e-4)
    assert rise == pytest.approx(PSI * slip - pressed / (KN * AREA), abs=3e-4 * PSI * REACH)


@pytest.mark.parametrize("azimuth", [90.0, 30.0])
def test_a_block_that_is_held_down_presses_as_it_slides(azimuth):
    """Under a roof of stiffness k2: v = (kn tan ψ u − W/A)/(kn + k2), N = W + k2 A v; the load grows with it."""
    pushed = Pushed(sliding(on_bed(azimuth), roof((-0.2, -0.2), (A + 0.2, T + 0.2)), dilation_slip=REACH))
    for far in (5e-5, 1e-4, 2e-4, 4e-4):
        load, rise = pushed.to(far)
        exact_rise, exact_load = held_down(far)
        assert load == pytest.approx(exact_load, rel=1e-4)
        assert rise == pytest.approx(exact_rise, rel=2e-4 if far < 4e-4 else 1e-6)


def held_down(far: float, reach: float = REACH) -> tuple[float, float]:
    """Rise and load of a block under a roof, at a displacement of its push."""

    def rise(slip: float) -> float:
        return (KN * PSI * min(slip, reach) - WEIGHT / AREA) / (KN + ROOF)

    def pressed(slip: float) -> float:
        return WEIGHT + ROOF * AREA * rise(slip)

    slip = brentq(lambda u: far - u - MU * pressed(u) / (KS * AREA), 0.0, far)
    return rise(slip), MU * pressed(slip)


@pytest.mark.parametrize("across", [False, True])
def test_a_block_that_is_held_down_at_one_side_turns_about_either_axis(across):
    """A roof over a strip: pressure on the bed is linear, so is the opening; both are those of two elastic layers.

    u = δ − μ p/ks under a pressure p, so that p = kn' (tan ψ δ − v − θ x) with 1/kn' = 1/kn + μ tan ψ/ks.
    """
    low, high = ((-0.2, 0.09), (A + 0.2, 0.12)) if across else ((0.24, -0.2), (0.32, T + 0.2))
    pushed = Pushed(sliding((0.0, 1.0) if across else (1.0, 0.0), roof(low, high)), kinematics="fixed")
    long = T if across else A
    wide = (high[1] - low[1]) if across else (high[0] - low[0])
    over, at = wide * AREA / long, ((low[1] + high[1]) if across else (low[0] + high[0])) / 2.0 - long / 2.0
    stiff = 1.0 / (1.0 / KN + MU * PSI / KS)
    for far in (1e-4, 3e-4):
        layers = np.array(
            [
                [stiff * AREA + ROOF * over, ROOF * over * at],
                [ROOF * over * at, stiff * AREA * long**2 / 12.0 + ROOF * over * (at**2 + wide**2 / 12.0)],
            ]
        )
        middle, lean = np.linalg.solve(layers, [stiff * AREA * PSI * far - WEIGHT, 0.0])
        load, rise = pushed.to(far)
        assert rise == pytest.approx(middle, rel=2e-4)
        turn = rotation_vectors(pushed.sim.bodies.orientations[[pushed.block]])[0]
        assert math.hypot(turn[0], turn[1]) == pytest.approx(abs(lean), rel=2e-4)
        assert load == pytest.approx(MU * (WEIGHT + ROOF * over * (middle + lean * at)), rel=2e-4)


def test_a_block_that_spins_lifts_by_its_corners():
    """Turned about the vertical under a roof: corners slip the most and lift the block off its other points."""
    radius = math.hypot(A, T) / 2.0
    arms = radius * np.array(4 * [1.0] + 4 * [0.4] + [0.0])
    areas = AREA * np.array(4 * [1 / 15] + 4 * [5 / 48] + [19 / 60])
    case = sliding((0.0, 1.0), roof((-0.2, -0.2), (A + 0.2, T + 0.2)))
    couple = [
        {"kind": "live", "block": "b", "at": [x, T / 2, H / 2], "force": [0.0, force, 0.0]}
        for x, force in ((A, 1.0 / A), (0.0, -1.0 / A))
    ]
    pushed, budget = Pushed(case | {"load": couple}), Budget(2_000_000)
    torques, rises = spun(arms, areas, np.linspace(0.0, 4e-3, 4001))
    for far in (500, 2000, 4000):
        for torque in np.linspace(pushed.sim.load, torques[far], 41)[1:]:
            assert relax(pushed.sim, torque, 1e-8, 200_000, budget=budget).state == "equilibrium"
        turn = rotation_vectors(pushed.sim.bodies.orientations[[pushed.block]])[0]
        assert turn[2] == pytest.approx(far * 1e-6, rel=2e-3)
        assert measures.displacements(pushed.sim)[pushed.block, 2] == pytest.approx(rises[far], rel=3e-3)
    assert (pushed.sim.contacts.normal[:9] > 0.0).sum() == 4  # of the bed, corners alone


def spun(arms: np.ndarray, areas: np.ndarray, turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Torque [N m] and rise [m] at rotations that grow: points at radii, each an elastic layer that slips, dilates."""
    slips, torques, rises = np.zeros(len(arms)), [], []

    def state(turn: float, rise: float) -> tuple[np.ndarray, np.ndarray]:
        """Pressures and slips, given those before."""
        sticks = KN * np.maximum(PSI * slips - rise, 0.0)
        sliding = np.maximum(KN * (PSI * turn * arms - rise) / (1.0 + KN * MU * PSI / KS), 0.0)
        slides = (KS * (turn * arms - slips) > MU * sticks) & (sliding > 0.0)
        found = np.where(slides, turn * arms - MU * sliding / KS, slips)
        return np.where(slides, sliding, sticks), found

    def left(rise: float, turn: float) -> float:
        return (areas * state(turn, rise)[0]).sum() - WEIGHT - ROOF * AREA * max(rise, 0.0)

    for turn in turns:
        rise = brentq(left, -1e-3, 1e-2, args=(turn,), xtol=1e-16)
        pressures, slips = state(turn, rise)
        shears = np.minimum(KS * (turn * arms - slips), MU * pressures)
        torques.append(float((areas * shears * arms).sum()))
        rises.append(rise)
    return np.array(torques), np.array(rises)
