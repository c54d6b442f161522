"""Natural frequencies of blocks that deform: closed forms, a wall beside finite elements, a cantilever."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine import scene
from studies.deformable.elastic_wall import corners_of
from studies.deformable.finite_elements import ElasticWall, frequencies

from dem_cli.core.dynamics.frequencies import modes, system
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.model.mode_masses import mass_matrices

YOUNG, DENSITY, DEEP, STIFF = 1e9, 2000.0, 0.5, 1e15


def prism(name: str, low: tuple[float, float], high: tuple[float, float], dimension: int = 2, fixed: bool = False):
    flat = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
    if dimension == 3:
        return {"id": name, "fixed": fixed, "vertices": [[x, y, z] for x, z in flat for y in (0.0, DEEP)]}
    return {"id": name, "fixed": fixed, "vertices": flat, "thickness": DEEP}


def lowest(blocks: list[dict], count: int, deformation: str, poisson: float = 0.0, kn: float = STIFF, ks=STIFF):
    """The simulation and its modes, all contact points closed."""
    stone = {"density": DENSITY, "young": YOUNG, "poisson": poisson, "deformation": deformation}
    law = (
        {"law": "elastic"} if deformation == "quadratic" else {"law": "coulomb", "friction": 0.9}
    )  # compiled elsewhere
    dry = law | {"kn": kn, "ks": ks, "points": 5}
    dimension = len(blocks[0]["vertices"][0])
    case = {"dimension": dimension, "gravity": 1e-9, "materials": {"stone": stone}, "joints": {"dry": dry}}
    made = scene(case | {"block": blocks, "analysis": {"kind": "modes"}})
    sim = Simulation(made.model, law_of(made.request), joint_properties(made.request, made.model), "large")
    return sim, modes(system(sim), count, dimension, made.model.n_blocks)


@pytest.mark.parametrize("dimension", [2, 3])
def test_clamped_column_vibrates_along_itself_as_a_rod_of_linear_elements(dimension):
    """Stiff joints: blocks of uniform strain with ν = 0 are linear elements with consistent masses, whose frequencies
    are c/h √(6 (1 − cos θ)/(2 + cos θ)), θ = (2k − 1) π/2n; the first is that of the rod, c/4L, + 0.6 % for n = 4."""
    n, high = 4, 0.3
    column = [prism(f"b{k}", (0.0, (k - 1) * high), (0.4, k * high), dimension, k == 0) for k in range(n + 1)]
    found = lowest(column, 30, "uniform-strain")[1]
    along = found.frequencies[found.effective_masses[:, -1] > 1e-3][:n]
    angle = math.pi / 2 / n * np.arange(1, 2 * n, 2)
    speed = math.sqrt(YOUNG / DENSITY)
    exact = speed / high * np.sqrt(6.0 * (1.0 - np.cos(angle)) / (2.0 + np.cos(angle))) / (2.0 * math.pi)
    assert along == pytest.approx(exact, rel=1e-5)
    assert along[0] == pytest.approx(speed / (4.0 * n * high), rel=0.01)
    assert found.mechanisms == 0


def test_cantilever_of_quadratic_blocks_vibrates_as_a_beam_that_shears():
    """Ten square blocks; Timoshenko's beam with k = 5/6 by 400 linear elements: 2.837 and 17.13 Hz."""
    column = [prism(f"b{k}", (0.0, (k - 1) * 0.4), (0.4, k * 0.4), fixed=k == 0) for k in range(11)]
    found = lowest(column, 2, "quadratic")[1].frequencies
    assert found == pytest.approx([2.837, 17.13], rel=0.02)


@pytest.mark.parametrize(("deformation", "degree"), [("none", 0), ("uniform-strain", 1), ("quadratic", 2)])
def test_wall_vibrates_as_elements_do_that_can_do_just_as_much(deformation, degree):
    """Soft joints in running bond, Poisson's ratio, oblong blocks: stiffness and coupled masses of elements."""
    size, kn, ks = 0.1, 5e9, 2e9
    rows = [(-0.1, [0.0, 1.2]), (0.0, [0.0, 0.4, 0.8, 1.2]), (0.2, [0.0, 0.2, 0.6, 1.0, 1.2]), (0.4, [0.0, 0.8, 1.2])]
    wall = [
        prism(f"b{y}-{k}", (left, y), (right, y + (0.1 if y < 0.0 else 0.2)), fixed=y < 0.0)
        for y, cuts in rows
        for k, (left, right) in enumerate(zip(cuts[:-1], cuts[1:], strict=True))
    ]
    sim, found = lowest(wall, 8, deformation, 0.2, kn, ks)
    elements = ElasticWall(*corners_of(sim.model), sim.model.fixed, YOUNG, 0.2, DEEP, kn, ks, DENSITY)
    assert found.frequencies == pytest.approx(frequencies(elements, size, 8, degree), rel=1e-6)
    if deformation == "quadratic":
        assert found.frequencies[:2] == pytest.approx(frequencies(elements, size / 2, 2), rel=0.02)


def test_masses_of_a_crooked_block_are_those_of_its_turning_and_positive():
    block = {"id": "a", "vertices": [[0.0, 0.0], [1.0, 0.1], [0.8, 0.5], [0.1, 0.7]], "thickness": DEEP}
    sim = lowest([prism("base", (0.0, -0.2), (1.0, 0.0), fixed=True), block], 1, "quadratic")[0]
    found = mass_matrices(sim.model)[1]
    assert found[0, 0] == pytest.approx(sim.model.inertias[1, 0])
    assert np.linalg.eigvalsh(found)[0] > 0.0
    assert np.abs(found[1:4, 4:]).max() > 1e-3 * found[1:4, 1:4].max()  # no symmetry
