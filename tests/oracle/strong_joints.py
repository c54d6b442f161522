"""Rigid blocks on joints with tension, cohesion and crushing, apart from dem_cli: a linear program, and closed forms.

The largest λ for which forces at the points of the joints, −ft A ≤ N ≤ fc A and |T| ≤ c A + μ N, balance dead loads and
λ times the weights sideways. Every joint has the same points: places and shares of its length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from oracle.limit_lp import area_and_centroid, interfaces


@dataclass(frozen=True)
class Points:
    """Contact points of a joint of length one, and its strength; thickness is one."""

    places: np.ndarray
    shares: np.ndarray
    friction: float
    cohesion: float = 0.0  # [Pa]
    tension: float = 0.0
    compression: float = np.inf


def largest_load(polygons: list[np.ndarray], fixed: list[bool], points: Points, gamma: float = 19620.0) -> float:
    """The largest share of their weight that the blocks carry sideways; nan: they do not stand.

    gamma: weight of a cubic metre [N].
    """
    centroids = np.array([area_and_centroid(p)[1] for p in polygons])
    weights = np.array([area_and_centroid(p)[0] for p in polygons]) * gamma
    columns, bounds, slopes = [], [], []
    for joint in interfaces(polygons):
        tangent = np.array([-joint.normal[1], joint.normal[0]])
        length = float(np.hypot(*(joint.ends[1] - joint.ends[0])))
        for place, share in zip(points.places, points.shares, strict=True):
            at, area = joint.ends[0] + place * (joint.ends[1] - joint.ends[0]), share * length
            for force in (joint.normal, tangent):
                column = np.zeros((len(polygons), 3))
                for block, sign in ((joint.a, -1.0), (joint.b, 1.0)):
                    arm = at - centroids[block]
                    column[block] = sign * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
                columns.append(column)
            bounds += [(-points.tension * area, points.compression * area), (None, None)]
            slopes.append(points.cohesion * area)
    free = ~np.array(fixed)
    live = np.column_stack([weights, np.zeros((len(weights), 2))])
    balance = np.array([*columns, live])[:, free].reshape(len(columns) + 1, -1).T / weights.mean()
    right = np.column_stack([np.zeros(len(weights)), weights, np.zeros(len(weights))])[free].ravel() / weights.mean()
    cones = np.zeros((2 * len(slopes), len(columns) + 1))
    for k in range(len(slopes)):
        cones[2 * k : 2 * k + 2, 2 * k] = -points.friction
        cones[2 * k : 2 * k + 2, 2 * k + 1] = 1.0, -1.0
    cost = np.zeros(len(columns) + 1)
    cost[-1] = -1.0
    found = linprog(
        cost, A_ub=cones, b_ub=np.repeat(slopes, 2), A_eq=balance, b_eq=right, bounds=[*bounds, (0, None)]
    )  # fmt: skip
    return float(found.x[-1]) if found.status == 0 else float("nan")


def toppling_load(points: Points, width: float, height: float, weight: float) -> float:
    """λ at which one block turns about its toe: the largest moment of point forces that add up to its weight.

    Pulled as far as they hold away from the toe, pressed as far as they hold next to it, one in between.
    """
    order = np.argsort(points.places)  # the toe is at place 0
    areas, arms = points.shares[order] * width, points.places[order] * width
    forces, left = -points.tension * areas, weight + points.tension * width
    for i, area in enumerate(areas):
        more = min(left, (points.compression + points.tension) * area)
        forces[i] += more
        left -= more
    return float((weight * width / 2.0 - forces @ arms) / (weight * height / 2.0))


def stress_block_load(width: float, height: float, weight: float, compression: float) -> float:
    """The same of a joint in one piece without tension: pressed by fc over the length that the weight needs."""
    return (width - weight / compression) / height
