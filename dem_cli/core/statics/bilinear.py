"""Bilinear idealisation of a capacity curve: an elastic, perfectly plastic system that takes as much energy.

Elastic through the point of a share of the peak on the rising branch, ultimate displacement where the curve has fallen
to a share of the peak, yield load by equal areas up to there:

    V_y = k (u_u − √(u_u² − 2 A/k))

Source: Tomaževič 1999, Earthquake-Resistant Design of Masonry Buildings, 7.3 (k through 0.7 to 0.75 of the peak, end at
0.8 of it); EN 1998-3:2005, C.3.1 (0.8); NTC 2018, circular 7/2019, C7.3.4.2 (k through 0.6, end at 0.85).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Bilinear(NamedTuple):
    """Elastic, perfectly plastic system; loads in the unit of the curve."""

    stiffness: float  # load per displacement [1/m]
    yield_load: float
    yield_displacement: float  # [m]
    ultimate_displacement: float  # [m]
    ductility: float  # ultimate over yield displacement
    softened: bool  # False: the curve ends before it has fallen to the share of its peak; its end counts as ultimate


def bilinear(displacements: np.ndarray, loads: np.ndarray, secant: float = 0.7, drop: float = 0.8) -> Bilinear | None:
    """Fit the bilinear system to a capacity curve that starts at rest, (n,) each, displacements growing [m].

    None where the curve carries nothing, or a load without end.

    secant: share of the peak load through which the elastic branch goes; drop: share at which the curve ends.
    """
    peak = int(np.argmax(loads))
    highest = float(loads[peak])
    if not 0.0 < highest < np.inf or peak == 0:
        return None
    stiffness = secant * highest / _first(displacements, loads, secant * highest, 0, rises=True)
    softened = bool((loads[peak:] <= drop * highest).any())
    ultimate = _first(displacements, loads, drop * highest, peak, rises=False) if softened else float(displacements[-1])
    area = _area(displacements, loads, ultimate)
    root = ultimate**2 - 2.0 * area / stiffness
    # A curve above its own secant takes more than the triangle: the system stays elastic up to the end.
    yields = stiffness * (ultimate - np.sqrt(root)) if root > 0.0 else stiffness * ultimate
    at_yield = float(yields) / stiffness
    return Bilinear(stiffness, float(yields), at_yield, ultimate, ultimate / at_yield, softened)


def _first(x: np.ndarray, y: np.ndarray, level: float, since: int, rises: bool) -> float:
    """Find where a curve first crosses a level after one of its points, by linear interpolation."""
    beyond = y[since:] >= level if rises else y[since:] <= level
    k = since + int(np.argmax(beyond))
    if k == since or y[k] == y[k - 1]:
        return float(x[k])
    return float(x[k - 1] + (level - y[k - 1]) / (y[k] - y[k - 1]) * (x[k] - x[k - 1]))


def _area(x: np.ndarray, y: np.ndarray, end: float) -> float:
    """Compute the area under a curve up to a place."""
    inside = x < end
    places = np.append(x[inside], end)
    values = np.append(y[inside], np.interp(end, x, y))
    return float(np.trapezoid(values, places))


def load_at(displacements: np.ndarray, loads: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Interpolate the loads of a curve at displacements [m], (n,); not a number beyond its end.

    Of a curve that turns back, when it first gets there.
    """
    return np.interp(places, np.maximum.accumulate(displacements), loads, right=np.nan)
