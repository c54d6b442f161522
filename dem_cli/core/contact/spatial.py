"""Narrow phase in space: faces, edges and corners of convex polyhedra that meet, and contact points between them.

Geometry of the start: points stay where they were found. One of the modules of contact/geometry.py.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.contact.area_rules import InnerPoints, inner_points
from dem_cli.core.contact.caps import apothems, has_cap, highest, odd_or_uneven, steepest
from dem_cli.core.contact.joints import DrawnFaces, Faces, JointProperties, joints_of
from dem_cli.core.contact.layout import PointLayout, ProfileFault, too_deep, too_steep
from dem_cli.core.contact.meetings import Meetings, meetings, polyhedra, room_of
from dem_cli.core.contact.near_boxes import near_boxes
from dem_cli.core.geometry.outlines import away_from, furthest
from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.geometry.rotation import matrices
from dem_cli.core.geometry.solids import face_areas
from dem_cli.core.kernels.deformation.pressed_faces import fan_out_all
from dem_cli.core.kernels.records import (
    FACES,
    BlockShapes,
    Bodies,
    Contacts,
    Joints,
    MovingJoints,
    SpatialGeometry,
)
from dem_cli.core.kernels.separation import separations
from dem_cli.core.kernels.spatial_geometry import AREA, CENTRE, GAP, MARGIN, PARALLEL, POLAR, TORSION
from dem_cli.core.model.block_measures import median
from dem_cli.core.model.model import Model

FLAT = 1e-4  # angle of kinks across which parts may touch on both sides, within round-off [rad]
NOTED = 0.02  # of the smaller face: area beside a joint that is worth a word
LONE = 0.25  # of the median face: the area of a point outside of face joints
INNER = np.iinfo(np.int32).max  # features of points within an outline: from here on


def find(model: Model, corners: np.ndarray, reach: float) -> Faces:
    """Find all pairs of parts of different blocks that are closer than `reach` [m], by the faces that look at each
    other.

    Two fixed blocks have no joint. Pairs are ordered by parts, whatever finds them.
    """
    pairs = near_boxes(corners, model.part_starts, model.part_blocks, model.fixed, reach)
    separation, faces, _ = _facing(model, corners, pairs, reach)
    near = separation <= reach
    # Where a piece touches another block with an inner face only, it is at an edge that another piece has too.
    near[near] &= ~model.inner_faces[faces[near]].any(axis=1)
    return Faces(pairs[near], faces[near], separation[near], reach)


def _facing(
    model: Model, corners: np.ndarray, pairs: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distance of pairs of parts, the faces that look at each other, and other areas that they share
    (separation.py).
    """
    solids = polyhedra(model, corners)
    faces, separation, beside = np.zeros((len(pairs), 2), np.int64), np.empty(len(pairs)), np.zeros(len(pairs))
    separations(solids, pairs, reach, room_of(solids), separation, faces, beside)
    return separation, faces, beside


def left_out(model: Model, corners: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Find blocks that also touch beside their joint, and the area of that [m²], (n, 2) and (n,).

    Two convex parts have one joint, in one plane: where one of them lies on both sides of a kink that is flatter than
    contact can tell, only the larger side counts. reach: [m].
    """
    normals, first = model.faces.normals, model.topology.part_faces
    kinked = np.zeros(model.n_parts, bool)
    for count in np.unique(np.diff(first)):
        parts = np.flatnonzero(np.diff(first) == count)
        own = normals[first[parts, None] + np.arange(count)]
        near = product(own, own.swapaxes(1, 2)) > 1.0 - 0.5 * FLAT**2
        kinked[parts] = near.sum(axis=(1, 2)) > count
    if not kinked.any():
        return np.zeros((0, 2), np.int64), np.zeros(0)
    pairs = near_boxes(corners, model.part_starts, model.part_blocks, model.fixed, reach)
    pairs = pairs[kinked[pairs].any(axis=1)]
    separation, faces, beside = _facing(model, corners, pairs, reach)
    smaller = model.faces.areas[faces].min(axis=1)
    kept = (separation <= reach) & (beside > NOTED * smaller)
    return model.part_blocks[pairs[kept]], beside[kept]


def touching(model: Model, faces: Faces, corners: np.ndarray, reach: float | np.ndarray) -> np.ndarray:
    """Test which pairs of faces share an area, a corner or edge within a face, or cross with two edges, (n,) bool.

    Blocks that meet edge to edge or corner to corner cannot carry force, to first order.
    reach: [m], one for all or (n,).
    """
    found, reaches = meetings(model, faces, corners), np.broadcast_to(reach, len(faces.parts))
    return (found.measures[:, MARGIN] > reaches) & ~_on_joints(model, faces, corners, found, reaches)


def _on_joints(model: Model, faces: Faces, corners: np.ndarray, found: Meetings, reaches: np.ndarray) -> np.ndarray:
    """Test which edges and corners meet a block where another part of their block lies on it with a face, (n,) bool.

    That edge is one of the parts, not of the block: what it carries is carried by the face. reaches: [m], (n,).
    """
    blocks, repeated = model.part_blocks[faces.parts], np.zeros(len(faces.parts), bool)
    several = np.bincount(model.part_blocks, minlength=model.n_blocks) > 1
    if not several.any():
        return repeated
    flat = _along(shapes_of(corners).normals(corners, model.topology), found.kinds, faces.faces)
    of_two = blocks.min(axis=1) * model.n_blocks + blocks.max(axis=1)
    for k in np.flatnonzero(~flat & several[blocks].any(axis=1)):
        others = np.flatnonzero(flat & (of_two == of_two[k]))
        own = np.arange(found.starts[k], found.starts[k + 1])
        nearest = found.gaps[own].min()
        touching = own[found.gaps[own] <= nearest + reaches[k]]
        for other in others:
            which = np.full(len(touching), other)
            away = away_from(found.places[touching], which, found.places, found.starts, found.frames[:, :3])
            repeated[k] |= bool((away <= reaches[k] + abs(nearest)).all())
    return repeated


def _mean_arms(found: Meetings, shares: np.ndarray) -> np.ndarray:
    """Compute the mean distance of the points of each joint from their centre, by their shares [m], (n,)."""
    starts = found.starts[:-1]
    owners = np.repeat(np.arange(len(starts)), np.diff(found.starts))
    totals = np.add.reduceat(shares, starts)
    centres = np.add.reduceat(shares[:, None] * found.places, starts) / totals[:, None]
    arms = np.sqrt(((found.places - centres[owners]) ** 2).sum(axis=1))
    return np.add.reduceat(shares * arms, starts) / totals


def points(
    model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties, chains: None = None
) -> tuple[MovingJoints, SpatialGeometry]:
    """Make joints with contact points at the corners of their overlap, and stiffness by the area of each; not yet
    placed.

    Where the layout of a joint asks for more, there are points within the outline as well.
    """
    found = meetings(model, faces, corners)
    lone, areas, shares = found.kinds != FACES, _areas(model, found), _shares(found)
    outline, measured = np.diff(found.starts), found.measures[:, TORSION]
    if properties.profiled:
        named, of_corners = properties.between(model, model.part_blocks[faces.parts]), _mean_arms(found, shares)
        found, shares = _with_centres(found, shares, ~lone & properties.centred[named])
        found, shares = _with_rules(found, shares, np.where(lone, 0, properties.along_sides[named]))
        arms = _mean_arms(found, shares)
        measured = measured * np.where(lone, 1.0, of_corners / np.where(arms > 0.0, arms, 1.0))
    spread = properties.spread_between(model, model.part_blocks[faces.parts])
    torsion = np.where(spread, measured, 1.0)
    joints = joints_of(model, faces, properties, found.starts, areas, shares, torsion, lone)
    geometry = SpatialGeometry(
        keys=faces.faces,
        features=found.features,
        kinds=found.kinds,
        corners=outline,
        axes=found.frames,
        places=found.places,
        gaps=found.gaps,
        areas=areas,
    )
    return joints, geometry


def _with_centres(found: Meetings, shares: np.ndarray, centred: np.ndarray) -> tuple[Meetings, np.ndarray]:
    """Add a point at the centroid of some joints, (n,) bool: area, first and polar moment of each are exact.

    Corners keep the share β of their areas and the centre gets the rest, β = polar moment / Σ w r².
    """
    owners = found.owners
    middles = found.measures[:, CENTRE : CENTRE + 3]
    arms = found.places - middles[owners]
    lumped = np.bincount(owners, found.weights * (arms**2).sum(axis=1), len(centred))
    keep = np.ones(len(centred))
    keep[centred] = found.measures[centred, POLAR] / lumped[centred]
    at = found.starts[1:][centred]
    return found._replace(
        starts=found.starts + np.concatenate([[0], np.cumsum(centred)]),
        places=np.insert(found.places, at, middles[centred], axis=0),
        weights=np.insert(found.weights * keep[owners], at, (1.0 - keep[centred]) * found.measures[centred, AREA]),
        gaps=np.insert(found.gaps, at, found.measures[centred, GAP]),
        features=np.insert(found.features, at, INNER),
    ), np.insert(shares * keep[owners], at, 1.0 - keep[centred])


def _with_rules(found: Meetings, shares: np.ndarray, sides: np.ndarray) -> tuple[Meetings, np.ndarray]:
    """Add so many points along each side of joints (n,), fewer than LEAST: none but those that there are."""
    inner = rules_over(found, sides)
    counts = np.diff(inner.starts)
    if not counts.any():
        return found, shares
    of, own = np.repeat(np.arange(len(counts)), counts), inner.corners[found.owners]
    at, areas = found.starts[1:][of], found.measures[of, AREA]
    return found._replace(
        starts=found.starts + np.concatenate([[0], np.cumsum(counts)]),
        places=np.insert(found.places, at, inner.places[:, :3], axis=0),
        weights=np.insert(found.weights * own, at, inner.shares * areas),
        gaps=np.insert(found.gaps, at, inner.places[:, 3]),
        features=np.insert(found.features, at, INNER + np.arange(len(of)) - inner.starts[of]),
    ), np.insert(shares * own, at, inner.shares)


def rules_over(found: Meetings, sides: np.ndarray) -> InnerPoints:
    """Quadrature points within the outlines of joints, so many along each side (n,), with gaps [m] in column 3."""
    outlines = np.column_stack([found.places, found.gaps])
    centres = np.column_stack([found.measures[:, CENTRE : CENTRE + 3], found.measures[:, GAP]])
    return inner_points(outlines, found.starts, centres, sides)


def _areas(model: Model, found: Meetings) -> np.ndarray:
    """Areas of contacts [m²], (n,): of overlaps their own, of lone contacts LONE of the median face for each point."""
    lone = LONE * median_face(model) * np.diff(found.starts)
    return np.where(found.kinds != FACES, lone, found.measures[:, AREA])


def _shares(found: Meetings) -> np.ndarray:
    """Compute the share of its joint that belongs to each point, (n_points,)."""
    return found.weights / np.bincount(found.owners, found.weights, len(found.kinds))[found.owners]


def median_face(model: Model) -> float:
    """Compute the median area of all faces that can be touched [m²]."""
    areas = model.faces.areas
    return median(areas[~model.inner_faces]) if len(areas) else 0.0


def place(joints: Joints, geometry: SpatialGeometry, contacts: Contacts, bodies: Bodies) -> None:
    """Set gaps, frames, levers and points as they were found; blocks are where they were then."""
    owners = joints.owners
    frames = geometry.axes[owners]
    joints.frames[:], joints.points[:], contacts.gaps[:] = frames, geometry.places, geometry.gaps
    if len(joints.integrated):
        fan_out_all(joints)
    along = frames.reshape(-1, 3, 3)
    for side in (0, 1):
        arms = geometry.places - bodies.positions[joints.blocks[owners, side]]
        joints.levers[:, 9 * side : 9 * side + 9] = np.cross(arms[:, None], along).reshape(-1, 9)


def corners_of(shape: BlockShapes, positions: np.ndarray, orientations: np.ndarray) -> np.ndarray:
    """Compute corners of all parts in world coordinates [m], (n_vertices, 3)."""
    turns = matrices(orientations)[shape.corner_blocks]
    return positions[shape.corner_blocks] + (turns * shape.corner_arms[:, None, :]).sum(axis=2)


def facing(model: Model, faces: Faces, corners: np.ndarray, sine: float, least: np.ndarray) -> np.ndarray:
    """Test which faces look at each other, nearly parallel, over a width of more than `least` [m], (n,) bool."""
    found, (a, b) = meetings(model, faces, corners), shapes_of(corners).normals(corners, model.topology)[faces.faces.T]
    return (found.kinds == FACES) & (np.linalg.norm(np.cross(a, b), axis=1) <= sine) & (found.widths > least)


def open_gaps(model: Model, faces: Faces, corners: np.ndarray, steepest: float, bare: float) -> np.ndarray:
    """Largest gap at the corners of overlaps of faces that look at each other [m], (n,); 0: none, or overlap."""
    if not len(faces.parts):
        return np.zeros(0)
    found = meetings(model, faces, corners)
    areas = face_areas(corners, model.topology)
    sizes = np.linalg.norm(areas, axis=1)
    a, b = faces.faces.T
    slopes = np.linalg.norm(np.cross(areas[a], areas[b]), axis=1) / (sizes[a] * sizes[b])
    facing = (found.kinds == FACES) & (slopes < steepest)
    facing &= found.measures[:, AREA] > bare * np.minimum(sizes[a], sizes[b])
    return np.where(facing, np.maximum.reduceat(found.gaps, found.starts[:-1]), 0.0).clip(0.0)


def drawn(model: Model, faces: Faces, corners: np.ndarray, least: float) -> DrawnFaces:
    """Find outlines of the pairs wider than `least` [m]; places on both parts are opposite, across the gap."""
    found = meetings(model, faces, corners)
    kept, reaches = found.widths > least, np.full(len(faces.parts), max(least, 0.0))
    kept &= (found.measures[:, MARGIN] > least) & ~_on_joints(model, faces, corners, found, reaches)
    points, normals = kept[found.owners], found.frames[:, :3]
    across = 0.5 * found.gaps[points, None] * normals[found.owners[points]]
    starts = np.concatenate([[0], np.cumsum(np.diff(found.starts)[kept])])
    places, shares = found.places[points], _shares(found)[points]
    ends = places[furthest(places, starts)]
    longest = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return DrawnFaces(
        model.part_blocks[faces.parts[kept]], normals[kept], starts, places - across, places + across, shares,
        longest, _areas(model, found)[kept],
    )  # fmt: skip


def bonds(model: Model, geometry: SpatialGeometry) -> np.ndarray:
    """Test which joints have faces that lie on each other, (n_joints,) bool; not edges and corners on faces."""
    return along_each_other(model, geometry.kinds, geometry.keys)


def end_to_end(model: Model, geometry: SpatialGeometry) -> np.ndarray:
    """Return False for all joints, (n_joints,) bool: in space corners that meet share no joint."""
    return np.zeros(len(geometry.kinds), bool)


def along_each_other(model: Model, kinds: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Test which pairs of faces (n, 2) of undeformed blocks lie along each other, (n,) bool; of kinds (n,)."""
    return _along(model.faces.normals, kinds, faces)


def _along(normals: np.ndarray, kinds: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b = normals[faces.T]
    return (kinds == FACES) & (np.linalg.norm(np.cross(a, b), axis=1) <= PARALLEL)


def chains_of(model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties) -> None:
    """Return None: joints in space without motion have no points that come back."""


def profile_fault(
    model: Model, faces: Faces, corners: np.ndarray, layout: PointLayout, among: np.ndarray
) -> ProfileFault | None:
    """Check the cap of these joints (n,) bool: its shape, its slope on the narrowest joint, its rise on the thinnest
    block. Returns the fault or None.
    """
    found = meetings(model, faces, corners)
    has_it = among & (found.kinds == FACES) & np.array([has_cap(layout, frame[:3]) for frame in found.frames], bool)
    if fault := odd_or_uneven(layout):
        return fault
    if not has_it.any():
        return None
    outlines = {k: found.places[found.starts[k] : found.starts[k + 1]] for k in map(int, np.flatnonzero(has_it))}
    widths = {k: 2.0 * float(apothems(outline).min()) for k, outline in outlines.items()}
    depths = {k: _thickness(model, corners, faces.parts[k, 1], found.frames[k, :3]) for k in outlines}
    narrowest, thinnest = min(widths, key=widths.__getitem__), min(depths, key=depths.__getitem__)
    flattest = min(depths, key=lambda k: depths[k] / widths[k])  # where the cap rises with the length of the joint

    def between(k: int) -> list[str]:
        return [model.block_ids[i] for i in model.part_blocks[faces.parts[k]]]

    faults = [too_steep(between(narrowest), widths[narrowest], steepest(layout, outlines[narrowest]))]
    faults += [too_deep(between(k), highest(layout, outlines[k]), depths[k]) for k in (thinnest, flattest)]
    return next(filter(None, faults), None)


def _thickness(model: Model, corners: np.ndarray, part: int, normal: np.ndarray) -> float:
    """Compute the extent of a part along a normal [m]."""
    return float(np.ptp(product(corners[model.part_starts[part] : model.part_starts[part + 1]], normal)))
