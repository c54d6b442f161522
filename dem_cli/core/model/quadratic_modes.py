"""Quadratic modes of deformable blocks: bending and bulging, their stiffness and loads; 2D, plane stress.

u(X) = Σ a_k φ_k(X), φ_k of second degree in X without mean displacement or mean rotation, so that neither weight nor
motion of the block as a whole does any work on them; pure second degree has no mean strain, so that none couples with
those of model/uniform_strain.py. They are eigenvectors of the elastic energy against the mean square of u: no two are
coupled. An amplitude [m] is the largest displacement of a corner.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.arithmetic.small_matrices import diagonalised, inverse, root
from dem_cli.core.geometry.rotation import turned_by
from dem_cli.core.model.uniform_strain import strains

N_QUADRATIC = 6  # in the plane
TERMS = 6  # 1, x, y, x², x y, y², of which each φ_k has coefficients for both directions
# Points and weights in triangles, exact to degree 4 (Dunavant 1985).
_NEAR, _FAR = 0.445948490915965, 0.091576213509771
_BARYCENTRIC = np.array([np.roll([a, a, 1.0 - 2.0 * a], k) for a in (_NEAR, _FAR) for k in range(3)])
_WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3)


def terms(arms: np.ndarray) -> np.ndarray:
    """Evaluate 1, x, y, x², x y, y² at arms (..., 2) [m], (..., 6)."""
    x, y = arms[..., 0], arms[..., 1]
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)


def quadratic_modes(
    vertices: np.ndarray,
    part_starts: np.ndarray,
    part_blocks: np.ndarray,
    thickness: np.ndarray,
    young: np.ndarray,
    poisson: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness [N/m], (n_blocks, 6), and shapes: coefficients of `terms` for both directions, (n_blocks, 6, 2, 6).

    vertices: corners of convex parts from the centroid of their block [m], (n_vertices, 2); part p of block
    part_blocks[p] has part_starts[p]:part_starts[p + 1]. thickness [m], young [Pa], poisson: (n_blocks,); young 0: a
    rigid block.
    """
    stiffness, shapes = np.zeros((len(young), N_QUADRATIC)), np.zeros((len(young), N_QUADRATIC, 2, TERMS))
    corners = [vertices[start:end] for start, end in zip(part_starts[:-1], part_starts[1:], strict=True)]
    for block in np.flatnonzero(young > 0.0):
        parts = [corners[p] for p in np.flatnonzero(part_blocks == block)]
        moduli = young[block] * thickness[block], poisson[block]
        stiffness[block], shapes[block] = _of_block(parts, *moduli)
    return stiffness, shapes


def _of_block(parts: list[np.ndarray], young: float, poisson: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute stiffness and shapes of the quadratic modes of one block; young: Young's modulus × thickness [N/m]."""
    points, weights = quadrature(parts)
    area, values = weights.sum(), terms(points)
    pure = np.zeros((N_QUADRATIC, 2, TERMS))
    for k in range(3):
        pure[k, 0, 3 + k] = pure[3 + k, 1, 3 + k] = 1.0
    moved = product(pure, values.T)  # (6, 2, n_points)
    turn = product(moved[:, 1] * points[:, 0] - moved[:, 0] * points[:, 1], weights) / (
        product((points**2).sum(axis=1), weights)
    )
    pure[:, :, 0] = -product(moved, weights) / area
    pure[:, 0, 2], pure[:, 1, 1] = turn, -turn
    moved = product(pure, values.T)
    metric = np.einsum("kip,lip,p->kl", moved, moved, weights) / area
    elastic = _elasticity(pure, points, weights, young, poisson)
    scales = 1.0 / np.sqrt(np.diag(metric))  # of round-off alone
    own = inverse(root(metric * np.outer(scales, scales))) * scales
    levels, vectors = diagonalised(product(product(own, elastic), own.T))
    found = np.einsum("kl,lim->kim", product(vectors.T, own), pure)
    reach = np.hypot(*np.moveaxis(product(found, terms(np.concatenate(parts)).T), 1, 0)).max(axis=1)
    return levels / reach**2, found / reach[:, None, None]


def _elasticity(
    shapes: np.ndarray, points: np.ndarray, weights: np.ndarray, young: float, poisson: float
) -> np.ndarray:
    """Integrate ∫ ε : C : ε of each two fields, plane stress [N/m], (6, 6)."""
    (x, y), zero, one = points.T, np.zeros(len(points)), np.ones(len(points))
    by_x = product(shapes, np.stack([zero, one, zero, 2.0 * x, y, zero]))  # (6, 2, n_points)
    by_y = product(shapes, np.stack([zero, zero, one, zero, x, 2.0 * y]))
    strain = np.stack([by_x[:, 0], by_y[:, 1], by_y[:, 0] + by_x[:, 1]])
    plane = np.array([[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, (1.0 - poisson) / 2.0]])
    plane *= young / (1.0 - poisson**2)
    return np.einsum("skp,st,tlp,p->kl", strain, plane, strain, weights)


def quadrature(parts: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] and weights [m²] in convex polygons, (n, 2) and (n,)."""
    triangles = np.concatenate([
        np.stack([np.repeat(part[:1], len(part) - 2, axis=0), part[1:-1], part[2:]], axis=1) for part in parts
    ])  # fmt: skip
    sides = triangles[:, 1:] - triangles[:, :1]
    areas = 0.5 * np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    points = np.einsum("pb,tbi->tpi", _BARYCENTRIC, triangles)
    return points.reshape(-1, 2), np.outer(areas, _WEIGHTS).ravel()


def bent_by(modes: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Coefficients of `terms` for both directions, summed over the last modes (n_blocks, m) [m], (n_blocks, 12)."""
    if not len(shapes):
        return np.zeros((0, 0))
    return np.einsum("nk,nkim->nim", modes[:, -N_QUADRATIC:], shapes).reshape(len(modes), -1)


def displacements(shapes: np.ndarray, arms: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Evaluate displacements R φ_k at arms (..., 2) [m] along the axes of the world, (..., 6, 2); turns: cosine
    and sine of R, (..., 2)."""
    cosines, sines = turns[..., 0], turns[..., 1]
    own = turned_by(arms, cosines, -sines)
    return turned_by(np.einsum("...kim,...m->...ki", shapes, terms(own)), cosines[..., None], sines[..., None])


def quadratic_loads(arms: np.ndarray, forces: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Compute modal loads of forces (n, 2) [N] at arms (n, 2) from the centroids on shapes (n, 6, 2, 6) [N], (n,
    6)."""
    return np.einsum("nkim,nm,ni->nk", shapes, terms(arms), forces)


def moved_by_modes(modes: np.ndarray, arms: np.ndarray, radii: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Compute the displacement of points by the deformation of their blocks, in the axes of the blocks [m], (n,
    d).

    modes: amplitudes of the block of each point [m], (n, m); arms: from its centroid, undeformed [m], (n, d); radii
    [m], (n,); shapes: of quadratic modes, (n, 6, 2, 6), or none of them.
    """
    found = np.einsum("nij,nj->ni", strains(modes, radii), arms)
    if len(shapes):
        found += np.einsum("nk,nkim,nm->ni", modes[:, -N_QUADRATIC:], shapes, terms(arms))
    return found
