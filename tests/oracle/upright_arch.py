"""Least thickness of a half ring cut by infinitely many vertical joints, in closed form but for two roots.

Forces pass through vertical cuts with a constant horizontal thrust H, so that the height of the thrust line is

    y(x) = y(0) - F(x) / H,   F'' = upper face - lower face

At the least thickness it touches the outer face at the crown, y(0) = R + t/2, the inner face somewhere between, and
ends at the toe of the support, y(R + t/2) = 0: five hinges. No sliding, no tension, no crushing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar


class UprightArch(NamedTuple):
    """The least thickness, and where the inner hinges are, over the mean radius."""

    thickness: float
    hinge: float  # distance of the inner hinges from the middle of the span
    angle_deg: float  # of them from the crown, seen from the centre


def double_integral(radius: float, x: float) -> float:
    """F(x) of a half disc: ∫₀ˣ ∫₀ˢ √(r² - u²) du ds."""
    root = np.sqrt(max(radius**2 - x**2, 0.0))
    return 0.5 * ((radius**3 - root**3) / 3.0 + radius**2 * (x * np.arcsin(x / radius) + root - radius))


def weight(thickness: float, x: float) -> float:
    """F(x) of the half ring, which over its supports has no lower face but the ground."""
    inner, outer = 1.0 - thickness / 2.0, 1.0 + thickness / 2.0
    under = double_integral(inner, min(x, inner)) + max(x - inner, 0.0) * np.pi * inner**2 / 4.0
    return double_integral(outer, x) - under


def thrust_line(thickness: float, x: float) -> float:
    """Height of the thrust line through the crown and the toe."""
    outer = 1.0 + thickness / 2.0
    return outer - outer * weight(thickness, x) / weight(thickness, outer)


def clearance(thickness: float) -> tuple[float, float]:
    """Least height of the thrust line above the inner face, and where."""
    inner = 1.0 - thickness / 2.0
    found = minimize_scalar(
        lambda x: thrust_line(thickness, x) - np.sqrt(inner**2 - x**2),
        bounds=(0.3 * inner, 0.99 * inner),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return float(found.fun), float(found.x)


def least() -> UprightArch:
    """The least thickness."""
    thickness = brentq(lambda t: clearance(t)[0], 0.05, 0.2, xtol=1e-13)
    hinge = clearance(thickness)[1]
    return UprightArch(thickness, hinge, float(np.degrees(np.arcsin(hinge / (1.0 - thickness / 2.0)))))
