"""The contract of a narrow phase, and the keys by which points are known again."""

from __future__ import annotations

import inspect

import numpy as np
import pytest
from engine import block, rectangle, running_wall, simulation, tables

from dem_cli.core.contact.geometry import GEOMETRY, NarrowPhase
from dem_cli.core.contact.keys import same_rows


@pytest.mark.parametrize("dimension", GEOMETRY)
def test_every_narrow_phase_keeps_the_contract(dimension):
    """The functions of the contract with its arguments, in its order."""
    promised = {name: f for name, f in vars(NarrowPhase).items() if inspect.isfunction(f) and name[0] != "_"}
    assert {"find", "points", "place"} <= promised.keys()
    for name, function in promised.items():
        kept = inspect.signature(getattr(GEOMETRY[dimension], name)).parameters
        assert list(kept) == list(inspect.signature(function).parameters)[1:], name


def test_find_points_place():
    """A block on a base: one pair of faces, two points, gaps of nothing."""
    sim = simulation(
        tables(block("base", rectangle(-1, -1, 2, 0), fixed=True), block("b", rectangle(0, 0, 1, 1))), "large"
    )
    narrow = GEOMETRY[2]
    faces = narrow.find(sim.model, sim.bodies.corners, 0.01)
    assert len(faces.parts) == 1
    joints, geometry = narrow.points(sim.model, faces, sim.bodies.corners, sim.properties)
    assert joints.starts.tolist() == [0, 2]
    assert geometry.features.tolist() == [0, 1]
    assert not joints.frames.any()
    narrow.place(joints, geometry, sim.contacts, sim.bodies)
    assert np.abs(joints.frames[:, :2]) == pytest.approx(np.array([[0.0, 1.0], [0.0, 1.0]]))
    assert sorted(joints.points[:, 0] + sim.origin[0]) == pytest.approx([0.0, 1.0])
    assert sim.contacts.gaps == pytest.approx(0.0, abs=1e-12)


def test_edges_of_a_pair_are_the_ends_of_its_faces():
    sim = simulation(tables(*running_wall(3, 3)), "large")
    ends = sim.model.topology.ends
    assert np.array_equal(sim.geometry.edges, ends[sim.geometry.keys].reshape(-1, 4))


def test_no_two_points_have_one_key():
    sim = simulation(tables(*running_wall(3, 3)), "large")
    keys = np.column_stack([sim.geometry.keys[sim.joints.owners], sim.geometry.features])
    assert len(np.unique(keys, axis=0)) == len(keys) == len(sim.joints.kn)


def test_rows_known_again():
    rng = np.random.default_rng(2)
    old = np.unique(rng.integers(0, 50, (200, 3)), axis=0)
    order = rng.permutation(len(old))
    assert np.array_equal(same_rows(old[order], old)[order], np.arange(len(old)))
    assert same_rows(old, np.array([[50, 0, 0], [0, 51, 0]])).tolist() == [-1, -1]
    assert same_rows(np.zeros((0, 2), int), np.array([[1, 2]])).tolist() == [-1]
    assert same_rows(np.array([[1, 2]]), np.zeros((0, 2), int)).tolist() == []
    assert same_rows(np.array([[3, 4], [1, 2], [1, 2]]), np.array([[1, 2], [3, 4], [2, 1]])).tolist() == [1, 0, -1]
