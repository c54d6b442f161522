"""Narrow phase in space where blocks move: contact points of polyhedra that know what they are, renewed on the way.

Between two detections the compiled loop renews the points of each joint itself (kernels/renewal.py). One of the modules
of contact/geometry.py; what does not depend on motion is that of contact/spatial.py.
"""

from __future__ import annotations

from typing import cast

import numpy as np

from dem_cli.core.contact.area_rules import LEAST
from dem_cli.core.contact.caps import Caps, caps_of, made_caps
from dem_cli.core.contact.joints import Faces, JointArrays, JointProperties, PressedLaw, joints_of
from dem_cli.core.contact.meetings import polyhedra
from dem_cli.core.contact.spatial import (
    LONE,
    along_each_other,
    corners_of,
    drawn,
    end_to_end,
    facing,
    find,
    left_out,
    median_face,
    open_gaps,
    profile_fault,
    touching,
)  # fmt: skip
from dem_cli.core.kernels.deformation.pressed_faces import press_all
from dem_cli.core.kernels.records import FACES, Bodies, Contacts, Joints, MovingJoints, SpatialMotion
from dem_cli.core.kernels.renewal import LEFT, MOST_LEFT
from dem_cli.core.kernels.spatial_forces import measure_spatial, renew_fresh
from dem_cli.core.kernels.spatial_points import KS, LOCAL, classify
from dem_cli.core.kernels.spatial_points import LONE as LONE_AREA
from dem_cli.core.model.block_measures import median
from dem_cli.core.model.model import Model
from dem_cli.errors import SolverError

__all__ = [
    "bonds", "book", "carry", "chains_of", "corners_of", "drawn", "end_to_end", "facing", "find", "left_out",
    "microrotations", "open_gaps", "place", "points", "profile_fault", "sink", "take_over", "touching",
]  # fmt: skip

BAND = 0.02  # of the shortest side of both faces: over so much of the rim normals turn
FLOOR = 0.25  # of the median face, or of the smaller one of a joint: area of a face joint, at least
BEVEL = 0.25  # of the typical face of the smaller part: what a small face of a large block counts as, at least
SKINS = 2.0  # of the reach of detection: how high over a face what lies on it is looked for


def points(
    model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties, chains: Caps | None = None
) -> tuple[MovingJoints, SpatialMotion]:
    """Make joints with room for contact points, and their geometry; points come when they are placed.

    chains: caps of the joints of the start, which alone have one; None: these are they, or there are none.
    """
    caps = caps_of(chains or made_caps(model, faces, corners, properties), faces)
    solids, n = polyhedra(model, corners), len(faces.parts)
    if np.diff(model.part_starts).max(initial=0) > LOCAL:
        raise SolverError(f"a block has more than {LOCAL:,} corners: where blocks move in space it needs several parts")
    counts = np.diff(solids.face_starts)
    slots = counts[faces.faces].sum(axis=1) + np.diff(caps.starts) + 1  # corners, and a centre
    starts = np.concatenate([[0], np.cumsum(slots)]).astype(np.int64)
    most = int(slots.max(initial=0))
    work = np.zeros((7, 2 * most + 2, 4))
    kinds, edges = np.zeros(n, np.int8), np.full((n, 5), -1)
    classify(solids, faces.parts, faces.faces, faces.separation, work, kinds, edges)
    n_points = int(starts[-1])
    none = np.zeros(n), np.zeros(n_points)
    joints = joints_of(model, faces, properties, starts, *none, np.ones(n), kinds != FACES)
    normals = model.faces.normals[faces.faces]
    geometry = SpatialMotion(
        keys=faces.parts,
        features=np.full(n_points, -1),
        kinds=kinds,
        faces=faces.faces,
        normals=np.ascontiguousarray(normals.reshape(-1, 6)),
        tangents=np.ascontiguousarray(model.faces.first_sides[faces.faces[:, 0]]),
        markers=np.full((n, 6), np.nan),
        apart=np.full((n, 3), np.nan),
        opened=np.zeros(n_points),
        scales=_scales(model, faces, properties, caps.corners),
        edges=edges,
        types=np.zeros(n_points, np.int8),
        corners=np.full((n_points, 5), -1),
        shares=np.zeros(n_points),
        spans=np.zeros((n_points, 2)),
        arms=np.zeros((n_points, 3)),
        rises=caps.rises,
        slopes=caps.slopes,
        cap_starts=caps.starts,
        cap_arms=caps.arms,
        cap_areas=caps.areas,
        face_starts=solids.face_starts,
        face_corners=solids.face_corners,
        part_starts=solids.part_starts,
        part_edges=solids.part_edges,
        part_sides=np.ascontiguousarray(solids.edges[:, :2]),
        work=work,
        found=np.full((2 * most + 2, 5), -1),
        labels=np.zeros((2 * most + 2, 2), np.int64),
        numbers=np.zeros((2 * most + 2, LEFT + MOST_LEFT)),
        taken=np.zeros(2 * most + 2, np.int64),
        heirs=np.zeros(2 * most + 2, np.int64),
    )
    return joints, geometry


def _median_free_face(model: Model) -> float:
    """Compute the median area of the faces of blocks that can move [m²]: a large base says nothing of a stone on it."""
    areas = model.faces.areas
    free = ~model.inner_faces & ~model.fixed[model.part_blocks[model.topology.face_parts]]
    return median(areas[free]) if free.any() else median_face(model)


def _scales(model: Model, faces: Faces, properties: JointProperties, own: np.ndarray) -> np.ndarray:
    """Compute SpatialMotion.scales of pairs of faces, (n, 10). own: Caps.corners of them, (n,).

    Where faces meet that did not at the start, they have their corners and the centre.
    """
    median, areas, shortest = _median_free_face(model), model.faces.areas, model.faces.shortest_sides
    blocks = model.part_blocks[faces.parts]
    named = properties.between(model, blocks)
    kn, ks = properties.stiffness_of(named, faces.faces)
    centred = (properties.centred[named] | ((properties.along_sides[named] >= LEAST) & (own == 0.0))).astype(float)
    typical = BEVEL * model.faces.typical_areas[faces.parts].min(axis=1)
    n, smaller = len(faces.parts), np.maximum(areas[faces.faces].min(axis=1), typical)
    face = np.minimum(median, smaller)  # a small block on a large one has no pillars for corners, a bevel no needles
    reach = SKINS * np.maximum(faces.reach, 0.0)
    spread = properties.spread_between(model, blocks).astype(float)
    return np.column_stack([
        np.sqrt(smaller), BAND * shortest[faces.faces].min(axis=1), kn, ks,
        LONE * face, FLOOR * face, np.full(n, reach), centred, own, spread,
    ])  # fmt: skip


def place(joints: Joints, geometry: SpatialMotion, contacts: Contacts, bodies: Bodies) -> None:
    """Update gaps, frames, levers and points to where the blocks are now; joints that have no points yet get them."""
    if np.isnan(geometry.markers).any():
        renew_fresh(joints, geometry, contacts, bodies)
    measure_spatial(joints, geometry, contacts, bodies)


def carry(old: JointArrays, new: JointArrays, target: np.ndarray, source: np.ndarray) -> None:
    """Copy forces of points that go on: by their areas, along the tangents that they have now."""
    grown = new.joints.kn[target] / old.joints.kn[source]
    new.contacts.normal[target] = grown * old.contacts.normal[source]
    before, now = (of.joints.frames[at, 3:].reshape(-1, 2, 3) for of, at in ((old, source), (new, target)))
    along = np.einsum("nij,ni->nj", before, old.contacts.shear[source])
    grown = new.joints.ks[target] / old.joints.ks[source]
    new.contacts.shear[target] = grown[:, None] * np.einsum("nij,nj->ni", now, along)


def take_over(old: JointArrays, new: JointArrays, match: np.ndarray, known: np.ndarray) -> None:
    """Copy traction, slip and memory of the nearest old point, open or not, to new points of a joint that goes on."""
    owners = new.joints.owners
    fresh = (new.geometry.features >= 0) & ~known & (match[owners] >= 0)
    for j in np.unique(owners[fresh]):
        was = np.arange(old.joints.starts[match[j]], old.joints.starts[match[j] + 1])
        now = np.arange(new.joints.starts[j], new.joints.starts[j + 1])
        was, now = was[old.geometry.features[was] >= 0], now[fresh[now]]
        if len(was):
            arms = new.joints.points[now][:, None] - old.joints.points[was]
            source = was[(arms**2).sum(axis=2).argmin(axis=1)]
            carry(old, new, now, source)
            for name in ("slip", "memory", "closure"):
                getattr(new.contacts, name)[now] = getattr(old.contacts, name)[source]
    _soften(old, new, match)


def _soften(old: JointArrays, new: JointArrays, match: np.ndarray) -> None:
    """Reduce the stiffness of an edge on a face to that of the strip over which an elastic face pressed before the
    turn.

    That strip is narrow and deep: on the area of a lone point the same overlap would push a hundred times as much.
    """
    was, now = cast(SpatialMotion, old.geometry), cast(SpatialMotion, new.geometry)
    joints, contacts, scales = new.joints, new.contacts, now.scales
    edged = np.flatnonzero((match >= 0) & (now.kinds != FACES))
    before = match[edged]
    soft = was.scales[before, LONE_AREA] / scales[edged, LONE_AREA]
    anew = (was.kinds[before] == FACES) & old.whole[old.joints.starts[before]]
    for k, joint in enumerate(edged):
        if not anew[k] and soft[k] == 1.0:
            continue
        at = slice(joints.starts[joint], joints.starts[joint + 1])
        if anew[k]:
            force = joints.kn[at] * np.maximum(-contacts.gaps[at], 0.0)
            push = old.contacts.normal[old.joints.starts[before[k]] : old.joints.starts[before[k] + 1]].sum()
            soft[k] = push / force.sum() if 0.0 < push < force.sum() else 1.0
            contacts.normal[at] = force
        joints.kn[at] *= soft[k]
        contacts.normal[at] *= soft[k]
        scales[joint, LONE_AREA] *= soft[k]
        scales[joint, KS] /= soft[k]  # along the face nothing gets softer


def book(old: JointArrays, new: JointArrays, known: np.ndarray, pressed: PressedLaw) -> None:
    """Add the elastic energy exchanged by new and lost points to the energy balance; new ones follow their gap and
    memory.
    """
    contacts, joints = new.contacts, new.joints
    fresh = ~known
    overlaps = (contacts.closure - contacts.gaps)[fresh]
    parameters = joints.law[joints.owners[fresh]]
    contacts.normal[fresh] = pressed(parameters, overlaps, contacts.memory[fresh], joints.kn[fresh])
    if len(joints.integrated):
        press_all(joints, contacts)
    contacts.shear[fresh & (contacts.normal == 0.0)] = 0.0
    change = _held(old) - _held(new)
    contacts.exchanged[:] += change, abs(change)


def _held(of: JointArrays) -> float:
    """Compute the elastic energy in the springs of all points [J]."""
    used = of.joints.kn > 0.0
    shear = of.contacts.shear[used]
    return 0.5 * float(of.pressed[used].sum() + ((shear**2).sum(axis=1) / of.joints.ks[used]).sum())


def bonds(model: Model, geometry: SpatialMotion) -> np.ndarray:
    """Test which joints have faces that lie on each other, (n_joints,) bool; not edges and corners on faces."""
    return along_each_other(model, geometry.kinds, geometry.faces)


def sink(geometry: SpatialMotion, joint: int, depth: float) -> None:
    """Do nothing: only profiles in the plane have a recess."""


def chains_of(model: Model, faces: Faces, corners: np.ndarray, properties: JointProperties) -> Caps | None:
    """Collect caps, which come back wherever the same faces meet again; None: all joints are plane."""
    return made_caps(model, faces, corners, properties)


def microrotations(joints: Joints, geometry: SpatialMotion) -> np.ndarray:
    """Compute the largest microrotation of each joint from the plane that it rests on at first [rad], (n_joints,)."""
    return geometry.slopes
