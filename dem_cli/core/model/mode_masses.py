"""Consistent mass matrices of blocks that deform: kinetic energy of their rotations and modes; 2D and 3D.

A material point X of a block moves by Σ q_k φ_k(X), φ_k: turning about an axis, then its modes; M_kl = ∫ ρ φ_k · φ_l.
Nothing is coupled with translations, for neither turning nor a mode moves the centroid. Turning is with shear wherever
a block is longer than wide, and modes are with each other. Strains are small: M is that of the undeformed block.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry.rotation import matrices
from dem_cli.core.model.model import Model
from dem_cli.core.model.quadratic_modes import quadrature, terms
from dem_cli.core.model.uniform_strain import BASIS

_TURNS = {  # velocity gradients of spins of 1 rad/s about the axes, (r, d, d)
    2: np.array([[[0.0, -1.0], [1.0, 0.0]]]),
    3: np.array([
        [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]],
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
    ]),
}  # fmt: skip


def mass_matrices(model: Model) -> np.ndarray:
    """Mass matrix of rotations [kg m²] and modes [kg] of all blocks along their own axes, (n_blocks, r + m, r +
    m).

    What a block has no stiffness for (rigid ones), or restraints hold, is coupled with nothing; modes without stiffness
    have the mass of their block.
    """
    stiff: np.ndarray = model.mode_stiffness > 0.0
    free = np.column_stack([~model.held[:, model.rotations], stiff])
    found = _of_linear_motion(model)
    if len(model.mode_shapes):
        found = _with_quadratic_modes(model, found)
    matrix = np.where(free[:, :, None] & free[:, None, :], found, 0.0)
    blocks, held = np.nonzero(~free)
    matrix[blocks, held, held] = model.masses[blocks]
    return matrix


def _tensors(model: Model) -> np.ndarray:
    """Tensors of inertia along the axes of the blocks [kg m²], (n_blocks, 3, 3)."""
    own = matrices(model.principal_axes)
    return np.einsum("nij,nj,nkj->nik", own, model.inertias, own)


def _of_linear_motion(model: Model) -> np.ndarray:
    """M of turning and uniform strain, ρ tr(A_k J A_lᵀ) with J = ∫ X Xᵀ, (n_blocks, r + 3 or 6, r + 3 or 6)."""
    d = model.dimension
    moments = _second_moments(model)
    turns = np.broadcast_to(_TURNS[d], (model.n_blocks, *_TURNS[d].shape))
    gradients = np.concatenate([turns, BASIS[d] / model.shapes.radii[:, None, None, None]], axis=1)
    return np.einsum("nkij,njm,nlim->nkl", gradients, moments, gradients)


def _second_moments(model: Model) -> np.ndarray:
    """∫ ρ X Xᵀ along the axes of the blocks [kg m²], (n_blocks, d, d)."""
    if model.dimension == 3:
        tensors = _tensors(model)
        return 0.5 * np.trace(tensors, axis1=1, axis2=2)[:, None, None] * np.eye(3) - tensors
    return np.array([np.einsum("pi,pj,p->ij", points, points, masses) for points, masses in _particles(model)])


def _particles(model: Model) -> list[tuple[np.ndarray, np.ndarray]]:
    """Points (n, 2) [m] and masses (n,) [kg] of each block in the plane, which integrate up to degree 4 exactly."""
    corners = np.split(model.vertices, model.part_starts[1:-1])
    found = []
    for block, mass in enumerate(model.masses):
        points, weights = quadrature([corners[part] for part in np.flatnonzero(model.part_blocks == block)])
        found.append((points, weights * mass / weights.sum()))
    return found


def _with_quadratic_modes(model: Model, linear: np.ndarray) -> np.ndarray:
    """Add quadratic modes, which are coupled with linear motion where a block has no two axes of symmetry."""
    n, k = linear.shape[:2]
    shapes = model.mode_shapes
    found = np.zeros((n, k + shapes.shape[1], k + shapes.shape[1]))
    found[:, :k, :k] = linear
    for block, (points, masses) in enumerate(_particles(model)):
        bent = product(shapes[block], terms(points).T)  # (6, 2, n_points)
        gradients = np.concatenate([_TURNS[2], BASIS[2] / model.shapes.radii[block]])
        moved = product(gradients, points.T)
        found[block, k:, k:] = np.einsum("kip,lip,p->kl", bent, bent, masses)
        found[block, :k, k:] = np.einsum("kip,lip,p->kl", moved, bent, masses)
        found[block, k:, :k] = found[block, :k, k:].T
    return found
