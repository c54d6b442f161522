"""Equilibrium is measured against the forces that act: a light block that is pulled hard comes to rest at once."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, running_wall, simulation, solve, tables

from dem_cli.core.engine.budget import Budget
from dem_cli.core.kernels import records as slot
from dem_cli.core.statics.equilibrium import relax, settle_or_fail, stand

GROUND = block("ground", rectangle(-1.0, -0.5, 1.0, 0.0), fixed=True)
LIGHT = 0.6 / (9.81 * 0.25**2)  # kg/m3: a block of 0.6 N
JOINT = {"j": {"law": "elastic", "kn": 1e10, "ks": 4e9}}
PULLED = {"analysis": {"kind": "pushover", "pattern": "live", "max_load": 1.0}}


def light_tower(n: int, kind: str, force: float = 4e4, **more) -> dict:
    """Blocks of 0.6 N on each other, the last one pulled up."""
    blocks = [block(f"b{i}", rectangle(0.0, 0.25 * i, 0.25, 0.25 * (i + 1))) for i in range(n)]
    load = [{"block": f"b{n - 1}", "force": [0.0, force], "kind": kind}]
    return tables(GROUND, *blocks, density=LIGHT, joints=JOINT, load=load, **more)


def test_weights_alone_are_measured_by_themselves():
    """The pattern "mass", up to many times the weights, leaves the measure as it is, to the last digit."""
    sim = simulation(tables(*running_wall(5, 3)))
    stand(sim, Budget(100_000))
    sim.set_load(0.3)
    sim.advance(10, slot.HOLD_LOAD)
    assert sim.unbalanced == sim.control[slot.UNBALANCED] > 0.0
    assert not sim.acting.count(9.0)
    assert sim.acting.growth(9.0) == 1.0


def test_a_pulled_block_is_measured_by_what_pulls_it():
    """In a step from rest nothing has answered yet: all of the load is unbalanced, ten times a tenth of it."""
    sim = simulation(light_tower(1, "live", **PULLED))
    load = 1.0 / sim.live_scale
    sim.set_load(load)
    sim.advance(1, slot.HOLD_LOAD)
    assert sim.control[slot.UNBALANCED] == pytest.approx(4e4 / 0.6, rel=1e-3)
    assert sim.unbalanced == pytest.approx(10.0, rel=1e-3)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_blocks_between_are_measured_by_what_they_carry(kinematics):
    """5 · 0.6 N and 40 kN: 1e-5 of a weight is the ten-billionth part of what the lower blocks carry."""
    sim = simulation(light_tower(5, "dead"), kinematics)
    assert relax(sim, 0.0, 1e-5, 2_000).state == "equilibrium"
    assert np.abs(sim.bodies.unbalanced[:, 1]).max() < 1e-3 * 1e-5 * 4e4 * (1.0 + 1e-9)


def test_a_load_holds_at_once():
    sim = simulation(light_tower(5, "live", **PULLED))
    stand(sim, Budget(10_000))
    moved = 15 * 4e4 / (1e10 * 0.25)  # m
    assert settle_or_fail(sim, 1.0 / sim.live_scale, Budget(40_000), moved).state == "equilibrium"
    upwards = (sim.bodies.positions - sim.reference_positions)[1:, 1]
    assert upwards == pytest.approx(np.arange(1, 6) * 4e4 / (1e10 * 0.25), rel=1e-3)


def test_a_curve_comes_to_its_end():
    """Displacement control: increments of 1e-5 m are millions of times what weights deform. 4 million steps before."""
    analysis = {"kind": "pushover", "pattern": "live", "control": "displacement", "follow": 2e-4, "max_load": 1.0}
    summary, _ = solve(light_tower(1, "live", analysis=analysis | {"increments": 20}))
    curve = summary["capacity_curve"]
    assert curve["whole"]
    assert curve["last_load"] == pytest.approx(1e10 * 0.25 * curve["last_displacement"] / 4e4, rel=1e-3)
    assert summary["steps"] < 300_000
