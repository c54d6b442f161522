"""Finite elements of a wall of rectangular blocks: nine-node quadrilaterals, elastic interfaces between them.

An independent model, beside which blocks that are rigid or deform in few modes are judged: linear elastic, plane
stress, all joints closed. Interfaces are integrated exactly (consistent mass matrix of a quadratic edge). Plain numpy
and scipy.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse import block_diag, coo_array, csr_array
from scipy.sparse.linalg import spsolve

GAUSS = (np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.6), np.array([5.0, 8.0, 5.0]) / 9.0)
EDGE = np.array([[4.0, 2.0, -1.0], [2.0, 16.0, 2.0], [-1.0, 2.0, 4.0]]) / 30.0  # ∫ N Nᵀ along an edge of length one


class ElasticWall(NamedTuple):
    """Rectangular blocks in the plane, and what they are made of."""

    low: np.ndarray  # lower left corners [m], (n, 2)
    high: np.ndarray  # upper right corners [m], (n, 2)
    fixed: np.ndarray  # (n,) bool
    young: float  # [Pa]
    poisson: float
    thickness: float  # [m]
    kn: float  # of the joints [Pa/m]
    ks: float


def quadratic(x: float) -> tuple[np.ndarray, np.ndarray]:
    """Shapes of an edge of three nodes at −1, 0, 1, and their slopes."""
    return np.array([x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2]), np.array([x - 0.5, -2 * x, x + 0.5])


def element(wall: ElasticWall) -> np.ndarray:
    """Stiffness of a square element of any size [N/m], (18, 18): node by node, x fastest, two displacements each."""
    e, nu = wall.young, wall.poisson
    elastic = e / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    total = np.zeros((18, 18))
    for x, wx in zip(*GAUSS, strict=True):
        for y, wy in zip(*GAUSS, strict=True):
            (nx, dx), (ny, dy) = quadratic(x), quadratic(y)
            along_x, along_y = np.outer(ny, dx).ravel(), np.outer(dy, nx).ravel()
            strain = np.zeros((3, 18))
            strain[0, ::2], strain[1, 1::2] = along_x, along_y
            strain[2, ::2], strain[2, 1::2] = along_y, along_x
            total += wx * wy * strain.T @ elastic @ strain
    return wall.thickness * total


def displacement(wall: ElasticWall, loaded: int, size: float, direction: int = 0, degree: int | None = None) -> float:
    """Mean displacement of a block per newton of a force that acts evenly in it [m/N].

    size: of the elements [m], which all sides of blocks are multiples of. degree: displacements are polynomials of this
    degree (0: rigid motions) in each block, at most 2; None: as the elements can.
    """
    cells = np.rint((wall.high - wall.low) / size).astype(int)
    nodes = 2 * cells + 1
    first = np.concatenate([[0], np.cumsum(nodes.prod(axis=1))])
    rows, columns, entries = [], [], []

    def add(at: np.ndarray, matrix: np.ndarray) -> None:
        dofs = (2 * at[:, :, None] + np.arange(2)).reshape(len(at), -1)
        shape = (*dofs.shape, dofs.shape[1])
        rows.append(np.broadcast_to(dofs[:, :, None], shape).ravel())
        columns.append(np.broadcast_to(dofs[:, None, :], shape).ravel())
        entries.append(np.broadcast_to(matrix, shape).ravel())

    one, weights = element(wall), np.zeros(2 * first[-1])
    for block in range(len(cells)):
        at = _elements(cells[block], first[block])
        add(at, one)
        if block == loaded:
            share = np.outer([1, 4, 1], [1, 4, 1]).ravel() / 36.0 / len(at)
            np.add.at(weights, 2 * at + direction, np.tile(share, (len(at), 1)))
    for a, b, axis in _interfaces(wall, cells, first, size):
        stiffness = np.diag([wall.kn, wall.ks] if axis == 0 else [wall.ks, wall.kn]) * wall.thickness * size
        add(np.hstack([a, b]), np.kron(np.array([[1.0, -1.0], [-1.0, 1.0]]), np.kron(EDGE, stiffness)))
    matrix = coo_array((np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
    held = np.concatenate([np.full(2 * n, fixed) for n, fixed in zip(nodes.prod(axis=1), wall.fixed, strict=True)])
    free = np.flatnonzero(~held)
    matrix, weights = matrix[free][:, free], weights[free]
    if degree is not None:
        fields = _polynomials(nodes[~wall.fixed], degree)
        matrix, weights = fields.T @ matrix @ fields, fields.T @ weights
    return float(weights @ spsolve(matrix.tocsc(), weights))


def _polynomials(nodes: np.ndarray, degree: int) -> csr_array:
    """Displacements of all nodes by the polynomials of each block; nodes: along x and y, (n, 2)."""
    blocks = []
    for along_x, along_y in nodes:
        y, x = (v.ravel() for v in np.mgrid[-1.0 : 1.0 : along_y * 1j, -1.0 : 1.0 : along_x * 1j])
        x, one = x * (along_x - 1) / (along_y - 1), np.ones(len(x))
        alone = [one, x, y, x * x, x * y, y * y][: (1, 3, 6)[degree]]
        fields = [np.kron(field, direction) for field in alone for direction in np.eye(2)]
        turn = [np.column_stack([-y, x]).ravel()] if degree == 0 else []
        blocks.append(np.column_stack(fields + turn))
    return block_diag(blocks, format="csr")


def _elements(cells: np.ndarray, first: int) -> np.ndarray:
    """Nodes of the elements of a block, (n_elements, 9)."""
    i, j = np.meshgrid(np.arange(cells[0]), np.arange(cells[1]))
    corner = first + 2 * i.ravel() + 2 * j.ravel() * (2 * cells[0] + 1)
    return corner[:, None] + (np.arange(3) + (2 * cells[0] + 1) * np.arange(3)[:, None]).ravel()


def _interfaces(
    wall: ElasticWall, cells: np.ndarray, first: np.ndarray, size: float
) -> Iterator[tuple[np.ndarray, np.ndarray, int]]:
    """Of each two blocks that share a part of their sides: nodes of both, edge by edge (n, 3), and the axis across."""
    for a, b in itertools.permutations(range(len(cells)), 2):
        for axis in (0, 1):
            along = 1 - axis
            low, high = max(wall.low[a, along], wall.low[b, along]), min(wall.high[a, along], wall.high[b, along])
            if abs(wall.high[a, axis] - wall.low[b, axis]) < 1e-3 * size and high - low > 0.5 * size:
                edges = np.arange(round((high - low) / size))
                on_a = _side(wall, cells, first, size, a, axis, True, low)
                on_b = _side(wall, cells, first, size, b, axis, False, low)
                yield on_a + edges[:, None] * (on_a[2] - on_a[0]), on_b + edges[:, None] * (on_b[2] - on_b[0]), axis


def _side(
    wall: ElasticWall, cells: np.ndarray, first: np.ndarray, size: float, block: int, axis: int, far: bool, low: float
) -> np.ndarray:
    """Nodes of the first edge of an element on a side of a block, counted from `low` [m], (3,)."""
    width = 2 * cells[block, 0] + 1
    begin = 2 * round((low - wall.low[block, 1 - axis]) / size)
    across = 2 * cells[block, axis] if far else 0
    column, row = (across, begin) if axis == 0 else (begin, across)
    return first[block] + column + row * width + (width if axis == 0 else 1) * np.arange(3)
