"""Compiled factorisation L D Lᵀ of sparse symmetric matrices, and solution with the factors.

Row by row (T. Davis, Algorithm 849: a concise sparse Cholesky factorization package, ACM Trans. Math. Softw. 31, 2005,
587). Every sum is written out: the last digits are those of any processor.
"""

from __future__ import annotations

from dem_cli.core.kernels.jit import kernel


@kernel
def count_entries(starts, rows, parents, counts, seen):
    """Find the elimination tree (n,) and count the entries of each column of L (n,), for a matrix by columns; seen:
    room, (n,).
    """
    for k in range(len(parents)):
        parents[k], seen[k], counts[k] = -1, k, 0
        for p in range(starts[k], starts[k + 1]):
            i = rows[p]
            while i < k and seen[i] != k:
                if parents[i] == -1:
                    parents[i] = k
                counts[i] += 1
                seen[i] = k
                i = parents[i]


@kernel
def order_rows(starts, columns, degrees, ascending, order, waits):
    """Order the rows of a symmetric matrix from neighbour to neighbour, so that its entries come to lie close to the
    diagonal (E. Cuthill, J. McKee, Reducing the bandwidth of sparse symmetric matrices, Proc. 24th ACM National
    Conference 1969, 157).

    starts, columns: entries of each row; degrees: of each row, (n,); ascending: rows in the order of their degrees,
    from which each part that hangs together begins, (n,); order: found, (n,); waits: room, (n,) of ones.
    """
    found = 0
    for k in range(len(ascending)):
        if waits[ascending[k]] == 0:
            continue
        order[found], waits[ascending[k]] = ascending[k], 0
        at, found = found, found + 1
        while at < found:
            first = found
            for p in range(starts[order[at]], starts[order[at] + 1]):
                j = columns[p]
                if waits[j] == 0:
                    continue
                waits[j], place = 0, found
                while place > first and degrees[j] < degrees[order[place - 1]]:  # those of one row by their degrees
                    order[place] = order[place - 1]
                    place -= 1
                order[place] = j
                found += 1
            at += 1


@kernel
def factorise_symmetric(matrix, factors, room):
    """Factorise a matrix into L (strictly lower, by columns) and D; returns the number of the first pivot that is zero,
    else −1.

    matrix: starts, rows, values of all columns; factors: parents, starts (n + 1,), counts, rows, values, diagonal;
    room: seen, order and values, (n,) each.
    """
    starts, rows, values = matrix
    parents, begins, counts, below, lower, diagonal = factors
    seen, order, work = room
    n = len(parents)
    for k in range(n):
        top, seen[k], counts[k], work[k] = n, k, 0, 0.0
        for p in range(starts[k], starts[k + 1]):
            i = rows[p]
            if i > k:
                continue
            work[i] += values[p]
            length = 0
            while seen[i] != k:
                order[length], seen[i] = i, k
                length, i = length + 1, parents[i]
            while length > 0:
                top, length = top - 1, length - 1
                order[top] = order[length]
        diagonal[k], work[k] = work[k], 0.0
        for at in range(top, n):
            i = order[at]
            taken, work[i] = work[i], 0.0
            end = begins[i] + counts[i]
            for p in range(begins[i], end):
                work[below[p]] -= lower[p] * taken
            share = taken / diagonal[i]
            diagonal[k] -= share * taken
            below[end], lower[end] = k, share
            counts[i] += 1
        if diagonal[k] == 0.0:
            return k
    return -1


@kernel
def solve_symmetric(factors, x):
    """Solve a factorised system in place: x holds the right side and becomes the solution, (n,)."""
    _, begins, counts, below, lower, diagonal = factors
    n = len(x)
    for j in range(n):
        for p in range(begins[j], begins[j] + counts[j]):
            x[below[p]] -= lower[p] * x[j]
    for j in range(n):
        x[j] /= diagonal[j]
    for j in range(n - 1, -1, -1):
        for p in range(begins[j], begins[j] + counts[j]):
            x[j] -= lower[p] * x[below[p]]
