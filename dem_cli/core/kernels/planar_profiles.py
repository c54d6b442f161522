"""Contact forces of joints with more than two points in moving geometry, 2D: joints with a profile, bonded joints.

Block b carries a convex chain of vertices on its side of the joint, block a is flat: the non-coplanar joint of thesis
7.2.3 as geometry. The ends of the joint are corners of b on the edge of a, or corners of a on a side of the chain, as
in planar_geometry.py; between them lie the vertices. A chain without rise is a planar joint. Edges of b are recessed
behind its corners, so that other faces may find themselves inside each other when they come to touch: a joint counts
its gaps from there.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from dem_cli.core.kernels.contact_point import add_force, jolt, make_press, meeting, push_apart, swing
from dem_cli.core.kernels.deformation.joint_spread import spread_between
from dem_cli.core.kernels.deformation.matrices import load_matrix
from dem_cli.core.kernels.deformation.pressed_faces import line_gaps, rubbing_together
from dem_cli.core.kernels.deformation.quadratic import apart_at, bend_apart, line_apart, with_force
from dem_cli.core.kernels.deformation.uniform_strain import stretch_apart
from dem_cli.core.kernels.jit import always_inline, inline, kernel, named
from dem_cli.core.kernels.planar_geometry import apart, place_end, refresh_lengths, share_of, sharper
from dem_cli.core.kernels.records import INTEGRATED
from dem_cli.core.kernels.vec import axpy, compose, load, scale, sliding


@always_inline
def _vertex(b1, tb, place, rise):
    """Compute a vertex of the chain, `place` [m] from corner b1 along the edge of b, `rise` [m] above it (into b)."""
    return b1[0] - place * tb[0] - rise * tb[1], b1[1] - place * tb[1] + rise * tb[0]


@always_inline
def _side(tb, slope):
    """Compute the direction of a side of the chain, as tb is that of the edge of b."""
    unit = 1.0 / math.sqrt(1.0 + slope * slope)
    return unit * (tb[0] + slope * tb[1]), unit * (tb[1] - slope * tb[0])


@always_inline
def _outside(point, on_line, t):
    """Compute the distance of a point from a line with direction t, positive on its outer side [m]."""
    return (point[0] - on_line[0]) * t[1] - (point[1] - on_line[1]) * t[0]


@always_inline
def _along(start, end, t):
    """Compute the distance from one point to another along a direction t [m]."""
    return (end[0] - start[0]) * t[0] + (end[1] - start[1]) * t[1]


@always_inline
def _end(twice_inside, blend, corner_a, corner_b, ta, ts, on_side):
    """Gap at an end of the joint, and its share as in planar_geometry.py, with a side of the chain as edge of b."""
    share = share_of(twice_inside, sharper(blend, ta, ts))
    gap = _outside(corner_b, corner_a, ta) if share >= 0.5 else _outside(corner_a, on_side, ts)
    return gap, share


def make_profiled_forces(
    law: Callable,
    bonded: bool = False,
    keeps: bool = False,
    places: bool = False,
    meets: bool = False,
    rigid: bool = False,
    strains: bool = False,
    bends: bool = False,
    elastic: bool = False,
) -> Callable:
    """Make the contact loop for one law (laws/law.py), as a plain function that `make_advance` closes over.

    keeps: frames and levers of the points that touch are kept up to date, for dampers. places: instead of forces, the
    loop keeps gaps, frames, levers and points up to date, for detection and records. rigid, strains: as in
    planar_forces.py. bends: blocks have quadratic modes as well (kernels/deformation/quadratic.py).
    elastic: as in planar_forces.py.
    """
    press, books = make_press(law, bonded), rigid and not bonded

    @inline
    def profiled_forces(joints, geometry, contacts, bodies, dt, like, like_rotation):
        """Add the forces of all joints on their blocks to `forces`; returns the work lost [J]."""
        blocks, starts, edges, scales, profile = (
            joints.blocks, joints.starts, geometry.edges, geometry.scales, geometry.profile
        )  # fmt: skip
        frames, levers, places_out = joints.frames, joints.levers, joints.points
        gaps, normals, stale, closures = contacts.gaps, contacts.normal, contacts.stale, contacts.closure
        sunk = geometry.sunk
        velocities, forces, positions, corners = bodies.velocities, bodies.forces, bodies.positions, bodies.corners
        stretchings, d = bodies.stretchings, len(like)
        lost = jolts = 0.0
        for number in range(blocks.shape[0]):
            joint = np.uint64(number)
            a0 = load(corners, np.uint64(edges[joint, 0]), 0, like)
            a1 = load(corners, np.uint64(edges[joint, 1]), 0, like)
            b0 = load(corners, np.uint64(edges[joint, 2]), 0, like)
            b1 = load(corners, np.uint64(edges[joint, 3]), 0, like)
            if strains:
                refresh_lengths(scales, joint, a0, a1, b0, b1)
            length_a, per_a, per_b, blend = (
                scales[joint, 0], scales[joint, 1], scales[joint, 2], scales[joint, 3]
            )  # fmt: skip
            length_b = 1.0 / per_b
            ta = ((a1[0] - a0[0]) * per_a, (a1[1] - a0[1]) * per_a)
            tb = ((b1[0] - b0[0]) * per_b, (b1[1] - b0[1]) * per_b)
            first, last = starts[joint], starts[number + 1] - 1
            # The outer sides go on to the corners of b.
            u0, g0, un, gn = profile[first, 0], profile[first, 1], profile[last, 0], profile[last, 1]
            slope_first = (profile[first + 1, 1] - g0) / (profile[first + 1, 0] - u0)
            slope_last = (gn - profile[last - 1, 1]) / (un - profile[last - 1, 0])
            corner_low = _vertex(b1, tb, 0.0, g0 - slope_first * u0)
            corner_high = _vertex(b1, tb, length_b, gn + slope_last * (length_b - un))
            low, high = _along(a0, corner_low, ta), _along(corner_high, a1, ta)
            overlap = length_a - max(low, 0.0) - max(high, 0.0)
            # Sides on which the corners of a lie.
            k, m = first, last - 1
            while k + 1 < last and profile[k + 1, 0] <= -low:
                k += 1
            while m > first and profile[m, 0] > length_b + high:
                m -= 1
            side_low = _side(tb, (profile[k + 1, 1] - profile[k, 1]) / (profile[k + 1, 0] - profile[k, 0]))
            side_high = _side(tb, (profile[m + 1, 1] - profile[m, 1]) / (profile[m + 1, 0] - profile[m, 0]))
            on_low = _vertex(b1, tb, profile[k, 0], profile[k, 1])
            on_high = _vertex(b1, tb, profile[m, 0], profile[m, 1])
            low += _along(corner_low, a0, side_low)
            high += _along(a1, corner_high, side_high)
            gap_low, share_low = _end(low, blend, a0, corner_low, ta, side_low, on_low)
            gap_high, share_high = _end(high, blend, a1, corner_high, ta, side_high, on_high)
            wrong = apart(overlap, gap_low, gap_high, a0, a1, b0, b1, tb, scales, joint)
            if wrong:
                loaded = False
                for p in range(first, last + 1):
                    loaded = loaded or normals[p] != 0.0
                if stale[joint] == 0 and (overlap > 0.0 or loaded):
                    stale[joint] = 1
                    stale[-1] = 1
                sunk[joint] = np.inf
            offset = 0.0
            if sunk[joint] > 0.0 and not wrong:
                offset = min(sunk[joint], max(-min(gap_low, gap_high), 0.0))
                sunk[joint] = offset
            a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
            spin_a = load(velocities, a, d, like_rotation)
            spin_b = load(velocities, b, d, like_rotation)
            relative = axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like))
            xa, xb = load(positions, a, 0, like), load(positions, b, 0, like)
            force, torque_a, torque_b = scale(0.0, like), scale(0.0, like_rotation), scale(0.0, like_rotation)
            if strains:
                gradient_a, gradient_b = load_matrix(stretchings, a, like), load_matrix(stretchings, b, like)
            if bends or (places and bodies.bent.shape[0] > 0):
                end_a, end_b = axpy(-1.0, xa, b1), axpy(-1.0, xb, b1)
                bent = line_apart(bodies.bent, bodies.turns, a, b, end_a, end_b, tb)
            if bends:
                bending = line_apart(bodies.bending, bodies.turns, a, b, end_a, end_b, tb)
                nothing = scale(0.0, like)
                sums = (nothing, nothing, nothing)
            whole = elastic and not wrong and joints.integrated[joint] == INTEGRATED
            end_low, end_high = gap_low, gap_high
            if elastic:
                low_end = place_end(xa, xb, share_low, gap_low, ta, side_low, a0, corner_low)
                high_end = place_end(xa, xb, share_high, gap_high, ta, side_high, a1, corner_high)
                if whole:
                    end_low, end_high = line_gaps(gap_low + offset, gap_high + offset)
                    low_end, high_end = rubbing_together(low_end, high_end, end_low, end_high)
            loaded = False
            for p in range(first, last + 1):
                point = np.uint64(p)
                share, side, corner_a, corner_b = 1.0, tb, a0, b1
                faces = not wrong
                if p == first:
                    gap, share, side, corner_b = gap_low, share_low, side_low, corner_low
                elif p == last:
                    gap, share, side, corner_a, corner_b = gap_high, share_high, side_high, a1, corner_high
                else:
                    corner_b = _vertex(b1, tb, profile[point, 0], profile[point, 1])
                    gap = _outside(corner_b, a0, ta)
                    along = _along(a0, corner_b, ta)
                    if along <= 0.0 or along >= length_a:  # beyond the corner of a, which carries there
                        gap, faces = max(gap, 0.0), False
                depth = gap
                if bends or (places and bodies.bent.shape[0] > 0):
                    frame, levers_a, levers_b, place = place_end(xa, xb, share, depth, ta, side, corner_a, corner_b)
                    way = _along(b1, place, tb)
                    gap += apart_at(bent, way, frame)[0]
                gap += offset
                if wrong:
                    if gap < 0.0 and normals[point] > 0.0:  # edges that slid past each other: what pressed is lost
                        lost += 0.5 * normals[point] * normals[point] / joints.kn[point]
                    gap = max(gap, 0.0)
                before = gaps[point]
                gaps[point] = gap
                opened = gap - before
                if whole:
                    gap, faces = end_low if p == first else end_high, False
                elif meets and not bonded:
                    gap = meeting(gap, opened)
                if rigid and faces:
                    gap -= closures[point]
                if not places and not bonded and gap >= 0.0 and normals[point] == 0.0:
                    continue
                frame, levers_a, levers_b, place = place_end(xa, xb, share, depth, ta, side, corner_a, corner_b)
                if whole:
                    frame, levers_a, levers_b, place = low_end if p == first else high_end
                if keeps or places:
                    frames[point, 0], frames[point, 1] = frame[0]
                    levers[point, 0], levers[point, 1] = levers_a[0][0], levers_a[1][0]
                    levers[point, 2], levers[point, 3] = levers_b[0][0], levers_b[1][0]
                if places:
                    places_out[point, 0], places_out[point, 1] = place
                    continue
                loaded = True
                slide = sliding(frame, levers_a, levers_b, relative, spin_a, spin_b, dt)
                if strains:
                    arm_a, arm_b = axpy(-1.0, xa, place), axpy(-1.0, xb, place)
                    slide = axpy(dt, spread_between(frame, gradient_a, gradient_b, arm_a, arm_b), slide)
                if bends:
                    slide = (slide[0] + dt * apart_at(bending, way, frame)[1],)
                pressed = normals[point]
                normal, shear, work = press(gap, opened, slide, joints, contacts, joint, point)
                if books and whole:
                    jolts += swing(before, gaps[point], pressed, normal)
                elif books and faces:
                    jolts += jolt(gap, opened, pressed, normal)
                lost += work
                force, torque_a, torque_b = add_force(
                    frame, levers_a, levers_b, normal, shear, force, torque_a, torque_b
                )  # fmt: skip
                if strains:
                    stretch_apart(bodies.dyads, a, b, compose(frame, normal, shear, scale(0.0, like)), arm_a, arm_b)
                if bends:
                    sums = with_force(sums, way, compose(frame, normal, shear, scale(0.0, like)))
            if loaded:
                push_apart(forces, a, b, force, torque_a, torque_b)
                if bends:
                    bend_apart(bodies.triads, bodies.turns, a, b, end_a, end_b, tb, sums)
        if books:
            contacts.jolts[0] += jolts
        return lost

    flags = {"bonded": bonded, "keeps": keeps, "places": places, "meets": meets, "rigid": rigid, "strains": strains}
    flags |= {"bends": bends, "elastic": elastic}
    return named(profiled_forces, law, *(name if on else "" for name, on in flags.items()))


@inline
def _no_law(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Return no force: a law for loops that only place points."""
    return 0.0, shear, False


_place_points = make_profiled_forces(_no_law, places=True)


@kernel
def measure_profiles(joints, geometry, contacts, bodies):
    """Frames, levers, places and gaps of all points from the corners of the blocks, for detection and records."""
    _place_points(joints, geometry, contacts, bodies, 0.0, (0.0, 0.0), (0.0,))
