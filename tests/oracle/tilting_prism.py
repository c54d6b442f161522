"""A rigid prism that stands on one edge of its foot, tilted, and is let go: exact until it lands.

The foot is a convex polygon, the prism is upright. About an edge that does not slide it has one degree of freedom,
whatever the angle of the edge to its principal axes:

    I θ'' = −m g R sin(α − θ),   I = d·(I_c d) + m R²

θ: tilt [rad]; R: distance from the edge to the centroid; tan α = distance in plan over half the height; d: along the
edge. Area integrals of the foot by Green's theorem, motion by `solve_ivp`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


class Landing(NamedTuple):
    """When a tilted prism is upright again."""

    time: float  # [s]
    speed: float  # dθ/dt then, negative [rad/s]


class TiltingPrism(NamedTuple):
    """A prism on the edge from foot[0] to foot[1]; per unit of mass."""

    foot: np.ndarray  # corners counter-clockwise seen from above [m], (n, 2)
    height: float  # [m]
    gravity: float = 9.81  # [m/s2]

    @property
    def edge(self) -> np.ndarray:
        """Direction of the edge, unit: a positive turn about it lifts the rest of the foot."""
        along = self.foot[1] - self.foot[0]
        return along / np.hypot(*along)

    @property
    def centroid(self) -> np.ndarray:
        """Of the foot [m]."""
        return _moments(self.foot)[1]

    @property
    def reach(self) -> float:
        """From the edge to the centroid, in plan [m]."""
        x, y = self.centroid - self.foot[0]
        return float(self.edge[0] * y - self.edge[1] * x)

    @property
    def radius(self) -> float:
        return float(np.hypot(self.reach, 0.5 * self.height))

    @property
    def alpha(self) -> float:
        """Tilt at which it stands over its edge [rad]."""
        return float(np.arctan2(self.reach, 0.5 * self.height))

    @property
    def inertia(self) -> float:
        """About the edge, of a unit of mass [m2]."""
        _, _, second = _moments(self.foot)
        across = np.array([-self.edge[1], self.edge[0]])
        return float(across @ second @ across + self.height**2 / 12.0 + self.radius**2)

    def lands(self, angle: float) -> Landing:
        """From rest at a tilt [rad], less than alpha."""
        pull = self.gravity * self.radius / self.inertia

        def rates(_, state):
            return [state[1], -pull * np.sin(self.alpha - state[0])]

        def upright(_, state):
            return state[0]

        upright.terminal = True
        found = solve_ivp(rates, (0.0, 1e3), [angle, 0.0], events=upright, rtol=1e-12, atol=1e-14)
        return Landing(float(found.t_events[0][0]), float(found.y_events[0][0][1]))


def _moments(foot: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Area, centroid, and second moments about the centroid over the area of a polygon."""
    after = np.roll(foot, -1, axis=0)
    doubled = foot[:, 0] * after[:, 1] - foot[:, 1] * after[:, 0]
    area = 0.5 * doubled.sum()
    middle = (doubled[:, None] * (foot + after)).sum(axis=0) / (6.0 * area)
    pairs = np.einsum("n,ni,nj->ij", doubled, foot, foot) + np.einsum("n,ni,nj->ij", doubled, after, after)
    pairs += np.einsum("n,ni,nj->ij", doubled, foot + after, foot + after)
    return float(area), middle, pairs / (24.0 * area) - np.outer(middle, middle)
