"""Where dashpots of elastic faces act in time histories: over the part that is pressed, at places that stand for it.

A dashpot spread evenly over the pressed part resists any motion of a rigid face as a few alike do: in the plane two at
the Gauss points of that part, in space four (of a triangle three) at c ± S e₁ ± S e₂, c its centroid and S the root of
its second moments over its area. Each has its share of the pressed area and the pressure there, below which spring and
dashpot together do not pull. They are kept with contact points of their joint (`Seats`), one each; all other points of
an elastic face have none.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import always_inline, inline, overload
from dem_cli.core.kernels.records import INTEGRATED
from dem_cli.core.kernels.vec import axpy, dot, load, store

# Of e₁ and e₂, so that second moments are right.
THREE = ((math.sqrt(0.5), math.sqrt(1.5)), (-math.sqrt(2.0), 0.0), (math.sqrt(0.5), -math.sqrt(1.5)))
FOUR = ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0))
GAUSS = 0.5 / math.sqrt(3.0)  # from the middle of a line of length 1
ALL = 1e-12  # of a face: less than that is not pressed where all of it is
SETTLED, PRESSED_IN_PART, CLOSES = 0, 1, 2  # of Dampers.unsettled


@always_inline
def _copy(joints, contacts, seats, point):
    """Seat the dashpot of a point at the point itself."""
    seats.kn[point], seats.ks[point] = joints.kn[point], joints.ks[point]
    seats.normal[point], seats.gaps[point] = contacts.normal[point], contacts.gaps[point]
    for k in range(seats.frames.shape[1]):
        seats.frames[point, k] = joints.frames[point, k]
    for k in range(seats.levers.shape[1]):
        seats.levers[point, k] = joints.levers[point, k]
    for k in range(seats.points.shape[1]):
        seats.points[point, k] = joints.points[point, k]


@always_inline
def _put(contacts, dampers, seats, point, kn, ks, gap):
    """Store stiffness and force of a dashpot; where the area behind it shrinks, its Maxwell forces go with that."""
    if kn < seats.kn[point]:
        for k in range(dampers.first + contacts.shear.shape[1] + 1, contacts.memory.shape[1]):
            contacts.memory[point, k] *= kn / seats.kn[point]
    seats.kn[point], seats.ks[point] = kn, ks
    seats.gaps[point], seats.normal[point] = gap, kn * max(-gap, 0.0)


@inline
def _seat_on_line(joints, contacts, dampers, seats, first):
    """Seat two dashpots at the Gauss points of the pressed part of a line; returns the share of it."""
    low, high = contacts.gaps[first], contacts.gaps[first + 1]
    if low >= 0.0 and high >= 0.0:
        seats.normal[first] = seats.normal[first + 1] = 0.0
        return 0.0
    begins = 0.0 if low < 0.0 else low / (low - high)
    ends = 1.0 if high < 0.0 else low / (low - high)
    share, middle = ends - begins, 0.5 * (begins + ends)
    for k in range(2):
        point = first + k
        at = middle + (GAUSS if k == 1 else -GAUSS) * share
        _put(
            contacts, dampers, seats, point, share * joints.kn[point], share * joints.ks[point],
            low + at * (high - low),
        )  # fmt: skip
        for m in range(4):
            seats.frames[point, m] = (1.0 - at) * joints.frames[first, m] + at * joints.frames[first + 1, m]
            seats.levers[point, m] = (1.0 - at) * joints.levers[first, m] + at * joints.levers[first + 1, m]
    return share


@always_inline
def _with_triangle(sums, one, two, three):
    """Add area, first and second moments of a triangle (x, y, z) to sums: area, x, y, z, xx, xy, yy."""
    area = 0.5 * ((two[0] - one[0]) * (three[1] - one[1]) - (two[1] - one[1]) * (three[0] - one[0]))
    x, y, z = one[0] + two[0] + three[0], one[1] + two[1] + three[1], one[2] + two[2] + three[2]
    part, third = area / 12.0, area / 3.0
    return (
        sums[0] + area,
        sums[1] + third * x,
        sums[2] + third * y,
        sums[3] + third * z,
        sums[4] + part * (x * x + one[0] * one[0] + two[0] * two[0] + three[0] * three[0]),
        sums[5] + part * (x * y + one[0] * one[1] + two[0] * two[1] + three[0] * three[1]),
        sums[6] + part * (y * y + one[1] * one[1] + two[1] * two[1] + three[1] * three[1]),
    )


@always_inline
def _seen_in(frame, origin, place):
    """Compute coordinates of a place along both tangents and the normal of a frame [m]."""
    arm = axpy(-1.0, origin, place)
    return dot(arm, frame[1]), dot(arm, frame[2]), dot(arm, frame[0])


@inline
def _pressed_part(joints, contacts, start, count, frame, origin):
    """Compute moments of the pressed part of an outline, as `_with_triangle` has them, and its whole area with the
    slope of the gap along both tangents.
    """
    nothing = (0.0, 0.0, 0.0)
    sums, whole = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0
    slope_x = slope_y = 0.0
    first_seen, before, n_seen = nothing, nothing, 0
    point, here, gap = start, nothing, contacts.gaps[start]
    for _ in range(count):
        other = joints.after[point]
        there, next_gap = _seen_in(frame, origin, load(joints.points, other, 0, nothing)), contacts.gaps[other]
        whole += 0.5 * (here[0] * there[1] - here[1] * there[0])
        slope_x += 0.5 * (gap + next_gap) * (there[1] - here[1])
        slope_y -= 0.5 * (gap + next_gap) * (there[0] - here[0])
        if gap < 0.0:
            first_seen = here if n_seen == 0 else first_seen
            sums = _with_triangle(sums, first_seen, before, here) if n_seen > 1 else sums
            before, n_seen = here, n_seen + 1
        if (gap < 0.0) != (next_gap < 0.0):
            cut = axpy(gap / (gap - next_gap), axpy(-1.0, here, there), here)
            first_seen = cut if n_seen == 0 else first_seen
            sums = _with_triangle(sums, first_seen, before, cut) if n_seen > 1 else sums
            before, n_seen = cut, n_seen + 1
        point, here, gap = other, there, next_gap
        if point == start:
            break
    per = 1.0 / whole if whole != 0.0 else 0.0
    return sums, whole, (slope_x * per, slope_y * per)


@inline
def _seat_in_outline(joints, contacts, dampers, seats, first, last):
    """Seat dashpots that stand for the pressed part of an outline; returns the share of it, −1: it has no area."""
    nothing, total, along, area = (0.0, 0.0, 0.0), 0.0, 0.0, 0.0
    start, count, presses = -1, 0, False
    for point in range(first, last):
        seats.normal[point] = 0.0
        if joints.kn[point] > 0.0:
            total, along = total + joints.kn[point], along + joints.ks[point]
            presses = presses or contacts.gaps[point] < 0.0
            area += joints.fans[point]
            count += 1
            start = point if start < 0 else start
    if not presses:
        return 0.0
    if area == 0.0:
        return -1.0
    frame = (
        load(joints.frames, start, 0, nothing),
        load(joints.frames, start, 3, nothing),
        load(joints.frames, start, 6, nothing),
    )
    origin = load(joints.points, start, 0, nothing)
    sums, whole, slope = _pressed_part(joints, contacts, start, count, frame, origin)
    share = sums[0] / whole if whole > 0.0 else 0.0
    if not share > 0.0:
        return 0.0
    x, y, z = sums[1] / sums[0], sums[2] / sums[0], sums[3] / sums[0]
    xx, xy, yy = sums[4] / sums[0] - x * x, sums[5] / sums[0] - x * y, sums[6] / sums[0] - y * y
    root = math.sqrt(max(xx * yy - xy * xy, 0.0))
    per = 1.0 / math.sqrt(max(xx + yy + 2.0 * root, 1e-300))
    steep = math.sqrt(slope[0] * slope[0] + slope[1] * slope[1])
    e = (slope[0] / steep, slope[1] / steep) if steep > 0.0 else (1.0, 0.0)
    one = (per * ((xx + root) * e[0] + xy * e[1]), per * (xy * e[0] + (yy + root) * e[1]))
    two = (per * (xy * e[0] - (xx + root) * e[1]), per * ((yy + root) * e[0] - xy * e[1]))
    n = 4 if count > 3 else 3
    kn, ks, k = share * total / n, share * along / n, 0
    for point in range(first, last):
        if joints.kn[point] == 0.0 or k == n:
            continue
        a, b = FOUR[k] if n == 4 else THREE[min(k, 2)]
        at_x, at_y = x + a * one[0] + b * two[0], y + a * one[1] + b * two[1]
        gap = contacts.gaps[start] + slope[0] * at_x + slope[1] * at_y
        _put(contacts, dampers, seats, point, kn, ks, gap)
        place = axpy(at_x, frame[1], axpy(at_y, frame[2], axpy(z, frame[0], origin)))
        store(seats.points, point, 0, place)
        for m in range(9):
            seats.frames[point, m] = joints.frames[point, m]
        k += 1
    return share


def seat_on_face(joints, contacts, dampers, seats, first, last, like):
    """Seat the dashpots of an elastic face; returns the share of it that is pressed, −1: it has no area."""
    if len(like) == 2:
        return _seat_on_line(joints, contacts, dampers, seats, first)
    return _seat_in_outline(joints, contacts, dampers, seats, first, last)


@overload(seat_on_face)
def _seat_on_face(joints, contacts, dampers, seats, first, last, like):
    if len(like) == 2:
        return lambda joints, contacts, dampers, seats, first, last, like: _seat_on_line(
            joints, contacts, dampers, seats, first
        )
    return lambda joints, contacts, dampers, seats, first, last, like: _seat_in_outline(
        joints, contacts, dampers, seats, first, last
    )


@always_inline
def _note_closing(contacts, dampers, first, last, touched):
    """Note which points of a face are closed; returns whether any has closed beside others that were."""
    closes, closed_before = False, False
    for point in range(first, last):
        shut = contacts.gaps[point] < 0.0
        closed_before = closed_before or dampers.shut[point] != 0
        closes = closes or (shut and dampers.shut[point] == 0)
        dampers.shut[point] = 1 if shut and touched else 0
    return closes and closed_before


@always_inline
def _rows_of(joints, joint, first, last):
    """Return how many dashpots an outline has."""
    count = 0
    for point in range(first, last):
        count += 1 if joints.kn[point] > 0.0 else 0
    return min(count, 4)


@inline
def seat_dashpots(joints, contacts, dampers, seats, like):
    """Seat the dashpots of all joints for this step."""
    for joint in range(joints.blocks.shape[0]):
        first, last = joints.starts[joint], joints.starts[joint + 1]
        share, settled = -1.0, SETTLED
        if joints.integrated[joint] == INTEGRATED:
            share = seat_on_face(joints, contacts, dampers, seats, first, last, like)
        if share < 0.0:
            for point in range(first, last):
                _copy(joints, contacts, seats, point)
        else:
            settled = PRESSED_IN_PART if 0.0 < share < 1.0 - ALL else SETTLED
            if _note_closing(contacts, dampers, first, last, share > 0.0):
                settled = CLOSES
            if len(like) == 3:
                rows = _rows_of(joints, joint, first, last) if share > 0.0 else 0
                goes_on = joints.held[joint] >= 0 and settled == SETTLED
                joints.held[joint] = rows if goes_on else -1 - rows
        dampers.unsettled[joint] = settled


@inline
def stir_faces(dampers):
    """Mark joints whose faces are pressed in part, so that their impulses are not taken for settled; returns how many
    have closed on further.
    """
    found = 0
    for joint in range(dampers.unsettled.shape[0]):
        if dampers.unsettled[joint] != SETTLED:
            dampers.met[joint] = 1
            found += 1 if dampers.unsettled[joint] == CLOSES else 0
    return found
