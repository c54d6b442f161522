"""Narrow phase in the plane: edges of convex polygons that face each other, the contact points between them, and where
these are when the blocks move. One of the modules of contact/geometry.py.
"""

from __future__ import annotations

from typing import cast

import numpy as np

from dem_cli.core.contact.chains import END_TO_END, STEEP, Chains, come_back, made_chains
from dem_cli.core.contact.edges import edges_of, lengths_of, overlap_ends, overlap_lengths, widest_gaps
from dem_cli.core.contact.joints import DrawnFaces, Faces, JointArrays, JointProperties, PressedLaw, joints_of
from dem_cli.core.contact.layout import PointLayout, ProfileFault, steepest, too_steep
from dem_cli.core.geometry.rotation import across, cross
from dem_cli.core.kernels.neighbours import find_pairs, place_corners
from dem_cli.core.kernels.planar_geometry import BLEND, FLAT, STEEPER, measure
from dem_cli.core.kernels.planar_profiles import measure_profiles
from dem_cli.core.kernels.records import BlockShapes, Bodies, Contacts, Joints, MovingJoints, PlanarGeometry
from dem_cli.core.model.model import Model

PARALLEL = 1e-2  # sine of the angle between edges that touch along their length
NARROWEST = 0.1  # of the shorter edge: the overlap that a joint has stiffness for at least


def find(model: Model, corners: np.ndarray, reach: float) -> Faces:
    """Find all pairs of faces of different blocks that are closer than `reach` [m].

    corners: world coordinates of all corners [m], (n_vertices, 2). Two fixed blocks have no joint. Two convex parts
    have one, and more where they meet corner to corner: those that may come to touch next.
    """
    starts, inner = model.part_starts, model.inner_faces
    low = np.minimum.reduceat(corners, starts[:-1], axis=0)
    high = np.maximum.reduceat(corners, starts[:-1], axis=0)
    boxes = np.ascontiguousarray(np.column_stack([low[:, 0], high[:, 0], low[:, 1], high[:, 1]]))
    order = np.argsort(boxes[:, 0], kind="stable")
    capacity = 8 * model.n_parts + 16
    while True:
        parts = np.empty((capacity, 2), np.int64)
        edges = np.empty((capacity, 2), np.int64)
        separation = np.empty(capacity)
        n = find_pairs(order, boxes, corners, starts, model.part_blocks, model.fixed, reach, parts, edges, separation)
        if n <= capacity:
            break
        capacity = n
    # Where a piece touches another block with an inner edge only, it is at a corner that another piece has too.
    by_part = np.lexsort((edges[:n, 1], edges[:n, 0], parts[:n, 1], parts[:n, 0]))
    by_part = by_part[~inner[edges[by_part]].any(axis=1)]
    return Faces(parts[by_part], edges[by_part], separation[by_part])  # an edge starts at the corner of its number


def points(
    model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties, chains: Chains | None = None
) -> tuple[MovingJoints, PlanarGeometry]:
    """Make joints of pairs of edges with stiffness from their present overlap, and their geometry; not yet placed.

    chains: of the joints of the start, which alone have a profile or more than two points; None: these are they.
    """
    n, edges = len(faces.parts), edges_of(model, faces)
    lengths = lengths_of(edges, corners)
    shortest = lengths.min(axis=1, initial=np.inf)
    overlap = np.clip(overlap_lengths(edges, corners), NARROWEST * shortest, shortest)
    areas = overlap * model.thickness[model.part_blocks[faces.parts]].min(axis=1, initial=np.inf)
    starts, profile, shares = np.arange(0, 2 * n + 1, 2), np.zeros((0, 2)), np.full(2 * n, 0.5)
    if properties.profiled:
        chains = made_chains(model, faces, corners, properties) if chains is None else chains
        starts, profile, shares = come_back(chains, faces, edges, corners)
    joints = joints_of(model, faces, properties, starts, areas, shares)
    scales = [lengths[:, 0], 1.0 / lengths, 0.25 / (BLEND * shortest), _cotangents(model)[edges]]
    geometry = PlanarGeometry(
        keys=faces.faces,
        features=np.arange(len(joints.kn)) - starts[joints.owners],
        edges=edges,
        scales=np.ascontiguousarray(np.column_stack(scales)),
        profile=profile,
        sunk=np.zeros(n),
    )
    return joints, geometry


def place(joints: Joints, geometry: PlanarGeometry, contacts: Contacts, bodies: Bodies) -> None:
    """Update gaps of all contacts, frames, levers and points of all joints to where the blocks are now; compiled."""
    (measure_profiles if len(geometry.profile) else measure)(joints, geometry, contacts, bodies)


def touching(model: Model, faces: Faces, corners: np.ndarray, reach: float | np.ndarray) -> np.ndarray:
    """Test which edges share a length, (n,) bool; edges that meet corner to corner cannot carry force, to first order.

    reach: [m], one for all or (n,).
    """
    edges = edges_of(model, faces)
    return (overlap_lengths(edges, corners) > reach) & ~corner_to_corner(edges, corners, reach)


def facing(model: Model, faces: Faces, corners: np.ndarray, sine: float, least: np.ndarray) -> np.ndarray:
    """Test which edges look at each other, nearly parallel, over a length of more than `least` [m], (n,) bool."""
    edges = edges_of(model, faces)
    along, against = corners[edges[:, 1]] - corners[edges[:, 0]], corners[edges[:, 3]] - corners[edges[:, 2]]
    parallel = np.abs(cross(along, against)) <= sine * np.hypot(*along.T) * np.hypot(*against.T)
    return parallel & (overlap_lengths(edges, corners) > least)


def open_gaps(model: Model, faces: Faces, corners: np.ndarray, steepest: float, bare: float) -> np.ndarray:
    """Compute the largest gap of each pair of edges that look at each other [m], (n,); 0: they do not, or overlap."""
    return widest_gaps(edges_of(model, faces), corners, steepest, bare)


def drawn(model: Model, faces: Faces, corners: np.ndarray, least: float) -> DrawnFaces:
    """Find pairs of edges that overlap by more than `least` [m], with both ends of the overlap."""
    low, high = overlap_ends(edges_of(model, faces), corners)
    kept = faces.where(high - low > least)
    edges, lengths = edges_of(model, kept), (high - low)[high - low > least]
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    along = (a1 - a0) / np.hypot(*(a1 - a0).T)[:, np.newaxis]
    places = np.stack(overlap_ends(edges, corners), axis=1)[..., np.newaxis]
    on_first = a0[:, np.newaxis] + places * along[:, np.newaxis]
    past = ((on_first - b0[:, np.newaxis]) * along[:, np.newaxis]).sum(axis=2)
    share = past / ((b1 - b0) * along).sum(axis=1)[:, np.newaxis]
    on_second = b0[:, np.newaxis] + share[..., np.newaxis] * (b1 - b0)[:, np.newaxis]
    blocks = model.part_blocks[kept.parts]
    return DrawnFaces(
        blocks, -across(along), 2 * np.arange(len(blocks) + 1), on_first.reshape(-1, 2), on_second.reshape(-1, 2),
        np.full(2 * len(blocks), 0.5), lengths, lengths * model.thickness[blocks].min(axis=1, initial=np.inf),
    )  # fmt: skip


def corner_to_corner(edges: np.ndarray, corners: np.ndarray, reach: float | np.ndarray) -> np.ndarray:
    """Test which edges meet at an angle, end to end, closer than `reach` [m], (n,) bool; 2D."""
    a0, a1, b0, b1 = (corners[edges[:, i]] for i in range(4))
    a, b = ((end - start) / np.hypot(*(end - start).T)[:, None] for start, end in ((a0, a1), (b0, b1)))
    angled = np.abs(cross(a, b)) > PARALLEL
    apart = np.minimum(np.hypot(*(a0 - b1).T), np.hypot(*(a1 - b0).T))
    return angled & (apart <= reach)


def _cotangents(model: Model) -> np.ndarray:
    """Compute the cotangent of the inner angle at each corner, (n_vertices,)."""
    first, after = model.topology.ends.T
    leaving = model.vertices[after] - model.vertices[first]
    arriving = np.empty_like(leaving)
    arriving[after] = leaving
    turn = cross(arriving, leaving)
    size = np.sqrt((arriving**2).sum(axis=1) * (leaving**2).sum(axis=1))
    return -(arriving * leaving).sum(axis=1) / np.maximum(turn, 1e-9 * size)


def corners_of(shape: BlockShapes, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Compute corners of all parts in world coordinates [m], (n_vertices, 2)."""
    corners = np.empty_like(shape.corner_arms)
    place_corners(positions, orientations, shape.corner_blocks, shape.corner_arms, corners)
    return corners


def left_out(model: Model, corners: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Return no pairs and no areas: in the plane each two edges have a joint of their own."""
    return np.zeros((0, 2), np.int64), np.zeros(0)


def bonds(model: Model, geometry: PlanarGeometry) -> np.ndarray:
    """Test which joints have edges that overlap; not those that meet end to end."""
    return ~end_to_end(model, geometry)


def end_to_end(model: Model, geometry: PlanarGeometry) -> np.ndarray:
    """Test which joints of the start have no length, as where four blocks have a corner in one place, (n_joints,)
    bool.
    """
    sizes = np.diff(model.part_starts)
    corners = model.vertices + np.repeat(model.centroids[model.part_blocks], sizes, axis=0)
    whole = lengths_of(geometry.edges, corners).min(axis=1, initial=np.inf)
    return overlap_lengths(geometry.edges, corners) <= END_TO_END * whole


def chains_of(model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties) -> Chains | None:
    """Collect points that come back wherever the same faces meet again; None: all joints have two points, at their
    ends.
    """
    return made_chains(model, faces, corners, properties) if properties.profiled else None


def take_over(old: JointArrays, new: JointArrays, match: np.ndarray, known: np.ndarray) -> None:
    """Copy initial penetrations of old joints to new ones with the same faces; match: number of the old one, −1:
    none.
    """
    go_on = np.flatnonzero(match >= 0)
    before, now = cast(PlanarGeometry, old.geometry), cast(PlanarGeometry, new.geometry)
    now.sunk[:] = np.inf
    now.sunk[go_on] = before.sunk[match[go_on]]


def carry(old: JointArrays, new: JointArrays, target: np.ndarray, source: np.ndarray) -> None:
    """Copy stiffness and forces of points that go on."""
    new.contacts.normal[target], new.contacts.shear[target] = old.contacts.normal[source], old.contacts.shear[source]
    new.joints.kn[target], new.joints.ks[target] = old.joints.kn[source], old.joints.ks[source]


def book(old: JointArrays, new: JointArrays, known: np.ndarray, pressed: PressedLaw) -> None:
    """Do nothing: points in the plane keep their stiffness, so that no energy is exchanged."""


def sink(geometry: PlanarGeometry, joint: int, depth: float) -> None:
    """Set the penetration from which a joint counts its gaps, at most this depth [m]: the recess of a profile."""
    geometry.sunk[joint] = min(geometry.sunk[joint], depth)


def microrotations(joints: Joints, geometry: PlanarGeometry) -> np.ndarray:
    """Compute the largest microrotation of each joint from the side that it rests on at first [rad], (n_joints,)."""
    angles, profile = np.zeros(len(joints.blocks)), geometry.profile
    if not len(profile):
        return angles
    sides = np.diff(profile, axis=0)
    inner = np.ones(len(sides), bool)
    inner[joints.starts[1:-1] - 1] = False  # from the last point of a joint to the first of the next
    np.maximum.at(angles, joints.owners[:-1][inner], np.abs(sides[inner, 1] / sides[inner, 0]))
    return angles


def profile_fault(
    model: Model, faces: Faces, corners: np.ndarray, layout: PointLayout, among: np.ndarray
) -> ProfileFault | None:
    """Check that a profile is not too steep on the shortest of these joints (n,) bool that has it; else a fault."""
    edges = edges_of(model, faces)
    along = corners[edges[:, 1]] - corners[edges[:, 0]]
    lengths, whole = overlap_lengths(edges, corners), lengths_of(edges, corners)[:, 1]
    has_it = among & (lengths > END_TO_END * whole)
    if layout.only != "all":
        has_it &= (np.abs(along[:, 0]) >= STEEP * np.hypot(*along.T)) == (layout.only == "bed")
    if not has_it.any():
        return None
    k = np.flatnonzero(has_it)[lengths[has_it].argmin()]
    between = [model.block_ids[i] for i in model.part_blocks[faces.parts[k]]]
    return too_steep(between, float(lengths[k]), steepest(layout, float(lengths[k])))


def corner_shares(joints: Joints, geometry: PlanarGeometry, corners: np.ndarray) -> np.ndarray:
    """Weight of edge a in the normal of each point: 1 but at ends near or beyond a corner of a, (n_points,)."""
    a0, a1, b0, b1 = (corners[geometry.edges[:, i]] for i in range(4))
    along_a, along_b = (a1 - a0) * geometry.scales[:, [1]], (b1 - b0) * geometry.scales[:, [2]]
    both = along_a - along_b
    blend = geometry.scales[:, 3] * (1.0 + STEEPER * np.maximum(np.abs(cross(along_a, along_b)) - FLAT, 0.0))
    found = np.ones(len(joints.kn))
    for inside, ends in ((b1 - a0, joints.starts[:-1]), (a1 - b0, joints.starts[1:] - 1)):
        found[ends] = np.clip(0.5 + (inside * both).sum(axis=1) * blend, 0.0, 1.0)
    return found
