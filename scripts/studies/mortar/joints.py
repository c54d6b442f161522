"""Contact points of a joint that cracks: moment of brittle points over that of the first crack, by rule and number."""

from __future__ import annotations

from typing import Any

import numpy as np

from dem_cli.core.contact.area_rules import inner_points
from studies.template import table

SQUARE = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
NUMBERS = range(2, 10)


def rows_of(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Points of a square by their distance from its middle, between −1 and 1, and the share of the area of each row."""
    rule = inner_points(SQUARE, np.array([0, 4]), np.zeros((1, 3)), np.array([n]))
    places = np.concatenate([SQUARE, rule.places])[:, 0].round(12)
    shares = np.concatenate([np.full(4, 0.25 * rule.corners[0]), rule.shares])
    levels, which = np.unique(places, return_inverse=True)
    return levels, np.bincount(which, shares)


def stages(levels: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Moment at which the next row cracks over ft W, when j rows have cracked and nothing is pressed, j = 0, 1, ..."""
    found = []
    for j in range(len(levels) - 1):
        x, w = levels[: len(levels) - j], shares[: len(levels) - j]
        middle = (w * x).sum() / w.sum()
        found.append(3.0 * (w * (x - middle) ** 2).sum() / (x[-1] - middle))
    return np.array(found)


def measure() -> list[dict[str, Any]]:
    """Of each number of points along a side: how many there are, and the moments of the stages."""
    found = []
    for n in NUMBERS:
        levels, shares = rows_of(n)
        points = 4 if n == 2 else 9 if n == 3 else n * n
        found.append({"n": n, "points": points, "stages": stages(levels, shares).round(3).tolist()})
    return found


def values(found: list[dict[str, Any]]) -> dict[str, str]:
    """The table of the page."""
    return {
        "rules": table(
            ["`points`", "points of a rectangle", "when the edge cracks", "strongest", "stages"],
            [
                [
                    f"{row['n']}", f"{row['points']}", f"{row['stages'][0]:.2f}", f"{max(row['stages']):.2f}",
                    ", ".join(f"{x:.2f}" for x in row["stages"][:4]),
                ]
                for row in found
            ],
        )
    }  # fmt: skip


PICTURES: dict[str, Any] = {}
