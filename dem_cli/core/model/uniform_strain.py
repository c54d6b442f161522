"""Uniform strain of deformable blocks: modes, elastic stiffness, loads, strains, stresses; 2D (plane stress) and 3D.

ε = Σ a_k B_k / radius: an amplitude a_k [m] is what a point as far from the centroid as the farthest corner moves by.
With B_k = 1, diag(1, −1), shear in the plane, and 1, diag(1, −1, 0), diag(1, 1, −2), three shears in space, isotropic
elasticity couples no two modes (bulk and shear moduli alone): energy ½ Σ K_k a_k², V σ : B_k = K_k a_k radius.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.arithmetic.small_matrices import diagonalised, inverse

_PLANAR = np.array([[[1.0, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, -1.0]], [[0.0, 1.0], [1.0, 0.0]]])
_SPATIAL = np.array(
    [
        np.eye(3),
        np.diag([1.0, -1.0, 0.0]),
        np.diag([1.0, 1.0, -2.0]),
        [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
    ]
)
_ORDER = {2: ([0, 1, 0], [0, 1, 1]), 3: ([0, 1, 2, 1, 2, 0], [0, 1, 2, 2, 0, 1])}  # of components, by dimension
BASIS = {2: _PLANAR, 3: _SPATIAL}  # B_k by dimension, (m, d, d)


def mode_stiffness(
    dimension: int, young: np.ndarray, poisson: np.ndarray, volumes: np.ndarray, radii: np.ndarray
) -> np.ndarray:
    """Stiffness of the modes of blocks [N/m], (n_blocks, m); in the plane of blocks in plane stress.

    young [Pa], poisson [-], volumes [m³], radii [m]: (n_blocks,); young 0: a rigid block, whose modes have none.
    """
    basis = BASIS[dimension]
    squares = (basis**2).sum(axis=(1, 2))
    moduli = np.repeat((young / (1.0 + poisson))[:, None], len(basis), axis=1)  # 2 G
    moduli[:, 0] = young / (1.0 - (dimension - 1) * poisson)
    return moduli * squares * (volumes / radii**2)[:, None]


def mode_loads(arms: np.ndarray, forces: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Compute modal loads of forces (n, d) [N] at arms (n, d) from the centroids [N], (n, m); radii [m], (n,)."""
    return np.einsum("ni,mij,nj->nm", forces, BASIS[arms.shape[1]], arms) / radii[:, None]


def turned_mode_loads(loads: np.ndarray, rotations: np.ndarray) -> np.ndarray:
    """Loads on modes [N], (n, m), of blocks that turned since, (n, d, d): forces keep their directions and levers.

    Of quadratic modes, which come behind, all stays as it was.
    """
    basis = _basis_of(loads)
    parts = loads[:, : len(basis)] / (basis**2).sum(axis=(1, 2))
    turned = np.einsum("nki,nm,mkl,nlj->nij", rotations, parts, basis, rotations)
    return np.column_stack([np.einsum("nij,mij->nm", turned, basis), loads[:, len(basis) :]])


def _basis_of(modes: np.ndarray) -> np.ndarray:
    """Return B_k of blocks with these amplitudes; in the plane quadratic modes may come behind them."""
    return _SPATIAL if modes.shape[1] == len(_SPATIAL) else _PLANAR


def strains(modes: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Strains of blocks in their own axes [-], (n_blocks, d, d); modes [m], (n_blocks, m)."""
    basis = _basis_of(modes)
    return np.einsum("nm,mij->nij", modes[:, : len(basis)] / radii[:, None], basis)


def stresses(modes: np.ndarray, stiffness: np.ndarray, volumes: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Stresses of blocks in their own axes, tension positive [Pa], (n_blocks, d, d); 0: rigid blocks."""
    basis = _basis_of(modes)
    parts = (stiffness * modes)[:, : len(basis)] * (radii / volumes)[:, None] / (basis**2).sum(axis=(1, 2))
    return np.einsum("nm,mij->nij", parts, basis)


def components(stresses: np.ndarray) -> np.ndarray:
    """Return components xx, yy, xy, in space xx, yy, zz, yz, zx, xy of symmetric tensors (n, d, d), (n, 3 or 6)."""
    rows, columns = _ORDER[stresses.shape[1]]
    return stresses[:, rows, columns]


def tensors(components: np.ndarray) -> np.ndarray:
    """Return symmetric tensors (n, d, d) of components as `components` orders them, (n, 3 or 6)."""
    d = 2 if components.shape[1] == 3 else 3
    found = np.empty((len(components), d, d))
    for places in (_ORDER[d], _ORDER[d][::-1]):
        found[:, places[0], places[1]] = components
    return found


def gradients_of(modes: np.ndarray, radii: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Deformation gradients R (I + ε), row by row, (n_blocks, d·d); turns: as kernels.records.Bodies."""
    d = _basis_of(modes).shape[1]
    return product(rotations_of(turns), np.eye(d) + strains(modes, radii)).reshape(-1, d * d)


def covectors_of(gradients: np.ndarray) -> np.ndarray:
    """Compute F⁻ᵀ of gradients F, row by row, which transforms normals of faces, (n_blocks, d·d)."""
    d = int(np.sqrt(gradients.shape[1]))
    return inverse(gradients.reshape(-1, d, d)).swapaxes(1, 2).reshape(-1, d * d)


def rotated_basis(gradients: np.ndarray) -> np.ndarray:
    """Compute R B_k F⁻¹ of blocks with gradients F (n_blocks, d, d): velocity gradients of their modes, (n_blocks,
    m, d, d)."""
    backwards, basis = inverse(gradients), BASIS[gradients.shape[1]]
    _, axes = diagonalised(product(gradients.swapaxes(1, 2), gradients))
    turned = product(gradients, axes)
    lengths = np.sqrt((turned**2).sum(axis=1))[:, None]
    rotations = product(turned / lengths, axes.swapaxes(1, 2))  # of the polar decomposition
    return np.einsum("nij,mjk,nkl->nmil", rotations, basis, backwards)


def rotations_of(turns: np.ndarray) -> np.ndarray:
    """Rotation matrices of blocks (n, d, d); turns: as kernels.records.Bodies."""
    if turns.shape[1] == 9:
        return turns.reshape(-1, 3, 3)
    c, s = turns.T
    return np.stack([np.stack([c, -s], axis=1), np.stack([s, c], axis=1)], axis=1)
