"""The one loop over contacts: kinematics, law, forces on the blocks, friction work.

`make_contact_forces(geometry, law)` closes over two plain functions:

geometry(joints, bodies, contacts, joint, point, closing, like) -> (frame, arm_a, arm_b)
    place of a contact point; it may also set contacts.gaps[point]
law(gap, slide, shear, kn, ks, parameters, joint, memory, point) -> (normal, shear, slipped)
    see laws/law.py
"""

from __future__ import annotations

from collections.abc import Callable

from dem_cli.kernels.jit import inline
from dem_cli.kernels.vec import add_at, along_tangents, axpy, compose, dot, load, moment, norm, spin, store


def make_contact_forces(prepare: Callable, place: Callable, law: Callable, integrates_gap: bool) -> Callable:
    """The loop for one kind of geometry and one law, as a plain function for `kernels.advance`.

    prepare(joints, bodies, contacts, joint, like) -> (touches, shared)
        what the points of a joint share; touches is False where none can carry force
    place(joints, bodies, contacts, joint, point, shared, like) -> (frame, arm_a, arm_b, gap)
        one contact point; with `integrates_gap` the gap is the last one, before this step's closing
    """

    @inline
    def contact_forces(joints, contacts, bodies, dt, like, like_rotation):
        """Forces of all joints on their blocks (added to bodies.forces); returns the friction work."""
        velocities, forces = bodies.velocities, bodies.forces
        d = len(like)
        friction_work = 0.0
        for joint in range(joints.blocks.shape[0]):
            touches, shared = prepare(joints, bodies, contacts, joint, like)
            if not touches:
                continue
            a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
            velocity_a, spin_a = load(velocities, a, 0, like), load(velocities, a, d, like_rotation)
            velocity_b, spin_b = load(velocities, b, 0, like), load(velocities, b, d, like_rotation)
            relative = axpy(-1.0, velocity_a, velocity_b)
            for point in range(joints.starts[joint], joints.starts[joint + 1]):
                frame, arm_a, arm_b, gap = place(joints, bodies, contacts, joint, point, shared, like)
                jump = axpy(1.0, axpy(-1.0, spin(spin_a, arm_a), spin(spin_b, arm_b)), relative)
                if integrates_gap:
                    gap += dt * dot(frame[0], jump)
                contacts.gaps[point] = gap
                if gap >= 0.0 and contacts.normal[point] == 0.0:
                    continue
                slide = along_tangents(frame, jump)
                slide = axpy(dt - 1.0, slide, slide)
                old = load(contacts.shear, point, 0, slide)
                ks = joints.ks[point]
                normal, shear, slipped = law(
                    gap, slide, old, joints.kn[point], ks, joints.law, joint, contacts.memory, point
                )
                if slipped:
                    # Mean of the forces really applied; the plastic part of the slide is slide + Δs/ks.
                    plastic = axpy(1.0 / ks, axpy(-1.0, old, shear), slide)
                    friction_work -= 0.5 * (dot(old, plastic) + dot(shear, plastic))
                    if normal > 0.0:
                        contacts.slip[point] += norm(plastic)
                contacts.normal[point] = normal
                store(contacts.shear, point, 0, shear)
                force = compose(frame, normal, shear)
                add_at(forces, a, 0, force, -1.0)
                add_at(forces, b, 0, force, 1.0)
                add_at(forces, a, d, moment(arm_a, force), -1.0)
                add_at(forces, b, d, moment(arm_b, force), 1.0)
        return friction_work

    return contact_forces
