"""Contact geometry that moves with the blocks, 2D: two edges and the ends of their overlap.

Both ends of the overlap of two edges are corners of one block on the edge of the other: of the two corners at an end
the one that lies inside, seen along the bisector of both edges. There its gap is the same whichever of the two it is,
and the way from one to the other goes across the joint: where they pass each other neither gap nor moment jumps.
The normal is that of the edge, and jumps by the angle between both. Where corners nearly coincide (a hinge of an arch,
the end of a column joint) they pass with every vibration: within BLEND of an edge length the normal turns smoothly
from one edge to the other, by way of the bisector. That is so of a hinge, whose edges open by a small angle. Corners of
stones that lie aslant have the normal of the edge that one of them has entered: the bisector belongs to neither, and
held up stones that slide out. Nothing else is blended: a place between two corners that are not the same lies outside
the overlap.
"""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.kernels.jit import always_inline, inline, kernel
from dem_cli.core.kernels.vec import load

BLEND = 0.02  # share of the shorter edge over which the normal turns
FLAT = 0.3  # sine of the angle between two edges, up to which they are the sides of a hinge
STEEPER = 5000.0  # beyond it, per sine: how many times as soon the normal turns
NARROW = 1e-4  # of the shorter edge: overlaps of less than that length are none


@always_inline
def place_end(xa, xb, share, gap, ta, tb, corner_a, corner_b):
    """Compute frame, levers and place of one end: from `share` 0.5 on a corner of b on the edge of a, else the reverse.

    share: of the normal of the edge of a in that of the end, `share_of`; gap: of the end [m]. Across the joint the
    place goes with the share from one edge to the other, so that the moment of the shear force does not jump either.
    """
    if share >= 1.0:
        nx, ny = ta[1], -ta[0]
        x, y = corner_b
    elif share <= 0.0:
        nx, ny = -tb[1], tb[0]
        x, y = corner_a
    else:
        nx = share * ta[1] - (1.0 - share) * tb[1]
        ny = -share * ta[0] + (1.0 - share) * tb[0]
        unit = 1.0 / math.sqrt(nx * nx + ny * ny)
        nx *= unit
        ny *= unit
        across, (x, y) = (share - 1.0, corner_b) if share >= 0.5 else (share, corner_a)
        across *= gap * unit
        x += across * nx
        y += across * ny
    ax, ay = x - xa[0], y - xa[1]
    bx, by = x - xb[0], y - xb[1]
    levers_a = ((ax * ny - ay * nx,), (ax * nx + ay * ny,))
    levers_b = ((bx * ny - by * nx,), (bx * nx + by * ny,))
    return ((nx, ny), (-ny, nx)), levers_a, levers_b, (x, y)


@always_inline
def share_of(twice_inside, blend):
    """Compute the weight of the normal of a at an end: 1 where the corner of b lies inside, 0 where that of a does.

    twice_inside: how far the corner of b is inside [m], along a and along b, added up; blend: ¼ / (BLEND · edge).
    """
    return min(max(0.5 + twice_inside * blend, 0.0), 1.0)


@always_inline
def sharper(blend, ta, tb):
    """Adapt `blend` of share_of to edges along ta and tb: as it is where these open like a hinge, else far larger."""
    return blend * (1.0 + STEEPER * max(abs(ta[0] * tb[1] - ta[1] * tb[0]) - FLAT, 0.0))


@always_inline
def refresh_lengths(scales, joint, a0, a1, b0, b1):
    """Update the lengths of the two edges of blocks that deform in the `scales` of their joint."""
    length_a = math.sqrt((a1[0] - a0[0]) ** 2 + (a1[1] - a0[1]) ** 2)
    scales[joint, 0], scales[joint, 1] = length_a, 1.0 / length_a
    scales[joint, 2] = 1.0 / math.sqrt((b1[0] - b0[0]) ** 2 + (b1[1] - b0[1]) ** 2)


@always_inline
def overlap_of(a0, a1, b0, b1, length_a, per_a, per_b, blend):
    """Overlap of two edges: its length, zero where it is narrow, the gaps of its ends, what `place_end` needs."""
    ta = ((a1[0] - a0[0]) * per_a, (a1[1] - a0[1]) * per_a)
    tb = ((b1[0] - b0[0]) * per_b, (b1[1] - b0[1]) * per_b)
    # How far the edge of b ends inside that of a, at both ends, along a and along b; then the clipped overlap.
    lx, ly, hx, hy = b1[0] - a0[0], b1[1] - a0[1], a1[0] - b0[0], a1[1] - b0[1]
    low, high = lx * ta[0] + ly * ta[1], hx * ta[0] + hy * ta[1]
    overlap = length_a - max(low, 0.0) - max(high, 0.0)
    if overlap * blend <= 0.25 / BLEND * NARROW:
        overlap = min(overlap, 0.0)
    blend = sharper(blend, ta, tb)
    share_low = share_of(low - lx * tb[0] - ly * tb[1], blend)
    share_high = share_of(high - hx * tb[0] - hy * tb[1], blend)
    # Distance of a corner to the other edge, positive outside; the outward normal is (ty, -tx).
    gap_low = lx * ta[1] - ly * ta[0] if share_low >= 0.5 else ly * tb[0] - lx * tb[1]
    gap_high = hy * ta[0] - hx * ta[1] if share_high >= 0.5 else hx * tb[1] - hy * tb[0]
    return overlap, gap_low, gap_high, share_low, share_high, ta, tb


@always_inline
def _other_depth(inside, along, cotangent):
    """Depth of a corner behind the next edge, from the depth behind this edge and the way along it from the corner."""
    return max((along - inside * cotangent) / math.sqrt(1.0 + cotangent * cotangent), 0.0)


@always_inline
def apart(overlap, gap_low, gap_high, a0, a1, b0, b1, tb, scales, joint):
    """Test whether two edges do not touch: no overlap, or deeper inside than they overlap.

    Where two corners are inside each other two pairs of edges could push them apart, and the one with the smaller
    sum of squares of both depths does: one of the two whatever the direction, and as the elastic energies are the
    same where one takes over from the other, none is made.
    """
    deepest = min(gap_low, gap_high)
    if overlap <= 0.0:
        return True
    if deepest > -0.3 * overlap:
        return False
    length_b = 1.0 / scales[joint, 2]
    low = (a1[0] - b0[0]) * tb[0] + (a1[1] - b0[1]) * tb[1]
    high = length_b - ((a0[0] - b0[0]) * tb[0] + (a0[1] - b0[1]) * tb[1])
    along_b = length_b - max(low, 0.0) - max(high, 0.0)
    if low >= 0.0 and high < 0.0:  # corner a1 inside b, b1 inside a
        cot_a, cot_b, behind_a, behind_b = scales[joint, 5], scales[joint, 7], gap_low, gap_high
    elif low < 0.0 and high >= 0.0:  # corner a0 inside b, b0 inside a
        cot_a, cot_b, behind_a, behind_b = scales[joint, 4], scales[joint, 6], gap_high, gap_low
    else:
        return deepest <= -overlap
    other = _other_depth(-behind_a, overlap, cot_a) ** 2 + _other_depth(-behind_b, along_b, cot_b) ** 2
    return min(behind_a, 0.0) ** 2 + min(behind_b, 0.0) ** 2 >= other


@inline
def _write_end(joints, point, end):
    """Write frame, levers and place of an end into the arrays of the joints."""
    frame, levers_a, levers_b, place = end
    frames, levers, points = joints.frames, joints.levers, joints.points
    frames[point, 0], frames[point, 1] = frame[0]
    points[point, 0], points[point, 1] = place
    levers[point, 0], levers[point, 1] = levers_a[0][0], levers_a[1][0]
    levers[point, 2], levers[point, 3] = levers_b[0][0], levers_b[1][0]


@kernel
def measure(joints, geometry, contacts, bodies):
    """Compute frames, arms and gaps of all points from the corners of the blocks, for detection and records."""
    edges, scales = geometry.edges, geometry.scales
    gaps, normals, stale = contacts.gaps, contacts.normal, contacts.stale
    for number in range(joints.blocks.shape[0]):
        joint = np.uint64(number)
        xa = load(bodies.positions, np.uint64(joints.blocks[joint, 0]), 0, (0.0, 0.0))
        xb = load(bodies.positions, np.uint64(joints.blocks[joint, 1]), 0, (0.0, 0.0))
        first = np.uint64(joints.starts[joint])
        second = first + np.uint64(1)
        i, j = np.uint64(edges[joint, 0]), np.uint64(edges[joint, 1])
        k, m = np.uint64(edges[joint, 2]), np.uint64(edges[joint, 3])
        like = (0.0, 0.0)
        a0, a1 = load(bodies.corners, i, 0, like), load(bodies.corners, j, 0, like)
        b0, b1 = load(bodies.corners, k, 0, like), load(bodies.corners, m, 0, like)
        overlap, gap_low, gap_high, share_low, share_high, ta, tb = overlap_of(
            a0, a1, b0, b1, scales[joint, 0], scales[joint, 1], scales[joint, 2], scales[joint, 3]
        )
        if apart(overlap, gap_low, gap_high, a0, a1, b0, b1, tb, scales, joint):
            if stale[joint] == 0 and (overlap > 0.0 or normals[first] + normals[second] > 0.0):
                stale[joint] = 1
                stale[-1] = 1
            gap_low = max(gap_low, 0.0)
            gap_high = max(gap_high, 0.0)
        gaps[first] = gap_low
        gaps[second] = gap_high
        _write_end(joints, first, place_end(xa, xb, share_low, gap_low, ta, tb, a0, b1))
        _write_end(joints, second, place_end(xa, xb, share_high, gap_high, ta, tb, a1, b0))
