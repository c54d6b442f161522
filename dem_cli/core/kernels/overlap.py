"""Overlap of two convex faces in a plane: its corners, and the area that belongs to each."""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import always_inline, inline

ROUND_OFF = 1e-13  # of the size: a corner so close to an edge is on it
SAME = 1e-6  # of the size: corners closer to each other, or to the line between their neighbours, are none
SHARE = 3  # column of row 2: area that belongs to a corner of an overlap that moves
FADES = 0.05  # sine of the turn of an outline below which a corner gives area to its neighbours
OF_LINE = 0.5  # FixedJoints.torsion of two points at the ends of a line of pressure
HANDS = 4  # rounds in which corners that fade and lie side by side hand on what they got


@inline
def _write(work, row, at, x, y, label):
    work[row, at, 0], work[row, at, 1], work[row, at, 2] = x, y, label


@inline
def clip(work, n_a, n_b, size):
    """Compute the corners of the overlap of two convex polygons; returns how many.

    work: (5, room, 3) with rows 0: corners (x, y) of a, 1: of b, both counter-clockwise. Out, in row 2: corners of the
    overlap and what they are: k < n_b: corner k of b; n_b + i: corner i of a; n_b + n_a + i n_b + k: where edge i of a
    (from corner i) crosses edge k of b. Sutherland and Hodgman 1974; each corner carries the edge that leaves it.
    """
    count, here, there, eps = n_b, 2, 3, ROUND_OFF * size
    for k in range(n_b):
        _write(work, here, k, work[1, k, 0], work[1, k, 1], float(k))
    for i in range(n_a):
        j = i + 1 if i + 1 < n_a else 0
        tx, ty = work[0, j, 0] - work[0, i, 0], work[0, j, 1] - work[0, i, 1]
        length = math.sqrt(tx * tx + ty * ty)
        nx, ny = -ty / length, tx / length
        offset = work[0, i, 0] * nx + work[0, i, 1] * ny
        kept = 0
        for k in range(count):
            m = k + 1 if k + 1 < count else 0
            x, y, label = work[here, k, 0], work[here, k, 1], work[here, k, 2]
            inside = x * nx + y * ny - offset
            after = work[here, m, 0] * nx + work[here, m, 1] * ny - offset
            if inside >= -eps:
                _write(work, there, kept, x, y, label)
                kept += 1
            if (inside >= -eps) != (after >= -eps):
                share = min(max(inside / (inside - after), 0.0), 1.0)
                leaving = float(n_b + i) if inside >= -eps else label
                x += share * (work[here, m, 0] - x)
                y += share * (work[here, m, 1] - y)
                _write(work, there, kept, x, y, leaving)
                kept += 1
        count = kept
        here, there = there, here
    for k in range(count):  # from the edges that arrive and leave to what the corner is
        arrives, leaves = work[here, k - 1 if k else count - 1, 2], work[here, k, 2]
        what = leaves
        if (arrives < n_b) != (leaves < n_b):
            what = float(n_b + n_a) + (max(arrives, leaves) - n_b) * n_b + min(arrives, leaves)
        _write(work, 4, k, work[here, k, 0], work[here, k, 1], what)
    for k in range(count):
        _write(work, 2, k, work[4, k, 0], work[4, k, 1], work[4, k, 2])
    return count


@inline
def area_of(work, count):
    """Compute area, centroid and second moment about it of the polygon in row 2, counter-clockwise."""
    x0, y0 = work[2, 0, 0], work[2, 0, 1]
    area, mx, my, polar = 0.0, 0.0, 0.0, 0.0
    for k in range(1, count - 1):
        ax, ay = work[2, k, 0] - x0, work[2, k, 1] - y0
        bx, by = work[2, k + 1, 0] - x0, work[2, k + 1, 1] - y0
        half = 0.5 * (ax * by - ay * bx)
        area += half
        mx += half * (ax + bx)
        my += half * (ay + by)
        polar += half * (ax * ax + ay * ay + ax * bx + ay * by + bx * bx + by * by)
    if area <= 0.0:
        return 0.0, x0, y0, 0.0
    mx /= 3.0 * area
    my /= 3.0 * area
    return area, x0 + mx, y0 + my, polar / 6.0 - area * (mx * mx + my * my)


@inline
def mean_distance(work, count, x, y):
    """Compute the mean distance of the polygon in row 2, counter-clockwise, from a place within it: triangles in closed
    form.

    A triangle with its apex there, its base at the distance h from u to v along it, has
    ∫ r dA = (h (v |v| − u |u|) + h³ (asinh v/h − asinh u/h)) / 6, |u| = √(h² + u²).
    """
    total, area = 0.0, 0.0
    for k in range(count):
        m = k + 1 if k + 1 < count else 0
        ax, ay = work[2, k, 0] - x, work[2, k, 1] - y
        bx, by = work[2, m, 0] - x, work[2, m, 1] - y
        length = math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
        h = (ax * by - ay * bx) / length
        if h > 1e-12 * length:
            u, v = (ax * (bx - ax) + ay * (by - ay)) / length, (bx * (bx - ax) + by * (by - ay)) / length
            ends = v * math.sqrt(h * h + v * v) - u * math.sqrt(h * h + u * u)
            total += h * (ends + h * h * (math.asinh(v / h) - math.asinh(u / h))) / 6.0
            area += 0.5 * h * length
    return total / area if area > 0.0 else 0.0


@inline
def _drop(work, k, count):
    for m in range(k, count - 1):
        _write(work, 2, m, work[2, m + 1, 0], work[2, m + 1, 1], work[2, m + 1, 2])
    return count - 1


@inline
def simplify(work, count, gap):
    """Remove corners of row 2 that coincide (crossings first), or lie on the line between their neighbours."""
    k = 0
    while count > 2 and k < count:
        m = k + 1 if k + 1 < count else 0
        dx, dy = work[2, m, 0] - work[2, k, 0], work[2, m, 1] - work[2, k, 1]
        if dx * dx + dy * dy < gap * gap:
            lesser = m if work[2, m, 2] >= work[2, k, 2] else k
            count = _drop(work, lesser, count)
        else:
            k += 1
    while count > 2:
        flattest, lowest = -1, gap
        for k in range(count):
            i, j = k - 1 if k else count - 1, k + 1 if k + 1 < count else 0
            cx, cy = work[2, j, 0] - work[2, i, 0], work[2, j, 1] - work[2, i, 1]
            px, py = work[2, k, 0] - work[2, i, 0], work[2, k, 1] - work[2, i, 1]
            height = abs(cx * py - cy * px) / max(math.sqrt(cx * cx + cy * cy), 1e-300)
            if height < lowest:
                flattest, lowest = k, height
        if flattest < 0:
            break
        count = _drop(work, flattest, count)
    return count


@inline
def share_area(work, count, area, gx, gy, weights, first):
    """Divide the area of the polygon in row 2 among its corners: half of both triangles with its centroid.

    Their sum is `area` and their centroid (gx, gy): those of the polygon before it was simplified.
    """
    own, cx, cy, _ = area_of(work, count)
    for k in range(count):
        weights[first + k] = 0.0
    for k in range(count):
        m = k + 1 if k + 1 < count else 0
        ax, ay = work[2, k, 0] - cx, work[2, k, 1] - cy
        bx, by = work[2, m, 0] - cx, work[2, m, 1] - cy
        quarter = 0.25 * (ax * by - ay * bx)
        weights[first + k] += quarter
        weights[first + m] += quarter
    sxx, sxy, syy = 0.0, 0.0, 0.0
    for k in range(count):
        x, y, w = work[2, k, 0] - cx, work[2, k, 1] - cy, weights[first + k]
        sxx += w * x * x
        sxy += w * x * y
        syy += w * y * y
    rx, ry, det = area * (gx - cx), area * (gy - cy), sxx * syy - sxy * sxy
    lx, ly = (rx * syy - ry * sxy) / det, (ry * sxx - rx * sxy) / det
    for k in range(count):
        x, y = work[2, k, 0] - cx, work[2, k, 1] - cy
        weights[first + k] *= area / own + lx * x + ly * y


@inline
def _turn_at(work, i, k, j):
    """Sine of the turn of the outline in row 2 at corner k, from i and on to j, and the lengths of both sides."""
    ax, ay = work[2, k, 0] - work[2, i, 0], work[2, k, 1] - work[2, i, 1]
    bx, by = work[2, j, 0] - work[2, k, 0], work[2, j, 1] - work[2, k, 1]
    before, after = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
    return abs(ax * by - ay * bx) / (before * after), before, after


@always_inline
def fades_by(sine):
    """Share of its area that a corner of an outline hands to its neighbours, by the sine of its turn [-]."""
    return max(1.0 - sine / FADES, 0.0)


@inline
def fading_areas(work, count, area, gx, gy):
    """Compute the area of each corner of the polygon in row 2, into column SHARE of that row; rows 5 and 6 are its own.

    area, gx, gy: of the polygon before it was simplified; area and first moment of what is shared out are those.
    """
    _, cx, cy, _ = area_of(work, count)
    for k in range(count):
        work[5, k, 0] = 0.0
    for k in range(count):
        m = k + 1 if k + 1 < count else 0
        ax, ay = work[2, k, 0] - cx, work[2, k, 1] - cy
        bx, by = work[2, m, 0] - cx, work[2, m, 1] - cy
        quarter = 0.25 * (ax * by - ay * bx)
        work[5, k, 0] += quarter
        work[5, m, 0] += quarter
    n_fading = 0
    for k in range(count):
        i, j = k - 1 if k else count - 1, k + 1 if k + 1 < count else 0
        sine, before, after = _turn_at(work, i, k, j)
        work[5, k, 1] = fades_by(sine)
        work[5, k, 2] = after / (before + after)  # of what it gives, to the corner before it
        if sine < FADES:
            n_fading += 1
    if 0 < n_fading < count:
        for _ in range(HANDS if n_fading > 1 else 1):
            for k in range(count):
                given = work[5, k, 1] * work[5, k, 0]
                if given > 0.0:
                    i, j = k - 1 if k else count - 1, k + 1 if k + 1 < count else 0
                    work[5, k, 0] -= given
                    work[5, i, 0] += work[5, k, 2] * given
                    work[5, j, 0] += (1.0 - work[5, k, 2]) * given
    _restore(work, count, area, gx, gy)


@inline
def _restore(work, count, area, gx, gy):
    """Scale areas w in row 5 by 1 + λ0 + λ·r, so that their sum is `area` and their centroid (gx, gy)."""
    s0, sx, sy, sxx, sxy, syy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        x, y, w = work[2, k, 0] - gx, work[2, k, 1] - gy, work[5, k, 0]
        s0 += w
        sx += w * x
        sy += w * y
        sxx += w * x * x
        sxy += w * x * y
        syy += w * y * y
    level, lx, ly = tilted(s0, sx, sy, sxx, sxy, syy, area)
    for k in range(count):
        x, y = work[2, k, 0] - gx, work[2, k, 1] - gy
        work[2, k, SHARE] = work[5, k, 0] * max(level + lx * x + ly * y, 0.0)


@inline
def tilted(s0, sx, sy, sxx, sxy, syy, area):
    """Solve for the factor 1 + λ0 + λ·r, as (1 + λ0, λ), by which areas at places r add up to `area` about the origin.

    Their moments so far: sums of w, w x, w y, w x², w x y, w y²: s0 (1 + λ0) + s·λ = area, s (1 + λ0) + S λ = 0.
    """
    det = sxx * syy - sxy * sxy
    lx, ly, level = 0.0, 0.0, area / s0
    if det > 1e-9 * (sxx + syy) * (sxx + syy):
        px, py = (sx * syy - sy * sxy) / det, (sy * sxx - sx * sxy) / det  # S⁻¹ s
        level = area / (s0 - sx * px - sy * py)
        lx, ly = -level * px, -level * py
    return level, lx, ly


@inline
def held_inside(work, count, x, y):
    """Find the place of the polygon in row 2, counter-clockwise, that is nearest to (x, y), and its distance."""
    outside, nearest, nx, ny = False, math.inf, x, y
    for k in range(count):
        m = k + 1 if k + 1 < count else 0
        x0, y0 = work[2, k, 0], work[2, k, 1]
        tx, ty, ax, ay = work[2, m, 0] - x0, work[2, m, 1] - y0, x - x0, y - y0
        outside = outside or tx * ay - ty * ax < 0.0
        share = min(max((ax * tx + ay * ty) / (tx * tx + ty * ty), 0.0), 1.0)
        dx, dy = ax - share * tx, ay - share * ty
        if dx * dx + dy * dy < nearest:
            nearest, nx, ny = dx * dx + dy * dy, x0 + share * tx, y0 + share * ty
    return (nx, ny, math.sqrt(nearest)) if outside else (x, y, 0.0)
