"""Certificates of a pushover: forces, a mechanism and two positions with which others check its claims.

Plain arrays, no files. docs/certificates.md says what each of them proves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

NO_CERTIFICATE = "none: "  # begins the words about a claim that has none


class StandingForces(NamedTuple):
    """Contact forces of the highest load held at rest, and where the blocks were."""

    factors: np.ndarray  # of dead and live loads; their ratio is the load multiplier, (2,)
    places: np.ndarray  # centroid [m], then the angle [rad] or the quaternion, (n_blocks, 3 or 7)
    blocks: np.ndarray  # both blocks of each point that presses, (n, 2) int64
    contacts: np.ndarray  # point, normal, tangent (3D), normal force, shear force, friction, (n, 7 or 13)


class BoundMechanism(NamedTuple):
    """Mechanism at the bound of limit analysis in the drawn geometry, with the contact forces at that bound."""

    bounds: np.ndarray  # multiplier in equilibrium with the forces, and that of the mechanism, (2,)
    rates: np.ndarray  # of all blocks, whose live power is one, (n_blocks, n_dof)
    blocks: np.ndarray  # as in StandingForces
    contacts: np.ndarray


class FailingMotion(NamedTuple):
    """Places of the blocks before and during the motion that shows a failure, and the energies at both instants."""

    factors: np.ndarray  # of dead and live loads that act, (2,)
    places: np.ndarray  # at both instants, as in StandingForces, (2, n_blocks, 3 or 7)
    energies: np.ndarray  # work of the loads, friction, elastic, kinetic at both instants [J], (2, 4)


class Certificates(NamedTuple):
    """Claims of a pushover in words, and the arrays that certify them; None: that claim has no certificate.

    words: of each claim, what is certified, or NO_CERTIFICATE and the reason
    """

    words: dict[str, str]
    standing: StandingForces | None = None
    mechanism: BoundMechanism | None = None
    failing: FailingMotion | None = None

    def in_one_line(self) -> str:
        """Name the claims that have a certificate; where none has one, say why the first has none."""
        named = [claim for claim, said in self.words.items() if not said.startswith(NO_CERTIFICATE)]
        return ", ".join(named) or next(iter(self.words.values()))

    def stored(self) -> dict[str, np.ndarray]:
        """Arrays by the name of their dataset: `standing_blocks` is `standing.blocks`."""
        parts = {"standing": self.standing, "mechanism": self.mechanism, "failing": self.failing}
        return {
            f"{part}_{name}": values
            for part, record in parts.items()
            if record is not None
            for name, values in record._asdict().items()
        }
