"""Faces of one part that are nearly in one plane, and edges on faces: what of them is a joint, its area, its bond."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic.skins import model_of, open_area
from synthetic.spatial_case import spatial_case
from synthetic.spatial_joints import KN, one_joint, start_joints

from dem_cli.core.contact import spatial
from dem_cli.core.contact.assemble import build_joints
from dem_cli.core.contact.between import StartJoints
from dem_cli.core.contact.detect import block_shape, world_corners
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.geometry.rotation import turns_of
from dem_cli.core.kernels.records import FACES
from dem_cli.core.limit.analysis import start_structure
from dem_cli.core.limit.cone import envelope_of
from dem_cli.core.model.scales import smallest_edge
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.solver_request import solver_request
from dem_cli.masonry.assembly.validate import warnings

LENGTH, HEIGHT, THICKNESS = 3.0, 1.6, 0.5
COURSED = {
    "kind": "coursed-wall", "size": [LENGTH, HEIGHT], "thickness": THICKNESS, "spacing": [0.4, 0.05],
    "segment": [0.8, 0.3], "head_spacing": [0.6, 0.2], "head_angle_deg": [0.0, 6.0], "base": False,
}  # fmt: skip
BOND = {"law": "mohr-coulomb", "friction": 0.6, "cohesion": 1e5, "tension": 5e4}


def prism(name, *polygons, **more):
    parts = [[[x, y, z] for y in (-0.5, 0.5) for x, z in polygon] for polygon in polygons]
    return {"id": name, "material": "peperino", "parts": parts, **more}


def drawn(*blocks, **tables):
    case = spatial_case(block=list(blocks), **tables)
    return case, assembly(case).model


@pytest.mark.parametrize("kink", [1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("seed", [37, 39])
def test_beds_with_any_kink_are_joints_all_over(kink, seed):
    """Of kinks flatter than 4e-5 the side was taken that came first: up to 40 % of a joint, or all of it, was lost."""
    model = model_of(COURSED | {"deviation": [0.0, kink], "seed": seed})
    around = 2.0 * LENGTH * HEIGHT + 2.0 * (LENGTH + HEIGHT) * THICKNESS
    assert open_area(model) == pytest.approx(around, rel=1e-8)


def on_a_kink(kink):
    """A compound on both sides of the ridge of a block."""
    below = [[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0 - kink], [0.0, 1.0], [-1.0, 1.0 - kink]]
    halves = [[0.0, 1.0], [0.6, 1.0 - 0.6 * kink], [0.6, 2.0], [0.0, 2.0]], [
        [-0.8, 1.0 - 0.8 * kink], [0.0, 1.0], [0.0, 2.0], [-0.8, 2.0],
    ]  # fmt: skip
    return drawn(prism("below", below, fixed=True), prism("above", *halves))[1]


@pytest.mark.parametrize("kink", [0.1, 1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("turn", [-1e-4, -1e-6, 0.0, 1e-6, 1e-4])
def test_halves_of_a_stone_on_a_kink_keep_their_faces_when_it_turns(kink, turn):
    """Turned by more than the kink, a half has a face that is nearer to the one on the other side."""
    model = on_a_kink(kink)
    bodies = bodies_at_rest(model, moves=True)
    bodies.orientations[1] = np.array([1.0, 0.0, 0.5 * turn, 0.0]) / np.hypot(1.0, 0.5 * turn)
    bodies.turns[:] = turns_of(bodies.orientations)
    bodies.corners[:] = world_corners(block_shape(model), bodies.positions, bodies.orientations)
    built = build_joints(model, spatial.find(model, bodies.corners, 1e-3), bodies, one_joint(), 0)
    assert (built.geometry.kinds == FACES).all()
    areas = np.bincount(built.joints.owners, built.joints.kn) / KN
    assert np.sort(areas) == pytest.approx([0.6, 0.8], rel=1e-2)


def test_a_joint_on_one_side_of_a_kink_only_says_so():
    """Two convex parts have one joint; 1.3 m² touch, within round-off."""
    below = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0 - 1e-8], [1.0, 1.0], [0.0, 1.0]]
    above = [[0.3, 1.0], [1.6, 1.0], [1.6, 2.0], [0.3, 2.0]]
    drawings = {"D": below, "P": above}
    prisms = [{"id": name, "material": "peperino", "polygon": outline, "y": [-0.5, 0.5], "fixed": name == "D"}
              for name, outline in drawings.items()]  # fmt: skip
    model = drawn(*prisms)[1]
    assert start_joints(model).joints.kn.sum() / KN == pytest.approx(0.7)
    (said,) = warnings(model)
    assert "'D' and 'P' touch on both sides of a kink that is almost flat" in said
    assert "short of 0.6 m²" in said
    assert warnings(on_a_kink(1e-3)) == warnings(on_a_kink(1e-7)) == []


def test_an_edge_between_the_parts_of_a_block_is_no_joint_of_its_own():
    """The part over the next face of a ridge meets this one with an edge, where its sibling lies on it."""
    below = [[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [-1.0, 0.8]]
    left = [[-0.8, 0.84], [-0.2, 0.96], [-0.2, 2.0], [-0.8, 2.0]]
    right = [[-0.2, 0.96], [0.4, 1.2], [0.4, 2.0], [-0.2, 2.0]]
    model = drawn(prism("below", below, fixed=True), prism("above", left, right))[1]
    faces = StartJoints(model).faces
    assert faces.areas == pytest.approx([np.hypot(0.6, 0.12)])
    assert start_joints(model).joints.kn.sum() / KN == pytest.approx(np.hypot(0.6, 0.12))


@pytest.mark.parametrize("lean", [0.0, 0.3])
def test_only_faces_that_lie_on_each_other_are_bonded(lean):
    """An edge on a face had the bond of half of the face over it."""
    ground = [[-2.0, -1.0], [2.0, -1.0], [2.0, 0.0], [-2.0, 0.0]]
    stone = [[0.0, 0.0], [1.0, lean], [1.0, 1.0], [0.0, 1.0]]
    joints = {"dry": BOND | {"kn": 1e9, "ks": 1e9}}
    case, model = drawn(prism("ground", ground, fixed=True), prism("stone", stone), joints=joints)
    properties, law = joint_properties(solver_request(case), model), law_of(solver_request(case))
    structure = start_structure(model, properties, law)
    found = envelope_of(structure.joints, law, bonds=structure.bonds)
    built = joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model), law.n_memory(3))
    touching = built.contacts.gaps <= 0.0
    intact = (built.contacts.memory[touching, : len(law.intact)] == law.intact).all(axis=1)
    if lean:
        assert not found.cohesion.any()
        assert not found.tension.any()
        assert not intact.any()
        assert (found.friction > 0.0).all()
    else:
        assert found.cohesion.sum() == pytest.approx(1e5)
        assert found.tension.sum() == pytest.approx(5e4)
        assert intact.all()
