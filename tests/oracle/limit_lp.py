"""Rigid-block limit analysis in 2D, independent of dem_cli: the oracle for failure loads.

Static theorem: the largest λ for which contact forces exist that balance dead + λ live loads on every free
block, press only, and stay inside the friction cone. Interfaces carry forces at their two ends. The
generators of the cone are the variables, n = a + b, t = μ (a − b), a, b ≥ 0, so only equilibrium rows remain.
Flow is associated: an upper bound where friction acts, exact where joints only open or where sliding is the
whole mechanism. Forces are scaled by a mean block weight, moments by that and a length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csc_matrix

Friction = float | Callable[["Interface"], float]


@dataclass(frozen=True)
class Interface:
    """Two edges that lie on each other: blocks a and b, ends of the overlap, unit normal from a to b."""

    a: int
    b: int
    ends: np.ndarray  # (2, 2) [m]
    normal: np.ndarray  # (2,)

    @property
    def steepness(self) -> float:
        """Angle of the joint to the horizontal, 0 … 90 degrees."""
        return float(np.degrees(np.arctan2(abs(self.normal[0]), abs(self.normal[1]))))


@dataclass(frozen=True)
class LimitLoad:
    """The answer, with what is needed to trust it."""

    multiplier: float  # inf: no load of this direction makes it fail; nan: does not stand at λ = 0
    residual: float  # largest violated equilibrium row, in block weights
    gap: float  # |primal − dual| multiplier
    normal_forces: np.ndarray  # at the two ends of each interface [N], (n, 2)
    shear_forces: np.ndarray  # (n, 2)
    velocities: np.ndarray  # mechanism: vx, vy, ω of each block, scaled so that the live loads do unit work


def area_and_centroid(polygon: np.ndarray) -> tuple[float, np.ndarray]:
    """Shoelace; the area is positive whatever the sense of the corners."""
    x, y = polygon.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = cross.sum() / 2
    cx = ((x + np.roll(x, -1)) * cross).sum() / (6 * area)
    cy = ((y + np.roll(y, -1)) * cross).sum() / (6 * area)
    return abs(area), np.array([cx, cy])


def bodies_area_and_centroid(polygons, bodies) -> tuple[np.ndarray, np.ndarray]:
    """Of each body, from its parts: (n,) and (n, 2)."""
    parts = [area_and_centroid(p) for p in polygons]
    areas = np.bincount(bodies, [area for area, _ in parts])
    moments = [np.bincount(bodies, [area * centre[k] for area, centre in parts]) for k in (0, 1)]
    return areas, np.column_stack(moments) / areas[:, None]


def edges_outward(polygon: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """(start, end, outward unit normal) of each edge, corners taken counter-clockwise."""
    x, y = polygon.T
    if (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() < 0:
        polygon = polygon[::-1]
    edges = []
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        along = (end - start) / np.hypot(*(end - start))
        edges.append((start, end, np.array([along[1], -along[0]])))
    return edges


def interfaces(
    polygons: Sequence[np.ndarray], bodies: Sequence[int] | None = None, tolerance: float | None = None
) -> list[Interface]:
    """Every pair of opposite edges of two bodies that touch along a length.

    bodies     the body that each polygon is a part of; default: each its own
    tolerance  [m], default 1e-6 of the size of all
    """
    bodies = range(len(polygons)) if bodies is None else bodies
    corners = np.vstack(polygons)
    if tolerance is None:
        tolerance = 1e-6 * float(np.ptp(corners, axis=0).max())
    lows = np.array([p.min(axis=0) for p in polygons]) - tolerance
    highs = np.array([p.max(axis=0) for p in polygons]) + tolerance
    all_edges = [edges_outward(p) for p in polygons]
    found = []
    for a in range(len(polygons)):
        near = np.flatnonzero(np.all((lows <= highs[a]) & (highs >= lows[a]), axis=1))
        for b in near[near > a]:
            if bodies[a] == bodies[b]:
                continue
            for start, end, normal in all_edges[a]:
                for other_start, other_end, other_normal in all_edges[b]:
                    ends = shared_segment(start, end, normal, other_start, other_end, other_normal, tolerance)
                    if ends is not None:
                        found.append(Interface(int(bodies[a]), int(bodies[b]), ends, normal))
    return found


def shared_segment(start, end, normal, other_start, other_end, other_normal, tolerance) -> np.ndarray | None:
    """The part that two edges share, or None: facing normals, both ends on the line, a length in common."""
    length = np.hypot(*(end - start))
    if normal @ other_normal > -1 + 1e-6:
        return None
    if max(abs((other_start - start) @ normal), abs((other_end - start) @ normal)) > tolerance:
        return None
    along = (end - start) / length
    low, high = sorted(((other_start - start) @ along, (other_end - start) @ along))
    low, high = max(low, 0.0), min(high, length)
    if high - low < 2 * tolerance:
        return None
    return np.array([start + low * along, start + high * along])


def limit_load(
    polygons: Sequence[np.ndarray],
    fixed: Sequence[bool],
    friction: Friction,
    *,
    weights: Sequence[float] | None = None,
    live: np.ndarray | None = None,
    dead: np.ndarray | None = None,
    direction: Sequence[float] = (1.0, 0.0),
    bodies: Sequence[int] | None = None,
) -> LimitLoad:
    """The largest multiplier of the live loads that the blocks carry. Every list but `polygons` is by body.

    weights  [N], default the area of each block; act downwards at the centroid
    live     fx, fy, moment about the centroid of each block per unit λ, default weight × direction
    dead     the same, constant, besides the weight
    friction one number, or a function of the Interface
    bodies   the body that each polygon is a part of; default: each its own
    """
    bodies = np.arange(len(polygons)) if bodies is None else np.asarray(bodies)
    n_blocks = int(bodies.max()) + 1
    areas, centroids = bodies_area_and_centroid(polygons, bodies)
    weights = np.array(areas if weights is None else weights, dtype=float)
    if live is None:
        live = np.column_stack([weights[:, None] * np.asarray(direction, dtype=float), np.zeros(n_blocks)])
    constant = np.zeros((n_blocks, 3)) if dead is None else np.array(dead, dtype=float)
    constant[:, 1] -= weights
    joints = interfaces(polygons, bodies)

    free = ~np.asarray(fixed, dtype=bool)
    row_of = np.cumsum(free) - 1
    weight = weights[free].mean()
    length = float(np.sqrt(areas[free].mean()))
    scale = np.tile([1 / weight, 1 / weight, 1 / (weight * length)], int(free.sum()))

    rows, columns, entries = [], [], []
    generators = []  # force on block b for a unit of each variable
    for i_joint, joint in enumerate(joints):
        mu = friction(joint) if callable(friction) else friction
        tangent = np.array([-joint.normal[1], joint.normal[0]])
        for i_end, point in enumerate(joint.ends):
            for side in (1.0, -1.0):
                force = joint.normal + side * mu * tangent
                column = len(generators)
                generators.append((i_joint, i_end, side * mu))
                for block, sign in ((joint.a, -1.0), (joint.b, 1.0)):
                    if free[block]:
                        arm = point - centroids[block]
                        moment = arm[0] * force[1] - arm[1] * force[0]
                        rows += [3 * row_of[block] + k for k in range(3)]
                        columns += [column] * 3
                        entries += [sign * force[0], sign * force[1], sign * moment / length]
    n_rows, n_forces = 3 * int(free.sum()), len(generators)
    rows += list(range(n_rows))
    columns += [n_forces] * n_rows
    entries += list(live[free].ravel() * scale)
    matrix = csc_matrix((entries, (rows, columns)), shape=(n_rows, n_forces + 1))
    right = -constant[free].ravel() * scale
    cost = np.zeros(n_forces + 1)
    cost[-1] = -1.0
    answer = linprog(cost, A_eq=matrix, b_eq=right, bounds=[(0, None)] * (n_forces + 1), method="highs")
    if answer.status in (2, 3):
        return LimitLoad(np.nan if answer.status == 2 else np.inf, 0.0, 0.0, *(np.zeros((0, 2)),) * 2, np.zeros((0, 3)))
    if answer.status != 0:
        raise RuntimeError(f"HiGHS: {answer.message}")

    normal_forces, shear_forces = np.zeros((2, len(joints), 2))
    for (i_joint, i_end, slope), force in zip(generators, answer.x, strict=False):
        normal_forces[i_joint, i_end] += force * weight
        shear_forces[i_joint, i_end] += slope * force * weight
    dual = answer.eqlin.marginals  # d(−λ)/d(right): the velocities of the mechanism
    velocities = np.zeros((n_blocks, 3))
    velocities[free] = -(dual * scale).reshape(-1, 3)
    return LimitLoad(
        multiplier=float(answer.x[-1]),
        residual=float(np.abs(matrix @ answer.x - right).max()),
        gap=abs(float(dual @ right) - float(answer.fun)),
        normal_forces=normal_forces,
        shear_forces=shear_forces,
        velocities=velocities,
    )


def stands(polygons, fixed, friction, **options) -> bool:
    """Whether contact forces exist that carry the dead load alone."""
    return not np.isnan(limit_load(polygons, fixed, friction, **options).multiplier)


def frictionless_heads(mu: float) -> Callable[[Interface], float]:
    """Friction μ in joints flatter than 45°, none in steeper ones (thesis Table 5-3)."""
    return lambda joint: mu if joint.steepness < 45 else 0.0
