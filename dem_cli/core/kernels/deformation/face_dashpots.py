"""Dashpots of elastic faces in time histories: they act over the part that is pressed, at places that stand for it.

A dashpot spread evenly over a face resists any motion of it as a few alike do: in the plane two at the Gauss points of
the pressed part, in space four (of a triangle three) at c ± S e₁ ± S e₂, c its centroid and S the root of its second
moments over its area. They are kept with contact points of their joint (`Seats`), one each; all other points of an
elastic face have none. Spring and dashpot together do not pull anywhere: where the face opens faster than both can
follow, g + c/k ġ > 0, nothing acts, and what the springs press there is taken back (`let_go`). Both gap and rate are
linear over the face, so that this is one more cut of the pressed part.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import always_inline, inline, overload
from dem_cli.core.kernels.joint_plane import load_mobility, rates_at, reach_of, spun, sweep, torque_at
from dem_cli.core.kernels.records import INTEGRATED
from dem_cli.core.kernels.vec import add_at, axpy, dot, load, load_frame, scale, store

# Of e₁ and e₂, so that second moments are right.
THREE = ((math.sqrt(0.5), math.sqrt(1.5)), (-math.sqrt(2.0), 0.0), (math.sqrt(0.5), -math.sqrt(1.5)))
FOUR = ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0))
GAUSS = 0.5 / math.sqrt(3.0)  # from the middle of a line of length 1
ALL = 1e-12  # of a face: less than that is not pressed where all of it is
SETTLED, PRESSED_IN_PART, CLOSES, LETS_GO = 0, 1, 2, 4  # sums of which are in Dampers.unsettled


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


@always_inline
def _rate(joints, bodies, joint, point, like, like_rotation):
    """Compute the speed at which a contact point opens [m/s]."""
    a, b, d = joints.blocks[joint, 0], joints.blocks[joint, 1], len(like)
    velocities, positions = bodies.velocities, bodies.positions
    reach_a = reach_of(joints, point, 0, load(positions, a, 0, like), like)
    reach_b = reach_of(joints, point, 1, load(positions, b, 0, like), like)
    relative = axpy(-1.0, load(velocities, a, 0, like), load(velocities, b, 0, like))
    spin_a, spin_b = load(velocities, a, d, like_rotation), load(velocities, b, d, like_rotation)
    return rates_at(load_frame(joints.frames, point, like), reach_a, reach_b, relative, spin_a, spin_b)[0]


@always_inline
def _below(low, high, begins, ends):
    """Cut a part of a line to where a number is negative that is `low` at its start and `high` at its end."""
    if low >= 0.0 and high >= 0.0:
        return begins, begins
    begins = begins if low < 0.0 else max(begins, low / (low - high))
    ends = ends if high < 0.0 else min(ends, low / (low - high))
    return begins, max(begins, ends)


@inline
def _seat_on_line(joints, contacts, dampers, seats, bodies, joint):
    """Seat two dashpots at the Gauss points of the pressed part of a line; returns the share of it that is pressed, and
    that of its dashpots.
    """
    first = joints.starts[joint]
    low, high = contacts.gaps[first], contacts.gaps[first + 1]
    seats.normal[first] = seats.normal[first + 1] = 0.0
    begins, ends = _below(low, high, 0.0, 1.0)
    pressed = ends - begins
    if pressed == 0.0:
        return 0.0, 0.0
    delay = dampers.viscosity[joint]
    if delay > 0.0 and bodies.stretchings.shape[0] == 0:
        later_low = low + delay * _rate(joints, bodies, joint, first, (0.0, 0.0), (0.0,))
        later_high = high + delay * _rate(joints, bodies, joint, first + 1, (0.0, 0.0), (0.0,))
        begins, ends = _below(later_low, later_high, begins, ends)
    share, middle = ends - begins, 0.5 * (begins + ends)
    for k in range(2):
        point = first + k
        at = middle + (GAUSS if k == 1 else -GAUSS) * share
        gap = low + at * (high - low)
        _put(contacts, dampers, seats, point, share * joints.kn[point], share * joints.ks[point], gap)
        for m in range(4):
            seats.frames[point, m] = (1.0 - at) * joints.frames[first, m] + at * joints.frames[first + 1, m]
            seats.levers[point, m] = (1.0 - at) * joints.levers[first, m] + at * joints.levers[first + 1, m]
    return pressed, share


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


@always_inline
def _add_corner(sums, polygon, corner):
    """Add a corner to a polygon that is summed triangle by triangle. polygon: its first and its last corner, and how
    many it has.
    """
    first, before, n = polygon
    if n > 1:
        sums = _with_triangle(sums, first, before, corner)
    return sums, (corner if n == 0 else first, corner, n + 1)


@inline
def _outline(joints, contacts, start, count, frame, origin):
    """Compute the area of an outline and the slope of the gap over it, along both tangents."""
    whole, slope_x, slope_y, point, here = 0.0, 0.0, 0.0, start, (0.0, 0.0, 0.0)
    for _ in range(count):
        other = joints.after[point]
        there = _seen_in(frame, origin, load(joints.points, other, 0, here))
        whole += 0.5 * (here[0] * there[1] - here[1] * there[0])
        both = 0.5 * (contacts.gaps[point] + contacts.gaps[other])
        slope_x += both * (there[1] - here[1])
        slope_y -= both * (there[0] - here[0])
        point, here = other, there
    per = 1.0 / whole if whole > 0.0 else 0.0
    return whole, (slope_x * per, slope_y * per)


@inline
def _part_below(joints, start, count, frame, origin, one, two):
    """Compute moments of the part of an outline, as `_with_triangle` has them, where two numbers that are linear over
    it are negative: each its value at the origin and its slopes.
    """
    nothing = (0.0, 0.0, 0.0)
    sums, polygon = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (nothing, nothing, 0)
    last, n_last = nothing, 0  # corner before of what is left by the first cut, and how many there were
    first_left, point, here = nothing, start, nothing
    for k in range(count + 1):
        # Corners that the first cut leaves, one or two for each side; after the last side the first of them again.
        other = joints.after[point]
        there = _seen_in(frame, origin, load(joints.points, other, 0, nothing))
        at, to = one[0] + one[1] * here[0] + one[2] * here[1], one[0] + one[1] * there[0] + one[2] * there[1]
        for cut in range(2):
            if k == count:
                corner, fits = first_left, cut == 0 and n_last > 0
            elif cut == 0:
                corner, fits = here, at < 0.0
            else:
                fits = (at < 0.0) != (to < 0.0)
                corner = axpy(at / (at - to), axpy(-1.0, here, there), here) if fits else here
            if not fits:
                continue
            if n_last == 0:
                first_left = corner
            else:
                before = two[0] + two[1] * last[0] + two[2] * last[1]
                now = two[0] + two[1] * corner[0] + two[2] * corner[1]
                if before < 0.0:
                    sums, polygon = _add_corner(sums, polygon, last)
                if (before < 0.0) != (now < 0.0):
                    crossing = axpy(before / (before - now), axpy(-1.0, last, corner), last)
                    sums, polygon = _add_corner(sums, polygon, crossing)
            last, n_last = corner, n_last + 1
        point, here = other, there
    return sums


@always_inline
def _direction(slope):
    """Compute the direction of a slope, or one at right angles to it, within 45° of the first axis: four dashpots stay
    where they were, each with its memory, while a face tilts to and fro.
    """
    x, y = slope
    if abs(x) < abs(y):
        x, y = y, -x
    size = math.sqrt(x * x + y * y)
    if size == 0.0:
        return (1.0, 0.0)
    size = size if x > 0.0 else -size
    return (x / size, y / size)


@inline
def _put_in_part(joints, contacts, dampers, seats, face, sums, start, frame, origin, gap_at, slope):
    """Put dashpots at places that stand for a part of a face with these moments. face: first point and the one after
    the last, how many there are, whether the part is not all of it, its normal and shear stiffness.
    """
    first, last, count, partly, kn, ks = face
    x, y, z = sums[1] / sums[0], sums[2] / sums[0], sums[3] / sums[0]
    xx, xy, yy = sums[4] / sums[0] - x * x, sums[5] / sums[0] - x * y, sums[6] / sums[0] - y * y
    root = math.sqrt(max(xx * yy - xy * xy, 0.0))
    per = 1.0 / math.sqrt(max(xx + yy + 2.0 * root, 1e-300))
    e = _direction(slope) if partly and count > 3 else (1.0, 0.0)
    one = (per * ((xx + root) * e[0] + xy * e[1]), per * (xy * e[0] + (yy + root) * e[1]))
    two = (per * (xy * e[0] - (xx + root) * e[1]), per * ((yy + root) * e[0] - xy * e[1]))
    n, k = 4 if count > 3 else 3, 0
    for point in range(first, last):
        if joints.kn[point] == 0.0 or k == n:
            continue
        a, b = FOUR[k] if n == 4 else THREE[min(k, 2)]
        at_x, at_y = x + a * one[0] + b * two[0], y + a * one[1] + b * two[1]
        gap = gap_at + slope[0] * at_x + slope[1] * at_y
        _put(contacts, dampers, seats, point, kn / n, ks / n, gap)
        store(seats.points, point, 0, axpy(at_x, frame[1], axpy(at_y, frame[2], axpy(z, frame[0], origin))))
        for m in range(9):
            seats.frames[point, m] = joints.frames[point, m]
        k += 1


@inline
def _seat_in_outline(joints, contacts, dampers, seats, bodies, joint):
    """Seat dashpots that stand for the pressed part of an outline; returns the share of it that is pressed, −1: it has
    no area, and that of its dashpots.
    """
    first, last = joints.starts[joint], joints.starts[joint + 1]
    nothing, total, along, area = (0.0, 0.0, 0.0), 0.0, 0.0, 0.0
    start, count, presses, mean = -1, 0, False, 0.0
    for point in range(first, last):
        seats.normal[point] = 0.0
        if joints.kn[point] > 0.0:
            total, along = total + joints.kn[point], along + joints.ks[point]
            presses = presses or contacts.gaps[point] < 0.0
            area += joints.fans[point]
            count += 1
            start = point if start < 0 else start
    if not presses:
        return 0.0, 0.0
    if area == 0.0:
        return -1.0, -1.0
    frame, origin = load_frame(joints.frames, start, nothing), load(joints.points, start, 0, nothing)
    whole, slope = _outline(joints, contacts, start, count, frame, origin)
    if whole == 0.0:
        return -1.0, -1.0
    later_rate, later_slope, lets_go = 0.0, slope, False
    delay = dampers.viscosity[joint]
    viscous = delay > 0.0 and bodies.stretchings.shape[0] == 0
    if viscous:
        a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
        spin = axpy(-1.0, load(bodies.velocities, a, 3, nothing), load(bodies.velocities, b, 3, nothing))
        later_rate = delay * _rate(joints, bodies, joint, start, nothing, nothing)
        later_slope = (
            slope[0] + delay * dot(frame[0], sweep(spin, frame[1])),
            slope[1] + delay * dot(frame[0], sweep(spin, frame[2])),
        )
    for point in range(first, last):
        if joints.kn[point] > 0.0:
            at = _seen_in(frame, origin, load(joints.points, point, 0, nothing))
            gap = contacts.gaps[point] - slope[0] * at[0] - slope[1] * at[1]
            mean += gap / count
            lets_go = lets_go or gap + later_rate + later_slope[0] * at[0] + later_slope[1] * at[1] >= 0.0
    gap, always = (mean, slope[0], slope[1]), (-1.0, 0.0, 0.0)
    sums = _part_below(joints, start, count, frame, origin, gap, always)
    pressed = share = sums[0] / whole
    if lets_go and viscous:
        later = (mean + later_rate, later_slope[0], later_slope[1])
        sums = _part_below(joints, start, count, frame, origin, gap, later)
        share = sums[0] / whole
    if share > 0.0:
        face = (first, last, count, share < 1.0 - ALL, share * total, share * along)
        _put_in_part(joints, contacts, dampers, seats, face, sums, start, frame, origin, mean, slope)
    return pressed, share


def seat_on_face(joints, contacts, dampers, seats, bodies, joint, like):
    """Seat the dashpots of an elastic face; returns the share of it that is pressed, −1: it has no area, and that over
    which they act.
    """
    seat = _seat_on_line if len(like) == 2 else _seat_in_outline
    return seat(joints, contacts, dampers, seats, bodies, joint)


@overload(seat_on_face)
def _seat_on_face(joints, contacts, dampers, seats, bodies, joint, like):
    seat = _seat_on_line if len(like) == 2 else _seat_in_outline
    return lambda joints, contacts, dampers, seats, bodies, joint, like: seat(
        joints, contacts, dampers, seats, bodies, joint
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
def seat_dashpots(joints, contacts, dampers, seats, bodies, like):
    """Seat the dashpots of all joints for this step."""
    for joint in range(joints.blocks.shape[0]):
        first, last = joints.starts[joint], joints.starts[joint + 1]
        pressed, share, settled = -1.0, -1.0, SETTLED
        if joints.integrated[joint] == INTEGRATED:
            pressed, share = seat_on_face(joints, contacts, dampers, seats, bodies, joint, like)
        if pressed < 0.0:
            for point in range(first, last):
                _copy(joints, contacts, seats, point)
        else:
            settled = PRESSED_IN_PART if 0.0 < share < 1.0 - ALL else SETTLED
            settled += CLOSES if _note_closing(contacts, dampers, first, last, pressed > 0.0) else 0
            settled += LETS_GO if share < pressed * (1.0 - ALL) else 0
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
            found += 1 if dampers.unsettled[joint] & CLOSES else 0
    return found


@always_inline
def _pushed(bodies, inverse_masses, block, frame, reach, impulse, sign, like, like_rotation):
    """Apply an impulse along the normal of a frame to a block, or against it."""
    force, mass, d = scale(impulse, frame[0]), inverse_masses[block, 0], len(like)
    turning = spun(
        load_mobility(bodies.mobilities, block, like), torque_at(reach, force, impulse, scale(0.0, like[1:]))
    )
    add_at(bodies.velocities, block, 0, scale(mass, force), sign)
    add_at(bodies.velocities, block, d, turning, sign)


@inline
def let_go(joints, contacts, bodies, inverse_masses, dampers, seats, dt, like, like_rotation):
    """Take back what springs press where a face opens faster than spring and dashpot follow: all that contact points
    press, but for what presses on dashpots.
    """
    positions = bodies.positions
    for joint in range(joints.blocks.shape[0]):
        if dampers.unsettled[joint] & LETS_GO == 0:
            continue
        a, b = joints.blocks[joint, 0], joints.blocks[joint, 1]
        xa, xb = load(positions, a, 0, like), load(positions, b, 0, like)
        for point in range(joints.starts[joint], joints.starts[joint + 1]):
            if contacts.normal[point] > 0.0:
                frame, lost = load_frame(joints.frames, point, like), -dt * contacts.normal[point]
                reach_a, reach_b = reach_of(joints, point, 0, xa, like), reach_of(joints, point, 1, xb, like)
                _pushed(bodies, inverse_masses, a, frame, reach_a, lost, -1.0, like, like_rotation)
                _pushed(bodies, inverse_masses, b, frame, reach_b, lost, 1.0, like, like_rotation)
            if seats.normal[point] > 0.0:
                frame, kept = load_frame(seats.frames, point, like), dt * seats.normal[point]
                reach_a, reach_b = reach_of(seats, point, 0, xa, like), reach_of(seats, point, 1, xb, like)
                _pushed(bodies, inverse_masses, a, frame, reach_a, kept, -1.0, like, like_rotation)
                _pushed(bodies, inverse_masses, b, frame, reach_b, kept, 1.0, like, like_rotation)
