"""Dense fronts solve the equations, of any pattern of blocks, fixed and held ones too."""

import numpy as np
import pytest

from dem_cli.core.limit.newton_matrix import NewtonMatrix, PointRows
from dem_cli.core.limit.settings import PathSettings

SETTINGS = PathSettings()
TANGENTS = {2: ((1, 1), (1, 0)), 3: ((1, 1), (2, 2), (1, 2), (1, 0), (2, 0))}


def points(dimension, n_blocks, n_points, seed, of_joint=1):
    """Points between random blocks, of which the last are fixed; two motions of the first block are held.

    of_joint: points in turn between the same two blocks
    """
    rng, n_dof = np.random.default_rng(seed), {2: 3, 3: 6}[dimension]
    blocks = np.repeat(rng.integers(0, n_blocks + 2, (n_points // of_joint, 2)), of_joint, axis=0)
    blocks[:, 1] = np.where(blocks[:, 0] == blocks[:, 1], (blocks[:, 1] + 1) % (n_blocks + 2), blocks[:, 1])
    columns = np.where(blocks < n_blocks, blocks * n_dof, -1)[:, :, None]
    columns = np.where(columns >= 0, columns + np.arange(n_dof), -1)
    columns[columns < 2] = -1
    rows = rng.normal(size=(n_points, dimension, 2, n_dof)) * (columns >= 0)[:, None]
    return PointRows(rows, columns, ((0, 0), *TANGENTS[dimension]), n_blocks * n_dof)


def factors(made, seed):
    """Of the products, those of a normal or a tangent by itself positive and far apart."""
    rng = np.random.default_rng(seed)
    found = [10.0 ** rng.uniform(-6.0, 0.0, len(made.rows)) for _ in made.products]
    return [one if i == j else 0.1 * one for one, (i, j) in zip(found, made.products, strict=True)]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(
    ("n_blocks", "n_points", "of_joint"), [(1, 4, 1), (12, 60, 1), (40, 160, 1), (90, 700, 1), (12, 120, 4)]
)
@pytest.mark.parametrize("viscous", [False, True])
def test_fronts_solve_the_equations(dimension, n_blocks, n_points, of_joint, viscous):
    """A viscosity of its own for each degree of freedom stands where this one does, whatever the order."""
    made = points(dimension, n_blocks, n_points, n_blocks, of_joint)
    right = np.random.default_rng(1).normal(size=made.n_columns)
    right[:2] = 0.0  # held
    stiff, elastic = factors(made, 2), factors(made, 3)
    dense = np.zeros((made.n_columns + 1, made.n_columns + 1))
    for (i, j), given in zip(made.products, stiff, strict=True):
        for a, b in ((i, j), (j, i)) if 0 < i < j else ((i, j),):
            for p, factor in enumerate(given):
                to = made.columns[p].ravel()
                dense[np.ix_(to, to)] += factor * np.outer(made.rows[p, a].ravel(), made.rows[p, b].ravel())
    viscosity = 10.0 ** np.random.default_rng(4).uniform(-3.0, 1.0, made.n_columns)
    if viscous:
        dense[:-1, :-1] += np.diag(viscosity)
    matrix = NewtonMatrix(made, SETTINGS)
    matrix.factorised(elastic)
    found = np.zeros(made.n_columns + 1)
    factored = matrix.factorised(stiff, viscosity[matrix.order] if viscous else None)
    found[matrix.order] = factored.solve(right[matrix.order])
    touched = np.append(np.abs(dense[:-1, :-1]).sum(axis=1) > 0.0, False)
    off = (dense @ found)[touched] - np.append(right, 0.0)[touched]
    assert np.abs(off).max() < 1e-6 * np.abs(right).max()
    assert (found[:2] == 0.0).all()


def test_points_are_summed_first_where_joints_in_space_have_several():
    assert NewtonMatrix(points(3, 12, 120, 0, 4), SETTINGS).by_joints
    assert not NewtonMatrix(points(3, 12, 120, 0), SETTINGS).by_joints
    assert not NewtonMatrix(points(2, 12, 120, 0, 4), SETTINGS).by_joints


def test_a_matrix_without_anything_is_singular():
    made = points(2, 12, 20, 0)
    with pytest.raises(RuntimeError, match="singular"):
        NewtonMatrix(made, SETTINGS).factorised([0.0 * one for one in factors(made, 0)])


def test_a_structure_without_contact_points():
    made = points(2, 3, 0, 0)
    matrix = NewtonMatrix(made, SETTINGS)
    assert sorted(matrix.order) == list(range(9))
    with pytest.raises(RuntimeError, match="singular"):
        matrix.factorised(factors(made, 0))
