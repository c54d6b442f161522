"""Blocks that bend: beside elements that can do just as much, bending through joints, turned blocks, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from engine import scene
from studies.deformable import bending, elastic_wall

from dem_cli.core.engine import measures
from dem_cli.core.engine.monitors import Monitors
from dem_cli.core.engine.placement import moves
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.kernels import records as slot
from dem_cli.errors import CaseError

YOUNG, KN = 1e9, 1e10
WIDE, HIGH, DEEP, BLOCKS = 0.4, 0.3, 0.5, 3


def column(couple: float, law: str = "elastic", press: float = 0.0) -> dict:
    """Blocks on a fixed one, under a rigid one that two opposite forces turn and a third one presses."""

    def box(k: int) -> dict:
        low, high = (k - 1) * HIGH, k * HIGH
        flat = [[0.0, low], [WIDE, low], [WIDE, high], [0.0, high]]
        material = "iron" if k > BLOCKS else "stone"
        return {"id": f"b{k}", "fixed": k == 0, "vertices": flat, "thickness": DEEP, "material": material}

    top, stone = (BLOCKS + 1) * HIGH, {"young": YOUNG, "poisson": 0.0, "deformation": "quadratic"}
    strength = {"friction": 0.9} if law == "coulomb" else {}
    forces = [([0.0, WIDE], couple / WIDE), ([WIDE, WIDE], -couple / WIDE), ([WIDE / 2, WIDE], -press)]
    return {
        "gravity": 1e-9,
        "materials": {"stone": {"density": 2000.0} | stone, "iron": {"density": 7000.0}},
        "joints": {"dry": {"law": law, "kn": KN, "ks": 4e9, "points": 5} | strength},
        "block": [box(k) for k in range(BLOCKS + 2)],
        "load": [{"block": f"b{BLOCKS + 1}", "force": [0.0, f], "at": [x, top]} for (x, _), f in forces],
        "analysis": {"kind": "gravity"},
    }  # fmt: skip


def at_rest(case: dict, kinematics: str) -> Simulation:
    made = scene(case)
    sim = Simulation(
        made.model,
        law_of(made.request),
        joint_properties(made.request, made.model),
        kinematics,
    )
    sim.use_combined_damping()
    for _ in range(60):
        sim.advance(200, slot.HOLD_LOAD)
        if sim.unbalanced < 1e-12:
            break
    return sim


@pytest.mark.parametrize(("deformation", "degree"), [("none", 0), ("uniform-strain", 1), ("quadratic", 2)])
def test_wall_is_as_stiff_as_elements_that_can_do_just_as_much(deformation, degree):
    """51 blocks, linear: five Gauss-Lobatto points integrate such joints exactly, so that both are the same model."""
    found = elastic_wall.displacement(0.44, deformation)
    assert found == pytest.approx(elastic_wall.finite_elements(0.44, 0.05, degree), rel=2e-6)


def test_blocks_that_bend_are_near_to_finite_elements():
    """By far nearer than rigid blocks (28 %), and stiffer, as they can do less."""
    error = elastic_wall.displacement(0.44, "quadratic") / elastic_wall.finite_elements(0.44, 0.05) - 1.0
    assert error == pytest.approx(-0.0256, abs=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_study_of_columns_has_closed_forms(dimension):
    """Rigid blocks have joints alone, n/(kn A) by hand; blocks of uniform strain shorten with them."""
    ratio, area = 0.44, bending.WIDTH * bending.THICKNESS
    joints = bending.BLOCKS * bending.HEIGHT / (ratio * bending.YOUNG * area)
    assert bending.displacement(ratio, "none", dimension, "pressed") == pytest.approx(joints, rel=1e-9)
    strained = bending.displacement(ratio, "uniform-strain", dimension, "pressed")
    assert strained == pytest.approx(bending.pressed_by_hand(ratio), rel=2e-4)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_bending_through_joints_is_exact(kinematics):
    """Each joint turns by M/kn I, each block by M h/E I; nothing slides, and books balance."""
    couple, inertia = 1e3, DEEP * WIDE**3 / 12.0
    case = column(couple) | {"monitor": [{"point": [0.0, BLOCKS * HIGH - 1e-9], "component": "x"}]}
    sim = at_rest(case, kinematics)
    bent, joint = couple * HIGH / (YOUNG * inertia), couple / (KN * inertia)
    starts = np.cumsum(np.full(BLOCKS, joint)) + bent * np.arange(BLOCKS)  # of each block, at its foot
    (sways,) = Monitors(scene(case).request.monitors, sim.model).values(sim)
    assert sways == pytest.approx(((starts + bent / 2.0) * HIGH).sum(), rel=3e-4)  # of second order
    turned = couple / inertia * ((BLOCKS + 1) / KN + BLOCKS * HIGH / YOUNG)
    exact = 1e-8 if kinematics == "fixed" else 1e-3  # of second order in the rotation
    assert -sim.bodies.orientations[-1, 0] == pytest.approx(turned, rel=exact)
    assert np.abs(sim.contacts.shear).max() < 1e-3 * np.abs(sim.contacts.normal).max()
    assert abs(measures.closure(sim)) < (1e-6 if kinematics == "fixed" else 1e-3)


def test_a_bent_column_that_turns_stays_as_bent_as_it_was():
    """Turned as one by 90°, with its loads: amplitudes are those in the axes of the blocks, gaps stay."""
    sim = at_rest(column(2e3, "coulomb", 1e5), "large")
    before, gaps, everything = sim.bodies.modes.copy(), sim.measured().gaps.copy(), np.arange(sim.model.n_blocks)
    assert np.abs(before[:, 3:]).max() > 0.05 * np.abs(before).max()
    moves.turn(sim, everything, np.pi / 2, np.zeros(2))
    moves.find_faces(sim)
    assert sim.measured().gaps == pytest.approx(gaps, rel=1e-6, abs=1e-6 * np.abs(gaps).max())
    sim.loads.dead[:, :2] = sim.loads.dead[:, :2] @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    sim.advance(400, slot.HOLD_LOAD)
    assert sim.bodies.modes == pytest.approx(before, rel=1e-5, abs=1e-9 * np.abs(before).max())


@pytest.mark.parametrize(
    ("table", "key", "value", "words"),
    [
        (None, "dimension", 3, "not known in 3D"),
        ("joints", "points", 2, "too few"),
    ],
)
def test_what_is_not_known_is_refused(table, key, value, words):
    case = column(1.0)
    at = case if table is None else case[table].get("dry", case[table])
    at[key] = value
    with pytest.raises(CaseError, match=words):
        scene(case)
