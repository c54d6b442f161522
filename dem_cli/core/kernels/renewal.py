"""Renewal of the contact points of joints in space that move: points that continue keep their slot, new ones get
memory.

Elastic slip and overlap are what a point remembers: where its area changes its forces go with it, and the energy that
is made or lost by that is added to the energy balance (Contacts.exchanged). A new point has the traction of the nearest
one before.
"""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.kernels.deformation.pressed_faces import fan_out, press_face
from dem_cli.core.kernels.jit import always_inline, kernel
from dem_cli.core.kernels.records import CROSSING, EDGES, FACES, FIXED_TO_B, INTEGRATED
from dem_cli.core.kernels.separation import minus3, row3
from dem_cli.core.kernels.spatial_features import NONE, carried3, feature_of, frame_of, on_cap, tangents3, turned_back3
from dem_cli.core.kernels.spatial_points import KN, KS, MOVED, SIZE, SPREAD, in_faces, of_edges, on_rim, torsion_now
from dem_cli.core.kernels.vec import axpy, dot

# Columns of SpatialMotion.numbers beyond area, share and arm: what a new point has from the nearest one before.
PRESSED, SLID_1, SLID_2 = 5, 6, 7  # overlap and elastic slip that its forces stand for [m]
PATH, CLOSURE = 8, 9  # slip path, closure taken back [m]
CLOSED = 10  # how far it has closed since forces were found [m]
LEFT = 11  # memory of the law, from here on ...
MOST_LEFT = 32  # ... so many numbers at most


@always_inline
def marks_of(geometry, bodies, joint, a):
    """Compute two corners of face b as block a sees them."""
    face = geometry.faces[joint, 1]
    first = geometry.face_starts[face]
    half = (geometry.face_starts[face + 1] - first) // 2
    centre = row3(bodies.positions, a)
    one = minus3(row3(bodies.corners, geometry.face_corners[first]), centre)
    two = minus3(row3(bodies.corners, geometry.face_corners[first + half]), centre)
    return turned_back3(bodies.turns, a, one), turned_back3(bodies.turns, a, two)


@always_inline
def is_due(geometry, bodies, joint, a):
    """Test whether one block has moved along or turned against the other since the joint was renewed."""
    one, two = marks_of(geometry, bodies, joint, a)
    m = geometry.markers
    far = MOVED * geometry.scales[joint, SIZE]
    first = minus3(one, (m[joint, 0], m[joint, 1], m[joint, 2]))
    second = minus3(two, (m[joint, 3], m[joint, 4], m[joint, 5]))
    return not (dot(first, first) <= far * far and dot(second, second) <= far * far)


@always_inline
def _energy(joints, contacts, point, whole):
    """Compute the elastic energy in the springs of a point [J]. whole: it has its share of a pressure that is
    integrated over the face.
    """
    if joints.kn[point] == 0.0:
        return 0.0
    normal, along = contacts.normal[point], contacts.shear[point, 0] ** 2 + contacts.shear[point, 1] ** 2
    if whole:
        return 0.5 * (along / joints.ks[point] - normal * contacts.gaps[point])
    return 0.5 * (normal * normal / joints.kn[point] + along / joints.ks[point])


@always_inline
def _place_of(bodies, b, kind, ends, row, share, arm):
    """Estimate the place of a point, in a slot or found. kind, ends[row], share, arm: as SpatialMotion has them."""
    if kind == FIXED_TO_B:
        return axpy(1.0, carried3(bodies, b, arm), row3(bodies.positions, b))
    start = row3(bodies.corners, ends[row, 0])
    if kind == CROSSING:
        return axpy(max(share, 0.0), minus3(row3(bodies.corners, ends[row, 1]), start), start)
    return start


@always_inline
def _put(geometry, vertices, point, k):
    """Store a found point in a slot."""
    found, labels, numbers = geometry.found, geometry.labels, geometry.numbers
    geometry.features[point], geometry.types[point] = labels[k, 0], labels[k, 1]
    for m in range(5):
        geometry.corners[point, m] = found[k, m]
    geometry.shares[point] = numbers[k, 1]
    for m in range(3):
        geometry.arms[point, m] = numbers[k, 2 + m]
    if labels[k, 1] != CROSSING:
        for m in range(2):
            if found[k, 2 * m + 1] != NONE:
                side = minus3(row3(vertices, found[k, 2 * m + 2]), row3(vertices, found[k, 2 * m + 1]))
                geometry.spans[point, m] = 1.0 / math.sqrt(dot(side, side))


@always_inline
def _resize(joints, contacts, geometry, joint, point, area):
    """Scale the stiffness of a point to its area; forces go with it."""
    kn, ks = area * geometry.scales[joint, KN], area * geometry.scales[joint, KS]
    if joints.kn[point] > 0.0:
        contacts.normal[point] *= kn / joints.kn[point]
        contacts.shear[point, 0] *= ks / joints.ks[point]
        contacts.shear[point, 1] *= ks / joints.ks[point]
    joints.kn[point], joints.ks[point] = kn, ks


@always_inline
def _forget(joints, contacts, geometry, point):
    """Clear a slot that has no point any more."""
    geometry.features[point], joints.kn[point], joints.ks[point] = NONE, 0.0, 0.0
    contacts.normal[point], contacts.gaps[point], contacts.slip[point], contacts.closure[point] = 0.0, 0.0, 0.0, 0.0
    contacts.shear[point, 0], contacts.shear[point, 1] = 0.0, 0.0
    for k in range(contacts.memory.shape[1]):
        contacts.memory[point, k] = 0.0


@always_inline
def _look_up(joints, geometry, bodies, joint, count, b):
    """Find the slot of each found point, into `taken`, and for new ones the nearest slot before, into `heirs`."""
    first, last, numbers = joints.starts[joint], joints.starts[joint + 1], geometry.numbers
    for k in range(count):
        geometry.taken[k], geometry.heirs[k] = NONE, NONE
        for point in range(first, last):
            if geometry.features[point] == geometry.labels[k, 0]:
                geometry.taken[k] = point
        if geometry.taken[k] != NONE:
            continue
        nearest = math.inf
        here = _place_of(
            bodies, b, geometry.labels[k, 1], geometry.found, k, numbers[k, 1],
            (numbers[k, 2], numbers[k, 3], numbers[k, 4]),
        )  # fmt: skip
        for point in range(first, last):
            if joints.kn[point] > 0.0:
                there = _place_of(
                    bodies, b, geometry.types[point], geometry.corners, point, geometry.shares[point],
                    row3(geometry.arms, point),
                )  # fmt: skip
                arm = minus3(there, here)
                if dot(arm, arm) < nearest:
                    geometry.heirs[k], nearest = point, dot(arm, arm)


@always_inline
def _bequeath(joints, contacts, geometry, bodies, joint, k, frame, remembers):
    """Copy to a new point from the nearest one: tractions over stiffness, slip, closure, memory of the law.

    Forces are those of the last step, so that the gap by which it has closed since then belongs to this one.
    """
    numbers, heir = geometry.numbers, geometry.heirs[k]
    for m in range(PRESSED, LEFT + remembers):
        numbers[k, m] = 0.0
    if heir == NONE:
        return
    numbers[k, CLOSED] = contacts.gaps[heir] - _gap_of(joints, geometry, bodies, joint, heir, frame)
    numbers[k, PRESSED] = contacts.normal[heir] / joints.kn[heir]
    numbers[k, SLID_1] = contacts.shear[heir, 0] / joints.ks[heir]
    numbers[k, SLID_2] = contacts.shear[heir, 1] / joints.ks[heir]
    numbers[k, PATH], numbers[k, CLOSURE] = contacts.slip[heir], contacts.closure[heir]
    for m in range(remembers):
        numbers[k, LEFT + m] = contacts.memory[heir, m]


@always_inline
def _gap_of(joints, geometry, bodies, joint, point, frame):
    """Compute the gap of a point where the blocks are now [m]."""
    a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
    _, gap, place = feature_of(geometry, bodies, joint, point, a, b, frame)
    return on_cap(geometry, bodies, joint, point, gap, place, frame)[0]


@always_inline
def _settle(joints, contacts, geometry, bodies, joint, point, k, frame, remembers, bonded, fresh):
    """Set up a new point in its slot: its own gap, and what the nearest one left it."""
    numbers = geometry.numbers
    _put(geometry, bodies.corners, point, k)
    _resize(joints, contacts, geometry, joint, point, numbers[k, 0])
    gap = _gap_of(joints, geometry, bodies, joint, point, frame)
    if fresh:
        contacts.gaps[point] = gap
        return
    gap += numbers[k, CLOSED]
    contacts.gaps[point] = gap
    contacts.slip[point], contacts.closure[point] = numbers[k, PATH], numbers[k, CLOSURE]
    for m in range(remembers):
        contacts.memory[point, m] = numbers[k, LEFT + m]
    deep = numbers[k, PRESSED] if bonded else max(numbers[k, CLOSURE] - gap, 0.0)
    contacts.normal[point] = joints.kn[point] * deep
    if deep != 0.0:
        contacts.shear[point, 0] = joints.ks[point] * numbers[k, SLID_1]
        contacts.shear[point, 1] = joints.ks[point] * numbers[k, SLID_2]


@always_inline
def _press_again(joints, contacts, geometry, bodies, joint, frame, along):
    """Compute normal forces of all points of an elastic face by the pressure on its present outline."""
    a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
    for point in range(joints.starts[joint], joints.starts[joint + 1]):
        if joints.kn[point] > 0.0:
            normal, _, place = feature_of(geometry, bodies, joint, point, a, b, frame)
            t1, t2 = tangents3(normal, along)
            for k in range(3):
                joints.points[point, k] = place[k]
                joints.frames[point, 3 + k], joints.frames[point, 6 + k] = t1[k], t2[k]
    fan_out(joints, joint)
    press_face(joints, contacts, joint)


@always_inline
def _found(geometry, bodies, joint, pair, frame, along, room):
    """Find the present contact points of a joint; returns how many."""
    out = (geometry.work, geometry.found, geometry.labels, geometry.numbers)
    if geometry.kinds[joint] == FACES:
        return in_faces(geometry, bodies, joint, pair, frame, along, out)
    if geometry.kinds[joint] == EDGES:
        return of_edges(geometry, joint, out)
    return on_rim(geometry, bodies, joint, frame, room, out)


@kernel
def _renew(joint, joints, geometry, contacts, bodies, remembers, bonded, fresh):
    """Find the contact points of a joint anew; returns how many there are.

    remembers: numbers of memory that belong to the law; fresh: nothing acts yet, and no energy is made.
    """
    a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
    frame, along = frame_of(geometry, bodies, joint, a, b)
    first, last = joints.starts[joint], joints.starts[joint + 1]
    count = min(_found(geometry, bodies, joint, (a, b), frame, along, last - first), last - first)
    if geometry.scales[joint, SPREAD] > 0.0:
        joints.torsion[joint] = torsion_now(geometry, joint, count)
    before, after = 0.0, 0.0
    whole = joints.integrated.shape[0] > 0 and joints.integrated[joint] == INTEGRATED
    for point in range(first, last):
        before += _energy(joints, contacts, point, whole)
    _look_up(joints, geometry, bodies, joint, count, b)
    for k in range(count):
        if geometry.taken[k] == NONE:
            _bequeath(joints, contacts, geometry, bodies, joint, k, frame, remembers)
    for point in range(first, last):
        stays = False
        for k in range(count):
            stays = stays or geometry.taken[k] == point
        if not stays:
            _forget(joints, contacts, geometry, point)
    free = first
    for k in range(count):
        if geometry.taken[k] != NONE:
            _put(geometry, bodies.corners, geometry.taken[k], k)
            _resize(joints, contacts, geometry, joint, geometry.taken[k], geometry.numbers[k, 0])
    for k in range(count):
        if geometry.taken[k] == NONE:
            while geometry.features[free] != NONE:
                free += 1
            _settle(joints, contacts, geometry, bodies, joint, free, k, frame, remembers, bonded, fresh)
    if whole and not fresh:
        _press_again(joints, contacts, geometry, bodies, joint, frame, along)
    for point in range(first, last):
        after += _energy(joints, contacts, point, whole)
    if not fresh:
        contacts.exchanged[0] += before - after
        contacts.exchanged[1] += abs(before - after)
    one, two = marks_of(geometry, bodies, joint, a)
    for m in range(3):
        geometry.markers[joint, m], geometry.markers[joint, 3 + m] = one[m], two[m]
    return count


@always_inline
def renew(joint, joints, geometry, contacts, bodies, remembers, bonded, fresh):
    """Find the contact points of a joint anew, for the loops that are made for a law; returns how many. The cache knows
    these loops by all that they name, and a kernel has another name in each process; a plain function has not. One
    kind of integer: it is compiled once.
    """
    return _renew(np.int64(joint), joints, geometry, contacts, bodies, remembers, bonded, fresh)
