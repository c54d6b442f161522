"""Forces at a contact point for all loops: law, forces, slip path, work lost, forces on the blocks. For all loops."""

from __future__ import annotations

from collections.abc import Callable

from dem_cli.core.kernels.jit import always_inline, inline, named
from dem_cli.core.kernels.vec import add_at, add_torques, axpy, compose, dot, load, norm, store


@always_inline
def meeting(gap, opened):
    """Correct the gap of a spring in the steps in which it closes or opens, in time histories, so that energy is kept.

    With overlaps x before, y now and z next the leapfrog does the work f (z − x)/2, and a closed spring holds k y z/2
    between two steps. Nothing is gained or lost on the way from an open point (x < 0) where f (z − x) = k y z; with
    z = 2 y − x that is f = k y (y + d)/2d, d = y − x, and the same on the way out. Exact but for what the speed changes
    within the step.
    """
    step = abs(opened)
    if gap >= 0.0 or gap <= -step:
        return gap
    return 0.5 * gap * (step - gap) / step


@always_inline
def jolt(gap, opened, before, after):
    """Compute the work of a step that closes a point beyond what its spring stores [J]; negative where one opens it.

    gap: after the step [m]; before, after: normal forces [N]. Work is the mean of both forces × the way between them,
    gap and all, while a spring knows but its own part of the way: what a point falls through counts half its force.
    """
    if before < 0.0 or after < 0.0 or before * after != 0.0:
        return 0.0
    return 0.5 * (after * max(gap - opened, 0.0) - before * max(gap, 0.0))


@always_inline
def swing(before, gap, pressed, normal):
    """Compute the work of a step at a point of an elastic face beyond what its pressure stores [J]: see `jolt`.

    before, gap: its gaps before and after the step [m]; pressed, normal: its forces [N]. Work is the mean of both
    forces × the way between; summed over the face ½ Σ F (−g) is stored (kernels/deformation/pressed_faces.py).
    """
    return 0.5 * (normal * before - pressed * gap)


@always_inline
def plastic_slide(old, shear, slide, ks):
    """Compute the plastic part of a slide, which the shear spring did not take up: slide + Δs/ks [m]."""
    return axpy(1.0 / ks, axpy(-1.0, old, shear), slide)


@always_inline
def friction_work(old, shear, plastic):
    """Compute the work lost by friction: mean of the forces really applied × plastic slide [J]."""
    return -0.5 * (dot(old, plastic) + dot(shear, plastic))


def make_press(law: Callable, bonded: bool = False) -> Callable:
    """Make the function that computes the forces at one point that touches or did, for the contact loops.

    bonded: the law carries tension or deforms for good across the joint, so that normal springs lose work too.
    """

    @always_inline
    def press(gap, opened, slide, joints, contacts, joint, point):
        """Compute normal and shear force of a point [N], kept in `contacts` with its slip path, and the work lost there
        [J].

        opened, slide: by how much b moved against a in this step, across and along the joint [m].
        """
        normals, shears, slips = contacts.normal, contacts.shear, contacts.slip
        kn, ks, pressed, old = joints.kn[point], joints.ks[point], normals[point], load(shears, point, 0, slide)
        normal, shear, slipped = law(gap, slide, old, kn, ks, joints.law, joint, contacts.memory, point)
        lost = 0.0
        if slipped:
            plastic = plastic_slide(old, shear, slide, ks)
            if normal > 0.0:
                slips[point] += norm(plastic)
            lost = friction_work(old, shear, plastic)
            if bonded and not (pressed >= 0.0 and normal >= 0.0 and pressed * normal == 0.0):
                # The same across the joint: work done on the spring, less what it stores; meeting or parting is free.
                lost -= 0.5 * (pressed + normal) * (opened + (normal - pressed) / kn)
        normals[point] = normal
        store(shears, point, 0, shear)
        return normal, shear, lost

    return named(press, law, "bonded" if bonded else "")


@always_inline
def add_force(frame, levers_a, levers_b, normal, shear, force, torque_a, torque_b):
    """Add force and moments of a contact point to those of its joint; the point has levers of its own."""
    return (
        compose(frame, normal, shear, force),
        add_torques(levers_a, normal, shear, torque_a),
        add_torques(levers_b, normal, shear, torque_b),
    )


@inline
def push_apart(forces, a, b, force, torque_a, torque_b):
    """Apply force and moments of a joint onto block b, and against block a."""
    add_at(forces, a, 0, force, -1.0)
    add_at(forces, b, 0, force, 1.0)
    add_at(forces, a, len(force), torque_a, -1.0)
    add_at(forces, b, len(force), torque_b, 1.0)
