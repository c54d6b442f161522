"""Surfaces and marks of rendered scenes: closed, of the right volume, in the right place."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic import DEPTH, HEIGHT, LENGTH, boxes_model, no_contacts, wall_frames, wall_model
from synthetic.solid_runs import drum, solid_frames, solid_wall
from synthetic.spatial import spatial_model

from dem_cli.core.geometry.polyhedron import box
from dem_cli.core.records.frames import STATES
from dem_cli.results.post import frame_measures, view_box
from dem_cli.results.post.scene import joint_strokes
from dem_cli.results.render import marks, solids


def faces_of(surface):
    """Faces as lists of point numbers."""
    found, at = [], 0
    while at < len(surface.faces):
        n = surface.faces[at]
        found.append(surface.faces[at + 1 : at + 1 + n].tolist())
        at += n + 1
    return found


def volume(points, faces):
    """By the divergence theorem, over fans of triangles."""
    total = 0.0
    for face in faces:
        a = points[face[0]]
        total += sum(float(a @ np.cross(points[b], points[c])) for b, c in zip(face[1:], face[2:])) / 6.0
    return total


def test_a_block_is_a_closed_prism_with_chamfers():
    model = boxes_model([(0.0, 0.0, 0.04, 0.02, False)])
    surface = solids.surface(model)
    faces = faces_of(surface)
    edges = [(a, b) for face in faces for a, b in zip(face, np.roll(face, -1).tolist())]
    assert sorted(edges) == sorted((b, a) for a, b in edges)  # each edge has a face on either side, turned outwards
    c = 0.006 * np.hypot(0.04, 0.02)  # the largest chamfer
    whole = 0.04 * 0.02 * (DEPTH - 2 * c)
    at = (np.arange(2000) + 0.5) / 2000 * c  # a chamfer of 45° takes twice its depth from either side
    whole += 2 * float(((0.04 - 2 * at) * (0.02 - 2 * at)).mean() * c)
    assert volume(surface.points, faces) == pytest.approx(whole, rel=1e-6)


def test_a_polyhedron_is_closed_with_chamfers():
    """A cube of side 1 with edges cut by c at 45°: c²/2 is lost along each edge between corners, 5 c³/6 at a corner."""
    model = spatial_model([box((0, 0, 0), (1, 1, 1))], fixed=())
    surface = solids.surface(model)
    faces = faces_of(surface)
    assert sorted(len(face) for face in faces) == [3] * 8 + [4] * 18
    edges = [(a, b) for face in faces for a, b in zip(face, np.roll(face, -1).tolist())]
    assert sorted(edges) == sorted((b, a) for a, b in edges)
    c = 0.006 * np.sqrt(3.0)
    lost = 12 * 0.5 * c**2 * (1.0 - 2.0 * c) + 8 * 5.0 / 6.0 * c**3
    assert volume(surface.points, faces) == pytest.approx(1.0 - lost, rel=1e-12)
    assert len(surface.edges) == 12


def test_pieces_of_one_block_in_space_show_no_joint():
    """Two cubes side by side are one block with the surface of the whole; as two blocks they have a groove."""
    halves = [box((0, 0, 0), (1, 1, 1)), box((1, 0, 0), (2, 1, 1))]
    whole = spatial_model([box((0, 0, 0), (2, 1, 1))], fixed=())
    one, two = spatial_model([halves], fixed=()), spatial_model(halves, fixed=())
    volumes = [volume(surface.points, faces_of(surface)) for surface in map(solids.surface, (whole, one))]
    assert len(solids.surface(two).edges) == 24
    assert len(solids.surface(one).edges) == 16  # 12 of the whole, four of them in two pieces
    assert volumes[1] == pytest.approx(volumes[0], rel=1e-3)  # faces at the seam are open by the chamfer's profile


def test_solids_of_any_kind_are_closed():
    surface = solids.surface(drum(7))
    faces = faces_of(surface)
    edges = [(a, b) for face in faces for a, b in zip(face, np.roll(face, -1).tolist())]
    assert sorted(edges) == sorted((b, a) for a, b in edges)


def test_joints_in_space_run_around_their_face():
    model = solid_wall(2, 2)
    frame = solid_frames(model, 4)[3]
    found = marks.stripes(model, frame, 1.0, 1e-3)
    boxes = found.points.reshape(-1, 8, 3)
    strokes = joint_strokes.strokes(frame.contacts)
    assert boxes.mean(axis=1) == pytest.approx(0.5 * (strokes.starts + strokes.ends))
    assert len(found.states) == 6 * len(boxes)


def test_every_block_turns_about_its_own_centroid():
    model = wall_model()
    surface = solids.surface(model)
    positions, angles = model.centroids + np.array((0.3, -0.2)), np.full((model.n_blocks, 1), 0.5)
    points = solids.placed(surface, solids.pose(positions, angles))
    rotation = np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    expected = positions[surface.owners] + surface.points[:, :2] @ rotation.T
    assert points[:, :2] == pytest.approx(expected)
    assert np.abs(points[:, 2]).max() == pytest.approx(DEPTH / 2)


@pytest.mark.parametrize("distances", [[0.1, 0.1, 0.1, 0.1], [0.1, 0.0, 0.2, 0.0]])
def test_edges_move_inwards_by_their_own_distance(distances):
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    low, right, top, left = distances
    expected = [(left, low), (1 - right, low), (1 - right, 1 - top), (left, 1 - top)]
    assert solids.inset(square, np.array(distances)) == pytest.approx(np.array(expected))


def test_a_corner_on_a_straight_side_moves_inwards_too():
    polygon = np.array([(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    assert solids.inset(polygon, np.full(5, 0.1))[1] == pytest.approx((0.5, 0.1))


def test_parts_of_one_block_show_no_joint():
    model = boxes_model([(0.0, 0.0, 1.0, 1.0, False), (1.0, 0.0, 1.0, 1.0, False)])
    left, right = model.vertices[:4], model.vertices[4:]
    concave = model._replace(
        block_ids=("L",), part_blocks=np.zeros(2, dtype=np.int64), centroids=np.array([[1.0, 0.5]]),
        vertices=np.concatenate([left - np.array((0.5, 0.0)), right + np.array((0.5, 0.0))]),
    )  # fmt: skip
    assert solids.inner_edges(concave, 0).tolist() == [False, True, False, False]
    assert solids.inner_edges(concave, 1).tolist() == [False, False, False, True]
    assert not solids.inner_edges(model, 0).any()


def test_joints_lie_on_their_contact_points():
    model = wall_model()
    frame = wall_frames(model, 6)[3]
    found = marks.stripes(model, frame, 1.0, 1e-3)
    boxes = found.points.reshape(-1, 8, 3)
    assert len(boxes) == len(frame.contacts.joint)
    middles = joint_strokes.middles(frame.contacts)
    assert boxes.mean(axis=1)[:, :2] == pytest.approx(0.5 * (frame.contacts.points + middles))
    assert np.abs(boxes[..., 2]).min() > DEPTH / 2  # stands out of the stones
    assert (found.states[::6] == frame.contacts.state).all()
    assert not found.faint[found.states != STATES.index("open")].any()


def test_bars_are_as_thick_as_forces_are_large():
    model = wall_model()
    frame = wall_frames(model, 6)[2]
    resultants = frame_measures.resultants(frame.contacts)
    sizes = np.linalg.norm(resultants.forces, axis=1)
    found = marks.forces(model, frame, "bars", 0.02)
    assert found.largest == pytest.approx(sizes.max())
    kept = sizes > 0.01 * sizes.max()
    expected = np.maximum(sizes[kept] / sizes.max(), 0.06)
    assert found.radii[::2] / found.radii.max() == pytest.approx(expected)


def test_arrows_point_downwards_at_the_joint():
    model = wall_model()
    frame = wall_frames(model, 6)[2]
    found = marks.forces(model, frame, "arrows", 0.02)
    arrows = found.points.reshape(-1, 4, 3)
    tips, tails = arrows[:, 3], arrows[:, 0]
    assert (tips[:, 1] < tails[:, 1]).all()
    lengths = np.linalg.norm(tips - tails, axis=1)
    assert lengths.max() == pytest.approx(0.02)
    centres = frame_measures.resultants(frame.contacts).points
    assert min(np.linalg.norm(centres - tips[0, :2], axis=1)) < 1e-9


def test_without_contacts_there_are_no_forces():
    frame = wall_frames(wall_model(), 4)[0]._replace(contacts=no_contacts())
    assert marks.forces(wall_model(), frame, "bars", 0.02) is None
    assert len(marks.stripes(wall_model(), frame, 1.0, 1e-3).points) == 0


def test_what_fell_far_away_is_not_in_the_picture():
    model = wall_model()
    start = view_box.corners(model, wall_frames(model, 4)[0], 1.0)
    low, high = view_box.window(model, [start], 0.0)
    fallen = start.copy()
    fallen[-4:] -= (0.0, 5.0)
    assert view_box.window(model, [fallen], 0.0)[0] == pytest.approx(low)
    beside = start.copy()
    beside[-4:] += (0.5 * LENGTH, 0.0)
    wider = view_box.window(model, [beside], 0.0)[1]
    assert wider[0] == pytest.approx(max(high[0], 3.5 * LENGTH), abs=HEIGHT)
