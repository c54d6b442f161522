"""Rows of sixteen joints side by side (lanes): vectors of one lane as tuples, in 2D and 3D, loaded and stored.

A row holds one number of each of LANES joints; a vector takes as many rows, one after the other. Number i of lane l in
the row that begins at s is array[s + i·LANES + l]. Distances that are known when a kernel is compiled are what lets the
compiler work on all lanes at once.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.kernels.jit import built_in, overload

LANES = 16
ROW = np.uint64(LANES)


def take(array, start, like):
    """Load as many numbers of a lane as `like` has; start: place of the first one."""
    return tuple(array[start + np.uint64(k) * ROW] for k in range(len(like)))


@overload(take)
def _take(array, start, like):
    if len(like) == 1:
        return lambda array, start, like: (array[start],)
    if len(like) == 2:
        return lambda array, start, like: (array[start], array[start + ROW])
    return lambda array, start, like: (array[start], array[start + ROW], array[start + np.uint64(2) * ROW])


def put(array, start, numbers):
    """Store numbers of a lane; the reverse of `take`."""
    for k, number in enumerate(numbers):
        array[start + np.uint64(k) * ROW] = number


@overload(put)
def _put(array, start, numbers):
    if len(numbers) == 1:

        def one(array, start, numbers):
            array[start] = numbers[0]

        return one
    if len(numbers) == 2:

        def two(array, start, numbers):
            array[start] = numbers[0]
            array[start + ROW] = numbers[1]

        return two

    def three(array, start, numbers):
        array[start] = numbers[0]
        array[start + ROW] = numbers[1]
        array[start + np.uint64(2) * ROW] = numbers[2]

    return three


def take_frame(array, start, like):
    """Load the frame of a lane, as `load_frame` has it, from 2 rows in the plane and 9 in space."""
    if len(like) == 2:
        x, y = take(array, start, like)
        return (x, y), (-y, x)
    return tuple(take(array, start + np.uint64(3 * k) * ROW, like) for k in range(3))


@overload(take_frame)
def _take_frame(array, start, like):
    if len(like) == 2:

        def planar(array, start, like):
            x, y = array[start], array[start + ROW]
            return (x, y), (-y, x)

        return planar
    return lambda array, start, like: (
        take(array, start, like),
        take(array, start + np.uint64(3) * ROW, like),
        take(array, start + np.uint64(6) * ROW, like),
    )


@built_in
def lowest_bit(bits):
    """Find the place of the lowest set bit of a whole number that is not zero."""
    place = 0
    while not (bits >> place) & 1:
        place += 1
    return place
