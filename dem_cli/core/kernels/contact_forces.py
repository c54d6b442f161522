"""Contact forces of joints in fixed geometry, 2D and 3D: relative motion, law, forces on the blocks, work lost.

Joint by joint: the motion of b against a at one anchor and its spin are worked out once in the frame of the joint; a
point adds its place in the joint plane. Forces add up in the frame and are turned into space once. The gap is
integrated from the closing velocity (exact for constant arms, so that the joint stiffness drops out of a failure load).

In space friction acts nearer to the centre of pressure c of the step before than its point r, at c + β (r − c)
(contact/corner_forces.py). Slides there are linear in r, and so is the moment: one slide, one spin and one moment of
the joint know of β, and no point does.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.contact_point import make_press, push_apart, swing
from dem_cli.core.kernels.deformation.joint_spread import (
    add_leverage,
    add_spread_dyads,
    no_leverage,
    spread_at,
    spread_of,
)
from dem_cli.core.kernels.deformation.matrices import load_matrix, times
from dem_cli.core.kernels.deformation.pressed_faces import share_pressure
from dem_cli.core.kernels.deformation.quadratic import apart_at, bend_apart, line_apart, with_force
from dem_cli.core.kernels.deformation.uniform_strain import stretch_apart
from dem_cli.core.kernels.jit import inline, named
from dem_cli.core.kernels.joint_plane import (
    add_moment_at,
    centre_of,
    drawn_in,
    moment,
    opening_at,
    seen_from,
    seen_outside,
    sliding_at,
    sweep,
    torsion_of,
    torsion_share,
)
from dem_cli.core.kernels.records import INTEGRATED
from dem_cli.core.kernels.vec import axpy, components, compose, load, load_frame, scale


@inline
def pressed_at(places, normals, first, last, like, like_rotation):
    """Compute the centre of pressure of the points from first to last of a joint, in its plane."""
    push, twist = 0.0, scale(0.0, like_rotation)
    for p in range(first, last):
        point = np.uint64(p)
        push += normals[point]
        twist = add_moment_at(load(places, point, 0, like[1:]), normals[point], scale(0.0, like[1:]), twist)
    return centre_of(push, twist)


def make_contact_forces(
    law: Callable, bonded: bool = False, strains: bool = False, bends: bool = False, elastic: bool = False
) -> Callable:
    """Make the contact loop for one law (laws/law.py), as a plain function that `make_advance` closes over.

    strains: blocks deform (kernels/deformation); bends: in quadratic modes as well, 2D;
    elastic: there are faces over which pressure is integrated (kernels/deformation/pressed_faces.py).
    """
    press = make_press(law, bonded)

    @inline
    def contact_forces(joints, geometry, contacts, bodies, dt, like, like_rotation):
        """Add the forces of all joints on their blocks to `forces`; returns the work lost [J]."""
        blocks, starts, axes, arms, places = joints.blocks, joints.starts, joints.axes, joints.arms, joints.places
        gaps, normals, velocities, forces = contacts.gaps, contacts.normal, bodies.velocities, bodies.forces
        stretchings, d = bodies.stretchings, len(like)
        lost = 0.0
        for number in range(blocks.shape[0]):
            joint = np.uint64(number)
            a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
            frame = load_frame(axes, joint, like)
            arm_a, arm_b = load(arms, joint, 0, like), load(arms, joint, d, like)
            spin_a = load(velocities, a, d, like_rotation)
            spin_b = load(velocities, b, d, like_rotation)
            moved = axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like))
            moved = axpy(1.0, axpy(-1.0, sweep(spin_a, arm_a), sweep(spin_b, arm_b)), moved)
            if strains:
                gradient_a, gradient_b = load_matrix(stretchings, a, like), load_matrix(stretchings, b, like)
                moved = axpy(1.0, axpy(-1.0, times(gradient_a, arm_a), times(gradient_b, arm_b)), moved)
                spread = spread_of(frame, gradient_a, gradient_b, dt)
                leverage = no_leverage(like)
            if bends:
                line = line_apart(bodies.bending, bodies.turns, a, b, arm_a, arm_b, frame[1])
                nothing = scale(0.0, like)
                sums = (nothing, nothing, nothing)
            opens, slides = components(frame, scale(dt, moved))
            spin = seen_from(frame, scale(dt, axpy(-1.0, spin_a, spin_b)))
            if elastic:
                for p in range(starts[joint], starts[number + 1]):
                    point = np.uint64(p)
                    place = load(places, point, 0, like[1:])
                    opened = opens + opening_at(spin, place)
                    if strains:
                        opened += spread_at(spread, place)[0]
                    if bends:
                        opened += dt * apart_at(line, place[0], frame)[0]
                    gaps[point] += opened
                share_pressure(joints, contacts, number)
            whole = elastic and joints.integrated[joint] == INTEGRATED
            share = torsion_share(joints.torsion, joint, like)
            centre = scale(0.0, like[1:])
            if share != 1.0:
                centre = pressed_at(places, normals, starts[joint], starts[number + 1], like, like_rotation)
            slides, spin = drawn_in(slides, spin, centre, share)
            push, rub, twist = 0.0, scale(0.0, like[1:]), scale(0.0, like_rotation)
            for p in range(starts[joint], starts[number + 1]):
                point = np.uint64(p)
                place = load(places, point, 0, like[1:])
                opened = opens + opening_at(spin, place)
                if strains:
                    spread_open, spread_along = spread_at(spread, place)
                    opened += spread_open
                if bends:
                    bent_open, bent_along = apart_at(line, place[0], frame)
                    opened += dt * bent_open
                if elastic:
                    gap = contacts.lumped[point]
                else:
                    gap = gaps[point] + opened
                    gaps[point] = gap
                if not bonded and gap >= 0.0 and normals[point] == 0.0:
                    continue
                slide = sliding_at(slides, spin, place)
                if strains:
                    slide = axpy(1.0, spread_along, slide)
                if bends:
                    slide = (slide[0] + dt * bent_along,)
                pressed = contacts.normal[point]
                normal, shear, work = press(gap, opened, slide, joints, contacts, joint, point)
                if whole:
                    contacts.jolts[0] += swing(gaps[point] - opened, gaps[point], pressed, normal)
                lost += work
                push += normal
                rub = axpy(1.0, shear, rub)
                twist = add_moment_at(place, normal, shear, twist)
                if strains:
                    leverage = add_leverage(leverage, place, normal, shear)
                if bends:
                    sums = with_force(sums, place[0], compose(frame, normal, shear, scale(0.0, like)))
            twist = torsion_of(twist, rub, centre, share)
            force, couple = compose(frame, push, rub, scale(0.0, like)), seen_outside(frame, twist)
            torque_a, torque_b = axpy(1.0, moment(arm_a, force), couple), axpy(1.0, moment(arm_b, force), couple)
            push_apart(forces, a, b, force, torque_a, torque_b)
            if strains:
                stretch_apart(bodies.dyads, a, b, force, arm_a, arm_b)
                add_spread_dyads(bodies.dyads, a, b, frame, leverage)
            if bends:
                bend_apart(bodies.triads, bodies.turns, a, b, arm_a, arm_b, frame[1], sums)
        return lost

    return named(contact_forces, law, "bonded" if bonded else "", "strains" if strains else "",
                 *["bends"] * bends, *["elastic"] * elastic)  # fmt: skip
