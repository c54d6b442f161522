"""Contact forces in moving geometry, 3D: points renewed where they are due, gaps first, then forces.

Each point has the normal of its feature (spatial_features.py); shear is counted along a direction fixed in block a, so
that two blocks that turn together keep their forces. In time histories a joint holds normals and places of its points
while its blocks hardly turn or move against each other: gaps grow by the rate of opening then, as slips do.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.contact_point import jolt, make_press, meeting, push_apart, swing
from dem_cli.core.kernels.deformation.matrices import load_matrix, times
from dem_cli.core.kernels.deformation.pressed_faces import fan_out, share_pressure
from dem_cli.core.kernels.deformation.uniform_strain import stretch_apart
from dem_cli.core.kernels.jit import always_inline, inline, kernel, named
from dem_cli.core.kernels.joint_plane import LEAST_PUSH, moment, sweep
from dem_cli.core.kernels.records import FACES, INTEGRATED
from dem_cli.core.kernels.renewal import MOST_LEFT, is_due, renew
from dem_cli.core.kernels.separation import minus3, row3
from dem_cli.core.kernels.spatial_features import feature_of, frame_of, on_cap, tangents3
from dem_cli.core.kernels.spatial_points import SIZE
from dem_cli.core.kernels.vec import axpy, compose, dot, load, load_frame, scale, store

HOLDS = 1e-3  # sine of the angle between faces up to which a joint may hold its geometry
SHIFT = 1e-5  # of its size: by so much its blocks may move against each other meanwhile


@kernel
def _measure(joint, joints, geometry, contacts, bodies, remembers, bonded, capped, holds):
    """Compute frames, places and gaps of the points of a joint where its blocks are now; renewed first where that is
    due.

    capped: joints may have caps; holds: what is found may be held from now on.
    """
    frames, places, gaps, normals = joints.frames, joints.points, contacts.gaps, contacts.normal
    a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
    first, last = joints.starts[joint], joints.starts[joint + 1]
    if is_due(geometry, bodies, joint, a):
        loaded = False
        for point in range(first, last):
            loaded = loaded or normals[point] != 0.0
        if renew(joint, joints, geometry, contacts, bodies, remembers, bonded, False) == 0 and loaded:
            contacts.stale[joint] = 1
            contacts.stale[-1] = 1
    frame, along = frame_of(geometry, bodies, joint, a, b)
    for point in range(first, last):
        if joints.kn[point] == 0.0:
            continue
        normal, gap, place = feature_of(geometry, bodies, joint, point, a, b, frame)
        if capped:
            gap, place = on_cap(geometry, bodies, joint, point, gap, place, frame)
        geometry.opened[point] = gap - gaps[point]
        gaps[point] = gap
        t1, t2 = tangents3(normal, along)
        for k in range(3):
            frames[point, k], frames[point, 3 + k], frames[point, 6 + k] = normal[k], t1[k], t2[k]
            places[point, k] = place[k]
    tilt, apart = axpy(-1.0, frame[0], frame[1]), minus3(row3(bodies.positions, a), row3(bodies.positions, b))
    plain = geometry.kinds[joint] == FACES and geometry.rises[joint] == 0.0 and dot(tilt, tilt) <= HOLDS * HOLDS
    for k in range(3):
        geometry.apart[joint, k] = apart[k] if holds and plain else math.nan


@always_inline
def measure(joint, joints, geometry, contacts, bodies, remembers, bonded, capped, holds):
    """Compute frames, places and gaps of the points of a joint, for the loops that are made for a law (renewal.renew
    says why).
    """
    _measure(np.int64(joint), joints, geometry, contacts, bodies, remembers, bonded, capped, holds)


@always_inline
def _keeps(geometry, bodies, joint, a, b):
    """Test whether the blocks of a joint have hardly moved against each other, nor turned, since it was measured."""
    if bodies.turned[a] != 0 or bodies.turned[b] != 0:
        return False
    apart = minus3(row3(bodies.positions, a), row3(bodies.positions, b))
    moved, far = minus3(apart, row3(geometry.apart, joint)), SHIFT * geometry.scales[joint, SIZE]
    return dot(moved, moved) <= far * far


@inline
def pressed_in_space(places, normals, stiffness, first, last, like):
    """Centre of pressure of the points from first to last of a joint [m]; where none press, that of an even one."""
    push, centre = 0.0, scale(0.0, like)
    for p in range(first, last):
        point = np.uint64(p)
        push += normals[point]
        centre = axpy(normals[point], load(places, point, 0, like), centre)
    if push > LEAST_PUSH:
        return scale(1.0 / push, centre)
    push, centre = LEAST_PUSH, scale(0.0, like)
    for p in range(first, last):
        point = np.uint64(p)
        push += stiffness[point]
        centre = axpy(stiffness[point], load(places, point, 0, like), centre)
    return scale(1.0 / push, centre)


def make_spatial_forces(
    law: Callable,
    bonded: bool = False,
    meets: bool = False,
    rigid: bool = False,
    remembers: int = 0,
    capped: bool = False,
    strains: bool = False,
    elastic: bool = False,
) -> Callable:
    """Make the contact loop for one law (laws/law.py), as a plain function that `make_advance` closes over.

    meets: in time histories; geometry is held there while blocks hardly move. rigid: as in planar_forces.py.
    remembers: numbers of a point's memory that belong to the law. capped: joints may have caps. strains: blocks deform
    (kernels/deformation); their faces stay plane, and geometry is measured in each step. elastic: there are faces over
    which pressure is integrated (kernels/deformation/pressed_faces.py), in statics.
    """
    assert remembers <= MOST_LEFT
    assert not (elastic and meets)
    press, holds, books = make_press(law, bonded), meets and not strains, rigid and not bonded

    @inline
    def spatial_forces(joints, geometry, contacts, bodies, dt, like, like_rotation):
        """Add the forces of all joints on their blocks to `forces`; returns the friction work [J]."""
        blocks, starts, stiffness = joints.blocks, joints.starts, joints.kn
        frames, places = joints.frames, joints.points
        gaps, normals, closures = contacts.gaps, contacts.normal, contacts.closure
        velocities, forces, positions = bodies.velocities, bodies.forces, bodies.positions
        stretchings, d = bodies.stretchings, len(like)
        lost = jolts = 0.0
        for number in range(blocks.shape[0]):
            joint = np.uint64(number)
            a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
            held = holds and _keeps(geometry, bodies, joint, a, b)
            if not held:
                measure(number, joints, geometry, contacts, bodies, remembers, bonded, capped, holds)
            spin_a, spin_b = load(velocities, a, d, like_rotation), load(velocities, b, d, like_rotation)
            va = load(velocities, a, 0, like)
            relative = axpy(-1.0, va, load(velocities, b, 0, like))
            xa, xb = load(positions, a, 0, like), load(positions, b, 0, like)
            force, torque_a, torque_b = scale(0.0, like), scale(0.0, like_rotation), scale(0.0, like_rotation)
            if strains:
                gradient_a, gradient_b = load_matrix(stretchings, a, like), load_matrix(stretchings, b, like)
            whole = elastic and joints.integrated[joint] == INTEGRATED
            if whole:
                fan_out(joints, number)
                share_pressure(joints, contacts, number)
            share, rub, middle, centre = joints.torsion[joint], scale(0.0, like), scale(0.0, like), xa
            if share != 1.0:
                centre = pressed_in_space(places, normals, stiffness, starts[joint], starts[number + 1], like)
                arm_a, arm_b = axpy(-1.0, xa, centre), axpy(-1.0, xb, centre)
                middle = axpy(1.0, axpy(-1.0, sweep(spin_a, arm_a), sweep(spin_b, arm_b)), relative)
                middle = scale(1.0 - share, middle)
            n_loaded, n_touch = 0, 0
            for p in range(starts[joint], starts[number + 1]):
                point = np.uint64(p)
                if stiffness[point] == 0.0:
                    continue
                place = load(places, point, 0, like)
                if held:
                    place = axpy(dt, va, place)
                    store(places, point, 0, place)
                frame = load_frame(frames, point, like)
                arm_a, arm_b = axpy(-1.0, xa, place), axpy(-1.0, xb, place)
                moved = axpy(1.0, axpy(-1.0, sweep(spin_a, arm_a), sweep(spin_b, arm_b)), relative)
                if strains:
                    moved = axpy(1.0, axpy(-1.0, times(gradient_a, arm_a), times(gradient_b, arm_b)), moved)
                if held:
                    opened = dt * dot(moved, frame[0])
                    gap = gaps[point] + opened
                    gaps[point] = gap
                else:
                    opened, gap = geometry.opened[point], gaps[point]
                if whole:
                    gap = contacts.lumped[point]
                elif meets and not bonded:
                    gap = meeting(gap, opened)
                if rigid and not whole:
                    gap -= closures[point]
                if not bonded and gap >= 0.0 and normals[point] == 0.0:
                    continue
                n_loaded += 1
                rubs, drop = moved, 0.0
                if whole and share != 1.0:  # in the plane through the centre of pressure: a gaping face has no lever
                    drop = dot(axpy(-1.0, centre, place), frame[0])
                    rubs = axpy(drop, axpy(-1.0, sweep(spin_b, frame[0]), sweep(spin_a, frame[0])), moved)
                slid = axpy(share, rubs, middle)
                slide = (dt * dot(slid, frame[1]), dt * dot(slid, frame[2]))
                before = normals[point]
                pressed, shear, work = press(gap, opened, slide, joints, contacts, joint, point)
                if books and whole:
                    jolts += swing(gaps[point] - opened, gaps[point], before, pressed)
                elif books:
                    jolts += jolt(gap, opened, before, pressed)
                n_touch += 1 if pressed != 0.0 else 0
                lost += work
                pushed = compose(frame, pressed, shear, scale(0.0, like))
                rubbed = axpy(shear[1], frame[2], scale(shear[0], frame[1]))
                turning = axpy(share - 1.0, rubbed, pushed)
                force, rub = axpy(1.0, pushed, force), axpy(1.0, rubbed, rub)
                torque_a = axpy(1.0, moment(arm_a, turning), torque_a)
                torque_b = axpy(1.0, moment(arm_b, turning), torque_b)
                if whole and share != 1.0:
                    tilt = moment(frame[0], rubbed)
                    torque_a, torque_b = axpy(-share * drop, tilt, torque_a), axpy(-share * drop, tilt, torque_b)
                if strains:
                    stretch_apart(bodies.dyads, a, b, pushed, arm_a, arm_b)
            if meets:
                joints.held[joint] = n_touch if held else -1 - n_touch
            if share != 1.0 and n_loaded > 0:
                rub = scale(1.0 - share, rub)
                torque_a = axpy(1.0, moment(axpy(-1.0, xa, centre), rub), torque_a)
                torque_b = axpy(1.0, moment(axpy(-1.0, xb, centre), rub), torque_b)
            if n_loaded > 0:
                push_apart(forces, a, b, force, torque_a, torque_b)
        if books:
            contacts.jolts[0] += jolts
        return lost

    flags = {"bonded": bonded, "meets": meets, "rigid": rigid, "capped": capped}
    flags |= {"strains": strains, "elastic": elastic}
    return named(spatial_forces, law, *(name if on else "" for name, on in flags.items()), str(remembers))


@kernel
def renew_fresh(joints, geometry, contacts, bodies):
    """Find contact points of joints that have none yet: nothing acts on them."""
    for joint in range(joints.blocks.shape[0]):
        renew(joint, joints, geometry, contacts, bodies, 0, False, True)


@kernel
def measure_spatial(joints, geometry, contacts, bodies):
    """Compute frames, levers, places and gaps of all points where the blocks are now, for detection and records."""
    frames, levers, places = joints.frames, joints.levers, joints.points
    for joint in range(joints.blocks.shape[0]):
        a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
        frame, along = frame_of(geometry, bodies, joint, a, b)
        xa, xb = load(bodies.positions, a, 0, (0.0, 0.0, 0.0)), load(bodies.positions, b, 0, (0.0, 0.0, 0.0))
        for point in range(joints.starts[joint], joints.starts[joint + 1]):
            if joints.kn[point] == 0.0:
                frames[point, :], levers[point, :], places[point, :] = 0.0, 0.0, 0.0
                continue
            normal, gap, place = feature_of(geometry, bodies, joint, point, a, b, frame)
            contacts.gaps[point], place = on_cap(geometry, bodies, joint, point, gap, place, frame)
            t1, t2 = tangents3(normal, along)
            arm_a, arm_b = axpy(-1.0, xa, place), axpy(-1.0, xb, place)
            k = 0
            for axis in (normal, t1, t2):
                on_a, on_b = moment(arm_a, axis), moment(arm_b, axis)
                for m in range(3):
                    frames[point, k], levers[point, k], levers[point, 9 + k] = axis[m], on_a[m], on_b[m]
                    k += 1
            for m in range(3):
                places[point, m] = place[m]
