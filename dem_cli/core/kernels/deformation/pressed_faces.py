"""Pressure on elastic faces, integrated over the part that is closed: p = kn ⟨−g⟩, with a gap g linear over the face.

The law of a joint works at contact points, the ends of a line or the corners of an outline. Each gets the share of the
pressure that has the same resultant and moments, F = ∫ p N dA with N linear from 1 at the point to 0 at the others, as
the gap at which the spring of the point alone would carry it. In the plane that is a closed form. In space the outline
is a fan of triangles around the mean of its corners, weighted by their stiffness, which shares what it gets among them;
a triangle that is partly closed is cut where the gap is zero, exactly. A corner at which the outline hardly turns hands
what it gets to those beside it, as it does with its area (overlap.fading_areas). The energy in the springs is
½ Σ F (−g), since the pressure is homogeneous in the gaps.
"""

from __future__ import annotations

import math

from dem_cli.core.kernels.jit import always_inline, inline, kernel
from dem_cli.core.kernels.overlap import HANDS, fades_by
from dem_cli.core.kernels.records import INTEGRATED, NOT_INTEGRATED
from dem_cli.core.kernels.vec import axpy, dot, load, scale


@always_inline
def line_gaps(low, high):
    """Compute equivalent gaps of two springs at the ends of a line, each with half its stiffness, for its pressure [m].

    low, high: gaps at the ends [m]. Without branches, for many lines at once.
    """
    on_low, on_high = low < 0.0, high < 0.0
    apart = low - high
    apart = 1.0 if apart == 0.0 else apart
    deep = low if on_low else high
    closed = deep / (apart if on_low else -apart)  # share of the line, from the end that is closed
    near, far = deep * closed * (1.0 - closed / 3.0), deep * closed * closed / 3.0
    part_low, part_high = near if on_low else far, far if on_low else near
    both, none = on_low & on_high, not (on_low | on_high)
    at_low = (2.0 * low + high) / 3.0 if both else low if none else part_low
    at_high = (low + 2.0 * high) / 3.0 if both else high if none else part_high
    return at_low, at_high


@always_inline
def rubbing_together(low, high, gap_low, gap_high):
    """Compute frame, levers and place of both ends of a line that rubs where its pressure acts, with one lever along
    it.

    low, high: frame, levers of both blocks and place of each end; gap_low, gap_high: as `line_gaps` leaves them [m].
    Friction at ends of which one gapes would have a moment about the other, that no face has.
    """
    on_low, on_high = max(-gap_low, 0.0), max(-gap_high, 0.0)
    total = on_low + on_high
    part = on_low / total if total > 0.0 else 0.5
    (frame_low, a_low, b_low, at_low), (frame_high, a_high, b_high, at_high) = low, high
    along_a = (part * a_low[1][0] + (1.0 - part) * a_high[1][0],)
    along_b = (part * b_low[1][0] + (1.0 - part) * b_high[1][0],)
    return (
        (frame_low, (a_low[0], along_a), (b_low[0], along_b), at_low),
        (frame_high, (a_high[0], along_a), (b_high[0], along_b), at_high),
    )


@always_inline
def _at_corner(a, b, c):
    """Integrate overlap × N of each corner, over the area, of the part where the overlap has the sign that it has at a.

    a, b, c: overlaps [m], of which b and c have the other sign or are zero.
    """
    to_b, to_c = a / (a - b), a / (a - c)
    part = a * to_b * to_c / 12.0
    return part * (4.0 - to_b - to_c), part * to_b, part * to_c


@always_inline
def triangle_shares(a, b, c):
    """Integrate ⟨overlap⟩ N dA over the area for the corners of a triangle [m]; a, b, c: overlaps there, negative:
    open.
    """
    if a <= 0.0 and b <= 0.0 and c <= 0.0:
        return 0.0, 0.0, 0.0
    if a > 0.0 and b <= 0.0 and c <= 0.0:
        return _at_corner(a, b, c)
    if b > 0.0 and c <= 0.0 and a <= 0.0:
        of_b, of_c, of_a = _at_corner(b, c, a)
        return of_a, of_b, of_c
    if c > 0.0 and a <= 0.0 and b <= 0.0:
        of_c, of_a, of_b = _at_corner(c, a, b)
        return of_a, of_b, of_c
    total = a + b + c
    one, two, three = (total + a) / 12.0, (total + b) / 12.0, (total + c) / 12.0
    if a < 0.0:
        of_a, of_b, of_c = _at_corner(a, b, c)
        return one - of_a, two - of_b, three - of_c
    if b < 0.0:
        of_b, of_c, of_a = _at_corner(b, c, a)
        return one - of_a, two - of_b, three - of_c
    if c < 0.0:
        of_c, of_a, of_b = _at_corner(c, a, b)
        return one - of_a, two - of_b, three - of_c
    return one, two, three


@inline
def _hand_on(joints, shares, first, last):
    """Move the shares of nearly straight (faint) corners to their neighbours."""
    after, faint, back = joints.after, joints.faint, joints.back
    for point in range(first, last):
        corner = after[point]
        if faint[corner] > 0.0:
            given = faint[corner] * shares[corner]
            shares[corner] -= given
            shares[point] += back[corner] * given
            shares[after[corner]] += (1.0 - back[corner]) * given


@inline
def _share_in_fan(joints, contacts, first, last):
    """Compute the pressure shares of the points of an outline into `contacts.lumped`, as `share_pressure` does."""
    kn, after, fans, gaps, shares = joints.kn, joints.after, joints.fans, contacts.gaps, contacts.lumped
    stiffness, middle, area, n_faint = 0.0, 0.0, 0.0, 0
    for point in range(first, last):
        stiffness += kn[point]
        area += fans[point]
        n_faint += 1 if joints.faint[point] > 0.0 else 0
        middle += kn[point] * gaps[point]
        shares[point] = 0.0
    if area == 0.0:  # fewer than three points, or in one line
        for point in range(first, last):
            shares[point] = gaps[point]
        return
    middle /= stiffness
    in_middle = 0.0
    for point in range(first, last):
        if fans[point] == 0.0:
            continue
        other = after[point]
        centre, here, there = triangle_shares(-middle, -gaps[point], -gaps[other])
        in_middle += fans[point] * centre
        shares[point] += fans[point] * here
        shares[other] += fans[point] * there
    for _ in range(HANDS if n_faint > 1 else n_faint):
        _hand_on(joints, shares, first, last)
    for point in range(first, last):
        if kn[point] > 0.0:
            carried = shares[point] * stiffness / kn[point] + in_middle
            shares[point] = -carried if carried > 0.0 else max(gaps[point], 0.0)


@inline
def share_pressure(joints, contacts, joint):
    """Set in `contacts.lumped` the gaps at which points of a joint carry their force [m]: their own, or shares."""
    first, last = joints.starts[joint], joints.starts[joint + 1]
    gaps, shares = contacts.gaps, contacts.lumped
    if joints.integrated[joint] == NOT_INTEGRATED:
        for point in range(first, last):
            shares[point] = gaps[point]
    elif last - first == 2:
        shares[first], shares[first + 1] = line_gaps(gaps[first], gaps[first + 1])
    else:
        _share_in_fan(joints, contacts, first, last)


@always_inline
def _before(ax, ay, bx, by):
    """Test whether direction a comes before b on the way around from the first axis, counter-clockwise."""
    upper_a, upper_b = ay > 0.0 or (ay == 0.0 and ax > 0.0), by > 0.0 or (by == 0.0 and bx > 0.0)
    if upper_a != upper_b:
        return upper_a
    return ax * by - ay * bx > 0.0


@inline
def fan_out(joints, joint):
    """Divide the area of a joint into a fan of triangles: the point after each along the outline, and the share of its
    area.
    """
    kn, points, after, fans = joints.kn, joints.points, joints.after, joints.fans
    first, last = joints.starts[joint], joints.starts[joint + 1]
    zero = (0.0, 0.0, 0.0)
    total, middle, one = 0.0, zero, -1
    for point in range(first, last):
        after[point], fans[point] = point, 0.0
        if kn[point] > 0.0:
            total += kn[point]
            middle = axpy(kn[point], load(points, point, 0, zero), middle)
            one = point if one < 0 else one
    if one < 0:
        return
    middle = scale(1.0 / total, middle)
    t1, t2 = load(joints.frames, one, 3, zero), load(joints.frames, one, 6, zero)
    area = 0.0
    for point in range(first, last):
        if kn[point] == 0.0:
            continue
        arm = axpy(-1.0, middle, load(points, point, 0, zero))
        x, y = dot(arm, t1), dot(arm, t2)
        near, lowest = -1, -1  # the next one around, else the first of all
        nx = ny = lx = ly = 0.0
        for other in range(first, last):
            if kn[other] == 0.0 or other == point:
                continue
            arm = axpy(-1.0, middle, load(points, other, 0, zero))
            u, v = dot(arm, t1), dot(arm, t2)
            if _before(x, y, u, v) and (near < 0 or _before(u, v, nx, ny)):
                near, nx, ny = other, u, v
            if lowest < 0 or _before(u, v, lx, ly):
                lowest, lx, ly = other, u, v
        if near < 0:
            near, nx, ny = lowest, lx, ly
        if near < 0:
            continue
        after[point] = near
        fans[point] = 0.5 * abs(x * ny - y * nx)
        area += fans[point]
    for point in range(first, last):
        fans[point] = fans[point] / area if area > 0.0 else 0.0
    _find_faint(joints, first, last, t1, t2)


@inline
def _find_faint(joints, first, last, t1, t2):
    """Compute how nearly straight (faint) each corner of an outline is, by its turn; t1, t2: along the joint. None is
    where all would be.
    """
    points, after, faint, back = joints.points, joints.after, joints.faint, joints.back
    zero, strong = (0.0, 0.0, 0.0), 0
    for point in range(first, last):
        faint[point] = 0.0
    for point in range(first, last):
        corner = after[point]
        if joints.fans[point] == 0.0 or after[corner] == point:
            continue
        here = load(points, corner, 0, zero)
        came = axpy(-1.0, load(points, point, 0, zero), here)
        goes = axpy(-1.0, here, load(points, after[corner], 0, zero))
        ax, ay, bx, by = dot(came, t1), dot(came, t2), dot(goes, t1), dot(goes, t2)
        before, behind = math.sqrt(ax * ax + ay * ay), math.sqrt(bx * bx + by * by)
        faint[corner] = fades_by(abs(ax * by - ay * bx) / (before * behind)) if before * behind > 0.0 else 1.0
        back[corner] = behind / (before + behind) if before + behind > 0.0 else 0.5
        strong += 1 if faint[corner] == 0.0 else 0
    if strong == 0:
        for point in range(first, last):
            faint[point] = 0.0


@kernel
def fan_out_all(joints):
    """Divide the areas of all integrated joints in space into fans of triangles."""
    for joint in range(joints.blocks.shape[0]):
        if joints.integrated[joint] == INTEGRATED:
            fan_out(joints, joint)


@inline
def press_face(joints, contacts, joint):
    """Compute normal forces of the points of an integrated face, by the gaps that they have."""
    share_pressure(joints, contacts, joint)
    for point in range(joints.starts[joint], joints.starts[joint + 1]):
        contacts.normal[point] = joints.kn[point] * max(-contacts.lumped[point], 0.0)


@kernel
def press_all(joints, contacts):
    """Compute normal forces of all integrated faces in space, by their present gaps and outlines."""
    for joint in range(joints.blocks.shape[0]):
        if joints.integrated[joint] == INTEGRATED:
            fan_out(joints, joint)
            press_face(joints, contacts, joint)
