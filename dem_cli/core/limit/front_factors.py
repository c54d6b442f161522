"""Compiled LU factorisation in dense fronts, and solution with the factors (pattern: limit/fronts.py).

No rows are exchanged: a matrix of joints has its large numbers on the diagonal. The numbers of a front are its square,
the strip below, transposed, and the strip beside, all by rows, so that every inner loop runs along a row.
"""

from __future__ import annotations

from dem_cli.core.kernels.jit import always_inline, inline, kernel


@kernel
def assemble(values, parts, rows, factors, pairs, pushed):
    """Assemble the matrix Σ f rowᵢᵀ rowⱼ of all points into its fronts.

    parts (n_points, 2, 2, 3): limit.fronts.parts_of; rows (n_points, d, 2, n_dof): motion of b against a;
    factors (n_pairs, n_points) of the pairs (i, j) of directions; pushed: room, (d, 2, n_dof).
    """
    values[:] = 0.0
    for p in range(len(rows)):
        pushed[:] = 0.0
        for k in range(len(pairs)):
            _add_scaled(pushed, pairs[k, 0], factors[k, p], rows, p, pairs[k, 1])
        for a in range(2):
            for b in range(2):
                if parts[p, a, b, 0] >= 0 and rows.shape[1] == 2:
                    _add_of_two(values, parts, rows, pushed, p, a, b)
                elif parts[p, a, b, 0] >= 0:
                    _add_part(values, parts[p, a, b], rows[p, :, a], pushed[:, b])


@always_inline
def _add_scaled(total, to, factor, rows, p, come):
    for a in range(2):
        for e in range(rows.shape[3]):
            total[to, a, e] += factor * rows[p, come, a, e]


@inline
def _add_part(values, part, left, right):
    """Adds the share of one contact point to the matrix of its two blocks."""
    d, n_dof = left.shape
    for e in range(n_dof):
        at = part[0] + e * part[1]
        for h in range(n_dof):
            value = 0.0
            for i in range(d):
                value += left[i, e] * right[i, h]
            values[at + h * part[2]] += value


@always_inline
def _add_of_two(values, parts, rows, pushed, p, a, b):
    """Add the share of a contact point with two directions to its blocks, with the loop unrolled: three times as
    fast."""
    first, down, across = parts[p, a, b, 0], parts[p, a, b, 1], parts[p, a, b, 2]
    for h in range(0, rows.shape[3], 3):
        x1, x2, x3 = pushed[0, b, h], pushed[0, b, h + 1], pushed[0, b, h + 2]
        y1, y2, y3 = pushed[1, b, h], pushed[1, b, h + 1], pushed[1, b, h + 2]
        for e in range(rows.shape[3]):
            x, y, at = rows[p, 0, a, e], rows[p, 1, a, e], first + e * down + h * across
            values[at] += x * x1 + y * y1
            values[at + across] += x * x2 + y * y2
            values[at + 2 * across] += x * x3 + y * y3


@kernel
def assemble_joints(values, parts, starts, rows, factors, pairs, pushed, part):
    """Assemble the matrix of joints in space: points of one joint are summed first and added together.

    parts (n_joints, 2, 2, 3); starts (n_joints + 1,): first point of each joint; rows (n_points, 3, 2 n_dof);
    pushed, part: room, (3, 2 n_dof) and (2 n_dof, 2 n_dof).
    """
    values[:] = 0.0
    for joint in range(len(starts) - 1):
        part[:] = 0.0
        for p in range(starts[joint], starts[joint + 1]):
            pushed[:] = 0.0
            for k in range(len(pairs)):
                _add_to_row(pushed[pairs[k, 0]], factors[k, p], rows[p, pairs[k, 1]])
            _add_point(part, rows[p], pushed)
        for a in range(2):
            for b in range(2):
                if parts[joint, a, b, 0] >= 0:
                    _put_part(values, parts[joint, a, b], part, a, b)


@inline
def _add_to_row(total, factor, row):
    for e in range(row.shape[0]):
        total[e] += factor * row[e]


@inline
def _add_point(part, left, pushed):
    """Adds the share of one contact point to the matrix of its joint."""
    normal, one, two = pushed[0], pushed[1], pushed[2]
    for e in range(part.shape[0]):
        row = part[e]
        x, y, z = left[0, e], left[1, e], left[2, e]
        for h in range(part.shape[0]):
            row[h] += x * normal[h] + y * one[h] + z * two[h]


@inline
def _put_part(values, where, part, a, b):
    """Adds the share of one joint to the matrix of its two blocks."""
    n_dof = part.shape[0] // 2
    for e in range(n_dof):
        at, row = where[0] + e * where[1], part[a * n_dof + e]
        for h in range(n_dof):
            values[at + h * where[2]] += row[b * n_dof + h]


@kernel
def add_to_diagonal(values, diagonal, share):
    """Add a share of the mean diagonal to the diagonal of a matrix in fronts; diagonal: indices of its entries."""
    total = 0.0
    for i in range(diagonal.size):
        total += abs(values[diagonal[i]])
    for i in range(diagonal.size):
        values[diagonal[i]] += share * total / diagonal.size


@kernel
def factorise(values, fronts, update):
    """Factorise a matrix in `limit.fronts.Fronts` by LU, in place; True where no pivot is zero. update: room."""
    for front in range(len(fronts.start) - 1):
        own, left = _sizes(fronts, front)
        at = fronts.start[front]
        square, below = values[at : at + own * own], values[at + own * own : at + own * (own + left)]
        beside = values[at + own * (own + left) : at + own * (own + 2 * left)]
        for k in range(0, own, 3):
            if not _divide_panel(square, below, beside, own, left, k):
                return False
            _eliminate(square, below, beside, own, left, k)
        _multiply(below, beside, own, left, update)
        for run in range(fronts.runs.first[front], fronts.runs.first[front + 1]):
            _subtract_beside(values, fronts, run, left, update)
            _subtract_below(values, fronts, run, left, update)
    return True


@inline
def _sizes(fronts, front):
    """Degrees of freedom of a front, and those it leaves behind."""
    own = fronts.first[front + 1] - fronts.first[front]
    left = fronts.row_start[front + 1] - fronts.row_start[front]
    return own * fronts.n_dof, left * fronts.n_dof


@inline
def _divide_panel(square, below, beside, own, left, k):
    """Divide three columns of a front, and three rows beside them, by their pivots; returns whether no pivot is
    zero."""
    end = k + 3
    for p in range(k, end):
        if square[p * own + p] == 0.0:
            return False
        inverse = 1.0 / square[p * own + p]
        lower, beyond = below[p * left : p * left + left], beside[p * left : p * left + left]
        for j in range(left):
            lower[j] *= inverse
        for i in range(p + 1, own):
            share = square[i * own + p] * inverse
            square[i * own + p] = share
            for c in range(p + 1, end):
                square[i * own + c] -= share * square[p * own + c]
        across = square[p * own + end : p * own + own]
        for i in range(p + 1, end):
            share, upper = square[i * own + p], square[p * own + i]
            row = square[i * own + end : i * own + own]
            for j in range(own - end):
                row[j] -= share * across[j]
            strip, other = beside[i * left : i * left + left], below[i * left : i * left + left]
            for j in range(left):
                strip[j] -= share * beyond[j]
                other[j] -= upper * lower[j]
    return True


@inline
def _eliminate(square, below, beside, own, left, k):
    """Eliminate three columns of a front from all others, one after the other in each number."""
    end, n = k + 3, own - k - 3
    a, b = square[k * own + end : end * own], beside[k * left : end * left]
    c, two, three = below[k * left : end * left], 2 * left, 2 * own
    for i in range(end, own):
        at = i * own + k
        x, y, z = square[at], square[at + 1], square[at + 2]
        if x != 0.0 or y != 0.0 or z != 0.0:
            row, strip = square[at + 3 : at + 3 + n], beside[i * left : i * left + left]
            for j in range(n):
                row[j] = ((row[j] - x * a[j]) - y * a[own + j]) - z * a[three + j]
            for j in range(left):
                strip[j] = ((strip[j] - x * b[j]) - y * b[left + j]) - z * b[two + j]
        x, y, z = a[i - end], a[own + i - end], a[three + i - end]
        if x != 0.0 or y != 0.0 or z != 0.0:
            strip = below[i * left : i * left + left]
            for j in range(left):
                strip[j] = ((strip[j] - x * c[j]) - y * c[left + j]) - z * c[two + j]


@inline
def _multiply(below, beside, own, left, update):
    """Multiply the strip below by the strip beside, (left, left), three rows and three columns at a time."""
    for i in range(0, left, 3):
        one, two = update[i * left : (i + 1) * left], update[(i + 1) * left : (i + 2) * left]
        three = update[(i + 2) * left : (i + 3) * left]
        for j in range(left):
            one[j] = 0.0
            two[j] = 0.0
            three[j] = 0.0
        for k in range(0, own, 3):
            at = k * left + i
            a0, a1, a2 = below[at], below[at + left], below[at + 2 * left]
            b0, b1, b2 = below[at + 1], below[at + 1 + left], below[at + 1 + 2 * left]
            c0, c1, c2 = below[at + 2], below[at + 2 + left], below[at + 2 + 2 * left]
            u = beside[k * left : (k + 1) * left]
            v, w = beside[(k + 1) * left : (k + 2) * left], beside[(k + 2) * left : (k + 3) * left]
            for j in range(left):
                x, y, z = u[j], v[j], w[j]
                one[j] += a0 * x + a1 * y + a2 * z
                two[j] += b0 * x + b1 * y + b2 * z
                three[j] += c0 * x + c1 * y + c2 * z


@inline
def _subtract_beside(values, fronts, run, left, update):
    """Subtract the update of a front from the square of a later front and from its strip beside."""
    runs, n_dof = fronts.runs, fronts.n_dof
    own, deep = _sizes(fronts, runs.into[run])
    at, begin, count = fronts.start[runs.into[run]], runs.ends[run, 0] * n_dof, runs.ends[run, 1] - runs.ends[run, 0]
    beside = at + own * (own + deep) - own
    where = runs.places[runs.place_start[run] : runs.place_start[run + 1]]
    j = 0
    while j < len(where):
        first, j = j, _end_in_line(where, j, count)
        size, come = (j - first) * n_dof, begin * left + begin + first * n_dof
        start, width = (at, own) if first < count else (beside, deep)
        for b in range(count):
            for row in range(where[b] * n_dof, (where[b] + 1) * n_dof):
                to = start + where[first] * n_dof + row * width
                taken, given = values[to : to + size], update[come : come + size]
                for k in range(size):
                    taken[k] -= given[k]
                come += left


@inline
def _end_in_line(where, j, border):
    """Find the end of consecutive places from j on, at a border at the latest."""
    j += 1
    while j < len(where) and where[j] == where[j - 1] + 1 and j != border:
        j += 1
    return j


@inline
def _subtract_below(values, fronts, run, left, update):
    """Subtract the update of a front from the strip below of a later front, which is stored transposed."""
    runs, n_dof = fronts.runs, fronts.n_dof
    own, deep = _sizes(fronts, runs.into[run])
    begin, count = runs.ends[run, 0] * n_dof, runs.ends[run, 1] - runs.ends[run, 0]
    below = fronts.start[runs.into[run]] + own * own - own
    where = runs.places[runs.place_start[run] : runs.place_start[run + 1]]
    i = count
    while i < len(where):
        first, i = i, _end_in_line(where, i, count)
        size, come = (i - first) * n_dof, (begin + first * n_dof) * left + begin
        for b in range(count):
            for row in range(where[b] * n_dof, (where[b] + 1) * n_dof):
                to = below + where[first] * n_dof + row * deep
                taken = values[to : to + size]
                for k in range(size):
                    taken[k] -= update[come + k * left]
                come += 1


@kernel
def solve_in_fronts(values, fronts, x, room):
    """Solve with the LU factors in place: x is the right side, then the solution; room: (widest,)."""
    n_fronts = len(fronts.start) - 1
    for front in range(n_fronts):
        _forward(values, fronts, front, x, room)
    for front in range(n_fronts - 1, -1, -1):
        _backward(values, fronts, front, x, room)


@inline
def _forward(values, fronts, front, x, room):
    n_dof = fronts.n_dof
    own, left = _sizes(fronts, front)
    at, begin = fronts.start[front], fronts.first[front] * n_dof
    square, below = values[at : at + own * own], values[at + own * own : at + own * (own + left)]
    y, taken = x[begin : begin + own], room[:left]
    for k in range(own):
        for i in range(k + 1, own):
            y[i] -= square[i * own + k] * y[k]
    for j in range(left):
        taken[j] = 0.0
    for k in range(0, own, 3):
        u, v = below[k * left : (k + 1) * left], below[(k + 1) * left : (k + 2) * left]
        w, a, b, c = below[(k + 2) * left : (k + 3) * left], y[k], y[k + 1], y[k + 2]
        for j in range(left):
            taken[j] += u[j] * a + v[j] * b + w[j] * c
    for i in range(left // n_dof):
        to = fronts.row[fronts.row_start[front] + i] * n_dof
        for k in range(n_dof):
            x[to + k] -= taken[i * n_dof + k]


@inline
def _backward(values, fronts, front, x, room):
    n_dof = fronts.n_dof
    own, left = _sizes(fronts, front)
    at, begin = fronts.start[front], fronts.first[front] * n_dof
    square, beside = values[at : at + own * own], values[at + own * (own + left) : at + own * (own + 2 * left)]
    y, known = x[begin : begin + own], room[:left]
    for i in range(left // n_dof):
        come = fronts.row[fronts.row_start[front] + i] * n_dof
        for k in range(n_dof):
            known[i * n_dof + k] = x[come + k]
    for k in range(0, own, 3):
        u, v = beside[k * left : (k + 1) * left], beside[(k + 1) * left : (k + 2) * left]
        w, a, b, c = beside[(k + 2) * left : (k + 3) * left], y[k], y[k + 1], y[k + 2]
        for j in range(left):
            a -= u[j] * known[j]
            b -= v[j] * known[j]
            c -= w[j] * known[j]
        y[k], y[k + 1], y[k + 2] = a, b, c
    for k in range(own - 1, -1, -1):
        value = y[k]
        for j in range(k + 1, own):
            value -= square[k * own + j] * y[j]
        y[k] = value / square[k * own + k]
