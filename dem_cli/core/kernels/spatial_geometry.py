"""Contact points between two convex polyhedra as they lie: overlaps of faces, edges and corners on faces, edges.

Faces within 30° of the separating axis and of each other make a face joint: the points are the corners of their overlap
across the bisector of both normals, which does not know which of the two comes first. Otherwise an edge or a corner of
one part lies on a face of the other, or two edges cross.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import inline, kernel
from dem_cli.core.kernels.overlap import OF_LINE, SAME, area_of, clip, mean_distance, share_area, simplify
from dem_cli.core.kernels.records import EDGES, FACES, RIM_OF_A, RIM_OF_B
from dem_cli.core.kernels.separation import NO_EDGE, cross3, minus3, row3, separate, unit3
from dem_cli.core.kernels.vec import axpy, dot

STEEP = math.cos(math.radians(30.0))  # faces within that angle look at each other
PARALLEL = 1e-2  # sine of the angle between faces, or edges, that lie along each other
SKEW = 0.05  # sine of the angle between edges from which on their crossing has a normal of its own
PLANE = 1e-7  # sine of the angle between faces that are parallel: their normal is that of both
BESIDE = 0.8  # cosine: the normal of a crossing is nearer than that to the one of the joint

MARGIN, AREA, GAP, POLAR = 0, 1, 2, 3  # columns of `measures`
CENTRE = 4  # and the next two
TORSION = 7


@inline
def _put(array, row, vector):
    array[row, 0], array[row, 1], array[row, 2] = vector


@inline
def face_origin(solids, face):
    """Return the first corner of a face."""
    return row3(solids.corners, solids.face_corners[solids.face_starts[face]])


@inline
def first_tangent(solids, face, normal):
    """A unit vector across the normal, along the first edge of a face: fixed in its part, whatever overlaps there."""
    first = solids.face_starts[face]
    start = row3(solids.corners, solids.face_corners[first])
    along = minus3(row3(solids.corners, solids.face_corners[first + 1]), start)
    return unit3(axpy(-dot(along, normal), normal, along))


@inline
def _flatten(solids, face, origin, t1, t2, work, row, turned):
    """Project corners of a face into the plane of t1 and t2; `turned`: the other way round. Returns how many."""
    first, count = solids.face_starts[face], solids.face_starts[face + 1] - solids.face_starts[face]
    for k in range(count):
        place = count - 1 - k if turned else k
        arm = minus3(row3(solids.corners, solids.face_corners[first + place]), origin)
        work[row, k, 0], work[row, k, 1], work[row, k, 2] = dot(arm, t1), dot(arm, t2), float(place)
    return count


@inline
def _inside(work, row, count, x, y):
    """Compute the distance of a point from the nearest side of a polygon, counter-clockwise; negative: outside."""
    least = math.inf
    for k in range(count):
        m = k + 1 if k + 1 < count else 0
        tx, ty = work[row, m, 0] - work[row, k, 0], work[row, m, 1] - work[row, k, 1]
        length = math.sqrt(tx * tx + ty * ty)
        least = min(least, (tx * (y - work[row, k, 1]) - ty * (x - work[row, k, 0])) / length)
    return least


@inline
def _edge_direction(solids, face, k):
    """Compute edge k of a face, from its corner k to the next one."""
    first, count = solids.face_starts[face], solids.face_starts[face + 1] - solids.face_starts[face]
    m = k + 1 if k + 1 < count else 0
    start = row3(solids.corners, solids.face_corners[first + k])
    return minus3(row3(solids.corners, solids.face_corners[first + m]), start)


@inline
def _own_normal(solids, face_a, face_b, n_a, n_b, what, middle):
    """Choose the normal of a point by what makes it: of the face that a corner lies on, of two edges that cross."""
    if what < n_b:
        return row3(solids.normals, face_a)
    if what < n_b + n_a:
        n = row3(solids.normals, face_b)
        return (-n[0], -n[1], -n[2])
    crossing = what - n_b - n_a
    along_a = _edge_direction(solids, face_a, crossing // n_b)
    place = n_b - 1 - crossing % n_b  # b runs the other way round: edge k goes from its corner place + … to the next
    along_b = _edge_direction(solids, face_b, place - 1 if place else n_b - 1)
    c = cross3(along_a, along_b)
    length = math.sqrt(dot(along_a, along_a) * dot(along_b, along_b))
    level = dot(c, middle)
    if abs(level) < SKEW * length:
        return middle
    c = unit3(c)
    if level < 0.0:
        c = (-c[0], -c[1], -c[2])
    return c if dot(c, middle) > BESIDE else middle


@inline
def _face_joint(solids, face_a, face_b, size, work, out, joint, first):
    """Compute the corners of the overlap of two faces that look at each other, with their areas; returns how many, or
    0.

    Gaps are the distances of both planes. All points are put into the plane across the normal of the joint: that of
    both faces where they are parallel, else that of the points that are nearest.
    """
    frames, places, weights, gaps, features, measures = out
    normal_a, normal_b = row3(solids.normals, face_a), row3(solids.normals, face_b)
    middle = unit3(minus3(normal_a, normal_b))
    origin = face_origin(solids, face_a)
    t1 = first_tangent(solids, face_a, middle)
    t2 = cross3(middle, t1)
    n_a = _flatten(solids, face_a, origin, t1, t2, work, 0, False)
    n_b = _flatten(solids, face_b, origin, t1, t2, work, 1, True)
    count = clip(work, n_a, n_b, size)
    if count < 3:
        return 0
    area, gx, gy, polar = area_of(work, count)
    count = simplify(work, count, SAME * size)
    if count < 3 or area <= (SAME * size) ** 2:
        return 0
    share_area(work, count, area, gx, gy, weights, first)
    angle = cross3(normal_a, normal_b)
    sine = math.sqrt(dot(angle, angle))
    slope_a, slope_b = _slopes(normal_a, middle, t1, t2), _slopes(normal_b, middle, t1, t2)
    arm = minus3(face_origin(solids, face_b), origin)
    rise = dot(arm, normal_b) / dot(middle, normal_b)  # of the plane of b over the origin, which lies on that of a
    upright, nearest, perimeter = dot(middle, normal_a), math.inf, 0.0
    for k in range(count):
        m = k + 1 if k + 1 < count else 0
        x, y = work[2, k, 0], work[2, k, 1]
        low, high = slope_a[0] * x + slope_a[1] * y, rise + slope_b[0] * x + slope_b[1] * y
        gap = (high - low) * upright
        gaps[first + k], features[first + k] = gap, int(work[2, k, 2])
        nearest = min(nearest, gap)
        _put(places, first + k, axpy(0.5 * (low + high), middle, axpy(y, t2, axpy(x, t1, origin))))
        perimeter += math.sqrt((work[2, m, 0] - x) ** 2 + (work[2, m, 1] - y) ** 2)
    level = 0.5 * (slope_a[0] * gx + slope_a[1] * gy + rise + slope_b[0] * gx + slope_b[1] * gy)
    centre = axpy(level, middle, axpy(gy, t2, axpy(gx, t1, origin)))
    margin, normal, anchor = 2.0 * area / perimeter, middle, centre
    if sine > PLANE:
        normal, anchor, touches = _at_the_nearest(
            solids, face_a, face_b, (n_a, n_b), (nearest + SAME * size, first, count), middle, out
        )
        if sine > PARALLEL:
            margin = min(margin, _edge_margin(work, (n_a, n_b), minus3(anchor, origin), t1, t2, touches))
        for k in range(first, first + count):
            place = row3(places, k)
            _put(places, k, axpy(dot(minus3(anchor, place), normal), normal, place))
        centre = axpy(dot(minus3(anchor, centre), normal), normal, centre)
    measures[joint, MARGIN], measures[joint, AREA], measures[joint, POLAR] = margin, area, polar
    distance, weight = 0.0, 0.0
    for k in range(count):
        own = weights[first + k]
        distance += own * math.sqrt((work[2, k, 0] - gx) ** 2 + (work[2, k, 1] - gy) ** 2)
        weight += own
    measures[joint, TORSION] = min(mean_distance(work, count, gx, gy) * weight / distance, 1.0)
    measures[joint, GAP] = rise + (slope_b[0] - slope_a[0]) * gx + (slope_b[1] - slope_a[1]) * gy
    measures[joint, GAP] *= upright
    measures[joint, CENTRE], measures[joint, CENTRE + 1], measures[joint, CENTRE + 2] = centre
    _put_frame(frames, joint, normal, first_tangent(solids, face_a, normal))
    return count


@inline
def _slopes(normal, middle, t1, t2):
    """Compute the rise of a plane along t1 and t2, over the plane across `middle`."""
    upright = dot(normal, middle)
    return -dot(normal, t1) / upright, -dot(normal, t2) / upright


@inline
def _at_the_nearest(solids, face_a, face_b, counts, points, middle, out):
    """Compute mean normal and place of the nearest points, and what is there: 2: one crossing of two edges, else 0.

    counts: corners of both faces; points: (largest gap, first, how many).
    """
    _, places, _, gaps, features, _ = out
    reach, first, count = points
    normal, anchor, found, crossings = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0, 0
    for k in range(first, first + count):
        if gaps[k] <= reach:
            own = _own_normal(solids, face_a, face_b, counts[0], counts[1], features[k], middle)
            normal, anchor, found = axpy(1.0, own, normal), axpy(1.0, row3(places, k), anchor), found + 1
            if features[k] >= counts[0] + counts[1]:
                crossings += 1
    share = 1.0 / found
    anchor = (anchor[0] * share, anchor[1] * share, anchor[2] * share)
    return unit3(normal), anchor, 2 if found == 1 and crossings == 1 else 0


@inline
def _edge_margin(work, counts, arm, t1, t2, touches):
    """Compute the margin of the nearest place within the rim of either face; infinite at a crossing of two edges."""
    if touches == 2:
        return math.inf
    x, y = dot(arm, t1), dot(arm, t2)
    return max(_inside(work, 0, counts[0], x, y), _inside(work, 1, counts[1], x, y))


@inline
def _put_frame(frames, joint, normal, t1):
    t2 = cross3(normal, t1)
    frames[joint, 0], frames[joint, 1], frames[joint, 2] = normal
    frames[joint, 3], frames[joint, 4], frames[joint, 5] = t1
    frames[joint, 6], frames[joint, 7], frames[joint, 8] = t2


@inline
def _support(solids, part, normal, band):
    """Find two corners of a part furthest against a normal, within `band` of the furthest; twice the same: one."""
    lowest = math.inf
    for k in range(solids.part_starts[part], solids.part_starts[part + 1]):
        lowest = min(lowest, dot(row3(solids.corners, k), normal))
    start, end, longest = -1, -1, -1.0
    for k in range(solids.part_starts[part], solids.part_starts[part + 1]):
        if dot(row3(solids.corners, k), normal) > lowest + band:
            continue
        for m in range(k, solids.part_starts[part + 1]):
            if dot(row3(solids.corners, m), normal) <= lowest + band:
                arm = minus3(row3(solids.corners, m), row3(solids.corners, k))
                length = dot(arm, arm)
                if length > longest:
                    start, end, longest = k, m, length
    return start, end


@inline
def _rim_joint(solids, face, other, sign, size, work, out, joint, first):
    """Compute contacts of a corner of the part `other` on a face, or both ends of its edge; returns how many points, or
    0.

    sign: 1 where the face belongs to a, −1 where it belongs to b.
    """
    frames, places, weights, gaps, features, measures = out
    n = row3(solids.normals, face)
    start, end = _support(solids, other, n, SAME * size)
    origin = face_origin(solids, face)
    t1 = first_tangent(solids, face, n)
    t2 = cross3(n, t1)
    count = _flatten(solids, face, origin, t1, t2, work, 0, False)
    arm, arm_end = minus3(row3(solids.corners, start), origin), minus3(row3(solids.corners, end), origin)
    x0, y0, dx, dy = dot(arm, t1), dot(arm, t2), 0.0, 0.0
    dx, dy = dot(arm_end, t1) - x0, dot(arm_end, t2) - y0
    low, high = 0.0, 1.0
    for k in range(count):  # Cyrus and Beck 1978
        m = k + 1 if k + 1 < count else 0
        tx, ty = work[0, m, 0] - work[0, k, 0], work[0, m, 1] - work[0, k, 1]
        inside, gains = tx * (y0 - work[0, k, 1]) - ty * (x0 - work[0, k, 0]), tx * dy - ty * dx
        if abs(gains) < 1e-12 * size * size:
            if inside < 0.0:
                return 0
        elif gains > 0.0:
            low = max(low, -inside / gains)
        else:
            high = min(high, -inside / gains)
    if high < low:
        return 0
    middle = 0.5 * (low + high)
    measures[joint, MARGIN] = _inside(work, 0, count, x0 + middle * dx, y0 + middle * dy)
    height, rise = dot(arm, n), dot(arm_end, n) - dot(arm, n)
    n_points = 2 if (high - low) * math.sqrt(dx * dx + dy * dy) > SAME * size else 1
    nearest = height + (low if rise > 0.0 else high) * rise
    for k in range(n_points):
        share = middle if n_points == 1 else (low if k == 0 else high)
        gaps[first + k], features[first + k], weights[first + k] = height + share * rise, k, 1.0
        place = axpy(y0 + share * dy, t2, axpy(x0 + share * dx, t1, origin))
        _put(places, first + k, axpy(0.5 * nearest, n, place))
    measures[joint, GAP], measures[joint, TORSION] = nearest, OF_LINE if n_points == 2 else 1.0
    normal = (sign * n[0], sign * n[1], sign * n[2])
    _put_frame(frames, joint, normal, first_tangent(solids, face, normal))
    return n_points


@inline
def _nearest_on(p, u, q, v):
    """Shares along two segments p + s u and q + t v where they are nearest to each other; Ericson 2005, 5.1.9."""
    uu, vv, uv = dot(u, u), dot(v, v), dot(u, v)
    arm = minus3(p, q)
    c, f = dot(u, arm), dot(v, arm)
    det = uu * vv - uv * uv
    s = min(max((uv * f - c * vv) / det, 0.0), 1.0) if det > 1e-12 * uu * vv else 0.5
    t = (uv * s + f) / vv
    if t < 0.0:
        t, s = 0.0, min(max(-c / uu, 0.0), 1.0)
    elif t > 1.0:
        t, s = 1.0, min(max((uv - c) / uu, 0.0), 1.0)
    return s, t


@inline
def _segment(solids, edge):
    """Return the start of an edge and the way to its end."""
    start = row3(solids.corners, solids.edges[edge, 0])
    return start, minus3(row3(solids.corners, solids.edges[edge, 1]), start)


@inline
def _nearest_edges(solids, a, b):
    """Find the two edges of parts a and b that are nearest to each other."""
    best, edge_a, edge_b = math.inf, solids.part_edges[a], solids.part_edges[b]
    for i in range(solids.part_edges[a], solids.part_edges[a + 1]):
        p, u = _segment(solids, i)
        for k in range(solids.part_edges[b], solids.part_edges[b + 1]):
            q, v = _segment(solids, k)
            s, t = _nearest_on(p, u, q, v)
            arm = minus3(axpy(t, v, q), axpy(s, u, p))
            if dot(arm, arm) < best:
                best, edge_a, edge_b = dot(arm, arm), i, k
    return edge_a, edge_b


@inline
def _edge_joint(solids, face_a, edges, axis, crossing, out, joint, first):
    """Compute the contact point where two edges are nearest; without a crossing it has no margin."""
    frames, places, weights, gaps, features, measures = out
    p, u = _segment(solids, edges[0])
    q, v = _segment(solids, edges[1])
    s, t = _nearest_on(p, u, q, v)
    on_a, on_b = axpy(s, u, p), axpy(t, v, q)
    long_u, long_v, c = math.sqrt(dot(u, u)), math.sqrt(dot(v, v)), cross3(u, v)
    margin = min(min(s, 1.0 - s) * long_u, min(t, 1.0 - t) * long_v)
    if not crossing or math.sqrt(dot(c, c)) < PARALLEL * long_u * long_v:
        margin = 0.0
    gap = dot(minus3(on_b, on_a), axis)
    _put(places, first, axpy(0.5, minus3(on_b, on_a), on_a))
    gaps[first], features[first], weights[first] = gap, 0, 1.0
    measures[joint, MARGIN], measures[joint, GAP], measures[joint, TORSION] = margin, gap, 1.0
    along = unit3(u)
    t1 = axpy(-dot(along, axis), axis, along)
    length = math.sqrt(dot(t1, t1))
    _put_frame(frames, joint, axis, unit3(t1) if length > PARALLEL else first_tangent(solids, face_a, axis))
    return 1


@inline
def describe_pair(solids, a, b, pair_of_faces, work, out, joint, first):
    """Compute contact points of one pair of parts; returns the kind of joint and how many points."""
    face_a, face_b = pair_of_faces
    size = min(solids.sizes[a], solids.sizes[b])
    _, axis, edge_a, edge_b = separate(solids, a, b, math.inf)
    normal_a, normal_b = row3(solids.normals, face_a), row3(solids.normals, face_b)
    along_a, along_b = dot(normal_a, axis), -dot(normal_b, axis)
    if min(along_a, along_b) >= STEEP and -dot(normal_a, normal_b) >= STEEP:
        count = _face_joint(solids, face_a, face_b, size, work, out, joint, first)
        if count:
            return FACES, count
    for turn in range(2):
        on_a = (along_a >= along_b) == (turn == 0)
        if (along_a if on_a else along_b) < STEEP:
            continue
        face, other, sign = (face_a, b, 1.0) if on_a else (face_b, a, -1.0)
        count = _rim_joint(solids, face, other, sign, size, work, out, joint, first)
        if count:
            return RIM_OF_A if on_a else RIM_OF_B, count
    crossing = edge_a != NO_EDGE
    if not crossing:
        edge_a, edge_b = _nearest_edges(solids, a, b)
    return EDGES, _edge_joint(solids, face_a, (edge_a, edge_b), axis, crossing, out, joint, first)


@kernel
def describe(solids, parts, faces, starts, work, out, kinds_out, counts_out):
    """Compute contact points of all pairs of parts with their faces, (n, 2) each.

    starts: room for the points of each, (n + 1,): as many as both faces have corners; work: (5, room of one pair, 3).
    out: frames (n, 9); and in the room of each pair places (3 columns), weights [m² or 1], gaps [m], features; measures
    (n, 8): how far the contact reaches [m], area, gap at the centroid, polar moment, centroid, torsion
    (contact/corner_forces.py).
    """
    for joint in range(parts.shape[0]):
        pair_of_faces = (faces[joint, 0], faces[joint, 1])
        kind, count = describe_pair(
            solids, parts[joint, 0], parts[joint, 1], pair_of_faces, work, out, joint, starts[joint]
        )
        kinds_out[joint], counts_out[joint] = kind, count
