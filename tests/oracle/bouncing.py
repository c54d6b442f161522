"""A block that falls flat on an elastic joint that does not pull, in closed form; with or without a dashpot.

Joint of stiffness k = kn A under the mass m; u is the overlap, ω = √(k/m), m u'' = m g − k u − c u', c = 2 ζ m ω. The
joint carries k u + c u' where that presses and u > 0, else nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq


class Joint(NamedTuple):
    """Block and joint, as far as they matter."""

    stiffness: float  # kn A [N/m]
    mass: float  # [kg]
    ratio: float = 0.0  # ζ, of critical
    gravity: float = 9.81  # [m/s2]

    @property
    def frequency(self) -> float:
        """ω [rad/s]."""
        return float(np.sqrt(self.stiffness / self.mass))

    @property
    def static(self) -> float:
        """Overlap at rest [m]."""
        return self.mass * self.gravity / self.stiffness


def contact(joint: Joint, speed: float, t):
    """Overlap [m], its rate [m/s] and the force in the joint [N], a time t after touching with `speed`, closed."""
    w, z, rest = joint.frequency, joint.ratio, joint.static
    t = np.asarray(t, float)
    if z == 1.0:
        a, b = -rest, speed - w * rest
        decay = np.exp(-w * t)
        u = rest + (a + b * t) * decay
        rate = (b - w * (a + b * t)) * decay
    else:
        root = np.sqrt(complex(z**2 - 1.0)) * w
        r1, r2 = -z * w + root, -z * w - root
        a = (speed + r2 * rest) / (r1 - r2)
        b = -rest - a
        u = rest + (a * np.exp(r1 * t) + b * np.exp(r2 * t)).real
        rate = (a * r1 * np.exp(r1 * t) + b * r2 * np.exp(r2 * t)).real
    return u, rate, joint.stiffness * u + 2.0 * z * joint.mass * w * rate


def contact_time(joint: Joint, speed: float) -> float:
    """How long the joint presses [s]; inf: it stays closed. Without a dashpot 2/ω (π − arctan(ω v / g))."""
    if joint.ratio == 0.0:
        return float(2.0 / joint.frequency * (np.pi - np.arctan(joint.frequency * speed / joint.gravity)))
    times = np.linspace(0.0, 4.0 * np.pi / joint.frequency, 4001)[1:]
    pulls = np.flatnonzero(contact(joint, speed, times)[2] <= 0.0)
    if len(pulls) == 0:
        return float("inf")
    end = times[pulls[0]]
    return float(brentq(lambda t: contact(joint, speed, t)[2], end - times[0], end, xtol=1e-16))


def rebound(joint: Joint, speed: float) -> float:
    """Speed with which it leaves over `speed`, that it came with."""
    end = contact_time(joint, speed)
    if not np.isfinite(end):
        return 0.0
    u, rate, _ = contact(joint, speed, end)
    drop = 2.0 * joint.gravity * max(float(u), 0.0)  # still inside: free flight up to the surface
    return float(np.sqrt(max(rate**2 - drop, 0.0)) / speed)


def heights(joint: Joint, height: float, count: int) -> np.ndarray:
    """Of the first `count` bounces after a fall of `height` [m]."""
    found = []
    for _ in range(count):
        speed = np.sqrt(2.0 * joint.gravity * height)
        height *= rebound(joint, speed) ** 2
        found.append(height)
    return np.array(found)


def peak_overlap(joint: Joint, height: float) -> float:
    """Largest overlap after a fall of `height`, without a dashpot [m]: twice the static one where it is set down."""
    rest = joint.static
    return rest + float(np.sqrt(rest**2 + 2.0 * rest * height))
