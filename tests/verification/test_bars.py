"""[[reinforcement]] in whole cases: limit loads where geometry moves in space, frequencies, histories, what is kept."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from engine import block, rectangle, scene, simulation, solve, tables

from dem_cli.core.dynamics.frequencies import modes, system
from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.dynamic import DynamicSimulation
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.viscous import Damping
from dem_cli.core.kernels.records import Ground
from dem_cli.core.links.link import FORCE
from dem_cli.core.statics.equilibrium import stand

CASES = Path(__file__).resolve().parents[2] / "cases" / "verification"
CEILING = block("ceiling", rectangle(-1, 1, 1, 2), fixed=True)
HUNG = block("hung", rectangle(-0.5, 0, 0.5, 1))
WEIGHT = 2000.0 * 9.81
ROD = {"area": 1.13e-4, "young": 2e11, "bond_stiffness": 1e9}
STIFFNESS = 0.5 * math.sqrt(2.26e7 * 1e9) * math.tanh(0.6 * math.sqrt(1e9 / 2.26e7))  # of 0.6 m on either side


def hung(path=((0.0, 1.6), (0.0, 0.4)), **more) -> dict:
    """A block below a ceiling, on a bar."""
    return tables(
        CEILING, HUNG, bars={"rod": ROD | more}, analysis={"kind": "gravity", "kinematics": "large"},
        reinforcement=[{"bar": "rod", "path": [list(point) for point in path]}],
    )  # fmt: skip


def test_corners_of_a_house_where_geometry_moves():
    """Limit analysis and the explicit solver within 1 %; bars that yield and bond are in the books."""
    summary, records = solve(
        CASES / "space" / "tied_corner.toml", "analysis.kinematics=large", "analysis.resolution=0.01"
    )
    assert summary["failure_load"] == pytest.approx(0.514085, rel=1e-2)
    assert abs(summary["energy_closure"]) < 1e-3
    assert summary["joint_state"]["bars"]["left-high"]["force"] == pytest.approx(2000.0, rel=0.15)
    (value,) = records.rows[-1].monitors
    assert 0.0 < value <= 2000.0 * (1 + 1e-9)


def test_a_block_hangs_from_its_bar():
    """Elongation and force are those of bond; the bar is stiff across, so that it swings about the joint."""
    sim = simulation(hung(), "large")
    assert stand(sim, Budget(100_000)).state == "equilibrium"
    (bar,) = sim.links
    assert bar.forces == pytest.approx([WEIGHT], rel=1e-4)
    sunk = sim.reference_positions[sim.free, 1] - sim.bodies.positions[sim.free, 1]
    assert sunk == pytest.approx([WEIGHT / STIFFNESS], rel=5e-3)
    assert abs(measures.closure(sim)) < 1e-4
    found = modes(system(sim, np.zeros(2, bool), geometric=True), 3, 2, 2).frequencies
    assert found[-1] == pytest.approx(math.sqrt(STIFFNESS / 2000.0) / (2.0 * math.pi), rel=5e-3)
    record = measures.frame(sim, "gravity").links
    (line,) = record.lines(measures.frame(sim, "gravity"))
    assert line[[0, -1]] == pytest.approx(np.array([[0.0, 1.6], [0.0, 0.4 - sunk[0]]]), abs=1e-9)
    assert record.largest() == pytest.approx([WEIGHT], rel=1e-4)
    joint = np.flatnonzero(np.diff(record.places.blocks))
    assert line[joint[0]] == pytest.approx([0.0, 1.0], abs=1e-9)  # below the ceiling, and the block under it has sunk
    assert line[joint[0] + 1] == pytest.approx([0.0, 1.0 - sunk[0]], abs=1e-9)


def test_a_block_that_falls_into_its_bar_keeps_its_energy():
    """In time: bond slides and gives back what is elastic; all that is lost is in the books."""
    made = scene(hung(bond_strength=4e4))
    sim = DynamicSimulation(
        made.model,
        law_of(made.request),
        joint_properties(made.request, made.model, 1e5),
        Damping(),
    )
    sim.begin(1e-5)
    steps = 4000
    watch = sim.watch(np.zeros(0, np.int64), 1, steps)
    sim.shake(Ground(np.zeros((steps, 2)), np.zeros(0, np.int64), np.zeros((steps, 0, 3))), steps, watch)
    sim.note_kinetic_energy()
    (bar,) = sim.links
    assert abs(measures.closure(sim)) < 1e-3
    assert watch.links[:, len(bar.slips) + bar.joints[0], FORCE].max() > WEIGHT
    assert watch.links[:, len(bar.slips) + bar.joints[0], FORCE].max() <= 24e3 * (1 + 1e-8)
    assert sim.ledger[3] > 0.0
    saved, before = sim.save(), bar.state.copy()
    bar.state[:] = 0.0
    sim.restore(saved)
    assert np.array_equal(bar.state, before)


def test_a_bar_across_a_bed_that_slides():
    """Square to the bed no slip stretches it: friction alone holds the run, λ = μ. In the associated load the
    bed opens and the bar clamps it, λ W = μ (W + Ny). The run says why it is lower, whatever the elements."""
    weight, strength = 2000.0 * 9.81 * 0.5, 2000.0
    rod = {"area": 1e-5, "young": 2e11, "yield_stress": 2e8, "bond_stiffness": 2e8, "bond_strength": 2e4}
    for element in (0.05, 0.02):
        case = tables(
            block("base", rectangle(-1, -1, 2, 0), fixed=True), block("b", rectangle(0, 0, 1, 0.5)), friction=0.3,
            bars={"rod": rod}, reinforcement=[{"bar": "rod", "path": [[0.5, -0.45], [0.5, 0.45]], "element": element}],
            analysis={"kind": "pushover", "direction": [1.0, 0.0], "limit": True},
        )  # fmt: skip
        summary, _ = solve(case)
        assert summary["failure_load"] == pytest.approx(0.3, rel=2e-3)
        assert summary["limit_analysis"]["associated"] == pytest.approx(0.3 * (1 + strength / weight), rel=1e-5)
        (said,) = [text for text in summary["warnings"] if "ties or bars may hold more" in text]
        assert "0.36116" in said


def test_the_bound_where_a_block_has_slid_knows_the_kink_of_its_bar():
    """A block pushed along a bed that a bar crosses carries what the kink holds, which the start cannot."""
    rod = ROD | {"yield_stress": 4e8, "bond_strength": 4e4}
    summary, _ = solve(tables(
        block("floor", rectangle(-1, -1, 2, 0), fixed=True), block("b", rectangle(0, 0, 1, 1)), friction=0.6,
        bars={"rod": rod}, reinforcement=[{"bar": "rod", "path": [[0.5, -0.9], [0.5, 0.9]], "element": 0.04}],
        analysis={"kind": "pushover", "kinematics": "large"},
    ))  # fmt: skip
    above = summary["above_the_bound"]
    assert summary["status"] == "ok"
    assert above["explained"]
    assert summary["failure_load"] > 1.5 * summary["limit_analysis"]["associated"]
    assert not any("do not trust" in line for line in summary["warnings"])
