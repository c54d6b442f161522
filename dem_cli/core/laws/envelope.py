"""Strength envelope of contact points: the largest forces of a joint law, as limit analysis needs them.

    −ft A ≤ N ≤ fc A,   |T| ≤ c A + μ N,   opening of tan ψ times the slip

Straight lines, so that they go into a linear program as they are. A law whose strength falls has two envelopes: what a
point carries at most, and what is left of that when it has slid and opened for long.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Envelope(NamedTuple):
    """Largest forces of contact points, each (n_points,)."""

    friction: np.ndarray  # μ [-]
    cohesion: np.ndarray  # c A [N]; infinite: no limit to the shear force
    tension: np.ndarray  # ft A [N], at most c A / μ; infinite: cannot be pulled apart
    compression: np.ndarray  # fc A [N]; infinite: cannot be crushed
    dilation: np.ndarray  # tan ψ: opening per slip, at most μ [-]


def frictional(friction: np.ndarray) -> Envelope:
    """Make the envelope of dry friction: N ≥ 0, |T| ≤ μ N; (n_points,)."""
    n_points = len(friction)
    return Envelope(
        np.array(friction, float), np.zeros(n_points), np.zeros(n_points), np.full(n_points, np.inf), np.zeros(n_points)
    )


def envelope(n_points: int, **values: np.ndarray | float) -> Envelope:
    """Make an envelope from these columns; those not named are of a dry joint without friction."""
    dry = frictional(np.zeros(n_points))._asdict()
    return Envelope(**dry | {name: np.broadcast_to(value, n_points).astype(float) for name, value in values.items()})
