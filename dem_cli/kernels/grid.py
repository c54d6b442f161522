"""Which boxes in space are near each other, by a uniform grid of cells; each pair in the cell of its lower corner."""

from __future__ import annotations

import math

from dem_cli.kernels.jit import inline, kernel


@inline
def _cells(boxes, part, origin, per_cell, shape, axis, reach):
    """First and last cell of a box along an axis."""
    low = math.floor((boxes[part, 0, axis] - reach - origin[axis]) * per_cell)
    high = math.floor((boxes[part, 1, axis] + reach - origin[axis]) * per_cell)
    return min(max(low, 0), shape[axis] - 1), min(max(high, 0), shape[axis] - 1)


@kernel
def enter_cells(boxes, parts, origin, per_cell, shape, reach, cells_out, parts_out):
    """Writes each of `parts` into all cells that its box, grown by `reach` [m], touches; returns how many entries.

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
    """Whether two boxes come closer than `reach` [m] along every axis."""
    for axis in range(3):
        if boxes[p, 0, axis] > boxes[q, 1, axis] + reach or boxes[q, 0, axis] > boxes[p, 1, axis] + reach:
            return False
    return True


@kernel
def pairs_in_cells(boxes, cells, parts, blocks, fixed, grid, reach, pairs_out):
    """Pairs of parts of different blocks, not both fixed, whose boxes meet; entries sorted by cell. Returns how many.

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
    """Pairs of `large` parts with all others, as `pairs_in_cells`."""
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
