"""Corner forces: friction of joints in space as forces at their contact points, equal to where it acts.

Torsion: corner forces are exact for what rocks, but friction at the corners has the torque μN times their distance: for
a square 85 % more than a uniform pressure p has, ∫ μ p |r − c| dA. So friction of a point at r acts at c + β (r − c),
c being the centre of pressure of the joint: the same forces with the same resultant, and at β = (mean distance of the
outline from its centroid) / (mean distance of its corners, by their areas) the torque of a uniform pressure. β is 0.541
for a square, 0.521 for a rectangle 3:1, 1/2 for a line. What friction carries so, forces at the corners in their cones
carry as well: β Tᵢ + (1 − β) (Nᵢ/N) ΣT, |ΣT| ≤ μN. A reader of results, who knows points alone, gets these.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry.rotation import frames
from dem_cli.core.kernels.records import Joints


def at_corners(joints: Joints, normal: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Convert shear forces to equivalent forces at the points, along their tangents [N], (n_points, d − 1).

    shear: as the loops have them [N], (n_points, d − 1), which comes back where torsion is no matter.
    """
    if shear.shape[1] == 1 or not (joints.torsion != 1.0).any():
        return shear
    owners = joints.owners
    share = joints.torsion[owners][:, None]
    tangents = frames(joints.frames, 3)[:, 1:]
    along = (shear[:, :, None] * tangents).sum(axis=1)
    n = len(joints.blocks)
    together = np.column_stack([np.bincount(owners, along[:, k], n) for k in range(3)])
    pressed = np.bincount(owners, normal, n)
    parts = normal / np.where(pressed > 0.0, pressed, 1.0)[owners]
    mean = (together[owners][:, None] * tangents).sum(axis=2) * parts[:, None]
    return np.where(share == 1.0, shear, share * shear + (1.0 - share) * mean)
