"""Least and largest thrust of a vault on its supports: a linear program of forces in equilibrium at given points.

Each point presses within a pyramid of eight edges in the friction cone: what it finds is possible, and at most 8 %
of the friction short of the cone. Points, normals and tangents are those of the joints; nothing else of `dem` is used.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix

EDGES = 8


def thrust_range(
    contacts: Any, centroids: np.ndarray, weights: np.ndarray, fixed: np.ndarray, friction: float
) -> tuple[float, float]:
    """Mean outward thrust along x on the supports over the weight of all free blocks: least and largest."""
    first, second = contacts.tangents, np.cross(contacts.normals, contacts.tangents)
    angles = 2.0 * np.pi * np.arange(EDGES) / EDGES
    edges = np.stack(
        [contacts.normals + friction * (np.cos(a) * first + np.sin(a) * second) for a in angles], axis=1
    )  # of a unit normal force, on the second block: (points, edges, 3)
    n_points, numbers = len(edges), np.cumsum(~fixed) - 1
    entries, push = [], np.zeros((n_points, EDGES))
    for side, sign in ((0, -1.0), (1, 1.0)):
        block = contacts.blocks[:, side]
        arms = np.cross((contacts.points - centroids[block])[:, None, :], edges)
        wrench = sign * np.concatenate([edges, arms], axis=2)
        rows = 6 * numbers[block][:, None, None] + np.arange(6)[None, None, :]
        columns = np.broadcast_to(np.arange(n_points * EDGES).reshape(n_points, EDGES, 1), wrench.shape)
        free = ~fixed[block]
        entries.append([wrench[free].ravel(), np.broadcast_to(rows, wrench.shape)[free].ravel(), columns[free].ravel()])
        push += np.where(fixed[block][:, None], sign * edges[:, :, 0] * np.sign(centroids[block][:, :1].round(9)), 0.0)
    data, rows, columns = (np.concatenate(parts) for parts in zip(*entries, strict=True))
    balance = coo_matrix((data, (rows, columns)), shape=(6 * int((~fixed).sum()), n_points * EDGES)).tocsr()
    total = float(weights[~fixed].sum())
    loads = np.zeros(balance.shape[0])
    loads[2::6] = weights[~fixed] / total
    found = [linprog(sign * push.ravel(), A_eq=balance, b_eq=loads, method="highs") for sign in (1.0, -1.0)]
    count = int(fixed.sum())
    return found[0].fun / count, -found[1].fun / count
