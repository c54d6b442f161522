"""The one loop over contact points: relative motion, law, forces on the blocks, friction work.

The same in 2D and 3D and for both kinematics: with fixed geometry the gap is integrated from the
closing velocity (exact for constant levers, so that the joint stiffness drops out of a failure load);
with moving geometry frames, levers and gaps are placed before this loop, or in it (planar_forces.py).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dem_cli.kernels.jit import always_inline, inline, named
from dem_cli.kernels.vec import (
    add_at,
    add_torques,
    axpy,
    components,
    compose,
    dot,
    load,
    load_frame,
    load_levers,
    norm,
    scale,
    store,
    turn,
)


@always_inline
def meeting(gap, opened):
    """The gap that a point shows its spring in the steps in which it closes or opens, in time histories.

    With overlaps x before, y now and z next the leapfrog does the work f (z − x)/2, and a closed spring holds k y z/2
    between two steps. Nothing is gained or lost on the way from an open point (x < 0) where f (z − x) = k y z; with
    z = 2 y − x that is f = k y (y + d)/2d, d = y − x, and the same on the way out. Exact but for what the speed changes
    within the step.
    """
    step = abs(opened)
    if gap >= 0.0 or gap <= -step:
        return gap
    return 0.5 * gap * (step - gap) / step


def make_press(law: Callable, bonded: bool = False) -> Callable:
    """What happens at one point that touches or did: law and lost work, as a function for the loops.

    bonded: the law carries tension or deforms for good across the joint, so that normal springs lose work too.
    """

    @always_inline
    def press(
        gap, opened, pressed, frame, levers_a, levers_b, relative, spin_a, spin_b, dt, old, kn, ks,
        parameters, joint, memory, point,
    ):  # fmt: skip
        """One point: (normal, shear force, slip path, work lost) [N, N, m, J].

        opened: by how much the gap grew in this step [m]; pressed, old: normal and shear force before it [N].
        """
        slid_a, slid_b = turn(levers_a, spin_a)[1], turn(levers_b, spin_b)[1]
        slide = scale(dt, axpy(1.0, components(frame, relative)[1], axpy(-1.0, slid_a, slid_b)))
        normal, shear, slipped = law(gap, slide, old, kn, ks, parameters, joint, memory, point)
        if not slipped:
            return normal, shear, 0.0, 0.0
        # Mean of the forces really applied; the plastic part of the slide is slide + Δs/ks.
        plastic = axpy(1.0 / ks, axpy(-1.0, old, shear), slide)
        path = norm(plastic) if normal > 0.0 else 0.0
        lost = -0.5 * (dot(old, plastic) + dot(shear, plastic))
        if bonded and not (pressed >= 0.0 and normal >= 0.0 and pressed * normal == 0.0):
            # The same across the joint: work done on the spring, less what it stores; to meet or part costs nothing.
            lost -= 0.5 * (pressed + normal) * (opened + (normal - pressed) / kn)
        return normal, shear, path, lost

    return named(press, law, "bonded" if bonded else "")


def make_contact_forces(law: Callable, integrates_gap: bool, bonded: bool = False) -> Callable:
    """The loop for one law (laws/law.py), as a plain function that `make_advance` closes over."""
    press = make_press(law, bonded)

    @inline
    def contact_forces(joints, contacts, velocities, forces, dt, like, like_rotation):
        """Adds the forces of all joints on their blocks to `forces`; returns the friction work [J]."""
        blocks, starts, frames, levers = joints.blocks, joints.starts, joints.frames, joints.levers
        kns, kss, parameters = joints.kn, joints.ks, joints.law
        gaps, shears, normals = contacts.gaps, contacts.shear, contacts.normal
        slips, memory = contacts.slip, contacts.memory
        d = len(like)
        friction_work = 0.0
        for number in range(blocks.shape[0]):
            joint = np.uint64(number)
            a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
            spin_a = load(velocities, a, d, like_rotation)
            spin_b = load(velocities, b, d, like_rotation)
            relative = axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like))
            force, torque_a, torque_b = scale(0.0, like), scale(0.0, like_rotation), scale(0.0, like_rotation)
            loaded = False
            for p in range(starts[joint], starts[number + 1]):
                point = np.uint64(p)
                gap = before = gaps[point]
                if not bonded and not integrates_gap and gap >= 0.0 and normals[point] == 0.0:
                    continue
                frame = load_frame(frames, point, like)
                levers_a, levers_b = load_levers(levers, point, 0, like), load_levers(levers, point, 1, like)
                if integrates_gap:
                    spun_a, spun_b = dot(levers_a[0], spin_a), dot(levers_b[0], spin_b)
                    gap += dt * (dot(frame[0], relative) + spun_b - spun_a)
                    gaps[point] = gap
                    if not bonded and gap >= 0.0 and normals[point] == 0.0:
                        continue
                loaded = True
                normal, shear, path, work = press(
                    gap, gap - before, normals[point], frame, levers_a, levers_b, relative, spin_a, spin_b, dt,
                    load(shears, point, 0, like[1:]), kns[point], kss[point], parameters, joint, memory, point,
                )  # fmt: skip
                if path > 0.0:
                    slips[point] += path
                friction_work += work
                normals[point] = normal
                store(shears, point, 0, shear)
                force = compose(frame, normal, shear, force)
                torque_a = add_torques(levers_a, normal, shear, torque_a)
                torque_b = add_torques(levers_b, normal, shear, torque_b)
            if loaded:
                add_at(forces, a, 0, force, -1.0)
                add_at(forces, b, 0, force, 1.0)
                add_at(forces, a, d, torque_a, -1.0)
                add_at(forces, b, d, torque_b, 1.0)
        return friction_work

    return named(contact_forces, law, "opening" if integrates_gap else "", "bonded" if bonded else "")


def of_bodies(loop: Callable) -> Callable:
    """The same loop, called with the bodies."""

    @inline
    def bodies_forces(joints, geometry, contacts, bodies, dt, like, like_rotation):
        return loop(joints, contacts, bodies.velocities, bodies.forces, dt, like, like_rotation)

    return named(bodies_forces, loop)
