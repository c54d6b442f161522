"""Structures in space whose failure load is known by hand: closed forms, met by rigid blocks whatever the history."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from studies.space.structures import (
    along_x,
    box,
    courses,
    extruded,
    prism,
    regular,
    solid,
    tables,
    towards,
)

STICKS = 3.0  # friction of joints that do not slide
EXACT, TWISTED = 1e-3, 3e-3  # of the load


class ByHand(NamedTuple):
    """A case with its load."""

    case: dict
    load: float
    formula: str
    tolerance: float = EXACT


def block_on_ground(size: tuple[float, float, float], **more) -> dict:
    """A block on flat ground; more: as of `tables`."""
    b, d, h = size
    ground = box("ground", (-b, -d, -h), (2 * b, 2 * d, 0.0), fixed=True)
    return tables(ground, box("block", (0.0, 0.0, 0.0), size), **more)


def block_over_edge(azimuth: float) -> ByHand:
    """Over the edge that gives first, whatever the direction."""
    b, d, h = 0.6, 0.4, 1.0
    x, y, _ = np.abs(towards(azimuth))
    load = min(b / h / max(x, 1e-9), d / h / max(y, 1e-9))
    case = block_on_ground((b, d, h), friction=STICKS, direction=towards(azimuth))
    return ByHand(case, load, "min(b / h cos ψ, d / h sin ψ)")


def tilted_block(azimuth: float) -> ByHand:
    """The same on a table that tilts in that direction: tan θ is the load."""
    found = block_over_edge(azimuth)
    analysis = {**found.case["analysis"], "pattern": "tilt"}
    return found._replace(case={**found.case, "analysis": analysis})


def sliding_block(azimuth: float) -> ByHand:
    """μ in any direction."""
    case = block_on_ground((0.6, 0.5, 0.1), friction=0.3, direction=towards(azimuth))
    return ByHand(case, 0.3, "μ")


def prism_over_edge() -> ByHand:
    """A triangular prism over its oblique edge."""
    corners = np.array([[0.0, 0.0], [0.7, 0.0], [0.0, 0.4]])
    normal = np.array([0.4, 0.7]) / math.hypot(0.4, 0.7)
    reach = float((corners[1] - corners.mean(axis=0)) @ normal)  # from the centroid to the long side
    ground = box("ground", (-1.0, -1.0, -0.3), (2.0, 2.0, 0.0), fixed=True)
    case = tables(ground, prism("block", corners, 0.0, 1.0), friction=STICKS, direction=(*normal, 0.0))
    return ByHand(case, reach / 0.5, "distance to the edge / half the height")


def block_on_slope(way: str) -> ByHand:
    """Up, down or across a plane that falls towards +x."""
    alpha, mu = math.radians(15.0), 0.5
    c, s, phi = math.cos(alpha), math.sin(alpha), math.atan(mu)
    axes = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])  # down the dip, across it, normal of the plane

    def corners(*ranges: tuple[float, float]) -> np.ndarray:
        return np.stack(np.meshgrid(*ranges), -1).reshape(-1, 3) @ axes

    load, direction, formula = {
        "up": (math.tan(phi + alpha), (-1.0, 0.0, 0.0), "tan(φ + α)"),
        "down": (math.tan(phi - alpha), (1.0, 0.0, 0.0), "tan(φ − α)"),
        "across": (math.sqrt((mu * c) ** 2 - s**2), (0.0, 1.0, 0.0), "√((μ cos α)² − sin²α)"),
    }[way]
    ground = solid("ground", corners((-1.0, 2.0), (-1.0, 2.0), (-0.5, 0.0)), fixed=True)
    block = solid("block", corners((0.0, 0.8), (0.0, 0.6), (0.0, 0.1)))
    return ByHand(tables(ground, block, friction=mu, direction=direction), load, formula)


def wedge_in_groove(half_deg: float = 50.0, mu: float = 0.25) -> ByHand:
    """A wedge in a horizontal groove, pushed along it: joints that dilate as they slide would carry 2 % more."""
    half = math.radians(half_deg)
    width, length = 0.3, 0.5
    depth = width / math.tan(half)
    left = [(-1.0, 0.0), (0.0, 0.0), (-width, depth), (-1.0, depth)]
    banks = [
        solid(f"bank-{i}", extruded([(sign * y, z) for y, z in left], -1.0, 2.0), fixed=True)
        for i, sign in enumerate((1.0, -1.0))
    ]
    wedge = solid("wedge", extruded([(0.0, 0.0), (width, depth), (-width, depth)], 0.0, length))
    return ByHand(tables(*banks, wedge, friction=mu), mu / math.sin(half), "μ / sin h")


def panel(azimuth: float) -> ByHand:
    """A wall in running bond with free ends over its foot."""
    n, blocks, t = 6, 6, 0.15
    laid = courses(
        lambda k: along_x(0.0, 2 * t * blocks, 2 * t if k % 2 == 0 else t, t),
        n,
        t,
        (-t, 2 * t * blocks + t, -2 * t, 3 * t),
    )
    load = 1.0 / n / math.sin(math.radians(azimuth))
    return ByHand(tables(*laid, friction=0.6, direction=towards(azimuth)), load, "t / H sin ψ")


def octagonal_drums(azimuth: float) -> ByHand:
    """A column of four drums with eight sides, over a side (0°) or a corner (22.5°)."""
    apothem, h, n = 0.4, 0.5, 4
    outline, reach = regular(8, apothem), apothem / math.cos(math.radians(azimuth))
    ground = box("ground", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), fixed=True)
    drums = [prism(f"drum-{k}", outline, k * h, (k + 1) * h) for k in range(n)]
    case = tables(ground, *drums, friction=STICKS, direction=towards(azimuth))
    return ByHand(case, reach / (0.5 * n * h), "apothem or circumradius / half the height")


def twisted_block() -> ByHand:
    """A cube under a couple about the vertical: μ N times the mean distance of its face from the centre, 0.383 a."""
    a, mu = 0.5, 0.4
    case = block_on_ground((a, a, a), friction=mu)
    pair = [((0.0, 0.5 * a, 0.5 * a), -1.0), ((a, 0.5 * a, 0.5 * a), 1.0)]
    loads = [{"block": "block", "force": [0.0, sign, 0.0], "at": list(at), "kind": "live"} for at, sign in pair]
    weight = 2000.0 * 9.81 * a**3
    case |= {"load": loads, "analysis": {"kind": "pushover", "pattern": "live", "max_load": 1e5}}
    arm = (math.sqrt(2.0) + math.asinh(1.0)) / 6.0
    return ByHand(case, mu * weight * arm, "μ W (√2 + asinh 1) / 6", TWISTED)


BY_HAND: dict[str, ByHand] = {
    **{f"block over an edge, {a:g}°": block_over_edge(a) for a in (0.0, 25.0, 50.0, 90.0, 205.0)},
    **{f"table tilts, {a:g}°": tilted_block(a) for a in (0.0, 30.0, 90.0)},
    **{f"block slides, {a:g}°": sliding_block(a) for a in (0.0, 33.0, 110.0)},
    "prism over its oblique edge": prism_over_edge(),
    **{f"slope, {way}": block_on_slope(way) for way in ("up", "down", "across")},
    "wedge in a groove": wedge_in_groove(),
    **{f"panel, {a:g}°": panel(a) for a in (90.0, 60.0)},
    **{f"octagonal drums, {a:g}°": octagonal_drums(a) for a in (0.0, 22.5)},
    "block is twisted": twisted_block(),
}
