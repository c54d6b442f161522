"""Matrices of links: their elongation per degree of freedom, energies and masses; beside those of the joints.

T: from the free degrees of freedom, block by block, translations first, to the elongation of every spring.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.links.link import FORCE, STRETCH, LinkArrays, Springs

if TYPE_CHECKING:
    from scipy.sparse import csr_array


def joined(springs: Iterable[Springs], n_dof: int) -> Springs:
    """All of them, one behind another."""
    nothing = Springs(np.zeros((0, 2), np.int64), np.zeros((0, 2, n_dof)), np.zeros(0))
    return Springs(*(np.concatenate(parts) for parts in zip(nothing, *springs, strict=True)))


def elongations(springs: Springs, fixed: np.ndarray) -> csr_array:
    """T of springs, (n, n_free); fixed: blocks that cannot move, (n_blocks,) bool."""
    from scipy.sparse import coo_array

    n, _, n_dof = springs.motion.shape
    columns = free_columns(springs.blocks, fixed, n_dof)
    rows = np.broadcast_to(np.arange(n)[:, None, None], columns.shape)
    used = (columns >= 0) & (springs.motion != 0.0)
    shape = (n, int((~fixed).sum()) * n_dof)
    return coo_array((springs.motion[used], (rows[used], columns[used])), shape=shape).tocsr()


def free_columns(blocks: np.ndarray, fixed: np.ndarray, n_dof: int) -> np.ndarray:
    """Column of each degree of freedom of both blocks, −1: a support or a fixed point, (n, 2, n_dof)."""
    column = np.full(len(fixed) + 1, -1)  # the last one: of no block
    column[:-1][~fixed] = np.arange(int((~fixed).sum())) * n_dof
    first = column[blocks]
    return np.where(first[:, :, None] < 0, -1, first[:, :, None] + np.arange(n_dof))


def geometric(links: Iterable[LinkArrays], bodies: Any, fixed: np.ndarray, n_dof: int) -> csr_array:
    """Geometric stiffness of the present forces of links, (n_free, n_free)."""
    from scipy.sparse import coo_array

    n_free = int((~fixed).sum()) * n_dof
    total = coo_array((n_free, n_free)).tocsr()
    for link in links:
        local = link.turning(bodies)
        columns = free_columns(link.blocks, fixed, n_dof).reshape(len(local), 2 * n_dof)
        rows, others = np.broadcast_arrays(columns[:, :, None], columns[:, None, :])
        used = (rows >= 0) & (others >= 0)
        total = total + coo_array((local[used], (rows[used], others[used])), shape=(n_free, n_free)).tocsr()
    return total


def gershgorin(springs: Springs, weights: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Σ_c k_c (|b_ci|/w_i) Σ_j |b_cj| w_j of springs, (n_blocks, n_dof); weights: w of all blocks, of that shape."""
    found = np.zeros_like(weights)
    rows = np.abs(springs.motion)  # 0 of fixed points, so that what block these point to is no matter
    reach = (rows * (weights * ~fixed[:, None])[springs.blocks]).sum(axis=(1, 2))
    share = rows * (springs.stiffness * reach)[:, None, None]
    for side in (0, 1):
        blocks = springs.blocks[:, side]
        np.add.at(found, blocks, share[:, side] / weights[blocks])
    return found


def elastic_energy_of_links(links: Iterable[LinkArrays]) -> float:
    """In the springs of links [J]."""
    return 0.5 * float(sum((link.state[:, FORCE] ** 2 / link.stiffness).sum() for link in links))


def follow(link: LinkArrays, motion: np.ndarray, bodies: Any) -> None:
    """Elongations and forces of a link after small displacements of all blocks, (n_blocks, n_dof); none yields."""
    springs = link.axial(bodies)
    longer = (springs.motion * motion[springs.blocks]).sum(axis=(1, 2))
    link.state[:, STRETCH] += longer
    link.state[:, FORCE] = np.clip(link.state[:, FORCE] + springs.stiffness * longer, *link.limits.T)


def softest(links: Iterable[LinkArrays]) -> float:
    """The least stiffness of any link [N/m]; infinite: there is none."""
    return min((float(link.stiffness.min()) for link in links if len(link.stiffness)), default=np.inf)
