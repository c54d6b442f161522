"""Virtual work of rigid bodies joined by hinges: the load multiplier of a mechanism of one degree of freedom."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

Point = tuple[float, float]
Hinge = tuple[str, str | None, Point]  # body, body (None: ground), place [m]
Weight = tuple[str, float, Sequence[float]]  # body, mass [kg], its centroid [m]


def multiplier(bodies: Sequence[str], hinges: Iterable[Hinge], weights: Iterable[Weight]) -> float:
    """−(work of gravity)/(work of the lateral load), which pushes to the left; hinges leave one motion."""
    rows = []
    for first, second, (x, z) in hinges:
        for axis in (0, 1):
            row = np.zeros(3 * len(bodies))
            for body, sign in ((first, 1.0), (second, -1.0)):
                if body is not None:
                    at = 3 * bodies.index(body)
                    row[at + axis] = sign
                    row[at + 2] = sign * (-z if axis == 0 else x)  # velocity of a point: (u − ω z, w + ω x)
            rows.append(row)
    _, sizes, vectors = np.linalg.svd(np.array(rows))
    (motion,) = vectors[len(sizes[sizes > 1e-9 * sizes[0]]) :]
    falls = pushed = 0.0
    for body, mass, (x, z) in weights:
        u, w, turn = motion[3 * bodies.index(body) :][:3]
        pushed += mass * -(u - turn * z)
        falls += mass * -(w + turn * x)
    return float(-falls / pushed)


def area_and_centroid(polygons: Iterable[Sequence[Sequence[float]]]) -> tuple[float, np.ndarray]:
    """[m2], [m]; of all polygons together."""
    total, moment = 0.0, np.zeros(2)
    for polygon in polygons:
        p = np.array(polygon)
        q = np.roll(p, -1, axis=0)
        cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
        total += 0.5 * cross.sum()
        moment += ((p + q) * cross[:, None]).sum(axis=0) / 6.0
    return abs(total), moment / total
