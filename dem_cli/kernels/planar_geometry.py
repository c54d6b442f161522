"""Contact geometry that moves with the blocks, 2D: two edges and the ends of their overlap.

Both ends of the overlap of two edges are corners of one block on the edge of the other. The contact
normal is that of the edge; where two corners meet (a hinge of an arch, the end of a column joint) it
turns smoothly into the bisector of both edges within BLEND of an edge length, because there a corner
changes from one edge to the other with every vibration.
"""

from __future__ import annotations

import math

import numpy as np

from dem_cli.kernels.jit import inline, kernel

BLEND = 0.02  # share of the shorter edge over which the normal turns


@inline
def _place(frames, levers, points, positions, a, b, point, share, gap_a, gap_b, ta, tb, corner_a, corner_b):
    """Frame and levers of one end: `share` 1 is a corner of b on the edge of a, 0 the reverse. Returns the gap."""
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
        x = share * corner_b[0] + (1.0 - share) * corner_a[0]
        y = share * corner_b[1] + (1.0 - share) * corner_a[1]
    frames[point, 0], frames[point, 1] = nx, ny
    points[point, 0], points[point, 1] = x, y
    arm_x, arm_y = x - positions[a, 0], y - positions[a, 1]
    levers[point, 0] = arm_x * ny - arm_y * nx
    levers[point, 1] = arm_x * nx + arm_y * ny
    arm_x, arm_y = x - positions[b, 0], y - positions[b, 1]
    levers[point, 2] = arm_x * ny - arm_y * nx
    levers[point, 3] = arm_x * nx + arm_y * ny
    return share * gap_a + (1.0 - share) * gap_b


@inline
def place_points(joints, contacts, positions, corners):
    """Frames, arms and gaps of all points from the corners of the blocks.

    A joint whose overlap vanished or became shorter than its penetration is not the face that the
    blocks touch with any more: it opens and, if it carried force or is penetrated, asks for a new
    detection (`stale`).
    """
    edges, scales, blocks, starts = joints.edges, joints.scales, joints.blocks, joints.starts
    frames, levers, points = joints.frames, joints.levers, joints.points
    gaps, normals, stale = contacts.gaps, contacts.normal, contacts.stale
    for joint in range(blocks.shape[0]):
        i, j = np.uint64(edges[joint, 0]), np.uint64(edges[joint, 1])
        k, m = np.uint64(edges[joint, 2]), np.uint64(edges[joint, 3])
        a0, a1 = (corners[i, 0], corners[i, 1]), (corners[j, 0], corners[j, 1])
        b0, b1 = (corners[k, 0], corners[k, 1]), (corners[m, 0], corners[m, 1])
        length_a, per_a, per_b, blend = scales[joint, 0], scales[joint, 1], scales[joint, 2], scales[joint, 3]
        ta = ((a1[0] - a0[0]) * per_a, (a1[1] - a0[1]) * per_a)
        tb = ((b1[0] - b0[0]) * per_b, (b1[1] - b0[1]) * per_b)
        # How far the edge of b ends inside that of a, at both ends; then the clipped overlap.
        low = (b1[0] - a0[0]) * ta[0] + (b1[1] - a0[1]) * ta[1]
        high = length_a - ((b0[0] - a0[0]) * ta[0] + (b0[1] - a0[1]) * ta[1])
        overlap = length_a - max(low, 0.0) - max(high, 0.0)
        share_low = min(max(0.5 + low * blend, 0.0), 1.0)
        share_high = min(max(0.5 + high * blend, 0.0), 1.0)
        # Distance of each corner to the other edge, positive outside; the outward normal is (ty, -tx).
        gap_b1 = (b1[0] - a0[0]) * ta[1] - (b1[1] - a0[1]) * ta[0]
        gap_b0 = (b0[0] - a0[0]) * ta[1] - (b0[1] - a0[1]) * ta[0]
        gap_a0 = (a0[0] - b0[0]) * tb[1] - (a0[1] - b0[1]) * tb[0]
        gap_a1 = (a1[0] - b0[0]) * tb[1] - (a1[1] - b0[1]) * tb[0]
        a, b = np.uint64(blocks[joint, 0]), np.uint64(blocks[joint, 1])
        first = np.uint64(starts[joint])
        second = np.uint64(starts[joint] + 1)
        gap_low = _place(
            frames, levers, points, positions, a, b, first, share_low, gap_b1, gap_a0, ta, tb, a0, b1
        )
        gap_high = _place(
            frames, levers, points, positions, a, b, second, share_high, gap_b0, gap_a1, ta, tb, a1, b0
        )
        if overlap <= 0.0 or min(gap_low, gap_high) <= -overlap:
            if stale[joint] == 0 and (overlap > 0.0 or normals[first] + normals[second] > 0.0):
                stale[joint] = 1
                stale[-1] = 1
            gap_low = max(gap_low, 0.0)
            gap_high = max(gap_high, 0.0)
        gaps[first] = gap_low
        gaps[second] = gap_high


@kernel
def measure(joints, contacts, bodies):
    """`place_points` once, for detection and records."""
    place_points(joints, contacts, bodies.positions, bodies.corners)
