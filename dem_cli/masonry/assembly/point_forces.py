"""Forces at points that represent one table of loads, with their resultant and its line of action."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.errors import CaseError, CaseProblem, KeyPath

LOOKS_UP = 1e-9  # vertical component of the normal of a face from which on it does
POINT = 1e-6  # of the shortest edge: half the width of what a load at a point or along a line acts on


class AppliedLoad(NamedTuple):
    """Applied load: the point forces of one load table of a case."""

    path: KeyPath  # of the table
    dead: bool
    blocks: np.ndarray  # on which they act, (n,)
    points: np.ndarray  # where, undeformed [m], (n, d)
    forces: np.ndarray  # [N], (n, d)
    weights: np.ndarray  # what of them is weight that the load of pattern "mass" shares in [N], (n,)
    area: float = 0.0  # of the surface that a pressure acts on [m²]
    follows: str | None = None  # a "point" of their block that forces go along with, or "block": they turn with it too

    @property
    def resultant(self) -> np.ndarray:
        """Resultant of the load [N], (d,)."""
        return self.forces.sum(axis=0)

    @property
    def centre(self) -> np.ndarray:
        """Centre of the load, the mean of its points weighted by force [m], (d,)."""
        sizes = np.linalg.norm(self.forces, axis=1)
        return self.points.mean(axis=0) if sizes.sum() == 0.0 else product(sizes, self.points) / sizes.sum()


def acts_on_nothing(path: KeyPath, key: str, message: str) -> CaseError:
    """Create the error, at a key of its table, of a load that finds no face to act on."""
    return CaseError([CaseProblem((*path, key), message)])
