"""Contact points between two parts in space that move: corners and crossings of their overlap, and the area of each.

Faces are clipped in the plane across the joint; outside of face joints corners on a face and edges that cross its rim
have an area of their own. Triangles about the centroid give the area of a corner of the overlap; one at which the
outline hardly turns gives it to its neighbours, so that nothing jumps where it comes or goes (overlap.fading_areas).

Points within the area of a joint of the start (contact/area_rules.py) belong to block b, as cracks do. One that block a
no longer covers is held at the rim of the overlap and fades over a length like that of its own area; with what is left
area and first moment are those of the overlap, but for slivers, where area alone is.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import always_inline, kernel
from dem_cli.core.kernels.overlap import (
    OF_LINE,
    ROUND_OFF,
    SAME,
    SHARE,
    area_of,
    clip,
    fading_areas,
    held_inside,
    mean_distance,
    simplify,
    tilted,
)
from dem_cli.core.kernels.records import (
    CORNER_OF_A,
    CORNER_OF_B,
    CROSSING,
    EDGES,
    FACES,
    FIXED_TO_B,
    RIM_OF_A,
    RIM_OF_B,
)
from dem_cli.core.kernels.separation import NO_EDGE, cross3, minus3, row3, separate, unit3
from dem_cli.core.kernels.spatial_features import NONE, carried3, carried_back3, height_inside, tangents3
from dem_cli.core.kernels.spatial_geometry import STEEP
from dem_cli.core.kernels.vec import axpy, dot

# Columns of SpatialMotion.scales.
SIZE = 0  # root of the smaller face [m]
BAND = 1  # width over which normals turn at rims [m]
KN, KS = 2, 3  # stiffness per area [Pa/m]
LONE = 4  # area of a point outside of face joints [m²]
FLOOR = 5  # area of a face joint, at least [m²]
REACH = 6  # how high features outside of face joints may lie over the face [m]
CENTRED = 7  # 1: face joints have a point at their centroid as well
OWN = 8  # share of the area that corners have where points of a rule lie within; 0: there are none
SPREAD = 9  # 1: friction has the torsion of a spread pressure (contact/corner_forces.py)

MOVED = 1e-3  # of SIZE: motion along the joint after which it is renewed
SLIVER = 1e-6  # of FLOOR: overlaps below it are none; tips sink unseen by about its root
NARROW = 1e-4  # of SIZE: overlaps of less than that width are none
LOCAL = 1024  # corners of a part that features tell apart
CAP = 2 * LOCAL + LOCAL**4  # features of caps: from here on, beyond those of crossings
LABEL = 2  # column of row 2: what a corner of the overlap is
LEFT_OVER = 0.05  # of its area that a point keeps at least where areas are tilted to where the overlap is


@always_inline
def _flatten(geometry, vertices, face, origin, t1, t2, work, row, turned):
    """Project corners of a face into the plane of t1 and t2; `turned`: the other way round. Returns how many."""
    first = geometry.face_starts[face]
    count = geometry.face_starts[face + 1] - first
    for k in range(count):
        corner = geometry.face_corners[first + (count - 1 - k if turned else k)]
        arm = minus3(row3(vertices, corner), origin)
        work[row, k, 0], work[row, k, 1], work[row, k, 2] = dot(arm, t1), dot(arm, t2), float(k)
    return count


@always_inline
def _corner_of(geometry, face, k, turned):
    """Return the vertex of corner k of a face that was flattened."""
    first = geometry.face_starts[face]
    count = geometry.face_starts[face + 1] - first
    k %= count
    return geometry.face_corners[first + (count - 1 - k if turned else k)]


@always_inline
def torsion_now(geometry, joint, count):
    """Compute the torsion share of the points that were just found, as FixedJoints.torsion."""
    kind, work = geometry.kinds[joint], geometry.work
    if kind != FACES:
        return OF_LINE if kind != EDGES and count == 2 else 1.0
    if count < 3:
        return 1.0
    area, gx, gy, _ = area_of(work, count)
    distance, weight = 0.0, 0.0
    for k in range(count):
        x, y = work[2, k, 0] - gx, work[2, k, 1] - gy
        distance += work[2, k, SHARE] * math.sqrt(x * x + y * y)
        weight += work[2, k, SHARE]
    return min(mean_distance(work, count, gx, gy) * weight / distance, 1.0) if area > 0.0 else 1.0


@always_inline
def _perimeter(work, count):
    """Compute the perimeter of the overlap in row 2 of `work` [m]."""
    around = 0.0
    for k in range(count):
        m = k + 1 if k + 1 < count else 0
        around += math.hypot(work[2, m, 0] - work[2, k, 0], work[2, m, 1] - work[2, k, 1])
    return around


@always_inline
def _clipped(geometry, vertices, joint, frame, along, work):
    """Overlap of the two faces of a joint in row 2 of `work`, with areas; returns corners, area, and its centroid."""
    face_a, face_b = geometry.faces[joint, 0], geometry.faces[joint, 1]
    middle = frame[2]
    t1, t2 = tangents3(middle, along)
    origin = row3(vertices, geometry.face_corners[geometry.face_starts[face_a]])
    n_a = _flatten(geometry, vertices, face_a, origin, t1, t2, work, 0, False)
    n_b = _flatten(geometry, vertices, face_b, origin, t1, t2, work, 1, True)
    size = geometry.scales[joint, SIZE]
    count = clip(work, n_a, n_b, size)
    if count < 3:
        return 0, 0.0, origin, 0.0
    area, gx, gy, polar = area_of(work, count)
    least = max(SLIVER * geometry.scales[joint, FLOOR], (SAME * size) ** 2)
    count = simplify(work, count, SAME * size)
    if count < 3 or area <= least or 2.0 * area <= NARROW * size * _perimeter(work, count):
        return 0, 0.0, origin, 0.0
    fading_areas(work, count, area, gx, gy)
    lumped, floor = 0.0, max(geometry.scales[joint, FLOOR] / area, 1.0)
    for k in range(count):
        x, y = work[2, k, 0] - gx, work[2, k, 1] - gy
        lumped += work[2, k, SHARE] * (x * x + y * y)
        work[2, k, SHARE] *= floor
    keep = polar / lumped if geometry.scales[joint, CENTRED] > 0.0 else 1.0
    keep = geometry.scales[joint, OWN] if geometry.scales[joint, OWN] > 0.0 else keep
    for k in range(count):
        work[2, k, SHARE] *= keep
    return count, (1.0 - keep) * floor * area, axpy(gy, t2, axpy(gx, t1, origin)), keep


@always_inline
def _sides_near(geometry, vertices, face, outwards, corner, width, out):
    """Find up to two sides of the rim of a face that are nearer to a corner than `width`: their ends, into out[1:5]."""
    first = geometry.face_starts[face]
    count = geometry.face_starts[face + 1] - first
    nearest, second = width, width
    for m in range(1, 5):
        out[m] = NONE
    for k in range(count):
        start = geometry.face_corners[first + k]
        end = geometry.face_corners[first + (k + 1 if k + 1 < count else 0)]
        origin = row3(vertices, start)
        along = unit3(minus3(row3(vertices, end), origin))
        depth = dot(minus3(corner, origin), cross3(outwards, along))
        if depth < nearest:
            out[3], out[4], second = out[1], out[2], nearest
            out[1], out[2], nearest = start, end, depth
        elif depth < second:
            out[3], out[4], second = start, end, depth


@always_inline
def _edge_key(start, end, first):
    """Number an edge of a part by its two corners, whichever comes first."""
    low, high = min(start, end) - first, max(start, end) - first
    return low % LOCAL * LOCAL + high % LOCAL


@always_inline
def _label_corner(of_a, corner, first):
    """Number the feature of a corner of a part."""
    return (LOCAL if of_a else 0) + (corner - first) % LOCAL


@always_inline
def _label_crossing(a0, a1, b0, b1, first_a, first_b):
    """Number the feature of two crossing edges."""
    return 2 * LOCAL + _edge_key(a0, a1, first_a) * LOCAL * LOCAL + _edge_key(b0, b1, first_b)


@always_inline
def _describe(geometry, joint, k, work, found, labels):
    """Identify corner k of the overlap in row 2: its corners into found[k], feature and type into labels[k]."""
    face_a, face_b = geometry.faces[joint, 0], geometry.faces[joint, 1]
    n_a = geometry.face_starts[face_a + 1] - geometry.face_starts[face_a]
    n_b = geometry.face_starts[face_b + 1] - geometry.face_starts[face_b]
    first_a = geometry.part_starts[geometry.keys[joint, 0]]
    first_b = geometry.part_starts[geometry.keys[joint, 1]]
    what = int(work[2, k, LABEL])
    for m in range(5):
        found[k, m] = NONE
    if what < n_b:
        found[k, 0] = _corner_of(geometry, face_b, what, True)
        labels[k, 0], labels[k, 1] = _label_corner(False, found[k, 0], first_b), CORNER_OF_B
    elif what < n_b + n_a:
        found[k, 0] = _corner_of(geometry, face_a, what - n_b, False)
        labels[k, 0], labels[k, 1] = _label_corner(True, found[k, 0], first_a), CORNER_OF_A
    else:
        i, m = (what - n_b - n_a) // n_b, (what - n_b - n_a) % n_b
        found[k, 0], found[k, 1] = _corner_of(geometry, face_a, i, False), _corner_of(geometry, face_a, i + 1, False)
        found[k, 2], found[k, 3] = _corner_of(geometry, face_b, m, True), _corner_of(geometry, face_b, m + 1, True)
        labels[k, 0] = _label_crossing(found[k, 0], found[k, 1], found[k, 2], found[k, 3], first_a, first_b)
        labels[k, 1] = CROSSING


@always_inline
def in_faces(geometry, bodies, joint, pair, frame, along, out):
    """Find the points of a face joint, into the arrays of `out`; returns how many."""
    work, found, labels, numbers = out
    vertices = bodies.corners
    count, centre_area, centre, keep = _clipped(geometry, vertices, joint, frame, along, work)
    width = geometry.scales[joint, BAND] + 2.0 * MOVED * geometry.scales[joint, SIZE]
    for k in range(count):
        _describe(geometry, joint, k, work, found, labels)
        numbers[k, 0], numbers[k, 1] = work[2, k, SHARE], 0.0
        if labels[k, 1] == CROSSING:
            start = row3(vertices, found[k, 0])
            edge = minus3(row3(vertices, found[k, 1]), start)
            t1, t2 = tangents3(frame[2], along)
            origin = row3(vertices, geometry.face_corners[geometry.face_starts[geometry.faces[joint, 0]]])
            place = axpy(work[2, k, 1], t2, axpy(work[2, k, 0], t1, origin))
            flat = axpy(-dot(edge, frame[2]), frame[2], edge)
            numbers[k, 1] = min(max(dot(minus3(place, start), flat) / dot(flat, flat), 0.0), 1.0)
        elif labels[k, 1] == CORNER_OF_B:
            corner = row3(vertices, found[k, 0])
            _sides_near(geometry, vertices, geometry.faces[joint, 0], frame[0], corner, width, found[k])
        else:
            n = frame[1]
            corner, outwards = row3(vertices, found[k, 0]), (-n[0], -n[1], -n[2])
            _sides_near(geometry, vertices, geometry.faces[joint, 1], outwards, corner, width, found[k])
    if count > 0 and geometry.scales[joint, OWN] > 0.0:
        return _with_area(
            geometry, bodies, joint, pair[1], frame, along, count, (centre, centre_area / (1.0 - keep)), out
        )
    if count > 0 and keep < 1.0:
        n_b, plane = frame[1], row3(vertices, geometry.face_corners[geometry.face_starts[geometry.faces[joint, 1]]])
        centre = axpy(dot(minus3(plane, centre), n_b) / dot(frame[2], n_b), frame[2], centre)
        b = pair[1]
        arm = carried_back3(bodies, b, minus3(centre, row3(bodies.positions, b)))
        for m in range(5):
            found[count, m] = NONE
        labels[count, 0], labels[count, 1] = 2 * LOCAL - 1, FIXED_TO_B
        numbers[count, 0], numbers[count, 1] = centre_area, 0.0
        numbers[count, 2], numbers[count, 3], numbers[count, 4] = arm
        count += 1
    return _with_cap(geometry, joint, count, found, labels, numbers) if count > 0 else 0


@always_inline
def _with_area(geometry, bodies, joint, b, frame, along, count, overlap, out):
    """Add the points within the area of a joint; returns how many there are. overlap: centroid, area at least."""
    work, found, labels, numbers = out
    vertices, n_b, upwards = bodies.corners, frame[1], frame[2]
    t1, t2 = tangents3(upwards, along)
    origin = row3(vertices, geometry.face_corners[geometry.face_starts[geometry.faces[joint, 0]]])
    plane = row3(vertices, geometry.face_corners[geometry.face_starts[geometry.faces[joint, 1]]])
    centroid = row3(bodies.positions, b)
    middle = minus3(overlap[0], origin)
    gx, gy, first, corners = dot(middle, t1), dot(middle, t2), geometry.cap_starts[joint], count
    raised = overlap[1] / area_of(work, corners)[0]  # where the overlap is below the floor
    for k in range(corners):
        numbers[k, 2], numbers[k, 3] = work[2, k, 0] - gx, work[2, k, 1] - gy
    for k in range(first, geometry.cap_starts[joint + 1]):
        place = axpy(1.0, carried3(bodies, b, row3(geometry.cap_arms, k)), minus3(centroid, origin))
        x, y, away = held_inside(work, corners, dot(place, t1), dot(place, t2))
        area = geometry.cap_areas[k] - math.sqrt(geometry.cap_areas[k]) * away
        if area > 0.0:
            for m in range(5):
                found[count, m] = NONE
            labels[count, 0], labels[count, 1] = CAP + k - first, FIXED_TO_B
            numbers[count, 0], numbers[count, 1], numbers[count, 2], numbers[count, 3] = (
                raised * area,
                0.0,
                x - gx,
                y - gy,
            )
            count += 1
    s0, sx, sy, sxx, sxy, syy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        w, x, y = numbers[k, 0], numbers[k, 2], numbers[k, 3]
        s0 += w
        sx += w * x
        sy += w * y
        sxx += w * x * x
        sxy += w * x * y
        syy += w * y * y
    level, lx, ly = tilted(s0, sx, sy, sxx, sxy, syy, overlap[1])
    total = 0.0
    for k in range(count):
        numbers[k, 0] *= max(level + lx * numbers[k, 2] + ly * numbers[k, 3], LEFT_OVER * level)
        total += numbers[k, 0]
    for k in range(count):
        x, y = numbers[k, 2], numbers[k, 3]
        numbers[k, 0] *= overlap[1] / total
        if k >= corners:
            place = axpy(y + gy, t2, axpy(x + gx, t1, origin))
            place = axpy(dot(minus3(plane, place), n_b) / dot(upwards, n_b), upwards, place)
            arm = carried_back3(bodies, b, minus3(place, centroid))
            numbers[k, 2], numbers[k, 3], numbers[k, 4] = arm
    return count


@always_inline
def _with_cap(geometry, joint, count, found, labels, numbers):
    """Add the inner points of the cap of a joint; returns how many points there are."""
    first = geometry.cap_starts[joint]
    for k in range(first, geometry.cap_starts[joint + 1]):
        for m in range(5):
            found[count, m] = NONE
        labels[count, 0], labels[count, 1] = CAP + k - first, FIXED_TO_B
        numbers[count, 0], numbers[count, 1] = geometry.cap_areas[k], 0.0
        for m in range(3):
            numbers[count, 2 + m] = geometry.cap_arms[k, m]
        count += 1
    return count


@always_inline
def on_rim(geometry, bodies, joint, frame, room, out):
    """Find points of a joint of a face and what of the other part lies on it: corners, and edges that cross its rim."""
    _, found, labels, numbers = out
    vertices, scales = bodies.corners, geometry.scales
    on_a = geometry.kinds[joint] == RIM_OF_A
    face = geometry.faces[joint, 0 if on_a else 1]
    other = geometry.keys[joint, 1 if on_a else 0]
    first_a = geometry.part_starts[geometry.keys[joint, 0]]
    first_b = geometry.part_starts[geometry.keys[joint, 1]]
    n = frame[1]
    outwards = frame[0] if on_a else (-n[0], -n[1], -n[2])
    reach, size, count = scales[joint, REACH], scales[joint, SIZE], 0
    for corner in range(geometry.part_starts[other], geometry.part_starts[other + 1]):
        place = row3(vertices, corner)
        inside, height = height_inside(geometry, vertices, face, outwards, place, ROUND_OFF * size * size)
        if inside and abs(height) <= reach and count < room:
            for m in range(5):
                found[count, m] = NONE
            found[count, 0] = corner
            labels[count, 0] = _label_corner(not on_a, corner, first_b if on_a else first_a)
            labels[count, 1] = CORNER_OF_B if on_a else CORNER_OF_A
            numbers[count, 0], numbers[count, 1] = scales[joint, LONE], 0.0
            count += 1
    first = geometry.face_starts[face]
    n_sides = geometry.face_starts[face + 1] - first
    for edge in range(geometry.part_edges[other], geometry.part_edges[other + 1]):
        q0, q1 = geometry.part_sides[edge, 0], geometry.part_sides[edge, 1]
        q = row3(vertices, q0)
        e = minus3(row3(vertices, q1), q)
        for k in range(n_sides):
            r0 = geometry.face_corners[first + k]
            r1 = geometry.face_corners[first + (k + 1 if k + 1 < n_sides else 0)]
            r = row3(vertices, r0)
            d = minus3(row3(vertices, r1), r)
            c = cross3(d, e)
            level, length = dot(c, outwards), math.sqrt(dot(c, c))
            if abs(level) < 0.5 * length or length < 1e-4 * math.sqrt(dot(d, d) * dot(e, e)):
                continue
            gap = minus3(q, r)
            s, t = dot(cross3(gap, e), outwards) / level, dot(cross3(gap, d), outwards) / level
            height = dot(axpy(t, e, gap), outwards)
            if not (0.0 < s < 1.0 and 0.0 < t < 1.0) or abs(height) > reach or count >= room:
                continue
            found[count, 4] = NONE
            if on_a:
                found[count, 0], found[count, 1], found[count, 2], found[count, 3] = r0, r1, q0, q1
            else:
                found[count, 0], found[count, 1], found[count, 2], found[count, 3] = q0, q1, r0, r1
            labels[count, 0] = _label_crossing(
                found[count, 0], found[count, 1], found[count, 2], found[count, 3], first_a, first_b
            )  # fmt: skip
            labels[count, 1] = CROSSING
            # From a to b: of b's rim, e × d is −c, and its face looks the other way.
            numbers[count, 0], numbers[count, 1] = scales[joint, LONE], 1.0 if level > 0.0 else -1.0
            count += 1
    return count


@always_inline
def of_edges(geometry, joint, out):
    """Find the point of a joint of two edges, if it has any."""
    _, found, labels, numbers = out
    if geometry.edges[joint, 0] == NONE:
        return 0
    for m in range(4):
        found[0, m] = geometry.edges[joint, m]
    found[0, 4] = NONE
    first_a = geometry.part_starts[geometry.keys[joint, 0]]
    first_b = geometry.part_starts[geometry.keys[joint, 1]]
    labels[0, 0] = _label_crossing(found[0, 0], found[0, 1], found[0, 2], found[0, 3], first_a, first_b)
    labels[0, 1] = CROSSING
    numbers[0, 0], numbers[0, 1] = geometry.scales[joint, LONE], float(geometry.edges[joint, 4])
    return 1


@always_inline
def _overlap_anywhere(geometry, vertices, faces, normals, work):
    """Test whether two faces overlap at all, seen along the joint."""
    face_a, face_b = faces[0], faces[1]
    middle = unit3(minus3(normals[0], normals[1]))
    t1, t2 = tangents3(middle, (0.6, 0.64, 0.48))
    origin = row3(vertices, geometry.face_corners[geometry.face_starts[face_a]])
    n_a = _flatten(geometry, vertices, face_a, origin, t1, t2, work, 0, False)
    n_b = _flatten(geometry, vertices, face_b, origin, t1, t2, work, 1, True)
    return clip(work, n_a, n_b, 1.0) >= 3


@kernel
def classify(solids, parts, faces, separations, work, kinds_out, edges_out):
    """Classify joints of pairs of parts (n,), as SpatialMotion.kinds, and find the edges that cross, as its `edges`.

    Faces within 30° of the separating axis and of each other look at each other; else a face within 30° of it has what
    lies on it; else two edges cross. Parts inside each other always have something in common there.
    """
    for number in range(parts.shape[0]):
        a, b = parts[number, 0], parts[number, 1]
        _, axis, edge_a, edge_b = separate(solids, a, b, math.inf)
        normal_a, normal_b = row3(solids.normals, faces[number, 0]), row3(solids.normals, faces[number, 1])
        along_a, along_b = dot(normal_a, axis), -dot(normal_b, axis)
        kind = EDGES
        if max(along_a, along_b) >= STEEP:
            kind = RIM_OF_A if along_a >= along_b else RIM_OF_B
        facing = min(along_a, along_b) >= STEEP and -dot(normal_a, normal_b) >= STEEP
        if facing and (
            separations[number] >= 0.0
            or _overlap_anywhere(solids, solids.corners, faces[number], (normal_a, normal_b), work)
        ):
            kind = FACES
        kinds_out[number] = kind
        for m in range(5):
            edges_out[number, m] = NONE
        if kind == EDGES and edge_a != NO_EDGE:
            a0, a1 = solids.edges[edge_a, 0], solids.edges[edge_a, 1]
            b0, b1 = solids.edges[edge_b, 0], solids.edges[edge_b, 1]
            d = minus3(row3(solids.corners, a1), row3(solids.corners, a0))
            e = minus3(row3(solids.corners, b1), row3(solids.corners, b0))
            edges_out[number, 0], edges_out[number, 1], edges_out[number, 2], edges_out[number, 3] = a0, a1, b0, b1
            edges_out[number, 4] = 1 if dot(cross3(d, e), axis) > 0.0 else -1
