"""Friction and slip in space of many contact points: limit/slip_cones.py in compiled code, the same to the last digit.

One loop over the points instead of some twenty passes over all of them; what is done to each point, and in which order,
is the same.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from dem_cli.core.kernels.jit import inline, kernel
from dem_cli.core.limit.slip_cones import TURNS, ConeStiffness, SlipCones, polar

ROOT = float(np.sqrt(2.0))


class CompiledCones(SlipCones):
    """Friction cones and slips of points in space, compiled (see SlipCones)."""

    def fastest(self, x: np.ndarray, change: np.ndarray) -> tuple[float, float]:
        """Compute the fastest relative fall and growth of the variables under a change (see Slips.fastest)."""
        found = np.zeros(2)
        find_fastest(x.reshape(8, -1), change.reshape(8, -1), found)
        return float(found[0]), float(found[1])

    def moved(self, x: np.ndarray, change: np.ndarray, length: float = 1.0) -> np.ndarray:
        """Move the variables along a change and keep them inside their cones (see Slips.moved)."""
        found = np.empty_like(x)
        move(x.reshape(8, -1), change.reshape(8, -1), float(length), found.reshape(8, -1))
        return found

    def linear(self, x: np.ndarray, friction: np.ndarray, ks: np.ndarray, stiff_n: np.ndarray) -> CompiledStiffness:
        """Linearise the complementarity of friction and slip (see Slips.linear)."""
        return CompiledStiffness(polar(x), friction, ks, stiff_n)


class CompiledStiffness(ConeStiffness):
    """Linearised complementarity of friction and slip, compiled (see ConeStiffness)."""

    def towards(self, tau: np.ndarray, off: np.ndarray) -> np.ndarray:
        """Compute the change of the slips while forces stay (see SlipStiffness.towards)."""
        found, wanted = np.empty_like(off), np.ascontiguousarray(tau).reshape(2, -1)
        slip_towards(wanted, self.at.c, self.at.a, off.reshape(3, -1), self.d, self.ratios, self.turning,
                     found.reshape(3, -1))  # fmt: skip
        return found

    def rubbed(self, forced: np.ndarray, off_slide: np.ndarray, push: np.ndarray) -> np.ndarray:
        """Compute the change of the shear forces while no block moves (see SlipStiffness.rubbed)."""
        found = np.empty_like(off_slide)
        rub(forced.reshape(3, -1), off_slide.reshape(2, -1), push, self.d, self.stiff_along, self.stiff_across,
            self.drag, found.reshape(2, -1))  # fmt: skip
        return found

    def sheared(self, rubbed: np.ndarray, slide: np.ndarray, closing: np.ndarray) -> np.ndarray:
        """Compute the change of the shear forces as blocks slide (see SlipStiffness.sheared)."""
        found = np.empty_like(rubbed)
        shear(rubbed.reshape(2, -1), slide.reshape(2, -1), closing, self.d, self.stiff_along, self.stiff_across,
              self.coupling, found.reshape(2, -1))  # fmt: skip
        return found

    def slipped(self, forced: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Compute the change of the slips as the reserves change (see SlipStiffness.slipped)."""
        found = np.empty_like(forced)
        slip_back(forced.reshape(3, -1), change.reshape(3, -1), self.d, self.ratios, self.turning,
                  found.reshape(3, -1))  # fmt: skip
        return found


@kernel
def find_fastest(x, change, found):
    """Find the fastest fall and growth of any variable in x (8, n) by a change (8, n), relative to itself, into
    found (2,)."""
    low, high = 0.0, 0.0
    for i in range(x.shape[1]):
        normal, opening = change[0, i] / x[0, i], change[4, i] / x[1, i]
        low, high = min(low, normal, opening), max(high, normal, opening)
        for own, by in ((2, 1), (4, 5)):
            first, second = x[own, i], x[own + 1, i]
            lead, along, across = _turned(change, by, i, x[6, i], x[7, i])
            scale = 0.5 * (first + second) if _turns(first, second) else sqrt(first * second)
            one, two, across = (lead - along) / first, (lead + along) / second, ROOT * across / scale
            middle = 0.5 * (one + two)
            radius = sqrt(0.25 * ((one - two) * (one - two)) + 0.5 * (across * across))
            low, high = min(low, middle - radius), max(high, middle + radius)
    found[0], found[1] = low, high


@inline
def _turned(change, row, i, d1, d2):
    """Return the first component, and the other two along and across the direction d."""
    one, two = change[row + 1, i], change[row + 2, i]
    return change[row, i], d1 * one + d2 * two, d1 * two - d2 * one


@inline
def _turns(first, second):
    """Test whether the element of one point turns as it moves (slip_cones._turns)."""
    return abs(second - first) > TURNS * (first + second)


@kernel
def move(x, change, length, found):
    """Move x (8, n) by a share of a change (8, n) into found (slip_cones.Polar.moved)."""
    for i in range(x.shape[1]):
        c1, c2, a1, a2, d1, d2 = x[2, i], x[3, i], x[4, i], x[5, i], x[6, i], x[7, i]
        dc, dt1, dt2 = length * change[1, i], length * change[2, i], length * change[3, i]
        da, dg1, dg2 = length * change[5, i], length * change[6, i], length * change[7, i]
        half_c, half_a = 0.5 * (c2 - c1), 0.5 * (a2 - a1)
        t1, t2, g1, g2 = half_c * d1 + dt1, half_c * d2 + dt2, half_a * d1 + dg1, half_a * d2 + dg2
        e1, e2 = t1 - g1, t2 - g2
        size = sqrt(e1 * e1 + e2 * e2)
        e1, e2 = (e1 / size, e2 / size) if size > 0.0 else (d1, d2)
        shear, slide = max(t1 * e1 + t2 * e2, 0.0), max(-(g1 * e1 + g2 * e2), 0.0)
        c = c1 + (dc - (d1 * dt1 + d2 * dt2)) if _turns(c1, c2) else 0.5 * (c1 + c2) + dc - shear
        a = a2 + (da + (d1 * dg1 + d2 * dg2)) if _turns(a1, a2) else 0.5 * (a1 + a2) + da - slide
        found[0, i], found[1, i] = x[0, i] + length * change[0, i], x[1, i] + length * change[4, i]
        found[2, i], found[3, i], found[4, i], found[5, i] = c, c + 2.0 * shear, a + 2.0 * slide, a
        found[6, i], found[7, i] = e1, e2


@inline
def _yielding(change, i, d1, d2, ratios, turning):
    """Compute the slips that a change of the reserve of one point takes back (slip_cones.ConeStiffness._yielding)."""
    lead, along, across = _turned(change, 0, i, d1, d2)
    one, two, across = ratios[0, i] * (lead - along), ratios[1, i] * (lead + along), turning[i] * across
    half = 0.5 * (two - one)
    return 0.5 * (one + two), half * d1 - across * d2, half * d2 + across * d1


@inline
def _stiff(one, two, d1, d2, stiff_along, stiff_across):
    """Compute the shear forces of a slide at one point (slip_cones.ConeStiffness._stiff)."""
    along, across = stiff_along * (d1 * one + d2 * two), stiff_across * (d1 * two - d2 * one)
    return along * d1 - across * d2, along * d2 + across * d1


@kernel
def slip_towards(tau, c, a, off, d, ratios, turning, found):
    """Compute the change of slips while forces stay (ConeStiffness.towards); tau, c, a, d, ratios (2, n), off,
    found (3, n), turning (n,)."""
    for i in range(turning.size):
        d1, d2 = d[0, i], d[1, i]
        one, two = (tau[0, i] - c[0, i] * a[0, i]) / c[0, i], (tau[1, i] - c[1, i] * a[1, i]) / c[1, i]
        lead, first, second = _yielding(off, i, d1, d2, ratios, turning)
        half = 0.5 * (two - one)
        found[0, i] = 0.5 * (one + two) - lead
        found[1, i], found[2, i] = half * d1 - first, half * d2 - second


@kernel
def slip_back(forced, change, d, ratios, turning, found):
    """Compute the change of slips with the reserves (ConeStiffness.slipped); forced, change, found (3, n), d,
    ratios (2, n), turning (n,)."""
    for i in range(turning.size):
        lead, first, second = _yielding(change, i, d[0, i], d[1, i], ratios, turning)
        found[0, i], found[1, i], found[2, i] = forced[0, i] - lead, forced[1, i] - first, forced[2, i] - second


@kernel
def rub(forced, off_slide, push, d, stiff_along, stiff_across, drag, found):
    """Compute shear forces of slips and normal forces (ConeStiffness.rubbed); forced (3, n), off_slide, d, drag,
    found (2, n), push and stiffness (n,)."""
    for i in range(push.size):
        one, two = forced[1, i] + off_slide[0, i], forced[2, i] + off_slide[1, i]
        first, second = _stiff(one, two, d[0, i], d[1, i], stiff_along[i], stiff_across[i])
        found[0, i], found[1, i] = first - drag[0, i] * push[i], second - drag[1, i] * push[i]


@kernel
def shear(rubbed, slide, closing, d, stiff_along, stiff_across, coupling, found):
    """Compute shear forces of sliding and opening (ConeStiffness.sheared); rubbed, slide, d, coupling, found (2,
    n), closing and stiffness (n,)."""
    for i in range(closing.size):
        first, second = _stiff(slide[0, i], slide[1, i], d[0, i], d[1, i], stiff_along[i], stiff_across[i])
        found[0, i] = rubbed[0, i] + (coupling[0, i] * closing[i] - first)
        found[1, i] = rubbed[1, i] + (coupling[1, i] * closing[i] - second)
