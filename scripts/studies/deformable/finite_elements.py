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
from scipy.sparse import block_diag, coo_array, csr_array, eye_array
from scipy.sparse.linalg import eigsh, spsolve

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
    density: float = 0.0  # [kg/m³]; displacements do not need it


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
    mesh = _mesh(wall, size)
    weights = np.zeros(2 * mesh.first[-1])
    at = _elements(mesh.cells[loaded], mesh.first[loaded])
    share = np.outer([1, 4, 1], [1, 4, 1]).ravel() / 36.0 / len(at)
    np.add.at(weights, 2 * at + direction, np.tile(share, (len(at), 1)))
    fields = _fields(wall, mesh, degree)
    weights, matrix = fields.T @ weights, fields.T @ stiffness_matrix(wall, mesh, size) @ fields
    return float(weights @ spsolve(matrix.tocsc(), weights))


def frequencies(wall: ElasticWall, size: float, count: int, degree: int | None = None) -> np.ndarray:
    """The lowest natural frequencies [Hz], (count,); size, degree: as for `displacement`."""
    mesh = _mesh(wall, size)
    fields, one = _fields(wall, mesh, degree), np.kron(np.kron(EDGE, EDGE), np.eye(2))
    mass, blocks = _Entries(), range(len(mesh.cells))
    for block in blocks:
        mass.add(_elements(mesh.cells[block], mesh.first[block]), wall.density * wall.thickness * size**2 * one)
    matrices = (fields.T @ matrix @ fields for matrix in (stiffness_matrix(wall, mesh, size), mass.matrix()))
    stiff, heavy = (matrix.tocsc() for matrix in matrices)
    found = eigsh(stiff, k=count, M=heavy, sigma=0.0, v0=np.ones(stiff.shape[0]))[0]
    return np.sqrt(np.sort(found)) / (2.0 * np.pi)


class Mesh(NamedTuple):
    """Elements of all blocks, numbered block by block."""

    cells: np.ndarray  # elements along x and y of each block, (n, 2)
    nodes: np.ndarray  # the same of nodes, (n, 2)
    first: np.ndarray  # first node of each block, and their number, (n + 1,)


def _mesh(wall: ElasticWall, size: float) -> Mesh:
    cells = np.rint((wall.high - wall.low) / size).astype(int)
    nodes = 2 * cells + 1
    return Mesh(cells, nodes, np.concatenate([[0], np.cumsum(nodes.prod(axis=1))]))


class _Entries:
    """Entries of a sparse matrix, element by element."""

    def __init__(self) -> None:
        self.rows, self.columns, self.entries = list[np.ndarray](), list[np.ndarray](), list[np.ndarray]()

    def add(self, at: np.ndarray, matrix: np.ndarray) -> None:
        """The same matrix at the nodes `at` (n, k) of several elements, two displacements each."""
        dofs = (2 * at[:, :, None] + np.arange(2)).reshape(len(at), -1)
        shape = (*dofs.shape, dofs.shape[1])
        self.rows.append(np.broadcast_to(dofs[:, :, None], shape).ravel())
        self.columns.append(np.broadcast_to(dofs[:, None, :], shape).ravel())
        self.entries.append(np.broadcast_to(matrix, shape).ravel())

    def matrix(self) -> csr_array:
        """Their sum."""
        places = np.concatenate(self.rows), np.concatenate(self.columns)
        return coo_array((np.concatenate(self.entries), places)).tocsr()


def stiffness_matrix(wall: ElasticWall, mesh: Mesh, size: float) -> csr_array:
    """Of all elements and interfaces [N/m], two displacements for each node, x first."""
    one, found = element(wall), _Entries()
    for block in range(len(mesh.cells)):
        found.add(_elements(mesh.cells[block], mesh.first[block]), one)
    for a, b, axis in _interfaces(wall, mesh.cells, mesh.first, size):
        stiffness = np.diag([wall.kn, wall.ks] if axis == 0 else [wall.ks, wall.kn]) * wall.thickness * size
        found.add(np.hstack([a, b]), np.kron(np.array([[1.0, -1.0], [-1.0, 1.0]]), np.kron(EDGE, stiffness)))
    return found.matrix()


def _fields(wall: ElasticWall, mesh: Mesh, degree: int | None) -> csr_array:
    """Displacements of all nodes by those that are free, or by the polynomials of each block that is."""
    held = np.concatenate([np.full(2 * n, fixed) for n, fixed in zip(mesh.nodes.prod(axis=1), wall.fixed, strict=True)])
    free = eye_array(len(held), format="csr")[:, np.flatnonzero(~held)]
    return free if degree is None else free @ _polynomials(mesh.nodes[~wall.fixed], degree)


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
