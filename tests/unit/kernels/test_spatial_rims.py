"""Contact in space as blocks pass each other: forces and moments without jumps, no work round closed loops.

Two cubes of 1 m, without friction, the upper one put where the test wants it. Points are renewed at each place, so that
what is seen is that of the scheme and not of its intervals. Energy of a closed loop: three-dimensional block contact
with normals of its own features takes none on a face; bisector normals gained 0.42 of the elastic energy there.
"""

from __future__ import annotations

import numpy as np
import pytest
from engine import simulation, steps
from scipy.spatial.transform import Rotation

from dem_cli.core.engine.placement import moves
from dem_cli.core.geometry.rotation import quaternions

DEEP = 1e-4  # m that the upper block is pressed into the lower one
UP = np.array([0.0, 0.0, 1.0])


def turn(*vector: float) -> Rotation:
    return Rotation.from_rotvec(vector)


class Pair:
    """A block on another one; `at` puts it somewhere and says what pushes it there."""

    def __init__(self, lower: float = 1.0, points: int | None = None):
        half = 0.5 * lower
        joint = {"friction": 1e-9, "kn": 1e9, "ks": 1e9} | ({} if points is None else {"points": points})
        blocks = [
            {
                "id": "low",
                "fixed": True,
                "polygon": [[-half, -1], [half, -1], [half, 0], [-half, 0]],
                "y": [-half, half],
            },
            {"id": "top", "polygon": [[-0.5, 0], [0.5, 0], [0.5, 1], [-0.5, 1]], "y": [-0.5, 0.5]},
        ]
        case = {
            "dimension": 3, "materials": {"stone": {"density": 2000.0}}, "block": blocks,
            "joints": {"dry": joint}, "analysis": {"kind": "gravity"},
        }  # fmt: skip
        self.sim = simulation(case, "large")
        self.sim.loads.inverse_masses[:] = 0.0
        self.centre = self.sim.bodies.positions[1] + [0.0, 0.0, -0.5]  # of the foot

    def at(self, shift: np.ndarray, turned: Rotation) -> tuple[np.ndarray, np.ndarray, float]:
        """Force and moment about the centre of the foot [N, N m], elastic energy [J], with the foot there."""
        sim, arm = self.sim, turned.apply([0.0, 0.0, 0.5])
        sim.bodies.positions[1] = self.centre + shift + arm
        sim.bodies.orientations[1] = quaternions(turned.as_rotvec()[None])[0]
        moves.find_faces(sim)
        sim.bodies.velocities[:] = 0.0
        steps(sim, 1)
        force = sim.bodies.forces[1].copy()
        return force[:3], force[3:] + np.cross(arm, force[:3]), sim.elastic_energy()


def largest_jumps(places: list[tuple[np.ndarray, Rotation]], pair: Pair) -> np.ndarray:
    """Of normal force, of shear force, of the moment [m], beyond the slope, over the mean normal force."""
    found = np.array([np.concatenate(pair.at(*place)[:2]) for place in places])
    bends = np.abs(found[2:] - 2.0 * found[1:-1] + found[:-2]).max(axis=0) / found[:, 2].mean()
    return np.array([bends[2], bends[:2].max(), bends[3:].max()])


def work_round(places: list[tuple[np.ndarray, Rotation]], pair: Pair) -> tuple[float, float]:
    """Work of the contact forces round a closed loop, and the largest elastic energy on it [J]."""
    at = [pair.at(*place) for place in [*places, places[0]]]
    work = 0.0
    for k, (shift, turned) in enumerate(places):
        next_shift, next_turned = places[(k + 1) % len(places)]
        spin = (next_turned * turned.inv()).as_rotvec()
        work += 0.5 * (at[k][0] + at[k + 1][0]) @ (next_shift - shift) + 0.5 * (at[k][1] + at[k + 1][1]) @ spin
    return float(work), max(energy for _, _, energy in at)


@pytest.mark.parametrize(
    "way",
    [
        lambda x: ((0.0, 0.0), x),  # yaws through zero, edges on edges
        lambda x: ((x, 0.0), 1e-3),  # slides through alignment
        lambda x: ((x, 0.7 * x), 1e-3),
        lambda x: ((x, 0.0), 0.0),
    ],
    ids=["yaw", "slide, turned", "slide askew", "slide"],
)
def test_nothing_jumps_through_alignment(way):
    """2e-6 of an edge or rad at a time; moments jumped by 3e-3 N·L where areas are triangles alone."""
    places = []
    for x in np.arange(-2e-4, 2e-4, 2e-6):
        (along, across), yaw = way(x)
        places.append((np.array([along, across, -DEEP]), turn(5e-5, 3e-5, yaw)))
    normal, shear, moment = largest_jumps(places, Pair())
    assert normal < 5e-6
    assert shear < 1e-9
    assert moment < 1e-6


@pytest.mark.parametrize(("points", "most"), [(3, 1.5e-4), (None, 3e-4)])
def test_a_tilted_block_passes_a_rim_without_a_jump(points, most):
    """A sixteenth of the step, far less of the bend: a kink where the pressed edge leaves the other block.

    Integrated pressure is that of the 4 mm that press, so that it has left the other block within so much.
    """
    tilt, found = 0.05, []
    start = np.array([0.5 - 0.5 * np.cos(tilt), 0.0, 0.5 * np.sin(tilt) - DEEP])
    for step in (4e-6, 2.5e-7):
        near = np.arange(-80, 81) * step
        places = [(start + np.array([x, 0.0, 0.0]), turn(0.0, tilt, 0.0)) for x in near]
        found.append(largest_jumps(places, Pair(points=points)))
    assert (found[1] < found[0] / 4.0).all()
    assert found[1].max() < most


def circle(radius: float, n: int) -> np.ndarray:
    angles = 2.0 * np.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])


def test_no_work_round_a_loop_on_a_base():
    """The foot slides and turns flat on a wide base, then on one of its edges, tilted by 0.1 rad."""
    pair = Pair(lower=6.0)
    yaws = 0.5 * np.sin(2.0 * np.pi * np.arange(40) / 40)
    flat = [(at - DEEP * UP, turn(0.0, 0.0, yaw)) for at, yaw in zip(circle(0.5, 40), yaws)]
    work, elastic = work_round(flat, pair)
    assert abs(work) < 1e-12 * elastic
    up = 0.5 * np.sin(0.1) - DEEP
    leaning = [(at + up * UP, turn(0.0, 0.0, yaw) * turn(0.0, 0.1, 0.0)) for at, yaw in zip(circle(0.5, 40), yaws)]
    work, elastic = work_round(leaning, pair)
    assert abs(work) < 1e-6 * elastic
