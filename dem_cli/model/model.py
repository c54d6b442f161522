"""What the solvers see of a structure: arrays only, the same fields in 2D and 3D.

Generalised vectors have n_dof = d + r columns: d translations, then r rotations
(2D: x, y, angle about z; 3D: x, y, z and three rotations).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Model(NamedTuple):
    """A structure that does not change during a run. Blocks are numbered 0 … n_blocks − 1."""

    dimension: int  # 2 or 3
    block_ids: tuple[str, ...]  # name of each block
    material_names: tuple[str, ...]  # the names that block_material indexes
    block_material: np.ndarray  # material of each block, (n_blocks,) int64
    fixed: np.ndarray  # blocks that cannot move, (n_blocks,) bool
    thickness: np.ndarray  # depth out of plane [m], (n_blocks,)
    masses: np.ndarray  # [kg], (n_blocks,)
    inertias: np.ndarray  # about the centroid [kg m2], (n_blocks, r)
    centroids: np.ndarray  # undeformed place [m], (n_blocks, d)
    part_blocks: np.ndarray  # block that each convex part belongs to, (n_parts,) int64, ascending
    part_starts: np.ndarray  # part p has the corners part_starts[p]:part_starts[p + 1], (n_parts + 1,) int64
    vertices: np.ndarray  # corners from the centroid of their block [m], (n_vertices, d); counter-clockwise in 2D
    dead_loads: np.ndarray  # weight and dead point loads [N, N m], (n_blocks, n_dof)
    live_loads: np.ndarray  # loads that the multiplier acts on [N, N m], (n_blocks, n_dof)

    @property
    def n_blocks(self) -> int:
        return len(self.block_ids)

    @property
    def n_parts(self) -> int:
        return len(self.part_blocks)
