"""Connected groups: the components of a graph, without SciPy's package of graphs, which loads half of SciPy."""

from __future__ import annotations

import numpy as np


def connected_groups(pairs: np.ndarray, n: int) -> np.ndarray:
    """Number the groups of things that pairs connect, in the order of the first of each, (n,).

    pairs: of numbers below n, (n_pairs, 2). Labels fall to the lowest of both ends until none changes.
    """
    labels = np.arange(n)
    if not len(pairs):
        return labels
    first, second = np.asarray(pairs, np.int64).T
    while (labels[first] != labels[second]).any():
        lowest = np.minimum(labels[first], labels[second])
        np.minimum.at(labels, labels[first], lowest)
        np.minimum.at(labels, labels[second], lowest)
        while (labels[labels] != labels).any():
            labels = labels[labels]
    return np.unique(labels, return_inverse=True)[1]
