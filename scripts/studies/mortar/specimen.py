"""Wallettes in four-point bending: running bond at any angle, cut by the outline of the specimen, with line loads."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dem_cli.core.geometry import polygon

WIDTH, LENGTH, THICKNESS = 0.8, 1.6, 0.15  # m; 0.79 x 1.6 m in paper 002: whole blocks with half a joint around
BLOCK = (0.4, 0.2)  # m, with a joint of 10 mm
OUTER, INNER = 1.5, 0.5  # m, between the lines of load
TENSION, COHESION, FRICTION_ANGLE = 0.322e6, 0.483e6, 36.0  # Pa, degrees
KN = 1e11  # Pa/m
FORCE = 1000.0  # N on each line at λ = 1
SLIVER = 0.1  # of a block: pieces of the pattern that are smaller are left out
ROWS = 12


def blocks_of(angle: float) -> list[np.ndarray]:
    """Blocks of a wallette whose beds are at this angle [deg] to the lines of load, polygons in x and z."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    turn, middle = np.array([[c, -s], [s, c]]), np.array([WIDTH, LENGTH]) / 2.0
    sides = [(1.0, 0.0, WIDTH), (-1.0, 0.0, 0.0), (0.0, 1.0, LENGTH), (0.0, -1.0, 0.0)]
    found = []
    for row in range(-ROWS, ROWS):
        for k in range(-ROWS, ROWS):
            low = np.array([(k + 0.5 * (row % 2)) * BLOCK[0], row * BLOCK[1]])
            piece = (np.array([[0.0, 0.0], [BLOCK[0], 0.0], BLOCK, [0.0, BLOCK[1]]]) + low) @ turn.T + middle
            for x, z, most in sides:
                piece = _cut(piece, np.array([x, z]), most)
            if len(piece) > 2 and polygon.properties(piece).area >= SLIVER * BLOCK[0] * BLOCK[1]:
                found.append(piece)
    return found


def _cut(corners: np.ndarray, normal: np.ndarray, most: float) -> np.ndarray:
    """What of a convex polygon (n, 2) lies below `most` along a unit normal; corners that coincide are one."""
    out: list[np.ndarray] = []
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        over, after = float(p @ normal) - most, float(q @ normal) - most
        if over <= 1e-12:
            out.append(p)
        if over * after < 0.0 and min(abs(over), abs(after)) > 1e-12:
            out.append(p + over / (over - after) * (q - p))
    kept = [p for k, p in enumerate(out) if np.linalg.norm(p - out[k - 1]) > 1e-9]
    return np.array(kept).reshape(-1, 2)


def lines_of_load(blocks: list[np.ndarray]) -> list[dict[str, Any]]:
    """Four line loads across the specimen, shared among the blocks that they cross: +, −, −, +."""
    loads = []
    for away, sign in ((-OUTER, 1.0), (-INNER, -1.0), (INNER, -1.0), (OUTER, 1.0)):
        z = 0.5 * (LENGTH + away)
        for i, corners in enumerate(blocks):
            xs = _crossings(corners, z + 1e-7)
            if len(xs) == 2 and xs[1] - xs[0] > 1e-6:
                place, force = [sum(xs) / 2.0, THICKNESS / 2.0, z], [0.0, sign * FORCE * (xs[1] - xs[0]) / WIDTH, 0.0]
                loads.append({"kind": "live", "block": f"b{i}", "at": place, "force": force})
    return loads


def held_of(blocks: list[np.ndarray]) -> int:
    """The lowest block in the middle."""
    low = [i for i, corners in enumerate(blocks) if corners[:, 1].min() < 1e-9]
    return min(low, key=lambda i: abs(blocks[i][:, 0].mean() - WIDTH / 2.0))


def _crossings(corners: np.ndarray, z: float) -> list[float]:
    """Where a level line crosses the outline of a polygon, in order."""
    ends = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    return sorted(
        float(p[0] + (z - p[1]) / (q[1] - p[1]) * (q[0] - p[0])) for p, q in ends if (p[1] - z) * (q[1] - z) < 0
    )


def wallette(angle: float, ratio: float, points: int = 3, **joint: Any) -> dict[str, Any]:
    """Tables of a case. Loads balance each other, so that the lowest block in the middle is held without any reaction.

    ratio: ks/kn. Gravity is 1 m/s², so that blocks have a weight by which their equilibrium can be judged: 1.1 kPa.
    """
    pieces = blocks_of(angle)
    held = held_of(pieces)
    blocks = [
        {"id": f"b{i}", "material": "block", "polygon": corners.round(12).tolist(), "y": [0.0, THICKNESS]}
        | ({"fixed": True} if i == held else {})
        for i, corners in enumerate(pieces)
    ]
    mortar = {
        "law": "mohr-coulomb", "friction_angle_deg": FRICTION_ANGLE, "cohesion": COHESION, "tension": TENSION,
        "kn": KN, "ks": ratio * KN, "points": points,
    }  # fmt: skip
    return {
        "dimension": 3,
        "gravity": 1.0,
        "materials": {"block": {"density": 1400.0}},
        "joints": {"mortar": mortar | joint},
        "block": blocks,
        "load": lines_of_load(pieces),
        "analysis": {"kind": "pushover", "pattern": "live", "kinematics": "fixed", "resolution": 0.005},
    }


def strength(load: float) -> float:
    """Flexural strength 6 M / (b t²) of a load multiplier [Pa]."""
    return 6.0 * load * FORCE * 0.5 * (OUTER - INNER) / (WIDTH * THICKNESS**2)
