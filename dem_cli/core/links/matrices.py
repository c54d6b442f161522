"""Matrices of links: their elongation per degree of freedom, energies and masses; beside those of the joints.

T: from the free degrees of freedom, block by block, translations first, to the elongation of every spring.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dem_cli.core.links.link import FIXED_POINT, LinkArrays, LinkReading, Springs

if TYPE_CHECKING:
    from scipy.sparse import csr_array


def joined(springs: Iterable[Springs], n_dof: int) -> Springs:
    """Concatenate springs of several kinds of link."""
    found = list(springs)
    many = max((one.blocks.shape[1] for one in found), default=2)
    nothing = Springs(np.zeros((0, many), np.int64), np.zeros((0, many, n_dof)), np.zeros(0))
    return Springs(*(np.concatenate(parts) for parts in zip(nothing, *(_of(one, many) for one in found), strict=True)))


def _of(springs: Springs, many: int) -> Springs:
    """Extend springs to so many blocks each, with fixed points."""
    more = many - springs.blocks.shape[1]
    if not more:
        return springs
    blocks = np.pad(springs.blocks, ((0, 0), (0, more)), constant_values=FIXED_POINT)
    return springs._replace(blocks=blocks, motion=np.pad(springs.motion, ((0, 0), (0, more), (0, 0))))


def elongations(springs: Springs, fixed: np.ndarray) -> csr_array:
    """Build the matrix T of elongations of springs; fixed: blocks that cannot move, (n_blocks,) bool."""
    from scipy.sparse import coo_array

    n, n_dof = len(springs.motion), springs.motion.shape[2]
    columns = free_columns(springs.blocks, fixed, n_dof)
    rows = np.broadcast_to(np.arange(n)[:, None, None], columns.shape)
    used = (columns >= 0) & (springs.motion != 0.0)
    shape = (n, int((~fixed).sum()) * n_dof)
    return coo_array((springs.motion[used], (rows[used], columns[used])), shape=shape).tocsr()


def free_columns(blocks: np.ndarray, fixed: np.ndarray, n_dof: int) -> np.ndarray:
    """Number the column of each degree of freedom of the blocks, −1: a support or a fixed point, (n, 2 or more,
    n_dof).
    """
    column = np.full(len(fixed) + 1, -1)  # the last one: of no block
    column[:-1][~fixed] = np.arange(int((~fixed).sum())) * n_dof
    first = column[blocks]
    return np.where(first[:, :, None] < 0, -1, first[:, :, None] + np.arange(n_dof))


def geometric(links: Iterable[LinkArrays], bodies: Any, fixed: np.ndarray, n_dof: int) -> csr_array:
    """Build the geometric stiffness matrix of the present forces of links, (n_free, n_free)."""
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
    """Gershgorin sums Σ_c k_c (|b_ci|/w_i) Σ_j |b_cj| w_j of springs, (n_blocks, n_dof), as are the weights w."""
    found = np.zeros_like(weights)
    rows = np.abs(springs.motion)  # 0 of fixed points, so that what block these point to is no matter
    reach = (rows * (weights * ~fixed[:, None])[springs.blocks]).sum(axis=(1, 2))
    share = rows * (springs.stiffness * reach)[:, None, None]
    for side in range(springs.blocks.shape[1]):
        blocks = springs.blocks[:, side]
        np.add.at(found, blocks, share[:, side] / weights[blocks])
    return found


def elastic_energy_of_links(links: Iterable[LinkArrays]) -> float:
    """Compute the elastic energy in the springs of all links [J]."""
    return float(sum(link.energy() for link in links))


def softest(links: Iterable[LinkArrays]) -> float:
    """Compute the least stiffness of any link [N/m]; infinite where there are no links."""
    return min((link.softest() for link in links), default=np.inf)


def stiffest(links: Iterable[LinkArrays]) -> float:
    """Compute the largest stiffness along any link [N/m]; 0 where there are no links."""
    return max((float(link.axial().stiffness.max(initial=0.0)) for link in links), default=0.0)


def reading_of(links: Iterable[LinkArrays], number: int, quantity: str, at: float) -> LinkReading:
    """Reading of one link by a monitor, by its number among all, in the rows of all states one behind another."""
    rows = 0
    for link in links:
        if number < link.n_drawn:
            found = link.reading(number, quantity, at)
            return found._replace(rows=tuple(rows + row for row in found.rows))
        number, rows = number - link.n_drawn, rows + len(link.state)
    raise IndexError(number)


def each(links: Iterable[LinkArrays], names: Sequence[str]) -> Iterator[tuple[LinkArrays, int, str]]:
    """Iterate over all links of a model: arrays of its kind, number in these, name (Model.link_names)."""
    numbered = [(link, number) for link in links for number in range(link.n_drawn)]
    yield from ((link, number, name) for (link, number), name in zip(numbered, names, strict=True))
