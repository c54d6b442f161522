"""A tie as the stepping loop sees it: forces are slopes of its energy, stiffness that of forces, compiled or not."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from dem_cli.case.tables.declared import table_of
from dem_cli.core.geometry.rotation import quaternions, turned_further, turns_of
from dem_cli.core.kernels.jit import kernel
from dem_cli.core.links.link import FIXED_POINT, FORCE, PLASTIC, LinkEnds, all_forces
from dem_cli.core.links.matrices import elastic_energy_of_links
from dem_cli.core.links.tie import TIE, Tie, ties

CENTROIDS = {2: np.array([[0.0, 0.0], [2.0, 1.0]]), 3: np.array([[0.0, 0.0, 0.2], [2.0, 1.0, -0.4]])}
POINTS = {2: [[0.3, 0.2], [-0.4, 0.1]], 3: [[0.3, 0.2, -0.1], [-0.4, 0.1, 0.25]]}


class Placed(NamedTuple):
    """What ties ask of kernels.records.Bodies."""

    positions: np.ndarray
    orientations: np.ndarray
    turns: np.ndarray
    forces: np.ndarray


LIKE = {2: ((0.0,) * 2, (0.0,)), 3: ((0.0,) * 3, (0.0,) * 3)}


def tie(**more) -> Tie:
    return table_of(Tie).model_validate({"ends": ((0.0, 0.0), (1.0, 1.0)), "stiffness": 1e5, **more})


def scene(dimension: int, anchored: bool, **more):
    """Ties of two blocks, or of one and a fixed point, which have moved and turned; bodies as the loop has them."""
    blocks = (0, FIXED_POINT) if anchored else (0, 1)
    points = np.array(POINTS[dimension]) + (CENTROIDS[dimension][1] if anchored else 0.0) * np.array([[0.0], [1.0]])
    links = (ties([tie(**more)], [LinkEnds(blocks, points)], CENTROIDS[dimension]).started(np.zeros(dimension)),)
    r = 1 if dimension == 2 else 3
    orientations = np.zeros((2, 1)) if dimension == 2 else quaternions(np.zeros((2, 3)))
    return links, bodies_at(CENTROIDS[dimension].copy(), orientations, np.zeros((2, dimension + r)))


def bodies_at(positions, orientations, forces):
    return Placed(positions, orientations, turns_of(orientations), forces)


def moved(bodies, motion):
    d = bodies.positions.shape[1]
    return bodies_at(
        bodies.positions + motion[:, :d],
        turned_further(bodies.orientations, motion[:, d:]),
        np.zeros_like(bodies.forces),
    )


def pull(links, bodies, moves: bool = True) -> np.ndarray:
    bodies.forces[:] = 0.0
    all_forces([TIE.forces[moves]])(links, bodies, *LIKE[bodies.positions.shape[1]])
    return bodies.forces.copy()


def shift(dimension: int, size: float) -> np.ndarray:
    return size * np.random.default_rng(3).standard_normal((2, dimension + (1 if dimension == 2 else 3)))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("anchored", [False, True])
def test_forces_are_slopes_of_the_energy_and_stiffness_of_forces(dimension, anchored):
    links, start = scene(dimension, anchored, compression=True, prestress=700.0)
    bodies = moved(start, shift(dimension, 0.3))
    forces = pull(links, bodies)
    stiffness = links[0].turning(bodies)[0]
    springs = links[0].axial(bodies)
    row = springs.motion[0].ravel()
    stiffness = stiffness + springs.stiffness[0] * np.outer(row, row)
    n_dof, step = forces.shape[1], 1e-6
    for i in range(2 * n_dof):
        change = np.zeros((2, n_dof))
        change.flat[i] = step
        sides = []
        for sign in (1.0, -1.0):
            there = moved(bodies, sign * change)
            sides.append((pull(links, there), elastic_energy_of_links(links)))
        slope = -(sides[0][1] - sides[1][1]) / (2 * step)
        assert slope == pytest.approx(forces.flat[i], rel=1e-6, abs=1e-3 * np.abs(forces).max())
    # Of moments along fixed axes the slope is not symmetric in space; that of the energy is.
    for i in range(2 * n_dof):
        for k in range(i + 1):
            values = []
            for a, b in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
                change = np.zeros((2, n_dof))
                change.flat[i] += 1e-4 * a
                change.flat[k] += 1e-4 * b
                pull(links, moved(bodies, change))
                values.append(elastic_energy_of_links(links))
            second = (values[0] - values[1] - values[2] + values[3]) / 4e-8
            assert second == pytest.approx(stiffness[i, k], abs=2e-4 * np.abs(stiffness).max()), (i, k)


@pytest.mark.parametrize("dimension", [2, 3])
def test_geometry_of_the_start_is_the_limit_of_small_motion(dimension):
    links, start = scene(dimension, False, prestress=700.0)
    motion = shift(dimension, 1e-7)
    large = pull(links, moved(start, motion))
    d = dimension
    small = bodies_at(start.positions + motion[:, :d], motion[:, d:], np.zeros_like(start.forces))
    assert pull(links, small, moves=False) == pytest.approx(large, abs=1e-5 * np.abs(large).max())


@pytest.mark.parametrize("moves", [False, True])
def test_compiled_is_what_is_written(moves):
    function, results = all_forces([TIE.forces[moves]]), []

    def call(links, bodies, like, like_rotation):
        return function(links, bodies, like, like_rotation)

    for run in (call, kernel(call)):
        links, start = scene(2, False, yield_force=800.0, prestress=700.0)
        bodies = moved(start, shift(2, 0.02))
        lost = [run(links, bodies, *LIKE[2]) for _ in range(2)]
        results.append((lost, bodies.forces, links[0].state))
    for written, compiled in zip(*results, strict=True):
        assert np.array_equal(written, compiled)


def stretched(links, bodies, by: float) -> tuple[float, float]:
    """Force, and work lost, when the second block is pulled away along the tie."""
    there = bodies_at(bodies.positions.copy(), bodies.orientations, bodies.forces)
    there.positions[1] += by * links[0].axes[0]
    lost = all_forces([TIE.forces[True]])(links, there, *LIKE[2])
    return float(links[0].state[0, FORCE]), lost


def test_a_tie_yields_hangs_and_takes_up_again():
    links, bodies = scene(2, False, yield_force=1000.0)
    assert stretched(links, bodies, 0.005) == (pytest.approx(500.0), 0.0)
    assert stretched(links, bodies, -0.005) == (0.0, 0.0)
    force, lost = stretched(links, bodies, 0.03)
    assert (force, lost) == (1000.0, pytest.approx(0.5 * 1000.0 * 0.02))  # mean of the forces before and after
    assert links[0].state[0, PLASTIC] == pytest.approx(0.02)
    assert stretched(links, bodies, 0.019) == (0.0, 0.0)
    assert stretched(links, bodies, 0.025) == (pytest.approx(500.0), 0.0)


def test_a_rod_yields_both_ways():
    links, bodies = scene(2, False, yield_force=1000.0, compression=True)
    force, lost = stretched(links, bodies, -0.03)
    assert (force, lost) == (-1000.0, pytest.approx(0.5 * 1000.0 * 0.02))
    assert stretched(links, bodies, -0.025)[0] == pytest.approx(-500.0)


WRONG = {
    "prestress": ({"prestress": 2e3, "yield_force": 1e3}, "must be at most yield_force"),
    "stress": ({"stiffness": None, "area": 1e-4, "young": 2e11, "prestress": 2e4, "yield_stress": 1e8}, "yield_stress"),
    "length": ({"ends": ((1.0, 1.0), (1.0, 1.0))}, "same point"),
    "no stiffness": ({"stiffness": None, "area": 1e-4}, "area and young, or stiffness"),
    "both": ({"young": 2e11}, "give one of them"),
    "anchored": ({"anchored": True, "other": "b"}, "fixed point"),
    "two limits": ({"yield_force": 1.0, "yield_stress": 1.0, "area": 1.0}, "give one of them"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_ties(name):
    keys, said = WRONG[name]
    with pytest.raises(ValueError, match=said):
        tie(**keys)
