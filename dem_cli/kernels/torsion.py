"""Torsion of joints in space: how far from the centre of pressure friction acts, so that it is that of spread pressure.

Corner forces are exact for what rocks, but friction at the corners has the torque μN times their distance: for a square
85 % more than a uniform pressure p has, ∫ μ p |r − c| dA. So friction of a point at r acts at c + β (r − c), c being
the centre of pressure of the joint: the same forces with the same resultant, and at β = (mean distance of the outline
from its centroid) / (mean distance of its corners, by their areas) the torque of a uniform pressure. β is 0.541 for a
square, 0.520 for a rectangle 3:1, 1/2 for a line. What friction carries so, forces at the corners in their cones carry
as well: β Tᵢ + (1 − β) (Nᵢ/N) ΣT.
"""

from __future__ import annotations

import math

from dem_cli.kernels.jit import inline

OF_LINE = 0.5  # share of two points at the ends of a line of pressure


@inline
def mean_distance(work, count, x, y):
    """Mean distance of the polygon in row 2, counter-clockwise, from a place within it: triangles in closed form.

    A triangle with its apex there, its base at the distance h from u to v along it, has
    ∫ r dA = (h (v |v| − u |u|) + h³ (asinh v/h − asinh u/h)) / 6, |u| = √(h² + u²).
    """
    total, area = 0.0, 0.0
    for k in range(count):
        m = k + 1 if k + 1 < count else 0
        ax, ay = work[2, k, 0] - x, work[2, k, 1] - y
        bx, by = work[2, m, 0] - x, work[2, m, 1] - y
        length = math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
        h = (ax * by - ay * bx) / length
        if h > 1e-12 * length:
            u, v = (ax * (bx - ax) + ay * (by - ay)) / length, (bx * (bx - ax) + by * (by - ay)) / length
            ends = v * math.sqrt(h * h + v * v) - u * math.sqrt(h * h + u * u)
            total += h * (ends + h * h * (math.asinh(v / h) - math.asinh(u / h))) / 6.0
            area += 0.5 * h * length
    return total / area if area > 0.0 else 0.0
