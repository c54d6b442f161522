"""Distance between two convex polyhedra: separating axes of faces and of pairs of edges that support each other.

The difference of two convex bodies has three sorts of facets: faces of the one, faces of the other, and pairs of edges
whose arcs on the sphere of normals cross (Gregorius 2013). They are apart as far as the furthest of these facets.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import inline, kernel
from dem_cli.core.kernels.overlap import area_of, clip
from dem_cli.core.kernels.vec import dot

TIE = 1e-9  # of the size: separations that are the same
EDGE_SHARE = 0.01  # of the separation by faces, and
EDGE_SIZE = 1e-6  # of the size: by so much an axis of two edges must beat the faces, which make steadier joints
ALIGNED = 0.05  # sine of the angle between edges that are parallel: where and how they cross swings with the blocks
TURN = 1e-12  # sine of the angle between faces that are parallel but for round-off
NEARLY = 0.05  # sine of the angle between faces of a part that may stand for each other: which one is said by overlaps
LEVEL = 1e-6  # of the size: gaps that differ by so little are the same
NO_EDGE = -1


@inline
def cross3(a, b):
    """Compute the cross product of two vectors in space."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inline
def minus3(a, b):
    """Subtract two vectors in space."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inline
def unit3(a):
    """Normalise a vector in space to length one."""
    length = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    return (a[0] / length, a[1] / length, a[2] / length)


@inline
def row3(array, row):
    """Load a row of three numbers as a tuple."""
    return (array[row, 0], array[row, 1], array[row, 2])


@inline
def height_over(solids, face, part):
    """Compute the least height of the corners of a part over the plane of a face, negative where one lies behind."""
    n = row3(solids.normals, face)
    x = row3(solids.corners, solids.face_corners[solids.face_starts[face]])
    offset = dot(x, n)
    least = math.inf
    for k in range(solids.part_starts[part], solids.part_starts[part + 1]):
        height = solids.corners[k, 0] * n[0] + solids.corners[k, 1] * n[1] + solids.corners[k, 2] * n[2] - offset
        least = min(least, height)
    return least


@inline
def _highest_face(solids, part, other, tie):
    """Find the face of a part over which the other one is highest, and how high."""
    best, best_face = -math.inf, solids.part_faces[part]
    for face in range(solids.part_faces[part], solids.part_faces[part + 1]):
        height = height_over(solids, face, other)
        if height > best + tie:
            best, best_face = height, face
    return best, best_face


@inline
def _highest_edges(solids, a, b):
    """Find the two edges between which the parts are furthest apart, their distance, and the axis from a to b."""
    best, best_a, best_b, axis = -math.inf, NO_EDGE, NO_EDGE, (0.0, 0.0, 0.0)
    for i in range(solids.part_edges[a], solids.part_edges[a + 1]):
        n1, n2 = row3(solids.normals, solids.edges[i, 2]), row3(solids.normals, solids.edges[i, 3])
        start = row3(solids.corners, solids.edges[i, 0])
        along = minus3(row3(solids.corners, solids.edges[i, 1]), start)
        turn_a = cross3(n2, n1)
        for k in range(solids.part_edges[b], solids.part_edges[b + 1]):
            m1, m2 = row3(solids.normals, solids.edges[k, 2]), row3(solids.normals, solids.edges[k, 3])
            side1, side2 = -dot(m1, turn_a), -dot(m2, turn_a)
            if side1 * side2 >= 0.0:
                continue
            turn_b = cross3(m2, m1)  # of −m2 and −m1: the same
            side3, side4 = dot(n1, turn_b), dot(n2, turn_b)
            if side3 * side4 >= 0.0 or side1 * side4 <= 0.0:
                continue
            there = row3(solids.corners, solids.edges[k, 0])
            beside = minus3(row3(solids.corners, solids.edges[k, 1]), there)
            c = cross3(along, beside)
            length = math.sqrt(dot(c, c))
            if length <= ALIGNED * math.sqrt(dot(along, along) * dot(beside, beside)):
                continue
            if dot(c, n1) + dot(c, n2) < 0.0:
                length = -length
            c = (c[0] / length, c[1] / length, c[2] / length)
            apart = dot(minus3(there, start), c)
            if apart > best:
                best, best_a, best_b, axis = apart, i, k, c
    return best, best_a, best_b, axis


@inline
def _off_axis(solids, face, axis, sign):
    """Squared difference between the normal of a face and sign × axis: of small angles, the angle squared."""
    n = row3(solids.normals, face)
    off = (n[0] - sign * axis[0], n[1] - sign * axis[1], n[2] - sign * axis[2])
    return dot(off, off)


@inline
def _most_along(solids, part, axis, sign):
    """The face of a part whose normal points most along sign × axis; how far off a face may be that stands for it,
    squared, and whether there is one."""
    cosine, face, after = -math.inf, solids.part_faces[part], -math.inf
    for other in range(solids.part_faces[part], solids.part_faces[part + 1]):
        level = sign * dot(row3(solids.normals, other), axis)
        if level > cosine + TIE:
            cosine, face, after = level, other, cosine
        else:
            after = max(after, level)
    limit = (math.sqrt(max(2.0 - 2.0 * cosine, 0.0)) + NEARLY) ** 2
    if 2.0 - 2.0 * after > limit:
        return face, limit, False
    best = math.inf  # cosines do not tell small angles apart
    for other in range(solids.part_faces[part], solids.part_faces[part + 1]):
        off = _off_axis(solids, other, axis, sign)
        if off < best * (1.0 - TIE) - TURN * TURN:
            best, face = off, other
    return face, limit, True


@inline
def _seen_along(solids, face, axis, t1, t2, turned, work, row):
    """Project the corners of a face along the axis; `turned`: the other way round. Returns how many."""
    first, count = solids.face_starts[face], solids.face_starts[face + 1] - solids.face_starts[face]
    for k in range(count):
        corner = row3(solids.corners, solids.face_corners[first + (count - 1 - k if turned else k)])
        work[row, k, 0], work[row, k, 1], work[row, k, 2] = dot(corner, t1), dot(corner, t2), float(k)
    return count


@inline
def _level(solids, face, axis, place):
    """Compute the height along the axis at which the plane of a face lies over a place."""
    n = row3(solids.normals, face)
    corner = row3(solids.corners, solids.face_corners[solids.face_starts[face]])
    return dot(minus3(corner, place), n) / dot(axis, n)


@inline
def _carries(solids, face_a, face_b, axis, t1, t2, separation, size, work):
    """Compute the area that two faces share, seen along the axis, as far as it is as near as the parts are [m²].

    Less where the gap at its centroid is wider than their separation: by half where it is as much wider as the parts
    overlap, or as LEVEL of the size.
    """
    n_a = _seen_along(solids, face_a, axis, t1, t2, False, work, 0)
    n_b = _seen_along(solids, face_b, axis, t1, t2, True, work, 1)
    count = clip(work, n_a, n_b, size)
    if count < 3:
        return 0.0
    area, x, y, _ = area_of(work, count)
    place = (x * t1[0] + y * t2[0], x * t1[1] + y * t2[1], x * t1[2] + y * t2[2])
    gap = _level(solids, face_b, axis, place) - _level(solids, face_a, axis, place)
    near = max(-separation, 0.0) + LEVEL * size
    return area * near / (near + max(gap - separation, 0.0))


@inline
def _facing(solids, a, b, axis, separation, work):
    """Find the faces of two parts that look at each other along an axis, and areas that other faces share beside these
    [m²].

    Those most along it. Where a part has others that are nearly so, as beside the kink of a bed, the two of them that
    share the most: a part that lies over one side of the kink has nothing on the other side of it, however it turns.
    """
    most_a, limit_a, several_a = _most_along(solids, a, axis, 1.0)
    most_b, limit_b, several_b = _most_along(solids, b, axis, -1.0)
    if not (several_a or several_b):
        return most_a, most_b, 0.0
    size = min(solids.sizes[a], solids.sizes[b])
    across = (1.0, 0.0, 0.0) if abs(axis[0]) < 0.7 else (0.0, 1.0, 0.0)
    t1 = unit3(cross3(across, axis))
    t2 = cross3(axis, t1)
    face_a, face_b, total = most_a, most_b, 0.0
    best = _carries(solids, most_a, most_b, axis, t1, t2, separation, size, work)
    for i in range(solids.part_faces[a], solids.part_faces[a + 1]):
        if _off_axis(solids, i, axis, 1.0) > limit_a:
            continue
        for k in range(solids.part_faces[b], solids.part_faces[b + 1]):
            if _off_axis(solids, k, axis, -1.0) > limit_b:
                continue
            shared = _carries(solids, i, k, axis, t1, t2, separation, size, work)
            total += shared
            if shared > best * (1.0 + TIE):
                best, face_a, face_b = shared, i, k
    return face_a, face_b, max(total - best, 0.0)


@inline
def separate(solids, a, b, reach):
    """Compute the separation of parts a and b [m], the axis from a to b, and the two edges that set it; NO_EDGE: a face
    does.

    Not sought any further where it is found to be larger than `reach`.
    """
    size = min(solids.sizes[a], solids.sizes[b])
    tie = TIE * size
    by_a, face_a = _highest_face(solids, a, b, tie)
    axis = row3(solids.normals, face_a)
    if by_a > reach:
        return by_a, axis, NO_EDGE, NO_EDGE
    by_b, face_b = _highest_face(solids, b, a, tie)
    by_face = by_a
    if by_b > by_a + tie:
        by_face = by_b
        n = row3(solids.normals, face_b)
        axis = (-n[0], -n[1], -n[2])
    if by_face > reach:
        return by_face, axis, NO_EDGE, NO_EDGE
    by_edges, edge_a, edge_b, between = _highest_edges(solids, a, b)
    if by_edges > by_face + EDGE_SHARE * abs(by_face) + EDGE_SIZE * size:
        return by_edges, between, edge_a, edge_b
    return max(by_face, by_edges), axis, NO_EDGE, NO_EDGE


@kernel
def separations(solids, pairs, reach, work, separation_out, faces_out, left_out):
    """Compute separations [m] of pairs of parts (n, 2), and their two faces that look at each other along the axis, (n,
    2).

    left_out: area that they share with other faces as well, across a kink of almost nothing [m²], (n,).
    work: room for the corners of two faces, as `clip` has it.
    """
    for number in range(pairs.shape[0]):
        a, b = pairs[number, 0], pairs[number, 1]
        separation, axis, _, _ = separate(solids, a, b, reach)
        separation_out[number] = separation
        if separation <= reach:
            face_a, face_b, left_out[number] = _facing(solids, a, b, axis, separation, work)
            faces_out[number, 0], faces_out[number, 1] = face_a, face_b
