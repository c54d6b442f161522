"""Follower loads: forces that move with a material point of their block, and may turn with the block."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.rotation import moments, turning


class FollowingLoads(NamedTuple):
    """Forces at points of blocks, as they were drawn; all other loads keep their direction and their lever."""

    blocks: np.ndarray  # that each acts on, (n,) int64
    arms: np.ndarray  # from the centroids to the points, undeformed [m], (n, d)
    forces: np.ndarray  # as drawn [N], (n, d)
    dead: np.ndarray  # constant; else times the multiplier, (n,) bool
    turning: np.ndarray  # whether the direction turns with the block, (n,) bool

    def shifted(self, shifts: np.ndarray) -> FollowingLoads:
        """Shift the loads to blocks whose centroids are elsewhere by so much [m], (n_blocks, d)."""
        return self._replace(arms=self.arms - shifts[self.blocks])

    def now(self, orientations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute arms [m] and forces [N] of the loads where their blocks have turned to, (n, d) each.

        orientations: of all blocks, as Bodies or Frame have them.
        """
        turned = turning(orientations[self.blocks])
        return turned(self.arms), np.where(self.turning[:, None], turned(self.forces), self.forces)

    def change(self, orientations: np.ndarray, dead: bool) -> np.ndarray:
        """Compute the change of dead or live follower loads since the start, about the centroids [N, N m],
        (n_blocks, n_dof).

        orientations: of all blocks, as Bodies has them.
        """
        acting = FollowingLoads(*(values[self.dead == dead] for values in self))
        blocks, arms, forces = acting.blocks, acting.arms, acting.forces
        moved, now = acting.now(orientations)
        more = np.column_stack([now - forces, moments(moved, now) - moments(arms, forces)])
        total = np.zeros((len(orientations), more.shape[1]))
        np.add.at(total, blocks, more)
        return total

    def beyond(self, orientations: np.ndarray, rotations: np.ndarray) -> float:
        """Compute q·u of live follower loads beyond that of their drawn resultants [J]: F·(R r − r) − M·θ.

        rotations: rotation vectors of all blocks (n_blocks, r). Along the directions as drawn.
        """
        blocks, arms, forces, _, _ = (values[~self.dead] for values in self)
        swung = turning(orientations[blocks])(arms) - arms
        return float((forces * swung).sum() - (moments(arms, forces) * rotations[blocks]).sum())
