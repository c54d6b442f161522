"""Deformation of elastic blocks lumped into their joints: each joint gives way for half of the block on either side.

    1/kn' = 1/kn + ℓa/Ea + ℓb/Eb,      1/ks' = 1/ks + ℓa/Ga + ℓb/Gb,      G = E / 2(1 + ν)

ℓ is half the extent of the block across the joint. Exact for uniform stress; blocks that bend between joints that are
stiff beside them come out too soft (docs/deformable.md). Fixed blocks are supports and do not deform.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.model.model import Model


class BlockCompliance(NamedTuple):
    """Compliance of blocks that deform, lumped into the joints on either side of them."""

    deforms: np.ndarray  # which blocks do, (n_blocks,) bool
    behind: np.ndarray  # ℓ/E and ℓ/G of the block behind each face [m/Pa], (n_faces, 2)
    free: np.ndarray  # named joints whose own kn, ks are those of a rigid joint: they do not count, (n_named, 2) bool

    def in_series(self, own: np.ndarray, faces: np.ndarray, named: np.ndarray) -> np.ndarray:
        """Compute the stiffness of joints in series with their blocks [Pa/m], (n, 2).

        own: kn and ks of the joints alone [Pa/m], (n, 2); faces: that meet there, (n, 1) or (n, 2); named: which joints
        of the model they are, (n,).
        """
        more = self.behind[faces].sum(axis=1)
        together = np.where(self.free[named], 0.0, 1.0 / own) + more
        return np.where(more > 0.0, 1.0 / np.where(more > 0.0, together, 1.0), own)

    def shares(self, own: np.ndarray, faces: np.ndarray, named: np.ndarray) -> np.ndarray:
        """Compute the compliance of the blocks over that of the joint alone, kn h/E [-], (n,); infinite where that is
        rigid.

        own: kn of the joints alone [Pa/m], (n,); faces: (n, 2); named: (n,).
        """
        more = self.behind[faces].sum(axis=1)[:, 0]
        return np.where(self.free[named, 0] & (more > 0.0), np.inf, own * more)


def block_compliance(model: Model, moduli: np.ndarray, free: np.ndarray) -> BlockCompliance | None:
    """Compute the compliance of the blocks of a model; None where no block deforms.

    moduli: E and G of each material [Pa], infinite where its blocks stay rigid, (n_materials, 2); free: as above.
    """
    deforms = np.isfinite(moduli[model.block_material, 0]) & ~model.fixed
    if not deforms.any():
        return None
    blocks = model.part_blocks[model.topology.face_parts]
    compliance = np.where(deforms[:, None], 1.0 / moduli[model.block_material], 0.0)[blocks]
    return BlockCompliance(deforms, model.half_extents[:, None] * compliance, free)
