"""Contact forces in moving geometry, 2D: gaps first, everything else only where blocks touch.

Each end of a joint has a frame of its own. Frames and levers stay in registers: the arrays `frames`, `levers` and
`points` of the joints are not kept up to date by it; `measure` does that where somebody wants to read them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.contact_point import add_force, jolt, make_press, meeting, push_apart, swing
from dem_cli.core.kernels.deformation.joint_spread import spread_between
from dem_cli.core.kernels.deformation.matrices import load_matrix
from dem_cli.core.kernels.deformation.pressed_faces import line_gaps, rubbing_together
from dem_cli.core.kernels.deformation.uniform_strain import stretch_apart
from dem_cli.core.kernels.jit import inline, named
from dem_cli.core.kernels.planar_geometry import apart, overlap_of, place_end, refresh_lengths
from dem_cli.core.kernels.records import INTEGRATED
from dem_cli.core.kernels.vec import axpy, compose, load, scale, sliding


def make_planar_forces(
    law: Callable,
    bonded: bool = False,
    keeps: bool = False,
    meets: bool = False,
    rigid: bool = False,
    strains: bool = False,
    elastic: bool = False,
) -> Callable:
    """Make the contact loop for one law (laws/law.py), as a plain function that `make_advance` closes over.

    keeps: frames and levers of the points that touch are kept up to date, for dampers.
    meets: points close and open without a loss of energy (`meeting`), in time histories.
    rigid: closure that was taken back (engine/rigid_joints.py) presses without an overlap, jolts are booked: statics.
    strains: blocks deform (kernels/deformation); their edges stay straight. elastic: there are joints over which
    pressure is integrated (kernels/deformation/pressed_faces.py).
    """
    press, books = make_press(law, bonded), rigid and not bonded

    @inline
    def planar_forces(joints, geometry, contacts, bodies, dt, like, like_rotation):
        """Add the forces of all joints on their blocks to `forces`; returns the friction work [J]."""
        blocks, starts, edges, scales = joints.blocks, joints.starts, geometry.edges, geometry.scales
        frames, levers = joints.frames, joints.levers
        gaps, normals, stale, closures = contacts.gaps, contacts.normal, contacts.stale, contacts.closure
        velocities, forces, positions, corners = bodies.velocities, bodies.forces, bodies.positions, bodies.corners
        stretchings, d = bodies.stretchings, len(like)
        friction_work = jolts = 0.0
        for number in range(blocks.shape[0]):
            joint = np.uint64(number)
            i, j = np.uint64(edges[joint, 0]), np.uint64(edges[joint, 1])
            k, m = np.uint64(edges[joint, 2]), np.uint64(edges[joint, 3])
            a0, a1 = load(corners, i, 0, like), load(corners, j, 0, like)
            b0, b1 = load(corners, k, 0, like), load(corners, m, 0, like)
            if strains:
                refresh_lengths(scales, joint, a0, a1, b0, b1)
            overlap, gap_low, gap_high, share_low, share_high, ta, tb = overlap_of(
                a0, a1, b0, b1, scales[joint, 0], scales[joint, 1], scales[joint, 2], scales[joint, 3]
            )
            first = np.uint64(starts[joint])
            second = first + np.uint64(1)
            wrong = apart(overlap, gap_low, gap_high, a0, a1, b0, b1, tb, scales, joint)
            if wrong:
                if stale[joint] == 0 and (overlap > 0.0 or normals[first] + normals[second] > 0.0):
                    stale[joint] = 1
                    stale[-1] = 1
                gap_low = max(gap_low, 0.0)
                gap_high = max(gap_high, 0.0)
            true_low, true_high = gap_low, gap_high
            was_low, was_high = gaps[first], gaps[second]
            opened_low, opened_high = gap_low - gaps[first], gap_high - gaps[second]
            gaps[first] = gap_low
            gaps[second] = gap_high
            whole = elastic and joints.integrated[joint] == INTEGRATED
            if whole:
                gap_low, gap_high = line_gaps(gap_low, gap_high)
            elif meets and not bonded:
                gap_low, gap_high = meeting(gap_low, opened_low), meeting(gap_high, opened_high)
            if rigid and not wrong and not whole:
                gap_low, gap_high = gap_low - closures[first], gap_high - closures[second]
            on_low = bonded or gap_low < 0.0 or normals[first] != 0.0
            on_high = bonded or gap_high < 0.0 or normals[second] != 0.0
            if not (on_low or on_high):
                continue
            a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
            spin_a = load(velocities, a, d, like_rotation)
            spin_b = load(velocities, b, d, like_rotation)
            relative = axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like))
            force, torque_a, torque_b = scale(0.0, like), scale(0.0, like_rotation), scale(0.0, like_rotation)
            if strains:
                gradient_a, gradient_b = load_matrix(stretchings, a, like), load_matrix(stretchings, b, like)
            xa, xb = load(positions, a, 0, like), load(positions, b, 0, like)
            if elastic:
                low = place_end(xa, xb, share_low, true_low, ta, tb, a0, b1)
                high = place_end(xa, xb, share_high, true_high, ta, tb, a1, b0)
                if whole:
                    low, high = rubbing_together(low, high, gap_low, gap_high)
            if on_low:
                if not elastic:
                    low = place_end(xa, xb, share_low, true_low, ta, tb, a0, b1)
                frame, levers_a, levers_b, place = low
                if keeps:
                    frames[first, 0], frames[first, 1] = frame[0]
                    levers[first, 0], levers[first, 1] = levers_a[0][0], levers_a[1][0]
                    levers[first, 2], levers[first, 3] = levers_b[0][0], levers_b[1][0]
                slide = sliding(frame, levers_a, levers_b, relative, spin_a, spin_b, dt)
                if strains:
                    arm_a, arm_b = axpy(-1.0, xa, place), axpy(-1.0, xb, place)
                    slide = axpy(dt, spread_between(frame, gradient_a, gradient_b, arm_a, arm_b), slide)
                pressed = normals[first]
                normal, shear, work = press(gap_low, opened_low, slide, joints, contacts, joint, first)
                if books and whole:
                    jolts += swing(was_low, gaps[first], pressed, normal)
                elif books and not wrong:
                    jolts += jolt(gap_low, opened_low, pressed, normal)
                friction_work += work
                force, torque_a, torque_b = add_force(
                    frame, levers_a, levers_b, normal, shear, force, torque_a, torque_b
                )  # fmt: skip
                if strains:
                    stretch_apart(bodies.dyads, a, b, compose(frame, normal, shear, scale(0.0, like)), arm_a, arm_b)
            if on_high:
                if not elastic:
                    high = place_end(xa, xb, share_high, true_high, ta, tb, a1, b0)
                frame, levers_a, levers_b, place = high
                if keeps:
                    frames[second, 0], frames[second, 1] = frame[0]
                    levers[second, 0], levers[second, 1] = levers_a[0][0], levers_a[1][0]
                    levers[second, 2], levers[second, 3] = levers_b[0][0], levers_b[1][0]
                slide = sliding(frame, levers_a, levers_b, relative, spin_a, spin_b, dt)
                if strains:
                    arm_a, arm_b = axpy(-1.0, xa, place), axpy(-1.0, xb, place)
                    slide = axpy(dt, spread_between(frame, gradient_a, gradient_b, arm_a, arm_b), slide)
                pressed = normals[second]
                normal, shear, work = press(gap_high, opened_high, slide, joints, contacts, joint, second)
                if books and whole:
                    jolts += swing(was_high, gaps[second], pressed, normal)
                elif books and not wrong:
                    jolts += jolt(gap_high, opened_high, pressed, normal)
                friction_work += work
                force, torque_a, torque_b = add_force(
                    frame, levers_a, levers_b, normal, shear, force, torque_a, torque_b
                )  # fmt: skip
                if strains:
                    stretch_apart(bodies.dyads, a, b, compose(frame, normal, shear, scale(0.0, like)), arm_a, arm_b)
            push_apart(forces, a, b, force, torque_a, torque_b)
        if books:
            contacts.jolts[0] += jolts
        return friction_work

    flags = {"bonded": bonded, "keeps": keeps, "meets": meets, "rigid": rigid, "strains": strains}
    flags |= {"elastic": elastic}
    return named(planar_forces, law, *(name if on else "" for name, on in flags.items()))
