"""Search for neighbours: parts that touch or may soon touch. Boxes are swept in 2D, then separating axes; in 3D boxes
in uniform cells.

In the plane faces are found. For two convex polygons the axis of largest separation is the normal of an edge; the joint
is that edge and the most antiparallel edge of the other polygon (Gottschalk, Lin and Manocha 1996).
"""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.kernels.jit import inline, kernel


@inline
def _separation(corners, i, j, t0, t1):
    """Compute the distance of polygon t from the line of edge (i, j), negative where it lies behind."""
    tx, ty = corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1]
    length = math.sqrt(tx * tx + ty * ty)
    nx, ny = ty / length, -tx / length
    separation = math.inf
    for k in range(t0, t1):
        distance = (corners[k, 0] - corners[i, 0]) * nx + (corners[k, 1] - corners[i, 1]) * ny
        separation = min(separation, distance)
    return separation


@inline
def _deepest_edge(corners, s0, s1, t0, t1):
    """Find the edge of polygon s from which polygon t has the largest separation, and that separation."""
    best, best_edge = -math.inf, s0
    for i in range(s0, s1):
        separation = _separation(corners, i, i + 1 if i + 1 < s1 else s0, t0, t1)
        if separation > best:
            best, best_edge = separation, i
    return best, best_edge


@inline
def _opposite_edge(corners, i, j, t0, t1):
    """Find the edge of polygon t whose outward normal points most against that of edge (i, j)."""
    tx, ty = corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1]
    best, best_edge = math.inf, t0
    for k in range(t0, t1):
        m = k + 1 if k + 1 < t1 else t0
        ux, uy = corners[m, 0] - corners[k, 0], corners[m, 1] - corners[k, 1]
        cosine = (tx * ux + ty * uy) / math.sqrt(ux * ux + uy * uy)
        if cosine < best:
            best, best_edge = cosine, k
    return best_edge


@inline
def _overlap(corners, i, j, k, m):
    """Compute the length over which edge (k, m) lies opposite to edge (i, j), along the latter."""
    tx, ty = corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1]
    length = math.sqrt(tx * tx + ty * ty)
    low = ((corners[m, 0] - corners[i, 0]) * tx + (corners[m, 1] - corners[i, 1]) * ty) / length
    high = ((corners[k, 0] - corners[i, 0]) * tx + (corners[k, 1] - corners[i, 1]) * ty) / length
    return min(high, length) - max(low, 0.0)


@inline
def _keep(parts_out, edges_out, distance_out, first, count, a, b, i, k, separation):
    """Write a pair unless it was written since `first`; returns the new count."""
    for n in range(first, min(count, edges_out.shape[0])):
        if edges_out[n, 0] == i and edges_out[n, 1] == k:
            return count
    if count < parts_out.shape[0]:
        parts_out[count, 0], parts_out[count, 1] = a, b
        edges_out[count, 0], edges_out[count, 1] = i, k
        distance_out[count] = separation
    return count + 1


@kernel
def find_pairs(order, boxes, corners, part_starts, part_blocks, fixed, reach, parts_out, edges_out, distance_out):
    """Find pairs of faces of convex parts closer than `reach` [m].

    order         parts sorted by the left side of their box, (n_parts,)
    boxes         (left, right, bottom, top) of each part [m], (n_parts, 4)
    parts_out     the two parts, (capacity, 2)
    edges_out     first corners of the edge of part a and of part b, (capacity, 2)
    distance_out  separation of the two parts [m], negative: overlap, (capacity,)
    Two parts have one pair of faces. Where they meet corner to corner, all pairs of faces that may come
    to touch next are added: a block that slides over a corner goes on along the other face.
    Returns the number of pairs, which may exceed the capacity: call again with more room.
    """
    count = 0
    n_parts = order.shape[0]
    for first in range(n_parts):
        p = order[first]
        right = boxes[p, 1] + reach
        for second in range(first + 1, n_parts):
            q = order[second]
            if boxes[q, 0] > right:
                break
            if boxes[q, 2] > boxes[p, 3] + reach or boxes[p, 2] > boxes[q, 3] + reach:
                continue
            if part_blocks[p] == part_blocks[q] or (fixed[part_blocks[p]] and fixed[part_blocks[q]]):
                continue
            a, b = (p, q) if p < q else (q, p)
            a0, a1, b0, b1 = part_starts[a], part_starts[a + 1], part_starts[b], part_starts[b + 1]
            from_a, i = _deepest_edge(corners, a0, a1, b0, b1)
            if from_a > reach:
                continue
            from_b, k = _deepest_edge(corners, b0, b1, a0, a1)
            if from_b > reach:
                continue
            separation = max(from_a, from_b)
            if from_a >= from_b:
                k = _opposite_edge(corners, i, i + 1 if i + 1 < a1 else a0, b0, b1)
            else:
                i = _opposite_edge(corners, k, k + 1 if k + 1 < b1 else b0, a0, a1)
            start = count
            count = _keep(parts_out, edges_out, distance_out, start, count, a, b, i, k, separation)
            j, m = i + 1 if i + 1 < a1 else a0, k + 1 if k + 1 < b1 else b0
            if min(_overlap(corners, i, j, k, m), _overlap(corners, k, m, i, j)) > 2.0 * reach:
                continue
            for i in range(a0, a1):
                j = i + 1 if i + 1 < a1 else a0
                if -4.0 * reach < _separation(corners, i, j, b0, b1):
                    k = _opposite_edge(corners, i, j, b0, b1)
                    count = _keep(parts_out, edges_out, distance_out, start, count, a, b, i, k, separation)
            for k in range(b0, b1):
                m = k + 1 if k + 1 < b1 else b0
                if -4.0 * reach < _separation(corners, k, m, a0, a1):
                    i = _opposite_edge(corners, k, m, a0, a1)
                    count = _keep(parts_out, edges_out, distance_out, start, count, a, b, i, k, separation)
    return count


@kernel
def place_corners(positions, orientations, corner_blocks, corner_arms, corners_out):
    """Compute world coordinates of all corners [m], (n_vertices, 2)."""
    block, c, s = -1, 1.0, 0.0
    for i in range(corner_blocks.shape[0]):
        if corner_blocks[i] != block:
            block = corner_blocks[i]
            c, s = np.cos(orientations[block, 0]), np.sin(orientations[block, 0])
        x, y = corner_arms[i, 0], corner_arms[i, 1]
        corners_out[i, 0] = positions[block, 0] + c * x - s * y
        corners_out[i, 1] = positions[block, 1] + s * x + c * y


@inline
def _cells(boxes, part, origin, per_cell, shape, axis, reach):
    """Compute the first and last cell of a box along an axis."""
    low = math.floor((boxes[part, 0, axis] - reach - origin[axis]) * per_cell)
    high = math.floor((boxes[part, 1, axis] + reach - origin[axis]) * per_cell)
    return min(max(low, 0), shape[axis] - 1), min(max(high, 0), shape[axis] - 1)


@kernel
def enter_cells(boxes, parts, origin, per_cell, shape, reach, cells_out, parts_out):
    """Enter each of `parts` into all cells that its box, grown by `reach` [m], touches; returns how many entries.

    boxes: lowest and highest corner of each part [m], (n_parts, 2, 3); cells have sides of 1 / per_cell [m], shape: how
    many there are along each axis. The number may exceed the room: call again with more.
    """
    count = 0
    for part in parts:
        x0, x1 = _cells(boxes, part, origin, per_cell, shape, 0, reach)
        y0, y1 = _cells(boxes, part, origin, per_cell, shape, 1, reach)
        z0, z1 = _cells(boxes, part, origin, per_cell, shape, 2, reach)
        for x in range(x0, x1 + 1):
            for y in range(y0, y1 + 1):
                for z in range(z0, z1 + 1):
                    if count < cells_out.shape[0]:
                        cells_out[count] = (x * shape[1] + y) * shape[2] + z
                        parts_out[count] = part
                    count += 1
    return count


@inline
def boxes_meet(boxes, p, q, reach):
    """Test whether two boxes come closer than `reach` [m] along every axis."""
    for axis in range(3):
        if boxes[p, 0, axis] > boxes[q, 1, axis] + reach or boxes[q, 0, axis] > boxes[p, 1, axis] + reach:
            return False
    return True


@kernel
def pairs_in_cells(boxes, cells, parts, blocks, fixed, grid, reach, pairs_out):
    """Find pairs of parts of different blocks, not both fixed, whose boxes meet; entries sorted by cell. Returns how
    many.

    grid: (origin, per_cell, shape) as in `enter_cells`. The number may exceed the room: call again with more.
    """
    origin, per_cell, shape = grid
    count, first = 0, 0
    for number in range(cells.shape[0]):
        if cells[number] != cells[first]:
            first = number
        q = parts[number]
        for other in range(first, number):
            p = parts[other]
            if blocks[p] == blocks[q] or (fixed[blocks[p]] and fixed[blocks[q]]) or not boxes_meet(boxes, p, q, reach):
                continue
            place = 0  # the cell of the lower corner of what both boxes share: the higher of both first cells
            for axis in range(3):
                low, _ = _cells(boxes, p, origin, per_cell, shape, axis, reach)
                also, _ = _cells(boxes, q, origin, per_cell, shape, axis, reach)
                place = place * shape[axis] + max(low, also)
            if place != cells[number]:
                continue
            if count < pairs_out.shape[0]:
                pairs_out[count, 0], pairs_out[count, 1] = min(p, q), max(p, q)
            count += 1
    return count


@kernel
def pairs_of_large(boxes, large, blocks, fixed, is_large, reach, pairs_out):
    """Find pairs of `large` parts with all others, as `pairs_in_cells`."""
    count = 0
    for p in large:
        for q in range(boxes.shape[0]):
            if q == p or (is_large[q] and q < p):
                continue
            if blocks[p] == blocks[q] or (fixed[blocks[p]] and fixed[blocks[q]]) or not boxes_meet(boxes, p, q, reach):
                continue
            if count < pairs_out.shape[0]:
                pairs_out[count, 0], pairs_out[count, 1] = min(p, q), max(p, q)
            count += 1
    return count
