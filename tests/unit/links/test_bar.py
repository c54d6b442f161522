"""A bar as the stepping loop sees it: bond against closed forms, forces slopes of its energy, compiled or not."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest

from dem_cli.case.tables.declared import table_of
from dem_cli.core.geometry.rotation import quaternions, turned_further, turns_of
from dem_cli.core.kernels.jit import kernel
from dem_cli.core.links.bar import BAR, bars
from dem_cli.core.links.drawn_bar import FINE, BarPiece, BarProfile, DrawnBar, Reinforcement
from dem_cli.core.links.link import FORCE, PLASTIC, STRETCH, all_forces

EA, KB, SB, LONG = 2.26e7, 1e9, 4e4, 0.6
MU = math.sqrt(KB / EA)
LIKE = {2: ((0.0,) * 2, (0.0,)), 3: ((0.0,) * 3, (0.0,) * 3)}


class Placed(NamedTuple):
    """What bars ask of kernels.records.Bodies."""

    positions: np.ndarray
    orientations: np.ndarray
    turns: np.ndarray
    forces: np.ndarray


def profile(**more) -> BarProfile:
    return table_of(BarProfile).model_validate(
        {"area": 1.13e-4, "young": 2e11, "bond_stiffness": KB, "bond_strength": SB, **more}
    )


def bodies_at(positions, orientations):
    dofs = positions.shape[1] + (1 if positions.shape[1] == 2 else 3)
    return Placed(positions, orientations, turns_of(orientations), np.zeros((len(positions), dofs)))


def unturned(dimension: int, n: int) -> np.ndarray:
    return np.zeros((n, 1)) if dimension == 2 else quaternions(np.zeros((n, 3)))


def straight(long: float = LONG, anchored=(False, False), element: float | None = None, **more):
    """A bar along x across the joint at x = 0 of two blocks, by `long` in either."""
    own = profile(**more)
    centroids = np.array([[-1.0, 0.0], [1.0, 0.0]])
    pieces = (
        BarPiece(0, np.array([[1.0 - long, 0.0], [1.0, 0.0]])),
        BarPiece(1, np.array([[-1.0, 0.0], [long - 1.0, 0.0]])),
    )
    drawn = DrawnBar(own, element or FINE / own.decay, anchored, pieces)
    return bars([None], [drawn], centroids).started(np.zeros(2)), bodies_at(centroids, unturned(2, 2))


@kernel
def pull_still(links, bodies, like, like_rotation):
    return STILL(links, bodies, like, like_rotation)


@kernel
def pull_moving(links, bodies, like, like_rotation):
    return MOVING(links, bodies, like, like_rotation)


STILL, MOVING = (all_forces([BAR.forces[moves]]) for moves in (False, True))
PULL = {False: pull_still, True: pull_moving}


def opened(bar, bodies, widths, moves: bool = False):
    """Force, work done and work lost up to each opening of the joint."""
    force, work, lost, rows, before = 0.0, 0.0, 0.0, [], 0.0
    for width in widths:
        bodies.positions[1, 0] = 1.0 + width
        bodies.forces[:] = 0.0
        lost += PULL[moves]((bar,), bodies, *LIKE[2])
        work += 0.5 * (force + bodies.forces[0, 0]) * (width - before)
        force, before = bodies.forces[0, 0], width
        rows.append((force, work, lost))
    return np.array(rows)


def bond(u: float, long: float = LONG) -> float:
    """Force of a bar of which the loaded end has slipped by u: elastic, then sliding over x from there."""
    if u <= SB / KB:
        return math.sqrt(EA * KB) * u * math.tanh(MU * long)
    low, high = 0.0, long
    for _ in range(100):
        x = 0.5 * (low + high)
        slip = SB / KB + SB / MU * math.tanh(MU * (long - x)) * x / EA + SB * x**2 / (2.0 * EA)
        low, high = (x, high) if slip < u else (low, x)
    return SB * x + SB / MU * math.tanh(MU * (long - x))


@pytest.mark.parametrize("moves", [False, True])
def test_bond_follows_its_closed_form(moves):
    """Elastic, sliding from the joint on, pulled out: within 0.5 % of sb L with elements as they are chosen."""
    widths = np.linspace(0.0, 1.5e-3, 101)[1:]
    bar, bodies = straight()
    rows = opened(bar, bodies, widths, moves)
    expected = np.array([bond(0.5 * width) for width in widths])  # either side slips by half
    assert np.abs(rows[:, 0] - expected).max() < 0.005 * SB * LONG
    assert rows[-1, 0] == pytest.approx(SB * LONG, rel=1e-9)
    assert rows[0, 0] == pytest.approx(expected[0], rel=5e-3)
    _, work, lost = rows[-1]
    assert work - lost - bar.energy() == pytest.approx(0.0, abs=1e-9 * work)
    assert bar.answer(0)["slid"]


def test_a_bar_yields_and_keeps_its_elongation():
    bar, bodies = straight(yield_stress=1e8)
    widths = [*np.linspace(0.0, 2e-3, 41)[1:], 1.9e-3, 1e-3]
    rows = opened(bar, bodies, widths)
    assert rows[39, 0] == pytest.approx(1.13e4, rel=1e-9)
    assert rows[40, 0] < 0.9 * 1.13e4
    assert rows[41, 0] == pytest.approx(-1.13e4, rel=1e-9)  # it also yields in compression
    assert bar.answer(0)["yielded"]
    assert rows[-1, 1] - rows[-1, 2] - bar.energy() == pytest.approx(0.0, abs=1e-9 * rows[-1, 1])


def test_an_anchored_end_holds_what_bond_does_not():
    """Bond of 0.1 m slides, and the end at the start holds: the other side is pulled out."""
    for anchored, expected in ((("start", "end"), None), (("start",), SB * 0.1), ((), SB * 0.1)):
        bar, bodies = straight(0.1, ("start" in anchored, "end" in anchored))
        force = opened(bar, bodies, np.linspace(0.0, 5e-4, 51)[1:])[-1, 0]
        most = bar.bounded()[1][0, 1]
        if expected is None:
            assert force > 2.0 * SB * 0.1
            assert most == math.inf
        else:
            assert force == pytest.approx(expected, rel=1e-9)
            assert most == pytest.approx(expected)


def crooked(dimension: int, **more):
    """Bars of four blocks: one straight through them, one that has corners, at a joint and in a block."""
    own = profile(**{"dowel_stiffness": 2e8, **more})
    centroids = np.zeros((4, dimension))
    centroids[:, 0] = [0.0, 1.0, 2.0, 3.0]
    up = np.zeros(dimension)
    up[1:] = [0.1, 0.2][: dimension - 1]

    def piece(block, *places):
        points = np.array([np.eye(dimension)[0] * x + y * up for x, y in places])
        return BarPiece(block, points - centroids[block])

    through = [piece(0, (0.2, 0.5), (0.5, 0.5)), piece(1, (0.5, 0.5), (1.5, 0.5)), piece(2, (1.5, 0.5), (1.8, 0.5))]
    bent = [
        piece(1, (0.8, -1), (1.5, -1)),
        piece(2, (1.5, -1), (2.0, -0.3)),
        piece(2, (2.0, -0.3), (2.5, -0.3)),
        piece(3, (2.5, -0.3), (2.9, 0.0)),
    ]
    drawn = [DrawnBar(own, 0.1, (False, True), tuple(through)), DrawnBar(own, 0.15, (False, False), tuple(bent))]
    made = bars([None, None], drawn, centroids).started(np.zeros(dimension))
    return (made,), bodies_at(centroids, unturned(dimension, 4))


def moved(bodies, motion):
    d = bodies.positions.shape[1]
    return bodies_at(bodies.positions + motion[:, :d], turned_further(bodies.orientations, motion[:, d:]))


def forces_at(links, bodies, moves: bool = True, again: int = 60) -> np.ndarray:
    """Forces on the blocks when the nodes beside joints have given way."""
    for _ in range(again):
        bodies.forces[:] = 0.0
        PULL[moves](links[0:1], bodies, *LIKE[bodies.positions.shape[1]])
    return bodies.forces.copy()


def shift(dimension: int, size: float) -> np.ndarray:
    motion = np.random.default_rng(3).standard_normal((4, dimension + (1 if dimension == 2 else 3)))
    motion[:, 0] += 3.0 * np.arange(4)  # joints open
    return size * motion


@pytest.mark.parametrize("dimension", [2, 3])
def test_forces_are_slopes_of_the_energy(dimension):
    links, start = crooked(dimension, bond_strength=None)
    bodies = moved(start, shift(dimension, 0.002))
    forces = forces_at(links, bodies)
    assert np.abs(forces.sum(axis=0)[:dimension]).max() < 1e-9 * np.abs(forces).max()
    for i in range(forces.size):
        change = np.zeros_like(forces)
        change.flat[i] = 1e-7
        sides = []
        for sign in (1.0, -1.0):
            forces_at(links, moved(bodies, sign * change))
            sides.append(links[0].energy())
        slope = -(sides[0] - sides[1]) / 2e-7
        assert slope == pytest.approx(forces.flat[i], abs=2e-5 * np.abs(forces).max()), i


@pytest.mark.parametrize("dimension", [2, 3])
def test_springs_are_the_stiffness_of_a_straight_bar(dimension):
    """Condensed stiffness, as masses and frequencies know it, is the slope of the forces."""
    links, start = crooked(dimension)
    springs = links[0].axial()
    n_dof = start.forces.shape[1]
    whole = np.zeros((4 * n_dof, 4 * n_dof))
    for blocks, motion, stiffness in zip(*springs, strict=True):
        row = np.zeros((4, n_dof))
        np.add.at(row, blocks, motion)
        whole += stiffness * np.outer(row, row)
    motion = shift(dimension, 1e-8)
    d = dimension
    small = Placed(start.positions + motion[:, :d], motion[:, d:], start.turns, start.forces)
    forces = forces_at(links, small, moves=False, again=1)
    expected = -(whole @ motion.ravel()).reshape(forces.shape)
    assert forces == pytest.approx(expected, abs=2e-2 * np.abs(forces).max())  # a corner at a joint is cut
    straight_alone = links[0].joints_of(0)
    assert straight_alone == slice(0, 2)


@pytest.mark.parametrize("dimension", [2, 3])
def test_geometry_of_the_start_is_the_limit_of_small_motion(dimension):
    motion, d = shift(dimension, 1e-11), dimension  # small beside kinks, which are short in such hard stone
    (links, start), (others, _) = (crooked(dimension, dowel_stiffness=1e17) for _ in range(2))
    large = forces_at(links, moved(start, motion))
    small = Placed(start.positions + motion[:, :d], motion[:, d:], start.turns, np.zeros_like(start.forces))
    assert forces_at(others, small, moves=False) == pytest.approx(large, abs=1e-4 * np.abs(large).max())


@pytest.mark.parametrize("moves", [False, True])
def test_compiled_is_what_is_written(moves):
    function, results = all_forces([BAR.forces[moves]]), []

    def call(links, bodies, like, like_rotation):
        return function(links, bodies, like, like_rotation)

    for run in (call, PULL[moves]):
        links, start = crooked(2, yield_stress=1e8)
        bodies = moved(start, shift(2, 1e-3))
        lost = [run(links, bodies, *LIKE[2]) for _ in range(2)]
        results.append((lost, bodies.forces, links[0].state))
    for written, compiled in zip(*results, strict=True):
        assert written == pytest.approx(compiled, rel=1e-12)


def test_readings_are_those_of_the_nodes_and_elements():
    bar, bodies = straight()
    opened(bar, bodies, [2e-5])
    force, slip = (
        lambda at, kind=kind: sum(
            weight * bar.state[row, bar.reading(0, kind, at).column]
            for row, weight in zip(bar.reading(0, kind, at).rows, bar.reading(0, kind, at).weights)
        )
        for kind in ("force", "slip")
    )
    assert force(LONG) == bar.forces[0]
    assert force(0.0) == force(1.2) == 0.0
    assert slip(LONG - 1e-9) == pytest.approx(-slip(LONG + 1e-9), rel=1e-6)  # jumps at the joint
    assert bar.length(0) == pytest.approx(1.2)


def test_saved_forces_are_those_of_the_springs():
    bar, bodies = straight()
    opened(bar, bodies, np.linspace(0.0, 3e-4, 20)[1:])
    n = len(bar.slips) + len(bar.crossing)
    elastic = bar.stiffness[:n] * (bar.state[:n, STRETCH] - bar.state[:n, PLASTIC])
    assert bar.state[:n, FORCE] == pytest.approx(elastic, abs=1e-6)


WRONG = {
    "same point": ({"path": [[0.0, 0.0], [0.0, 0.0]]}, "the one before it"),
    "one point": ({"path": [[0.0, 0.0]]}, "at least 2"),
    "end": ({"anchored": ["middle"]}, "start"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_bars(name):
    keys, said = WRONG[name]
    with pytest.raises(ValueError, match=said):
        table_of(Reinforcement).model_validate({"bar": "rebar", "path": [[0.0, 0.0], [1.0, 0.0]], **keys})


def slid(element: float, opening: float, slips, **more) -> np.ndarray:
    """Force along a joint that is open by so much, at each slip of its second block, (n_slips,)."""
    bar, bodies = straight(element=element, **more)
    opened(bar, bodies, np.linspace(0.0, opening, 21)[1:], moves=True)
    found = []
    for slip in slips:
        bodies.positions[1, 1] = slip
        found.append(-forces_at((bar,), bodies)[1, 1])
    return np.array(found)


def test_a_kink_holds_a_joint_that_slides_whatever_the_length_of_elements():
    """Within 2 % of the largest force, up to slips that are as long as the kink."""
    slips = np.linspace(0.0, 0.01, 41)[1:]
    *longer, shortest = (slid(element, 0.0, slips, yield_stress=4e8) for element in (0.04, 0.02, 0.01))
    assert shortest.max() > 2e4
    for found in longer:
        assert np.abs(found - shortest).max() < 0.02 * shortest.max()


@pytest.mark.parametrize("bed", [1e7, 1e8, 1e9])
def test_a_kink_is_that_of_a_string_on_an_elastic_bed(bed):
    """A bar that yields, across a joint that slides by s, little beside Λ = √(H/kd): H s/2Λ."""
    force = 1e8 * 1.13e-4
    spread = math.sqrt(force / bed)
    slips = np.array([0.01, 0.02]) * spread
    found = slid(0.02, 2e-4, slips, yield_stress=1e8, bond_strength=None, dowel_stiffness=bed)
    assert found == pytest.approx(force * slips / (2.0 * spread), rel=0.01)
