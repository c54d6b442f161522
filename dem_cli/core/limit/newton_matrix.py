"""Newton's matrix of elastic, frictional joints, Σ f rowᵢᵀ rowⱼ over all points, factorised again and again.

Its pattern is that of blocks that touch and stays, so that order and fill are found once. It lies in dense fronts
(limit/fronts.py) and is factorised by compiled code: that takes a third of the time of SuperLU, whose BLAS moreover
gives other last digits on other processors, and a path may end elsewhere by them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.limit.fronts import fronts_of, parts_of
from dem_cli.core.limit.settings import PathSettings


class PointRows(NamedTuple):
    """Motions of b against a at every point, and which of their products make the matrix."""

    rows: np.ndarray  # (n_points, d directions, 2 blocks, n_dof), nothing where held
    columns: np.ndarray  # degrees of freedom, −1: held, (n_points, 2 blocks, n_dof)
    products: tuple[tuple[int, int], ...]  # directions; of two different tangents either way round
    n_columns: int  # degrees of freedom in all
    places: np.ndarray | None = None  # of the blocks that can move, for the order of many [m], (n_blocks, d)

    @property
    def n_dof(self) -> int:
        """Degrees of freedom of a block."""
        return self.columns.shape[2]


class NewtonMatrix:
    """Newton matrix of one structure; degrees of freedom are those of `order`, one after the other.

    No rows are exchanged.
    """

    def __init__(self, points: PointRows, settings: PathSettings) -> None:
        n_dof = points.n_dof
        blocks = points.columns.max(axis=2) // n_dof  # −1: fixed
        blocks = np.where((points.columns >= 0).any(axis=2), blocks, -1)
        touching = np.unique(np.sort(blocks[(blocks >= 0).all(axis=1)], axis=1), axis=0)
        self.settings = settings
        self.fronts = fronts = fronts_of(touching, points.n_columns // n_dof, n_dof, points.places)
        self.order = (fronts.order[:, None] * n_dof + np.arange(n_dof)).ravel()
        both = np.stack([np.repeat(blocks, 2, axis=1), np.tile(blocks, 2)], axis=2)
        self.parts = parts_of(fronts, both.reshape(-1, 2)).reshape(-1, 2, 2, 3)
        first, row, column = parts_of(fronts, np.repeat(np.arange(len(fronts.order)), 2).reshape(-1, 2)).T
        self.diagonal = (first[:, None] + (row + column)[:, None] * np.arange(n_dof)).ravel()[self.order]
        self.rows = np.ascontiguousarray(points.rows)
        self.joint_starts = np.flatnonzero(np.r_[True, (self.parts[1:] != self.parts[:-1]).any(axis=(1, 2, 3)), True])
        pairs = [(pair, k) for k, pair in enumerate(points.products)]
        pairs += [((j, i), k) for (i, j), k in pairs if 0 < i < j]  # of two tangents, either way round
        self.pairs, self.of_pair = np.array([pair for pair, _ in pairs]), [k for _, k in pairs]
        self.values = np.empty(int(fronts.start[-1]))
        self.room = np.empty(max(fronts.widest**2, 1))
        self.pushed = np.empty(self.rows.shape[1:])
        several = len(self.rows) >= settings.points_summed * (len(self.joint_starts) - 1)
        self.by_joints = several and self.rows.shape[1] == 3  # whether points of a joint are summed before they go in
        if self.by_joints:
            self.parts = np.ascontiguousarray(self.parts[self.joint_starts[:-1]])
            self.rows, self.pushed = (room.reshape(*room.shape[:-2], 2 * n_dof) for room in (self.rows, self.pushed))
            self.part = np.empty((2 * n_dof, 2 * n_dof))

    def factorised(self, factors: list[np.ndarray], more: np.ndarray | None = None) -> FrontFactors:
        """LU factors of the matrix whose products have these factors; those of the last call are lost.

        more: what comes to its diagonal, (n_columns,) in the order of elimination as right sides are; None: as little
        as makes it regular. Raises RuntimeError where it is singular.
        """
        from dem_cli.core.limit.front_factors import add_to_diagonal, factorise

        fronts, values = self.fronts, self.values
        self._assemble(np.stack([factors[k] for k in self.of_pair]))
        if more is None:
            add_to_diagonal(values, self.diagonal, self.settings.singular)
        else:
            values[self.diagonal] += more
        if not factorise(values, fronts, self.room):
            raise RuntimeError("a pivot is zero: the matrix is singular")
        return FrontFactors(self)

    def _assemble(self, factors: np.ndarray) -> None:
        if self.by_joints:
            from dem_cli.core.limit.front_factors import assemble_joints

            starts = self.joint_starts
            assemble_joints(self.values, self.parts, starts, self.rows, factors, self.pairs, self.pushed, self.part)
        else:
            from dem_cli.core.limit.front_factors import assemble

            assemble(self.values, self.parts, self.rows, factors, self.pairs, self.pushed)


class FrontFactors(NamedTuple):
    """LU factors in fronts."""

    matrix: NewtonMatrix

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solve for one right side; returns the solution, (n_columns,)."""
        from dem_cli.core.limit.front_factors import solve_in_fronts

        found = right.copy()
        solve_in_fronts(self.matrix.values, self.matrix.fronts, found, self.matrix.room)
        return found
