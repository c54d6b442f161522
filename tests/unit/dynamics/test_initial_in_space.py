"""[[initial]] in space: blocks tilt about the edge or the corner on which they then stand, as in the plane."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, tables

from dem_cli.core.dynamics.initial_state import set_initial
from dem_cli.core.engine.dynamic import DynamicSimulation
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.viscous import Damping
from dem_cli.core.geometry.rotation import angles_of, matrices, rotation_vectors
from dem_cli.errors import CaseError

LOWER, UPPER = 1, 2
SHAKEN = {"kind": "time-history", "duration": 1.0}
SIDES = ((-0.5, 0.5), (-0.4, 0.4))


def box(name: str, x, y, z, **more) -> dict:
    return {"id": name, "vertices": [[a, b, c] for a in x for b in y for c in z], **more}


def column(*initial: dict) -> tuple[DynamicSimulation, np.ndarray]:
    """Two blocks on a base, 1 × 0.8 × 1 m each, with their initial state; and where corners were before [m]."""
    base = box("base", (-3.0, 3.0), (-3.0, 3.0), (-1.0, 0.0), fixed=True)
    blocks = [box("lower", *SIDES, (0.0, 1.0)), box("upper", *SIDES, (1.0, 2.0))]
    return started(tables(base, *blocks, dimension=3, analysis=SHAKEN, initial=list(initial)))


def started(case: dict) -> tuple[DynamicSimulation, np.ndarray]:
    made = scene(case)
    sim = DynamicSimulation(
        made.model,
        law_of(made.request),
        joint_properties(made.request, made.model, 1e5),
        Damping(),
    )
    sim.begin(1e-4)
    before = sim.bodies.corners + sim.origin
    set_initial(made.request.initial, sim)
    return sim, before


def corners(sim: DynamicSimulation, number: int) -> np.ndarray:
    return (sim.bodies.corners + sim.origin)[sim.shape.corner_blocks == number]


def test_blocks_tilt_as_one_towards_the_left():
    """About the left edge of the lower one: that edge stays, all else is where one rotation takes it."""
    sim, before = column({"blocks": ["lower", "upper"], "tilt": 0.1})
    turn = matrices(np.array([[0.0, -0.1, 0.0]]))[0]
    edge = np.array([-0.5, 0.0, 0.0])
    for number in (LOWER, UPPER):
        was = before[sim.shape.corner_blocks == number]
        assert corners(sim, number) == pytest.approx(edge + (was - edge) @ turn.T, abs=1e-12)
    assert np.sort(corners(sim, LOWER)[:, 2])[:2] == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(
    ("axis", "corner"), [([3.0, -4.0, 0.0], [-0.5, -0.4, 0.0]), ([-3.0, 4.0, 0.0], [0.5, 0.4, 0.0])]
)
def test_about_an_oblique_axis_they_stand_on_a_corner(axis, corner):
    """The corner that is farthest to the side of the tilt stays on the base, all others are above it."""
    sim, _ = column({"blocks": ["lower", "upper"], "tilt": 0.1, "axis": axis})
    low = corners(sim, LOWER)
    lowest = low[:, 2].argmin()
    assert low[lowest] == pytest.approx(corner, abs=1e-12)
    assert np.sort(low[:, 2])[1] > 0.02
    assert rotation_vectors(sim.bodies.orientations)[LOWER] == pytest.approx(0.02 * np.array(axis), rel=1e-12)
    assert angles_of(sim.bodies.orientations)[UPPER] == pytest.approx(0.1, rel=1e-12)


def test_it_is_what_it_is_in_the_plane():
    """The planar twin of a tilt, a shift and a velocity: corners and velocities along x and z."""
    motion = {"block": "upper", "tilt": -0.15, "displacement": [0.1, 0.02], "velocity": [0.3, 0.1, 0.5]}
    boxes = [block("base", rectangle(-3, -1, 3, 0), fixed=True)]
    boxes += [block("lower", rectangle(-0.5, 0, 0.5, 1)), block("upper", rectangle(-0.5, 1, 0.5, 2))]
    flat, _ = started(tables(*boxes, analysis=SHAKEN, initial=[motion]))
    twin = {**motion, "displacement": [0.1, 0.0, 0.02], "velocity": [0.3, 0.0, 0.1, 0.0, -0.5, 0.0]}
    sim, _ = column(twin)
    assert sim.bodies.positions[UPPER, [0, 2]] + sim.origin[[0, 2]] == pytest.approx(
        flat.bodies.positions[UPPER] + flat.origin, abs=1e-12
    )
    assert rotation_vectors(sim.bodies.orientations)[UPPER, 1] == pytest.approx(-flat.bodies.orientations[UPPER, 0])
    assert sim.bodies.velocities[UPPER] == pytest.approx([0.3, 0.0, 0.1, 0.0, -0.5, 0.0])
    assert np.unique(corners(sim, UPPER)[:, [0, 2]].round(12), axis=0) == pytest.approx(
        np.unique(corners(flat, UPPER).round(12), axis=0), abs=1e-11
    )


def test_blocks_do_not_start_inside_each_other():
    with pytest.raises(CaseError, match=r"puts blocks 'lower' and 'upper' 0\.1 m into each other"):
        column({"block": "upper", "displacement": [0.2, 0.1, -0.1]})
