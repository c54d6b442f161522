"""Contact geometry that moves with the blocks, 2D: two edges and the ends of their overlap.

Both ends of the overlap of two edges are corners of one block on the edge of the other. The contact
normal is that of the edge; where two corners meet (a hinge of an arch, the end of a column joint) it
turns smoothly into the bisector of both edges within BLEND of an edge length, because there a corner
changes from one edge to the other with every vibration.
"""

from __future__ import annotations

import math

from dem_cli.kernels.jit import inline, kernel
from dem_cli.kernels.vec import store

BLEND = 0.02


@inline
def prepare(joints, bodies, contacts, joint, like):
    """Corners and directions of the two edges; False where their overlap has no length.

    A joint whose overlap vanished or became shorter than its penetration is not the face that the
    blocks touch with any more: it carries nothing and asks for a new detection (`stale`).
    """
    edges, corners = joints.edges, bodies.corners
    i, j, k, m = edges[joint, 0], edges[joint, 1], edges[joint, 2], edges[joint, 3]
    a0x, a0y, a1x, a1y = corners[i, 0], corners[i, 1], corners[j, 0], corners[j, 1]
    b0x, b0y, b1x, b1y = corners[k, 0], corners[k, 1], corners[m, 0], corners[m, 1]
    length_a, length_b = joints.lengths[joint, 0], joints.lengths[joint, 1]
    tax, tay = (a1x - a0x) / length_a, (a1y - a0y) / length_a
    tbx, tby = (b1x - b0x) / length_b, (b1y - b0y) / length_b
    # Positions of b1 and b0 along edge a, and the clipped overlap.
    low = (b1x - a0x) * tax + (b1y - a0y) * tay
    high = length_a - ((b0x - a0x) * tax + (b0y - a0y) * tay)
    overlap = length_a - max(low, 0.0) - max(high, 0.0)
    # Distance of each corner to the other edge, positive outside; outward normal of an edge: (ty, -tx).
    gap_b1 = (b1x - a0x) * tay - (b1y - a0y) * tax
    gap_b0 = (b0x - a0x) * tay - (b0y - a0y) * tax
    gap_a0 = (a0x - b0x) * tby - (a0y - b0y) * tbx
    gap_a1 = (a1x - b0x) * tby - (a1y - b0y) * tbx
    blend = 1.0 / (2.0 * BLEND * min(length_a, length_b))
    share_low = min(max(0.5 + low * blend, 0.0), 1.0)
    share_high = min(max(0.5 + high * blend, 0.0), 1.0)
    end_low = (
        share_low,
        share_low * gap_b1 + (1.0 - share_low) * gap_a0,
        share_low * b1x + (1.0 - share_low) * a0x,
        share_low * b1y + (1.0 - share_low) * a0y,
    )
    end_high = (
        share_high,
        share_high * gap_b0 + (1.0 - share_high) * gap_a1,
        share_high * b0x + (1.0 - share_high) * a1x,
        share_high * b0y + (1.0 - share_high) * a1y,
    )
    touches = overlap > 0.0 and min(end_low[1], end_high[1]) > -overlap
    if not touches:
        first = joints.starts[joint]
        was_loaded = contacts.normal[first] + contacts.normal[first + 1] > 0.0
        if contacts.stale[joint] == 0 and (was_loaded or overlap > 0.0):
            contacts.stale[joint] = 1
            contacts.stale[-1] = 1
        for point in range(first, first + 2):
            contacts.gaps[point] = max(end_low[1], end_high[1], 0.0)
            contacts.normal[point] = 0.0
            contacts.shear[point, 0] = 0.0
    return touches, (tax, tay, tbx, tby, end_low, end_high)


@inline
def place(joints, bodies, contacts, joint, point, shared, like):
    """One end of the overlap: frame (normal from a to b, tangent), arms, gap."""
    tax, tay, tbx, tby, end_low, end_high = shared
    share, gap, x, y = end_low if point == joints.starts[joint] else end_high
    if share >= 1.0:
        nx, ny = tay, -tax
    elif share <= 0.0:
        nx, ny = -tby, tbx
    else:
        nx = share * tay - (1.0 - share) * tby
        ny = -share * tax + (1.0 - share) * tbx
        scale = 1.0 / math.sqrt(nx * nx + ny * ny)
        nx *= scale
        ny *= scale
    positions = bodies.positions
    a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
    arm_a = (x - positions[a, 0], y - positions[a, 1])
    arm_b = (x - positions[b, 0], y - positions[b, 1])
    return ((nx, ny), (-ny, nx)), arm_a, arm_b, gap


@kernel
def measure(joints, bodies, contacts, like, points_out, normals_out, gaps_out, overlaps_out):
    """Ends of all joints as they are now: place [m], unit normal from a to b, gap [m]; overlap length [m].

    points_out, normals_out (n_points, 2), gaps_out (n_points,), overlaps_out (n_joints,)
    """
    for joint in range(joints.blocks.shape[0]):
        _, shared = prepare(joints, bodies, contacts, joint, like)
        tax, tay, tbx, tby, end_low, end_high = shared
        low = end_low[2] * tax + end_low[3] * tay
        high = end_high[2] * tax + end_high[3] * tay
        overlaps_out[joint] = high - low
        for point in range(joints.starts[joint], joints.starts[joint + 1]):
            frame, arm_a, arm_b, gap = place(joints, bodies, contacts, joint, point, shared, like)
            a = joints.blocks[joint, 0]
            gaps_out[point] = gap
            store(normals_out, point, 0, frame[0])
            store(points_out, point, 0, (arm_a[0] + bodies.positions[a, 0], arm_a[1] + bodies.positions[a, 1]))
