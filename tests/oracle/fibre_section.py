"""Fibre section of a mortar joint: plane faces, N given, bent until it carries no more; independent of dem_cli.

Each fibre is a spring kn [Pa/m] that crushes at fc, perfectly plastic, and that cracks at ft: at once, or with the
exponential softening t = ft exp(−ft w / G) of its inelastic opening w. Gaps g = ft/kn − κ (s − c) along the section, so
that one fibre at s = c is at its tensile strength: crack and curvature grow together, which passes snap-back.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

MANY = 1000  # fibres


class Bond(NamedTuple):
    """Strengths [Pa], stiffness [Pa/m], fracture energy [J/m2], 0: brittle."""

    tension: float
    kn: float
    compression: float = np.inf
    energy: float = 0.0


class Section(NamedTuple):
    """Fibres: places from its middle along the section, the tension side first [m], and areas [m2]."""

    places: np.ndarray
    areas: np.ndarray


class Bent(NamedTuple):
    """A section as it is bent, one row for each step."""

    curvature: np.ndarray  # turn of the faces against each other [rad]
    moment: np.ndarray  # about the middle [N m]
    stresses: np.ndarray  # compression positive [Pa], (n, fibres)
    gaps: np.ndarray  # [m], (n, fibres)

    @property
    def strength(self) -> float:
        """The largest moment [N m]."""
        return float(self.moment.max())


def rectangle(width: float, depth: float = 1.0, n: int = MANY) -> Section:
    """Bent about the axis along its depth."""
    return Section(width * (0.5 - (np.arange(n) + 0.5) / n), np.full(n, width * depth / n))


def square_about_its_diagonal(side: float, n: int = MANY) -> Section:
    """Strips along the diagonal."""
    half = side / np.sqrt(2.0)
    places = half * (1.0 - 2.0 * (np.arange(n) + 0.5) / n)
    areas = 2.0 * (half - np.abs(places)) * 2.0 * half / n
    return Section(places, areas * side**2 / areas.sum())


def stress(gaps: np.ndarray, bond: Bond) -> np.ndarray:
    """Of fibres that open further and further [Pa], compression positive; brittle ones that are open hold nothing."""
    peak = bond.tension / bond.kn
    found = np.minimum(-bond.kn * gaps, bond.compression)
    open_ = gaps > peak * (1.0 + 1e-12)
    if bond.energy == 0.0:
        return np.where(open_, 0.0, found)
    return np.where(open_, -np.interp(gaps, *_softened(bond)), found)


@cache
def _softened(bond: Bond) -> tuple[np.ndarray, np.ndarray]:
    """Gaps and the stress that is held at them: g = w + t/kn grows with w where kn is more than ft²/G."""
    w = bond.energy / bond.tension * np.concatenate([np.linspace(0.0, 40.0, 20_001), [1e9]])
    held = bond.tension * np.exp(-bond.tension / bond.energy * w)
    return w + held / bond.kn, held


def bent(section: Section, bond: Bond, normal: float, steps: int = 100) -> Bent:
    """The section under a constant normal force N [N], the front at ft moved from edge to edge.

    normal: compression positive, less than crushes it without any moment [N].
    """
    places, areas = section
    area, half, peak = areas.sum(), 0.5 * (places[0] - places[-1] + places[0] - places[1]), bond.tension / bond.kn
    fronts = half - 2.0 * half * (np.arange(steps)) / steps
    rows = []
    for front in fronts:

        def carried(curvature: float, front: float = front) -> tuple[float, np.ndarray, np.ndarray]:
            gaps = peak + curvature * (places - front)
            stresses = stress(gaps, bond)
            return float((stresses * areas).sum()), stresses, gaps

        # N grows with the curvature as long as what is pressed grows faster than what is pulled: first bracket it.
        tries = np.geomspace(1e-4, 1e5, 46) * (bond.tension + normal / area) / bond.kn / half
        forces = np.array([carried(curvature)[0] for curvature in tries])
        for k in np.flatnonzero((forces[:-1] < normal) & (forces[1:] >= normal)):
            low, high = tries[k], tries[k + 1]
            for _ in range(40):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if carried(middle)[0] < normal else (low, middle)
            _, stresses, gaps = carried(high)
            rows.append((high, float((stresses * areas * -places).sum()), stresses, gaps))
    return Bent(*(np.array(column) for column in zip(*rows, strict=True)))
