"""Material points of blocks where the blocks are now: the ends of links, for the stepping loop and outside of it."""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.kernels.jit import overload


def turned_arm(turns, row, arm):
    """Turn the arm of a material point with its block: by cosine and sine in 2D, a rotation matrix in 3D."""
    if len(arm) == 2:
        return turns[row, 0] * arm[0] - turns[row, 1] * arm[1], turns[row, 1] * arm[0] + turns[row, 0] * arm[1]
    return tuple(turns[row, 3 * k] * arm[0] + turns[row, 3 * k + 1] * arm[1] + turns[row, 3 * k + 2] * arm[2]
                 for k in range(3))  # fmt: skip


@overload(turned_arm)
def _turned_arm(turns, row, arm):
    if len(arm) == 2:
        return lambda turns, row, arm: (
            turns[row, 0] * arm[0] - turns[row, 1] * arm[1],
            turns[row, 1] * arm[0] + turns[row, 0] * arm[1],
        )
    return lambda turns, row, arm: (
        turns[row, 0] * arm[0] + turns[row, 1] * arm[1] + turns[row, 2] * arm[2],
        turns[row, 3] * arm[0] + turns[row, 4] * arm[1] + turns[row, 5] * arm[2],
        turns[row, 6] * arm[0] + turns[row, 7] * arm[1] + turns[row, 8] * arm[2],
    )


def turned_arms(turns: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Turn the arms of many material points, (n, d); turns: of the block of each, as Bodies.turns has them."""
    if arms.shape[1] == 2:
        cosine, sine = turns.T
        return np.column_stack([cosine * arms[:, 0] - sine * arms[:, 1], sine * arms[:, 0] + cosine * arms[:, 1]])
    return product(turns.reshape(-1, 3, 3), arms[:, :, None])[:, :, 0]


def cross_rows(arms: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Compute arm × direction, (n, r): motion of a point along a direction when its block turns."""
    if arms.shape[1] == 2:
        return (arms[:, 0] * along[:, 1] - arms[:, 1] * along[:, 0])[:, None]
    return np.cross(arms, along)
