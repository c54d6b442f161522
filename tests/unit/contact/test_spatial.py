"""Contact in space: random pairs against a linear program and shapely, a wall and its planar twin, lone contacts."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from oracle.shapes import arch, rectangle, running_wall
from scipy.optimize import linprog
from synthetic.spatial import extruded, spatial_model
from synthetic.spatial_joints import KN, KS, near_pairs, one_joint, shifted, start_joints, turned

from dem_cli.core.contact import near_boxes, spatial
from dem_cli.core.contact.compatibility import compatibility
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.polyhedron import Polyhedron, box, hull, prism
from dem_cli.core.geometry.rotation import matrices, moments
from dem_cli.core.kernels.records import EDGES, FACES, RIM_OF_A, RIM_OF_B
from dem_cli.core.kernels.spatial_geometry import AREA, CENTRE, POLAR
from dem_cli.core.model.bodies import bodies_of
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed
from dem_cli.core.model.scales import smallest_edge


def corners_of(model, block: int) -> np.ndarray:
    return undeformed(model)[model.vertex_blocks == block]


def share_a_point(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two hulls have a point in common: a linear program over the weights of their corners."""
    equal, near = np.zeros((5, len(a) + len(b))), a.mean(axis=0)  # far from the origin its tolerance would be wide
    equal[:3, : len(a)], equal[:3, len(a) :] = (a - near).T, (near - b).T
    equal[3, : len(a)] = equal[4, len(a) :] = 1.0
    return linprog(np.zeros(equal.shape[1]), A_eq=equal, b_eq=[0, 0, 0, 1, 1], method="highs").status == 0


@pytest.fixture(scope="module")
def pairs():
    """300 pairs of hulls and boxes, and what was found of them."""
    model = spatial_model(near_pairs(300, np.random.default_rng(7)), fixed=())
    corners = undeformed(model)
    faces = spatial.find(model, corners, 0.0)
    return model, faces, spatial.meetings(model, faces, corners)


def test_random_pairs_touch_where_a_linear_program_says_so(pairs):
    model, faces, _ = pairs
    found = {tuple(pair) for pair in faces.parts.tolist()}
    assert 100 < len(found) < 250
    for i in range(0, 600, 4):
        assert ((i, i + 1) in found) == share_a_point(corners_of(model, i), corners_of(model, i + 1)), i


def test_random_pairs_give_sound_points(pairs):
    model, faces, met = pairs
    assert set(met.kinds.tolist()) == {FACES, RIM_OF_A, RIM_OF_B, EDGES}
    for field in met:
        assert np.isfinite(field).all()
    assert (met.weights > 0.0).all()
    frames = met.frames.reshape(-1, 3, 3)
    assert np.abs(frames @ frames.swapaxes(1, 2) - np.eye(3)).max() < 1e-14
    assert np.cross(frames[:, 0], frames[:, 1]) == pytest.approx(frames[:, 2], abs=1e-14)  # t2 = n × t1
    sizes = model.parts.sizes[faces.parts].min(axis=1)
    flat = ((met.places - met.places[met.starts[:-1]][met.owners]) * met.frames[met.owners, :3]).sum(axis=1)
    assert (np.abs(flat) < 1e-14 * 1e4 * sizes[met.owners]).all()  # points lie in one plane; places are up to 3,000 m


def test_the_normal_points_from_a_to_b(pairs):
    """Moved along it by the separation, b comes free of a."""
    model, faces, met = pairs
    for i in range(0, len(faces.parts), 3):
        a, b = faces.parts[i]
        deep = -min(met.gaps[met.starts[i] : met.starts[i + 1]].min(), faces.separation[i])
        away = met.frames[i, :3] * (1.5 * deep + 0.02)
        assert not share_a_point(corners_of(model, a), corners_of(model, b) + away), i


def test_forces_on_both_blocks_are_equal_and_opposite():
    """Of any forces at the points: no resultant, and no moment about the origin, to round-off."""
    random = np.random.default_rng(8)
    blocks = [shifted(block, [-10.0 * (i // 2), 0.0, 0.0]) for i, block in enumerate(near_pairs(60, random))]
    for a, b in zip(blocks[::2], blocks[1::2], strict=True):
        model = spatial_model([a, b], fixed=())
        found = spatial.find(model, undeformed(model), 0.0)
        if not len(found.parts):
            continue
        built = start_joints(model)
        if not len(built.joints.kn):
            continue
        forces = random.normal(size=built.joints.frames.shape[0] * 3)
        on_blocks = (compatibility(model, built.joints).T @ forces).reshape(2, 6)
        turning = on_blocks[:, 3:] + moments(model.centroids, on_blocks[:, :3])
        assert np.abs(on_blocks[:, :3].sum(axis=0)).max() < 1e-12
        assert np.abs(turning.sum(axis=0)).max() < 1e-12


def outline(random: np.random.Generator) -> np.ndarray:
    """A convex polygon of 3 to 9 corners on an ellipse."""
    n = random.integers(3, 10)
    angles = np.sort((np.arange(n) + random.uniform(0.0, 0.8, n)) * 2.0 * np.pi / n)
    return np.column_stack([np.cos(angles), np.sin(angles)]) * random.uniform(0.3, 1.0, 2)


def test_areas_of_overlaps_are_those_of_shapely():
    """Equal, shifted and disjoint faces: area, centroid, polar moment of the overlap; the shares add up."""
    random = np.random.default_rng(9)
    blocks, flats = [], []
    for i in range(300):
        one, two = outline(random), outline(random)
        two = one if i % 5 == 0 else two + random.uniform(-1.0, 1.0, 2)
        two = two + ([0.3, 0.1] if i % 10 == 5 else [0.0, 0.0])
        flats.append((shapely.Polygon(one), shapely.Polygon(two)))
        blocks += [shifted(solid, [10.0 * i, 0.0, 0.0]) for solid in (prism(one, -1.0, 0.0), prism(two, 0.0, 1.0))]
    model = spatial_model(blocks, fixed=())
    corners = undeformed(model)
    met = spatial.meetings(model, spatial.find(model, corners, 1e-6), corners)
    parts = spatial.find(model, corners, 1e-6).parts[:, 0] // 2
    n_faces = 0
    for j, i in enumerate(parts):
        shared = flats[i][0].intersection(flats[i][1])
        size = np.sqrt(min(flats[i][0].area, flats[i][1].area))
        if met.kinds[j] != FACES:
            assert shared.area < 1e-6 * size**2
            continue
        n_faces += 1
        at = slice(met.starts[j], met.starts[j + 1])
        weights, places = met.weights[at], met.places[at][:, [0, 2]] - [10.0 * i, 0.0]
        centroid = np.array([shared.centroid.x, shared.centroid.y])
        assert met.measures[j, AREA] == pytest.approx(shared.area, abs=1e-12 * size**2)
        assert weights.sum() == pytest.approx(shared.area, abs=1e-12 * size**2)
        assert weights @ places == pytest.approx(shared.area * centroid, abs=1e-11 * size**3)
        assert met.measures[j, [CENTRE, CENTRE + 2]] - [10.0 * i, 0.0] == pytest.approx(centroid, abs=1e-10)
        exact = polygon.polar_moment(np.array(shared.exterior.coords)[:-1])
        assert met.measures[j, POLAR] == pytest.approx(exact, abs=1e-12)
    assert n_faces > 150


def test_corners_that_almost_coincide_are_one_and_keep_area_and_first_moment():
    """A face moved and turned by less than a millionth: four points, none with next to no area."""
    shift = np.array([3e-8, 2e-8, 0.0])
    model = spatial_model([box([0, 0, 0], [2, 1, 1]), shifted(box([0, 0, 1], [2, 1, 2]), shift)])
    built = start_joints(model)
    assert len(built.joints.kn) == 4
    areas, exact = built.joints.kn / KN, (2.0 - shift[0]) * (1.0 - shift[1])
    assert areas.sum() == pytest.approx(exact, rel=1e-14)
    first = areas @ built.joints.points
    assert first == pytest.approx(exact * (np.array([1.0, 0.5, 1.0]) + 0.5 * shift), rel=1e-13)
    assert areas == pytest.approx(0.5, rel=1e-6)


def test_a_wall_in_bond_is_its_planar_twin():
    """21 blocks: the same joints in the same order, two points for each one of the plane, each with half of it."""
    polygons, fixed = running_wall(3, 6)
    depth, n = 0.1, len(polygons)
    solid = spatial_model(extruded(polygons, depth), np.flatnonzero(fixed))
    flat = Model(
        **bodies_of(2, [[each] for each in polygons], np.full(n, 2000.0), np.full(n, depth))._asdict(),
        block_ids=solid.block_ids, material_names=("stone",), block_material=solid.block_material, fixed=solid.fixed,
        thickness=np.full(n, depth), dead_loads=np.zeros((n, 3)), live_loads=np.zeros((n, 3)),
    )  # fmt: skip
    plane = joints_of_start(flat, bodies_at_rest(flat), one_joint(), smallest_edge(flat))
    space = start_joints(solid)
    assert int((~solid.fixed).sum()) == 21
    assert np.array_equal(plane.joints.blocks, space.joints.blocks)
    assert len(space.joints.kn) == 2 * len(plane.joints.kn)
    assert space.joints.frames[:, [0, 2]] == pytest.approx(np.repeat(plane.joints.frames[:, :2], 2, axis=0), abs=1e-14)
    for j in range(len(plane.joints.blocks)):
        here = np.flatnonzero(space.joints.owners == j)
        for point in np.flatnonzero(plane.joints.owners == j):
            away = np.abs(space.joints.points[here][:, [0, 2]] - plane.joints.points[point]).max(axis=1)
            same = here[away < 1e-14]
            assert sorted(space.joints.points[same, 1]) == pytest.approx([0.0, depth], abs=1e-15)
            assert space.joints.kn[same] == pytest.approx(0.5 * plane.joints.kn[point], rel=1e-12)
            assert space.joints.ks[same] == pytest.approx(0.5 * plane.joints.ks[point], rel=1e-12)


def test_faces_of_a_cube_on_a_cube_do_not_alternate():
    """Whatever round-off adds: the same two faces, the same first tangent, four points."""
    random, cube = np.random.default_rng(3), box([0, 0, 0], [1, 1, 1])
    found = set()
    for _ in range(40):
        other = turned(shifted(box([0, 0, 1], [1, 1, 2]), random.normal(size=3) * 1e-12), random, 1e-13)
        built = start_joints(spatial_model([cube, other]))
        found.add((*built.geometry.keys[0], len(built.joints.kn), *built.joints.frames[0, :6].round(9) + 0.0))
    assert len(found) == 1
    assert next(iter(found))[2] == 4


def test_pairs_do_not_depend_on_the_order_of_the_blocks_nor_on_the_grid():
    random = np.random.default_rng(4)
    polygons, _ = running_wall(6, 6, 1.0, 0.5)
    blocks = [
        *extruded(polygons, 0.4),
        box([-1.0, -3.0, -1.2], [7.0, 3.0, -0.5]),
        box([0.0, 0.4, 0.0], [0.3, 0.7, 3.0]),
    ]
    order = random.permutation(len(blocks))
    shift = np.array([0.37, -0.61, 0.23])

    def faces_of(shapes):
        model = spatial_model(shapes, fixed=())
        return spatial.find(model, undeformed(model), 1e-6)

    straight = faces_of(blocks)
    moved = faces_of([shifted(blocks[i], shift) for i in order])
    again = {tuple(sorted(order[pair].tolist())) for pair in moved.parts}
    assert {tuple(pair) for pair in straight.parts.tolist()} == again
    assert straight.parts.tolist() == sorted(straight.parts.tolist())
    finer = near_boxes.CELL
    try:
        near_boxes.CELL = 0.4
        for field, other in zip(faces_of(blocks), straight, strict=True):
            assert np.array_equal(field, other)
    finally:
        near_boxes.CELL = finer


def test_broad_phase_finds_the_pairs_of_brute_force():
    random = np.random.default_rng(5)
    low = random.uniform(0.0, 6.0, (150, 3))
    boxes = np.stack(
        [low, low + random.uniform(0.1, 1.0, (150, 3)) * np.where(random.random((150, 1)) < 0.05, 8, 1)], 1
    )
    corners = boxes.reshape(-1, 3)
    starts, fixed = np.arange(0, 301, 2), random.random(150) < 0.2
    blocks = np.sort(random.integers(0, 100, 150))
    fixed = np.bincount(blocks, fixed, 150) > 0
    found = near_boxes.near_boxes(corners, starts, blocks, fixed, 0.05)
    near = ((boxes[:, None, 0] <= boxes[None, :, 1] + 0.05) & (boxes[None, :, 0] <= boxes[:, None, 1] + 0.05)).all(
        axis=2
    )
    a, b = np.nonzero(np.triu(near, 1))
    kept = (blocks[a] != blocks[b]) & ~(fixed[blocks[a]] & fixed[blocks[b]])
    assert found.tolist() == np.column_stack([a, b])[kept].tolist()


@pytest.mark.parametrize("shape", ["wall", "arch", "drums"])
def test_turned_and_moved_structures_keep_their_joints(shape):
    """In any direction, mirrored and far from the origin: the same pairs, points and areas, to round-off."""
    random, ring = np.random.default_rng(6), np.arange(12) * np.pi / 6.0
    circle = np.column_stack([np.cos(ring), np.sin(ring)])
    blocks = {
        "wall": lambda: extruded(running_wall(4, 4)[0], 0.1),
        "arch": lambda: extruded(arch(9, 1.0, 0.2)[0], 0.3),
        "drums": lambda: [prism(circle, 0.5 * i, 0.5 * (i + 1)) for i in range(6)],
    }[shape]()
    straight = start_joints(spatial_model(blocks))
    for far in (0.0, 1.0, 100.0, -1.0):
        turn = matrices(random.normal(size=(1, 3)))[0] * (1.0 if far >= 0.0 else -1.0)
        mirrored = [tuple(face[:: 1 if far >= 0.0 else -1] for face in block.faces) for block in blocks]
        moved = [
            Polyhedron(block.vertices @ turn.T + far, faces) for block, faces in zip(blocks, mirrored, strict=True)
        ]
        found = start_joints(spatial_model(moved))
        assert found.joints.blocks.tolist() == straight.joints.blocks.tolist()
        assert found.geometry.kinds.tolist() == straight.geometry.kinds.tolist()
        assert np.array_equal(found.joints.starts, straight.joints.starts)
        assert found.geometry.areas == pytest.approx(straight.geometry.areas, rel=1e-9)


BASE = box([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0])


def lone(other: Polyhedron, kind: int, *places) -> np.ndarray:
    """The one joint of a block with BASE: its kind, its points with a quarter of the median face each; its normal."""
    model = spatial_model([BASE, other])
    built = start_joints(model)
    assert built.geometry.kinds.tolist() == [kind]
    order = np.lexsort(built.joints.points.T)
    assert built.joints.points[order] == pytest.approx(np.array(places, float), abs=1e-12)
    areas = [np.linalg.norm(normal) for normal in spatial.face_areas(model.vertices, model.topology)]
    assert built.joints.kn == pytest.approx(KN * 0.25 * np.median(areas))
    assert built.joints.ks == pytest.approx(KS * 0.25 * np.median(areas))
    assert built.contacts.gaps == pytest.approx(0.0, abs=1e-12)
    return built.joints.frames[0, :3]


def test_a_corner_on_a_face():
    apex = hull(np.array([[0.3, 0.2, 0.0], [0.8, 0.2, 1.0], [0.0, 0.7, 1.0], [0.0, -0.3, 1.0]]))
    assert lone(apex, RIM_OF_A, [0.3, 0.2, 0.0]) == pytest.approx([0.0, 0.0, 1.0])


def test_an_edge_on_a_face_ends_where_the_face_does():
    ridge = hull(
        np.array([[-1.0, 0.5, 0.0], [5.0, 0.5, 0.0], [-1.0, 1.5, 1.0], [5.0, 1.5, 1.0], [-1, -0.5, 1], [5, -0.5, 1]])
    )
    assert lone(ridge, RIM_OF_A, [-1.0, 0.5, 0.0], [2.0, 0.5, 0.0]) == pytest.approx([0.0, 0.0, 1.0])


def test_two_edges_that_cross():
    """Ridges square to each other: the normal is that of both, the place where they cross."""
    model = spatial_model(
        [
            hull(
                np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 1.0, -1.0], [1, 1, -1], [-1, -1, -1], [1, -1, -1]])
            ),
            hull(
                np.array(
                    [[0.25, -1.0, 0.0], [0.25, 1.0, 0.0], [1.25, -1.0, 1], [1.25, 1, 1], [-0.75, -1, 1], [-0.75, 1, 1]]
                )
            ),
        ]
    )
    built = start_joints(model)
    assert built.geometry.kinds.tolist() == [EDGES]
    assert built.joints.points == pytest.approx(np.array([[0.25, 0.0, 0.0]]))
    assert built.joints.frames[0, :3] == pytest.approx([0.0, 0.0, 1.0])


@pytest.mark.parametrize(
    "other",
    [
        box([2.0, -1.0, 0.0], [3.0, 1.0, 1.0]),  # along an edge
        box([2.0, 2.0, 0.0], [3.0, 3.0, 1.0]),  # at a corner
        shifted(turned(box([0, 0, 0], [1, 1, 1]), np.random.default_rng(1)), [9.0, 0.0, 0.0]),  # nowhere
        hull(
            np.array(
                [
                    [2.0, -1, 0.0],
                    [2.0, 1, 0],
                    [3.0, -1, 0.1],
                    [3.0, 1, 0.1],
                    [2.0, -1, 1],
                    [2, 1, 1],
                    [3, -1, 1],
                    [3, 1, 1],
                ]
            )
        ),
        hull(
            np.array(
                [
                    [2.0, -2, 0.0],
                    [2.0, 2, 0],
                    [0.0, -2, 0.3],
                    [0.0, 2, 0.3],
                    [2.0, -2, 1],
                    [2, 2, 1],
                    [0, -2, 1],
                    [0, 2, 1],
                ]
            )
        ),
    ],
)
def test_blocks_that_meet_with_their_edges_or_corners_share_no_joint(other):
    assert len(start_joints(spatial_model([BASE, other])).joints.blocks) == 0


def test_a_wedge_touches_with_the_normal_of_the_face_it_stands_on():
    """A block tilted by 3° on its edge: the joint has the normal of the base, and its far corners are open."""
    tilt = np.radians(3.0)
    turn = np.array([[np.cos(tilt), 0.0, np.sin(tilt)], [0.0, 1.0, 0.0], [-np.sin(tilt), 0.0, np.cos(tilt)]])
    block = box([-1.0, 0.0, 0.0], [0.0, 1.0, 1.0])
    built = start_joints(spatial_model([BASE, Polyhedron(block.vertices @ turn.T, block.faces)]))
    assert built.geometry.kinds.tolist() == [FACES]
    assert built.joints.frames[:, :3] == pytest.approx(np.tile([0.0, 0.0, 1.0], (4, 1)), abs=1e-15)
    assert np.sort(built.contacts.gaps) == pytest.approx([0.0, 0.0, np.sin(tilt), np.sin(tilt)], rel=2e-3)
    assert built.joints.points[:, 2] == pytest.approx(0.0, abs=1e-15)


def test_a_point_at_the_centre_keeps_area_and_both_moments():
    """Of a triangle, a rectangle and a hexagon: β = 1/4, 1/3, …; area, first moments and polar moment are exact."""
    hexagon = np.array([[np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3.0])
    for flat, share in (
        (np.array([[0.0, 0.0], [1.0, 0.2], [0.3, 0.8]]), 0.25),
        (rectangle(0, 0, 2, 1), 1 / 3),
        (hexagon, None),
    ):
        model = spatial_model([prism(flat, -1.0, 0.0), prism(flat, 0.0, 1.0)])
        joints = start_joints(model, centred=True).joints
        exact = polygon.properties(flat)
        assert len(joints.kn) == len(flat) + 1
        areas = joints.kn / KN
        arms = joints.points[:, [0, 2]] - exact.centroid
        assert areas.sum() == pytest.approx(float(exact.area), rel=1e-14)
        assert areas @ arms == pytest.approx(0.0, abs=1e-15)
        assert areas @ (arms**2).sum(axis=1) == pytest.approx(float(exact.polar_moment), rel=1e-13)
        assert joints.points[-1, [0, 2]] == pytest.approx(exact.centroid, abs=1e-15)
        if share is not None:
            assert areas[:-1].sum() / areas.sum() == pytest.approx(share, rel=1e-12)


def test_torsion_of_a_square_joint_by_its_layout():
    """Σ w r over A a, what slides at once under uniform pressure: 1/√2 of corners, a third of it with the centre."""
    model = spatial_model([BASE, box([0, 0, 0], [1, 1, 1])])
    for centred, exact in ((False, np.sqrt(0.5)), (True, np.sqrt(0.5) / 3.0)):
        joints = start_joints(model, centred).joints
        arms = np.linalg.norm(joints.points - [0.5, 0.5, 0.0], axis=1)
        assert (joints.kn / KN) @ arms == pytest.approx(exact, rel=1e-14)


def test_pieces_of_one_block_share_no_joint_and_do_not_touch_from_inside():
    """An L of two pieces on a base: only faces that can be touched."""
    ell = [box([0, 0, 0], [1, 1, 1]), box([1, 0, 0], [2, 1, 0.5])]
    model = spatial_model([BASE, ell, box([1.0, 0.0, 0.5], [2.0, 1.0, 1.5])])
    built = start_joints(model)
    assert built.joints.blocks.tolist() == [[0, 1], [0, 1], [1, 2], [1, 2]]
    assert sorted((built.joints.kn / KN).tolist()) == pytest.approx([0.125] * 4 + [0.25] * 12)
    assert not model.inner_faces[built.geometry.keys].any()
