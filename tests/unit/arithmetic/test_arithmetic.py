"""Products, small matrices, functions and sparse systems are those of NumPy, LAPACK and SuperLU to round-off."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.sparse import block_diag, csc_array, diags_array, eye_array, kron, random_array
from scipy.sparse.csgraph import connected_components, reverse_cuthill_mckee

from dem_cli.core.arithmetic import functions
from dem_cli.core.arithmetic.connected_groups import connected_groups
from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.arithmetic.small_matrices import (
    determinants,
    diagonalised,
    inverse,
    least_squares,
    root,
    singular,
    solved,
    solved_tridiagonal,
)  # fmt: skip
from dem_cli.core.arithmetic.sparse_systems import narrow_order, solved_symmetric

RNG = np.random.default_rng(7)
SHAPES = [((4,), (4,)), ((3, 4), (4,)), ((4,), (4, 2)), ((3, 4), (4, 2)), ((5, 3, 3), (5, 3, 1)), ((4,), (5, 4, 2))]


@pytest.mark.parametrize(("left", "right"), SHAPES)
def test_products(left, right):
    a, b = RNG.normal(size=left), RNG.normal(size=right)
    assert np.allclose(product(a, b), a @ b, rtol=1e-14, atol=1e-14)
    assert product(a, b).shape == (a @ b).shape
    assert norm(a) == pytest.approx(np.linalg.norm(a.ravel()), rel=1e-15)


@pytest.mark.parametrize("n", [1, 2, 3, 6, 9])
def test_small_matrices(n):
    given, right = RNG.normal(size=(20, n, n)), RNG.normal(size=(20, n, 2))
    assert np.allclose(solved(given, right), np.linalg.solve(given, right), rtol=1e-9)
    assert np.allclose(product(given, inverse(given)), np.eye(n), atol=1e-9)
    definite = product(given, given.swapaxes(1, 2)) + 0.1 * np.eye(n)
    values, vectors = diagonalised(definite)
    assert np.allclose(values, np.linalg.eigvalsh(definite), rtol=1e-11)
    assert np.allclose(product(definite, vectors), vectors * values[:, None], atol=1e-12)
    assert np.allclose(product(vectors.swapaxes(1, 2), vectors), np.eye(n), atol=1e-14)
    assert np.allclose(root(definite[0]), np.linalg.cholesky(definite[0]), rtol=1e-12)


def test_matrices_that_are_diagonal_or_of_no_size_stay_what_they_are():
    values, vectors = diagonalised(np.diag([1.0, 2.0, 2.0]))
    assert values.tolist() == [1.0, 2.0, 2.0]
    assert np.array_equal(vectors, np.eye(3))
    assert diagonalised(np.zeros((0, 0)))[0].shape == (0,)
    assert diagonalised(np.zeros((0, 3, 3)))[1].shape == (0, 3, 3)
    assert diagonalised(np.array([[0.0, 1.0], [1.0, 0.0]]))[0] == pytest.approx([-1.0, 1.0])


def test_a_singular_matrix_is_said_to_be_one():
    with pytest.raises(np.linalg.LinAlgError):
        inverse(np.zeros((2, 2)))


@pytest.mark.parametrize("n", [2, 3])
def test_determinants(n):
    given = RNG.normal(size=(10, n, n))
    assert np.allclose(determinants(given), np.linalg.det(given), rtol=1e-12)


def test_singular_values_and_least_squares():
    given, right = RNG.normal(size=(9, 3)) * (1.0, 1e-3, 1e4), RNG.normal(size=9)
    left, sizes, axes = singular(given)
    assert np.allclose(sizes, np.linalg.svd(given, compute_uv=False), rtol=1e-12)
    assert np.allclose(product(left * sizes, axes.T), given, rtol=1e-12)
    assert np.allclose(least_squares(given, right), np.linalg.lstsq(given, right, rcond=None)[0], rtol=1e-9)
    flat = np.column_stack([given[:, :2], given[:, 0] + given[:, 1]])  # of rank two
    assert np.allclose(least_squares(flat, right, 1e-9), np.linalg.pinv(flat, rcond=1e-9) @ right, rtol=1e-6)


@pytest.mark.parametrize("n", [1, 2, 8])
def test_three_diagonals(n):
    diagonal, beside, right = RNG.uniform(3.0, 4.0, n), -RNG.uniform(0.0, 1.0, n - 1), RNG.normal(size=(n, 2))
    matrix = np.diag(diagonal) + np.diag(beside, 1) + np.diag(beside, -1)
    assert np.allclose(matrix @ solved_tridiagonal(diagonal, beside, right), right, atol=1e-14)


@pytest.mark.parametrize("n", [1, 3, 12])
def test_sparse_systems(n):
    line = diags_array([-1.0, 2.01, -1.0], offsets=[-1, 0, 1], shape=(n, n))
    matrix = csc_array(kron(line, eye_array(n)) + kron(eye_array(n), line))
    right = RNG.normal(size=n * n)
    found = solved_symmetric(matrix, right)
    assert np.allclose(found, np.linalg.solve(matrix.toarray(), right), rtol=1e-10)
    assert right.any()  # and is left as it was


@pytest.mark.parametrize("n", [1, 2, 17, 60])
@pytest.mark.parametrize("density", [0.0, 0.03, 0.3])
def test_the_order_of_elimination_is_as_narrow_as_that_of_scipy(n, density):
    """Also where parts do not hang together, and where diagonals are empty. Ties are broken otherwise: here by number,
    in SciPy by a sort that is not the same on every processor."""
    entries = random_array((n, n), density=density, rng=np.random.default_rng(n))
    for matrix in (entries + entries.T, entries + entries.T + eye_array(n), block_diag([entries + entries.T] * 3)):
        order, of_scipy = narrow_order(csc_array(matrix)), reverse_cuthill_mckee(matrix.tocsr(), symmetric_mode=True)
        assert sorted(order) == list(range(matrix.shape[0]))
        assert profile(matrix, order) <= 1.1 * profile(matrix, of_scipy)


def profile(matrix, order) -> int:
    """Numbers between the first entry of each row and its diagonal, in this order: those that elimination fills."""
    rows, columns = np.nonzero(matrix.toarray()[np.ix_(order, order)])
    first = np.arange(len(order))
    np.minimum.at(first, rows, columns)
    return int((np.arange(len(order)) - first).sum())


def test_a_sparse_system_is_solved_without_the_heavy_parts_of_scipy():
    """The order alone loaded scipy.sparse.csgraph, with it scipy.linalg: a twelfth of a history of half a second."""
    program = (
        "import sys, numpy as np; from scipy.sparse import csc_array;"
        "from dem_cli.core.arithmetic.sparse_systems import solved_symmetric;"
        "print(solved_symmetric(csc_array(np.diag([2.0, 4.0])), np.ones(2)).tolist());"
        "print([name for name in ('scipy.sparse.csgraph', 'scipy.linalg') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["[0.5, 0.25]", "[]"]


@pytest.mark.parametrize(("n", "many"), [(1, 0), (5, 0), (40, 20), (40, 200), (300, 250)])
def test_connected_groups_are_those_of_scipy(n, many):
    pairs = np.random.default_rng(n + many).integers(0, n, (many, 2))
    graph = csc_array((np.ones(many), pairs.T), (n, n))
    assert connected_groups(pairs, n).tolist() == connected_components(graph, directed=False)[1].tolist()


def test_a_sparse_matrix_without_a_pivot():
    with pytest.raises(np.linalg.LinAlgError):
        solved_symmetric(csc_array(np.diag([1.0, 0.0])), np.ones(2))


def test_functions():
    x = RNG.uniform(0.1, 0.9, (3, 4))
    for name in ("arccos", "arcsin", "arctan", "tan", "exp", "expm1", "log", "log1p", "log10"):
        assert np.allclose(getattr(functions, name)(x), getattr(np, name)(x), rtol=1e-15), name
    assert np.allclose(functions.arctan2(x, -x[0]), np.arctan2(x, -x[0]), rtol=1e-15)
    assert np.allclose(functions.power(x, 0.3), x**0.3, rtol=1e-15)
    assert functions.log([0.0, -1.0, np.inf]).tolist()[::2] == [-np.inf, np.inf]
    assert functions.exp([1000.0, -np.inf]).tolist() == [np.inf, 0.0]
    assert np.isnan([functions.exp(np.nan), functions.log(-1.0)]).all()
    assert np.allclose(functions.geometric(0.02, 4.0, 7), np.geomspace(0.02, 4.0, 7), rtol=1e-14)
    assert functions.geometric(0.02, 4.0, 7)[[0, -1]].tolist() == [0.02, 4.0]


def test_agreed_digits():
    assert functions.agreed(123.45678904) == functions.agreed(123.45678904 * (1.0 + 1e-14)) == 123.456789
    assert functions.agreed([[1.0 / 3.0, 0.0, -np.inf]]).tolist() == [[0.333333333, 0.0, -np.inf]]
    beside = functions.agreed_beside(np.array([2.0, 1.0 / 3.0, -1e-17]), 2.0)
    assert beside.tolist() == pytest.approx([2.0, 0.333333334, 0.0], abs=1e-15)
    assert not np.signbit(beside).any()
