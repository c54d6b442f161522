"""Geometry of contact points of blocks that move in space: place, normal and gap of a corner on a face and of crossing
edges.

Each feature has its own normal: a corner that of the face on which it lies, a crossing that of both its edges. Where
one feature becomes another normals would jump by the angle between the blocks: within a band along the rim of a face
they turn smoothly, half way where they meet (2 % of an edge, as in the plane). A corner of b over the rim of a goes
over to the normal across that side of the rim in the plane of b, so that it turns about the rim alone: blocks that are
flush on the other sides keep the normal of the face, as those in the plane do.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import always_inline
from dem_cli.core.kernels.records import CORNER_OF_A, CORNER_OF_B, CROSSING, FACES, FIXED_TO_B
from dem_cli.core.kernels.separation import cross3, minus3, row3, unit3
from dem_cli.core.kernels.spin import along, combined
from dem_cli.core.kernels.vec import axpy, dot, load_frame

SKEW, APART = 0.05, 0.1  # sine between two edges, seen along the joint: up to where they are parallel, from where not
LEAST, ENOUGH = (
    0.8,
    0.9,
)  # cosine between the normals of a crossing and of the joint: up to where it has no own, from where
NONE = -1


@always_inline
def turned3(turns, block, v):
    """Turn a vector from the frame of a block into world axes."""
    return along(load_frame(turns, block, v), v)


@always_inline
def turned_back3(turns, block, v):
    """Turn a vector from world axes into the frame of a block."""
    return combined(load_frame(turns, block, v), v)


@always_inline
def carried3(bodies, block, arm):
    """Move an arm of the undeformed block, from its centroid, with the block to where it is now."""
    if bodies.gradients.shape[0] > 0:
        return turned3(bodies.gradients, block, arm)
    return turned3(bodies.turns, block, arm)


@always_inline
def carried_back3(bodies, block, arm):
    """Move an arm back to the undeformed block; the inverse of `carried3`."""
    if bodies.covectors.shape[0] > 0:
        return turned_back3(bodies.covectors, block, arm)
    return turned_back3(bodies.turns, block, arm)


@always_inline
def _normal3(bodies, block, normal):
    """Compute the present unit normal of a face of the undeformed block."""
    if bodies.covectors.shape[0] > 0:
        return near_unit3(turned3(bodies.covectors, block, normal))
    return turned3(bodies.turns, block, normal)


@always_inline
def mixed(x, v, w):
    """Blend two vectors: x of one and the rest of the other."""
    return axpy(x, v, axpy(-x, w, w))


@always_inline
def _share(way, band):
    """Compute the share of a normal by the way from a rim: 0 there, 1 from the end of the band on."""
    return min(max(way / band, 0.0), 1.0)


@always_inline
def near_unit3(v):
    """Normalise a vector of about length one; by a series where it hardly differs: no root, no division."""
    short = 1.0 - dot(v, v)
    if abs(short) > 1e-3:
        return unit3(v)
    size = 1.0 + short * (0.5 + short * (0.375 + short * (0.3125 + short * 0.2734375)))
    return (size * v[0], size * v[1], size * v[2])


@always_inline
def _half_way(own, other, along):
    """Compute the direction half way from a normal to what is left of another one across a unit vector."""
    over = near_unit3(axpy(-dot(other, along), along, other))
    return (0.5 * (own[0] + over[0]), 0.5 * (own[1] + over[1]), 0.5 * (own[2] + over[2]))


@always_inline
def _over_rim(vertices, ends, span, corner, outwards, own, other, band):
    """Compute the share of a corner's own normal by its way from a side of the rim, and the normal where it is over
    that side.

    ends, span: corners of the side, and one over its length [1/m].
    """
    origin = row3(vertices, ends[0])
    side = minus3(row3(vertices, ends[1]), origin)
    along = (span * side[0], span * side[1], span * side[2])
    depth = dot(minus3(corner, origin), cross3(outwards, along))
    return _share(depth, band), _half_way(own, other, along)


@always_inline
def corner_normal(vertices, sides, spans, point, corner, outwards, own, other, middle, band):
    """Compute the normal of a corner on a face. own: of the face, from a to b; other: of the face of the corner's
    block, likewise.

    outwards: own, as the face has it; sides[point, 1:5]: corners of up to two sides of its rim that are near, spans:
    one over their lengths [1/m].
    """
    if sides[point, 1] == NONE:
        return own
    first, over_first = _over_rim(
        vertices, (sides[point, 1], sides[point, 2]), spans[point, 0], corner, outwards, own, other, band
    )  # fmt: skip
    second, over_second = 1.0, own
    if sides[point, 3] != NONE:
        second, over_second = _over_rim(
            vertices, (sides[point, 3], sides[point, 4]), spans[point, 1], corner, outwards, own, other, band
        )  # fmt: skip
    return _bilinear(first, second, own, over_first, over_second, middle)


@always_inline
def _bilinear(first, second, inside, over_first, over_second, over_both):
    """Interpolate the normal between two rims: inside of both, over one of them, over both."""
    if first >= 1.0 and second >= 1.0:
        return inside
    return near_unit3(mixed(second, mixed(first, inside, over_first), mixed(first, over_second, over_both)))


@always_inline
def crossing_in_faces(vertices, ends, point, share, normal_a, normal_b, middle, band):
    """Compute normal, gap and place of two edges that cross where two faces look at each other.

    Nearly parallel ones have the normal of the joint, at the place along the edge of a where they began to cross.
    """
    on_a, on_b = row3(vertices, ends[point, 0]), row3(vertices, ends[point, 2])
    d, e = minus3(row3(vertices, ends[point, 1]), on_a), minus3(row3(vertices, ends[point, 3]), on_b)
    long_d, long_e, c = math.sqrt(dot(d, d)), math.sqrt(dot(e, e)), cross3(d, e)
    level = dot(c, middle)
    skew = abs(level) / (long_d * long_e)
    if skew < SKEW:
        place = axpy(share, d, on_a)
        return middle, dot(minus3(on_b, place), normal_b) / dot(middle, normal_b), place
    if level < 0.0:
        c, level = (-c[0], -c[1], -c[2]), -level
    r = minus3(on_b, on_a)
    s, t = dot(cross3(r, e), middle), dot(cross3(r, d), middle)
    upright = dot(cross3(d, e), middle)
    s, t = min(max(s / upright, 0.0), 1.0), min(max(t / upright, 0.0), 1.0)
    height = dot(r, c) / level
    normal = unit3(c)
    own = min((skew - SKEW) / (APART - SKEW), (dot(normal, middle) - LEAST) / (ENOUGH - LEAST))
    if own < 1.0:
        normal = unit3(mixed(max(own, 0.0), normal, middle))
    by_a, by_b = _share(min(s, 1.0 - s) * long_d, band), _share(min(t, 1.0 - t) * long_e, band)
    if by_a < 1.0 or by_b < 1.0:
        along_d, along_e = axpy(1.0 / long_d - 1.0, d, d), axpy(1.0 / long_e - 1.0, e, e)
        near_b, near_a = _half_way(normal_a, normal_b, along_d), _half_way(normal_b, normal_a, along_e)
        normal = _bilinear(by_a, by_b, normal, near_a, near_b, middle)
    return normal, height * dot(middle, normal), axpy(s, d, on_a)


@always_inline
def crossing_alone(vertices, ends, point, sign):
    """Normal, gap and place of two edges that cross outside of face joints; sign: which way their normal goes."""
    on_a, on_b = row3(vertices, ends[point, 0]), row3(vertices, ends[point, 2])
    d, e = minus3(row3(vertices, ends[point, 1]), on_a), minus3(row3(vertices, ends[point, 3]), on_b)
    c, r = cross3(d, e), minus3(on_b, on_a)
    square = dot(c, c)
    if square <= 1e-8 * dot(d, d) * dot(
        e, e
    ):  # parallel: they cross nowhere, and are open; finite, as rates are formed
        return (0.0, 0.0, 1.0), math.sqrt(dot(d, d)), on_a
    s = min(max(dot(cross3(r, e), c) / square, 0.0), 1.0)
    length = sign / math.sqrt(square)
    normal = (length * c[0], length * c[1], length * c[2])
    return normal, dot(r, normal), axpy(s, d, on_a)


@always_inline
def feature_of(geometry, bodies, joint, point, a, b, frame):
    """Normal from a to b, gap [m] and place of one contact point; frame: normals of both faces and of the joint."""
    vertices, corners, kind, scales = bodies.corners, geometry.corners, geometry.types[point], geometry.scales
    normal_a, normal_b, middle = frame
    band, in_faces = scales[joint, 1], geometry.kinds[joint] == FACES
    if kind == CROSSING:
        if in_faces:
            return crossing_in_faces(
                vertices, corners, point, geometry.shares[point], normal_a, normal_b, middle, band
            )  # fmt: skip
        return crossing_alone(vertices, corners, point, geometry.shares[point])
    if kind == CORNER_OF_A:
        corner = row3(vertices, corners[point, 0])
        face = geometry.faces[joint, 1]
        height = dot(minus3(row3(vertices, geometry.face_corners[geometry.face_starts[face]]), corner), normal_b)
        outwards = (-normal_b[0], -normal_b[1], -normal_b[2])
        normal = corner_normal(
            vertices, corners, geometry.spans, point, corner, outwards, normal_b, normal_a, middle, band
        )  # fmt: skip
        return normal, height / dot(normal, normal_b), corner
    if kind == CORNER_OF_B:
        corner = row3(vertices, corners[point, 0])
    else:
        arm = carried3(bodies, b, row3(geometry.arms, point))
        corner = axpy(1.0, arm, row3(bodies.positions, b))
    face = geometry.faces[joint, 0]
    height = dot(minus3(corner, row3(vertices, geometry.face_corners[geometry.face_starts[face]])), normal_a)
    normal = corner_normal(
        vertices, corners, geometry.spans, point, corner, normal_a, normal_a, normal_b, middle, band
    )  # fmt: skip
    return normal, height / dot(normal, normal_a), corner


@always_inline
def height_inside(geometry, vertices, face, outwards, corner, slack):
    """Test whether a point lies over a face, but for `slack` [m²], and compute its height [m]."""
    first = geometry.face_starts[face]
    count = geometry.face_starts[face + 1] - first
    height = dot(minus3(corner, row3(vertices, geometry.face_corners[first])), outwards)
    for k in range(count):
        origin = row3(vertices, geometry.face_corners[first + k])
        after = row3(vertices, geometry.face_corners[first + (k + 1 if k + 1 < count else 0)])
        if dot(minus3(corner, origin), cross3(outwards, minus3(after, origin))) < -slack:
            return False, height
    return True, height


@always_inline
def on_cap(geometry, bodies, joint, point, gap, place, frame):
    """Correct gap and place of a point where b has a cap: its outline lies higher, its inner points carry over face a
    alone.
    """
    rise = geometry.rises[joint]
    if rise == 0.0:
        return gap, place
    if geometry.types[point] != FIXED_TO_B:
        return gap + rise, axpy(rise, frame[1], place)
    inside, _ = height_inside(geometry, bodies.corners, geometry.faces[joint, 0], frame[0], place, 0.0)
    return gap if inside else max(gap, 0.0), place


@always_inline
def frame_of(geometry, bodies, joint, a, b):
    """Compute normals from a to b (of the face of a, of that of b, half way) and the direction of shear, in space."""
    n, t = geometry.normals, row3(geometry.tangents, joint)
    normal_a = _normal3(bodies, a, (n[joint, 0], n[joint, 1], n[joint, 2]))
    normal_b = _normal3(bodies, b, (-n[joint, 3], -n[joint, 4], -n[joint, 5]))
    between = axpy(1.0, normal_a, normal_b)
    if dot(between, between) < 1e-12:  # faces back to back: no joint of theirs
        between = normal_a
    return (normal_a, normal_b, unit3(between)), turned3(bodies.turns, a, t)


@always_inline
def tangents3(normal, along):
    """Compute two unit vectors across a normal: what is left of `along`, and normal × that."""
    first = axpy(-dot(normal, along), normal, along)
    if dot(first, first) < 1e-6:  # along the normal: any will do
        first = cross3(normal, (1.0, 0.0, 0.0) if abs(normal[0]) < 0.7 else (0.0, 1.0, 0.0))
    first = near_unit3(first)
    return first, cross3(normal, first)
