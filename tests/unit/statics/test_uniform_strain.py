"""Blocks of uniform strain: pressed and sheared blocks in closed form, corotational, energy, what is refused."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from engine import scene

from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.monitors import Monitors
from dem_cli.core.engine.placement import moves
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.geometry.rotation import turned_as_one
from dem_cli.core.kernels import records as slot
from dem_cli.core.model import uniform_strain
from dem_cli.core.statics.equilibrium import stand
from dem_cli.errors import CaseError
from dem_cli.results.output.block_stress import mean_stresses

CASES = Path(__file__).resolve().parents[3] / "cases"
YOUNG, POISSON, KN, KS = 1e9, 0.25, 1e10, 4e9
WIDE, HIGH, DEEP = 0.4, 0.3, 0.5


def column(dimension: int, *, load=(0.0, -1e5), poisson: float = POISSON, n: int = 1, gravity: float = 0.0, **joint):
    """n blocks on a fixed one, the highest with a load in the middle of its top."""

    def box(k: int) -> dict:
        low, high = (-HIGH, 0.0) if k == 0 else ((k - 1) * HIGH, k * HIGH)
        of_block = {"id": f"b{k}", "fixed": k == 0}
        flat = [[0.0, low], [WIDE, low], [WIDE, high], [0.0, high]]
        if dimension == 2:
            return of_block | {"vertices": flat, "thickness": DEEP}
        return of_block | {"vertices": [[x, y, z] for x, z in flat for y in (0.0, DEEP)]}

    middle = [WIDE / 2, n * HIGH] if dimension == 2 else [WIDE / 2, DEEP / 2, n * HIGH]
    force = list(load) if dimension == 2 else [load[0], 0.0, load[1]]
    return {
        "dimension": dimension,
        "gravity": gravity or 1e-9,
        "materials": {
            "stone": {"density": 2000.0, "young": YOUNG, "poisson": poisson, "deformation": "uniform-strain"}
        },
        "joints": {"dry": {"law": "coulomb", "friction": 0.9, "kn": KN, "ks": KS} | joint},
        "block": [box(k) for k in range(n + 1)],
        "load": [{"block": f"b{n}", "force": force, "at": middle}],
        "analysis": {"kind": "gravity"},
    }


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


def stress(sim: Simulation) -> np.ndarray:
    model, shape = sim.model, sim.shape
    volumes = model.shapes.volumes * model.thickness
    return uniform_strain.stresses(sim.bodies.modes, shape.mode_stiffness, volumes, shape.radii)


@pytest.mark.parametrize(("dimension", "kinematics"), [(2, "fixed"), (2, "large"), (3, "fixed"), (3, "large")])
def test_column_under_compression_is_exact(dimension, kinematics):
    """Every block E A/h between joints of kn A, its own weight at its middle; no lateral strain, no restraint."""
    n, gravity, force = 3, 9.81, 1e6 if kinematics == "fixed" else 1e5
    sim = at_rest(column(dimension, load=(0.0, -force), poisson=0.0, n=n, gravity=gravity), kinematics)
    area, weight = WIDE * DEEP, 2000.0 * WIDE * DEEP * HIGH * gravity
    below = force + weight * np.arange(n, 0, -1)  # at the bottom of each block
    inside = (below - weight / 2) / area
    joints, blocks = np.cumsum(below / (KN * area)), np.cumsum(inside / YOUNG * HIGH)
    expected = -(joints + blocks - inside / YOUNG * HIGH / 2)
    exact = 1e-9 if kinematics == "fixed" else 3.0 * inside.max() / YOUNG  # of second order in the strain
    assert measures.displacements(sim)[1:, -1] == pytest.approx(expected, rel=exact)
    assert stress(sim)[1:, -1, -1] == pytest.approx(-inside, rel=exact)
    assert abs(measures.closure(sim)) < (1e-6 if kinematics == "fixed" else 1e-3)
    by_contacts = mean_stresses(sim.model, measures.frame(sim, "gravity"))
    where_blocks_are = 3.0 * inside.max() / YOUNG  # its arms are those of now
    assert by_contacts[1:n] == pytest.approx(stress(sim)[1:n], abs=where_blocks_are * inside.max())


@pytest.mark.parametrize("dimension", [2, 3])
def test_one_block_between_soft_joints_bulges_by_poisson(dimension):
    """No shear stiffness to speak of: sideways strain is −ν times that along the force."""
    sim = at_rest(column(dimension, ks=1e3), "fixed")
    strain = uniform_strain.strains(sim.bodies.modes, sim.shape.radii)[1]
    sigma = 1e5 / (WIDE * DEEP)
    assert np.diag(strain) == pytest.approx([POISSON * sigma / YOUNG] * (dimension - 1) + [-sigma / YOUNG], rel=1e-5)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_sheared_block_is_exact(kinematics):
    """A pressed block pushed at its centroid: T h/2 in both halves of the dyad, half of the shear stress at its foot.

    The joint slides by T/ks A and turns by φ = (T h/2)/(kn A w²/4), the block shears by ε = T/2A 2G: its centroid moves
    by T/ks A + φ h/2 + ε h.
    """
    push, case = 2e4, column(2, load=(2e4, -2e5), poisson=0.0, points=2)
    case["load"][0]["at"][-1] = HIGH / 2
    sim, area = at_rest(case, kinematics), WIDE * DEEP
    exact = 1e-9 if kinematics == "fixed" else 1e-3
    strain, turn = push / (2.0 * area) / YOUNG, push * HIGH / 2 / (KN * area * WIDE**2 / 4)
    assert stress(sim)[1, 0, 1] == pytest.approx(push / (2.0 * area), rel=exact)
    expected = push / (KS * area) + turn * HIGH / 2 + strain * HIGH
    assert measures.displacements(sim)[1, 0] == pytest.approx(expected, rel=exact)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_block_that_nothing_holds_swells_without_stress(dimension):
    case = column(dimension, load=(0.0, -1e-3), friction=0.0)
    corner = [WIDE, HIGH] if dimension == 2 else [WIDE, DEEP, HIGH]
    case["monitor"] = [{"point": corner, "component": "x"}, {"block": "b1", "component": "x"}]
    case |= {"strain": [{"block": "b1", "value": 3e-4}]}
    sim = at_rest(case, "fixed")
    of_corner, of_block = Monitors(scene(case).request.monitors, sim.model).values(sim)
    assert of_corner - of_block == pytest.approx(3e-4 * WIDE / 2, rel=1e-6)
    strain = uniform_strain.strains(sim.bodies.modes, sim.shape.radii)[1]
    assert strain == pytest.approx(3e-4 * np.eye(dimension), abs=1e-9)
    assert np.abs(measures.block_stresses(sim)).max() < 1e-5 * YOUNG * 3e-4


@pytest.mark.parametrize("deformation", ["uniform-strain", "quadratic"])
def test_a_held_block_that_swells_has_the_stress_of_what_holds_it(deformation):
    """Between two fixed ones across which nothing slides: σ (w/E + 2/kn) = −ε w."""
    case = column(2, load=(0.0, -1e-3), poisson=0.0, friction=0.0, points=5)
    case["materials"]["stone"]["deformation"] = deformation
    if deformation == "quadratic":  # nothing that opens and closes on the way, so that books balance to round-off
        case["joints"]["dry"] = {"law": "elastic", "kn": KN, "ks": 1.0, "points": 5}
    for name, low in (("left", -WIDE), ("right", WIDE)):
        flat = [[low, 0.0], [low + WIDE, 0.0], [low + WIDE, HIGH], [low, HIGH]]
        case["block"].append({"id": name, "fixed": True, "vertices": flat, "thickness": DEEP})
    case["strain"] = [{"block": "b*", "value": 2e-4}, {"block": "b1", "value": 1e-4}]
    sim = at_rest(case, "fixed")
    pressed = -3e-4 * WIDE / (WIDE / YOUNG + 2.0 / KN)
    found = measures.block_stresses(sim)[sim.model.numbers["b1"]]
    assert found == pytest.approx([pressed, 0.0, 0.0], rel=1e-6, abs=1e-6 * abs(pressed))
    assert deformation != "quadratic" or abs(measures.closure(sim)) < 1e-6


def test_strain_comes_little_by_little():
    """Blocks that swell at once leap off each other: books were 2.4e-3 off, and friction took 7 times as much."""
    case = column(2, n=2, load=(0.0, -1.0), poisson=0.2, gravity=9.81, friction=0.7)
    made = scene(case | {"strain": [{"block": "b*", "value": 1e-4}]})
    found = []
    for ramp in (100, 1000):
        settings = replace(DEFAULT, relaxation=replace(DEFAULT.relaxation, ramp_of_memory=ramp))
        properties = joint_properties(made.request, made.model)
        sim = Simulation(made.model, law_of(made.request), properties, "fixed", settings=settings)
        assert stand(sim, Budget(2_000_000)).state == "equilibrium"
        assert abs(measures.closure(sim)) < 1e-4
        found.append(measures.energy(sim).friction)
    assert found[0] == pytest.approx(found[1], rel=0.02)


def test_energy_of_modes_closes_while_blocks_vibrate():
    """Undamped, far from rest, with small steps: kinetic energy, springs, modes and loads balance."""
    made = scene(column(2, n=2, gravity=9.81))
    sim = Simulation(made.model, law_of(made.request), joint_properties(made.request, made.model), "fixed")
    sim.use(0.02, 0.0)
    sim.advance(400, slot.HOLD_LOAD)
    inside = 0.5 * (sim.shape.mode_stiffness * sim.bodies.modes**2).sum()
    assert inside > 0.05 * sim.elastic_energy()
    assert sim.kinetic_energy() > 0.05 * sim.elastic_energy()
    assert abs(measures.closure(sim)) < 0.01


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_loaded_block_that_turns_keeps_its_strain(dimension):
    """Two blocks that press each other, turned as one by 90°: strains are those in their own axes."""
    sim = at_rest(column(dimension, n=2), "large")
    before, gaps = sim.bodies.modes.copy(), sim.measured().gaps.copy()
    everything = np.arange(sim.model.n_blocks)
    turn = np.pi / 2 if dimension == 2 else np.array([0.0, np.pi / 2, 0.0])
    moves.turn(sim, everything, turn, np.zeros(dimension))
    moves.find_faces(sim)
    assert sim.bodies.modes == pytest.approx(before)
    assert sim.measured().gaps == pytest.approx(gaps, rel=1e-9)
    sim.loads.dead[:, :dimension] = turned_as_one(sim.loads.dead[:, :dimension], turn)  # loads turn with them
    sim.advance(400, slot.HOLD_LOAD)
    within = 1e-6 if dimension == 2 else 2e-4  # in space points are found anew, with other arms by their overlap
    assert sim.bodies.modes == pytest.approx(before, rel=within, abs=1e-12 * np.abs(before).max())


def test_a_column_on_rigid_joints_stands_however_soft_its_blocks_are():
    """It sinks by half a millimetre, thousands of times what joints with kn = "auto" give way: it was said to fall."""
    made = scene(column(2, n=4, load=(0.0, -1e5), poisson=0.0, gravity=9.81, kn="auto", ks="auto"))
    sim = Simulation(
        made.model,
        law_of(made.request),
        joint_properties(made.request, made.model, 1e10),
        "fixed",
    )
    assert stand(sim, Budget(2_000_000)).state == "equilibrium"
    weight = 2000.0 * 9.81 * WIDE * HIGH * DEEP
    sunk = (3.5 * 1e5 + (3.5 + 2.5 + 1.5 + 0.25) * weight) * HIGH / (YOUNG * WIDE * DEEP)  # of its centroid
    assert -(sim.places() - sim.first_places)[4, 1] == pytest.approx(sunk, rel=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_blocks_that_are_moved_back_keep_their_strain(dimension):
    """Closure of rigid joints that is taken back: a settlement of such blocks ended with an internal error."""
    made = scene(column(dimension, n=1))
    sim = Simulation(made.model, law_of(made.request), joint_properties(made.request, made.model), "large")
    sim.bodies.modes[1, 0], before = 1e-3, sim.bodies.positions.copy()
    motion = np.zeros_like(sim.bodies.velocities)
    motion[1, :dimension] = 2e-6
    moves.shift(sim, motion)
    assert (sim.bodies.positions - before)[1] == pytest.approx(2e-6, rel=1e-6)
    assert (sim.taken_back == motion[:, : sim.taken_back.shape[1]]).all()
    assert sim.bodies.modes[1, 0] == 1e-3


@pytest.mark.parametrize(("ratio", "finite_elements"), [(0.05, 0.9626), (1.0, 0.5614)])
def test_wall_is_as_much_softer_as_finite_elements_say(ratio, finite_elements):
    """51 blocks with elastic joints of kn = ratio × E/h, pushed sideways: rigid blocks move less by that factor.

    From displacements against a model of the whole wall in finite elements (Q2 and elastic interfaces), of which rigid
    blocks differ by −4.7 % and −47 %, blocks of uniform strain by −1.0 % and −5.6 %.
    """
    case = tomllib.loads((CASES / "validation/shear_wall_sw100.toml").read_text(encoding="utf-8"))
    kn, moved = ratio * 15.5e9 / 0.1, []
    case["joints"]["dry"] = {"law": "elastic", "kn": kn, "ks": 0.417 * kn, "points": 5}
    for kind in ("none", "uniform-strain"):
        for material in case["materials"].values():
            material |= {"young": 15.5e9, "poisson": 0.2, "deformation": kind}
        made = scene(case)
        sim = Simulation(
            made.model,
            law_of(made.request),
            joint_properties(made.request, made.model),
            "fixed",
        )
        sim.set_dead_share(0.0)
        sim.loads.dead[:] = 0.0
        sim.set_load(1e3)
        sim.use_combined_damping()
        sim.advance(6000, slot.HOLD_LOAD)
        moved.append(measures.displacements(sim)[-1, 0])
    assert moved[0] / moved[1] == pytest.approx(finite_elements, rel=0.01)


def test_rigid_blocks_among_others_stay_rigid():
    case = column(2, n=2)
    case["materials"]["iron"] = {"density": 7000.0}
    for block in case["block"]:
        block["material"] = "iron" if block["id"] == "b1" else "stone"
    sim = at_rest(case, "large")
    assert not sim.bodies.modes[1].any()
    assert sim.bodies.modes[2].any()


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        ({"materials.stone.young": None}, "deformation", "without 'young'"),
        ({"strain": [{"block": "b0", "value": 1e-4}]}, "block", "'b0' is fixed"),
        ({"materials.stone.deformation": "joints", "strain": [{"block": "b1", "value": 1e-4}]}, "block", "no strain"),
    ],
)
def test_what_is_not_known_is_refused(change, key, words):
    case = column(2)
    for path, value in change.items():
        *tables, name = path.split(".")
        table = case
        for part in tables:
            table = table[part]
        if value is None:
            del table[name]
        else:
            table[name] = value
    with pytest.raises(CaseError) as caught:
        scene(case)
    assert caught.value.problems[0].path[-1] == key
    assert words in str(caught.value)
