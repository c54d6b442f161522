"""Straight spans between material points of two blocks: lengths and directions now, motion, geometric stiffness.

What ties and the elements of bars that cross joints have in common, outside of the stepping loop.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.links.link import FIXED_POINT, LinkEnds
from dem_cli.core.links.material_points import cross_rows, turned_arms


class Spans(NamedTuple):
    """Straight spans between material points, as they were drawn."""

    blocks: np.ndarray  # the second one may be FIXED_POINT, (n, 2) int64
    arms: np.ndarray  # of both ends from the centroids, undeformed; of a fixed point its place [m], (n, 2·d)
    axes: np.ndarray  # unit, from the first end to the second, at the start, (n, d)
    starts: np.ndarray  # centroids of both blocks at the start; 0 of a fixed point [m], (n, 2·d)
    lengths: np.ndarray  # at the start [m], (n,)

    def started(self, origin: np.ndarray) -> Spans:
        """Copy the spans for a simulation that counts places from `origin`."""
        d, held = self.axes.shape[1], self.blocks[:, 1] == FIXED_POINT
        arms, starts = self.arms.copy(), self.starts.copy()
        arms[held, d:] -= origin
        starts[:, :d] -= origin
        starts[~held, d:] -= origin
        return self._replace(arms=arms, starts=starts)

    def ends(self, bodies: Any) -> np.ndarray:
        """Compute the places of both ends of each span now [m], (n, 2, d)."""
        return self._placed(bodies)[0]

    def lines(self, bodies: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute unit vectors (n, d), lengths (n,) and arms (n, 2, d) of spans now; bodies None: of the start."""
        n, d = self.axes.shape
        if bodies is None or not n:
            return self.axes, self.lengths, self.arms.reshape(n, 2, d)
        ends, arms = self._placed(bodies)
        between = ends[:, 1] - ends[:, 0]
        lengths = np.sqrt((between**2).sum(axis=1))
        return between / lengths[:, None], lengths, arms

    def _placed(self, bodies: Any) -> tuple[np.ndarray, np.ndarray]:
        """Compute ends and arms of spans now, (n, 2, d) each."""
        n, d = self.axes.shape
        held, arms = self.blocks[:, 1] == FIXED_POINT, self.arms.reshape(n, 2, d).copy()
        for side in (0, 1):
            of = ~held if side else np.ones(n, bool)
            arms[of, side] = turned_arms(bodies.turns[self.blocks[of, side]], arms[of, side])
        ends = arms.copy()
        ends[:, 0] += bodies.positions[self.blocks[:, 0]]
        ends[~held, 1] += bodies.positions[self.blocks[~held, 1]]
        return ends, arms

    def motion(self, along: np.ndarray, arms: np.ndarray) -> np.ndarray:
        """Compute the relative motion of the ends along a direction, per motion of the blocks, (n, 2, n_dof)."""
        sides = []
        for side, sign in ((0, -1.0), (1, 1.0)):
            row = sign * np.column_stack([along, cross_rows(arms[:, side], along)])
            row[self.blocks[:, side] == FIXED_POINT] = 0.0
            sides.append(row)
        return np.stack(sides, axis=1)

    def sideways(self, bodies: Any) -> np.ndarray:
        """Compute the relative motion of the ends across each span, (d, n, 2, n_dof).

        Along the d − 1 directions across an axis: those of the unit vectors that are left when the axis is taken out,
        all of them, as more stiffness than there is does no harm.
        """
        axes, _, arms = self.lines(bodies)
        d = axes.shape[1]
        return np.stack([self.motion(np.eye(d)[k] - axes * axes[:, k : k + 1], arms) for k in range(d)])

    def turning(self, force: np.ndarray, bodies: Any) -> np.ndarray:
        """Compute the geometric stiffness of axial forces, tension positive [N], (n,): N times the second derivatives
        of lengths.

        Across: (1 − n nᵀ)/L of the relative motion of the ends; a block that turns by θ takes the end at its arm r
        back by θ × (θ × r)/2. (n, 2·n_dof, 2·n_dof), first block first.
        """
        axes, lengths, arms = self.lines(bodies)
        n, d = axes.shape
        n_dof = d + (1 if d == 2 else 3)
        across = [np.eye(d)[k] - axes * axes[:, k : k + 1] for k in range(d)]
        rows = np.stack([self.motion(side, arms).reshape(n, 2 * n_dof) for side in across], axis=1)
        found = product(rows.swapaxes(1, 2), rows) / lengths[:, None, None]
        for side, sign in ((0, -1.0), (1, 1.0)):
            arm, held = arms[:, side], self.blocks[:, side] != FIXED_POINT
            along = (axes * arm).sum(axis=1)[:, None, None]
            both = axes[:, :, None] * arm[:, None, :]
            turns = 0.5 * (both + both.swapaxes(1, 2)) - along * np.eye(d) if d == 3 else -along
            own = slice(side * n_dof + d, (side + 1) * n_dof)
            found[:, own, own] += sign * held[:, None, None] * turns
        return force[:, None, None] * found


def spans(ends: Sequence[LinkEnds], centroids: np.ndarray) -> Spans:
    """Build the spans of blocks that lie where they are; centroids: of the blocks [m], (n_blocks, d).

    The points of `ends` are counted from the centroids of their blocks, that of a fixed point from nowhere.
    """
    n, d = len(ends), centroids.shape[1]
    blocks = np.array([end.blocks for end in ends], np.int64).reshape(n, 2)
    arms = np.array([end.points for end in ends], float).reshape(n, 2, d)
    starts = np.where((blocks == FIXED_POINT)[:, :, None], 0.0, centroids[blocks])
    between = (starts[:, 1] + arms[:, 1]) - (starts[:, 0] + arms[:, 0])
    lengths = np.sqrt((between**2).sum(axis=1))
    return Spans(blocks, arms.reshape(n, 2 * d), between / lengths[:, None], starts.reshape(n, 2 * d), lengths)
