"""Places of the contact points of a joint: vertices of its profile, or the points of a rule of integration."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Literal, NamedTuple

import numpy as np

from dem_cli.core.geometry import profile

Range = tuple[float, float]  # lowest and highest value; the same twice: always this one

SAMPLES = 100  # profiles drawn to see how steep they may be

STEEPEST_SIDE = 0.2  # slope of a side of a profile: beyond it the small angles of a profile are wrong by more than 1 %

# A profile pressed onto one side is as stiff as a plane joint with points at both ends.
VERTEX_SHARE = 0.5

# Points along a joint that cracks or is crushed: with them it is as strong in bending as its whole section, to 1 % at
# any normal force, brittle in tension or perfectly plastic in compression. Half of them, from the middle of the joint
# to its end at 1; found by minimising the largest error, with exact second moment. Lobatto's rule needs 24.
SECTION = 16  # laws/stiffness.py has the same number for the key `points`
SECTION_PLACES = (0.098369398, 0.292408772, 0.485293093, 0.668875623, 0.814652644, 0.912170232, 0.969895267, 1.0)
SECTION_SHARES = (0.098318572, 0.09772978, 0.095683014, 0.084577732, 0.057252655, 0.036762648, 0.02150179, 0.008173809)


class PointLayout(NamedTuple):
    """Layout of the contact points of one named joint. Without `sides` the joint is plane and has `points` of them.

    In space a plane joint has points at the corners of the overlap, and so many along each of its sides
    (contact/area_rules.py), or one at its centre besides.
    """

    points: int = 2
    centred: bool = False  # in space: corners and centre
    sides: tuple[int, int] | None = None
    aperture: Range = (0.0, 0.0)  # [m]
    lengths: tuple[Range, ...] = ()  # of the sides [m] or as proportions; one: the same range for each; none: equal
    central: Range | None = None  # share of the middle side; then only odd numbers of sides are drawn
    keep: Literal["aperture", "angle", "lengths"] = "aperture"  # where the lengths do not add up to that of the joint
    over: Literal["joint", "face"] = "joint"  # what the polygon spans: each joint, or the whole edge of block b
    only: Literal["bed", "head", "all"] = "all"  # joints flatter or steeper than 45°: which have the profile
    seed: int = 0


class ProfileFault(NamedTuple):
    """Reason why joints cannot have a profile."""

    key: str  # of its table
    why: str  # as users read it


def too_steep(between: Sequence[str], length: float, slope: float) -> ProfileFault | None:
    """Check the steepest slope of the profile over a joint of this length [m]; returns the fault or None."""
    if slope <= STEEPEST_SIDE:
        return None
    a, b = between
    return ProfileFault(
        "aperture",
        f"too large for the joint of '{a}' and '{b}', {length:.3g} m long: a side of the profile has a slope of "
        f"{slope:.2g} there, at most {STEEPEST_SIDE:g} is allowed",
    )


def too_deep(between: Sequence[str], rise: float, thickness: float) -> ProfileFault | None:
    """Check that the rise of a profile [m] is less than the thickness of block b behind the joint [m]; else a fault."""
    if rise < thickness:
        return None
    a, b = between
    return ProfileFault(
        "aperture",
        f"too large for the joint of '{a}' and '{b}': it takes {rise:.3g} m from '{b}', which is {thickness:.3g} m "
        "thick there",
    )


def draw(
    layout: PointLayout, key: tuple[int, ...], length: float, mirrored: bool = False
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Draw the contact points of a joint of this length [m]: places [m], initial gaps [m], shares of the area [-].

    places: along the joint, increasing from 0 to its length; gaps: 0 at the two ends of the side in contact;
    shares: of the points of a plane joint they add up to 1, of a profile each two neighbours do.
    key: what tells this joint from others of its kind (numbers ≥ 0): the same key draws the same profile,
    whatever was drawn before. mirrored: an odd number of sides, and the second half is the mirror image of the first.
    """
    if layout.sides is None:
        places, shares = section() if layout.points == SECTION else lobatto(layout.points)
        return places * length, np.zeros(layout.points), shares
    random = np.random.default_rng([layout.seed, *key])
    low, high = layout.sides
    odd = 1 if layout.central is None and not mirrored else 2
    sides = low + odd * int(random.integers(0, (high - low) // odd, endpoint=True))
    aperture = random.uniform(*layout.aperture)
    if layout.lengths:
        ranges = layout.lengths * sides if len(layout.lengths) == 1 else layout.lengths
        lengths = np.array([random.uniform(*each) for each in ranges])
        lengths = np.concatenate([lengths[: sides // 2 + 1], lengths[: sides // 2][::-1]]) if mirrored else lengths
    else:
        lengths = profile.regular(sides, None if layout.central is None else random.uniform(*layout.central))
    if layout.keep == "lengths":
        places, rises = profile.polygon(lengths, aperture)
        places, rises = profile.cut(places + 0.5 * (length - places[-1]), rises, 0.0, length)
        return places, rises, np.full(len(places), VERTEX_SHARE)
    scale = length / lengths.sum()
    if layout.keep == "angle":
        aperture *= scale
    places, rises = profile.polygon(lengths * scale, aperture)
    places[-1] = length
    return places, rises, np.full(sides + 1, VERTEX_SHARE)


def steepest(layout: PointLayout, length: float) -> float:
    """Compute the largest slope of a side of a joint of this length [m] against the one that it rests on [-]; 0 where
    plane.

    Of profiles with ranges: the largest of many that are drawn.
    """
    if layout.sides is None:
        return 0.0
    drawn = (draw(layout, (i,), length) for i in range(SAMPLES))
    return max(float(np.abs(profile.slopes(places, gaps)).max()) for places, gaps, _ in drawn)


@cache
def lobatto(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Compute the Gauss–Lobatto rule with n ≥ 2 points: places from 0 to 1 and weights, each (n,); the weights add up
    to 1.

    Exact for polynomials up to degree 2n − 3: from three points on, a joint under bending has the section modulus
    and the moment of inertia of a rectangle. Source: Abramowitz and Stegun 25.4.32. Nobody may write to them.
    """
    if n < 2:
        raise ValueError("the rule has at least two points")
    x, weights = np.array([-1.0, 1.0]), np.ones(2)
    if n > 2:
        from numpy.polynomial.legendre import Legendre

        last = Legendre.basis(n - 1)
        inner = np.sort(last.deriv().roots().real)
        inner = 0.5 * (inner - inner[::-1])  # symmetric to the last digit
        x = np.concatenate([[-1.0], inner, [1.0]])
        weights = 1.0 / (n * (n - 1) * last(x) ** 2)
    places, weights = 0.5 * (x + 1.0), weights / weights.sum()
    places.flags.writeable = weights.flags.writeable = False
    return places, weights


@cache
def section() -> tuple[np.ndarray, np.ndarray]:
    """Compute the rule with SECTION points: places from 0 to 1 and weights, each (SECTION,); the weights add up to 1.

    Exact up to degree 3. Nobody may write to them.
    """
    places, weights = np.array(SECTION_PLACES), np.array(SECTION_SHARES)
    # What rounding of the printed digits has left of the second moment goes from the ends to the middle.
    weights *= 0.5 / weights.sum()
    excess = (weights * places**2).sum() - 1.0 / 6.0
    weights[[0, -1]] += np.array([excess, -excess]) / (1.0 - places[0] ** 2)
    places, weights = np.concatenate([-places[::-1], places]), np.concatenate([weights[::-1], weights])
    places = 0.5 * (places + 1.0)
    places.flags.writeable = weights.flags.writeable = False
    return places, weights
