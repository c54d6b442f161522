"""Joints of the start of models in space, with one stiffness for all; random convex polyhedra that nearly touch."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from dem_cli.core.contact.joints import JointArrays, JointProperties
from dem_cli.core.contact.layout import PointLayout
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.geometry.polyhedron import Polyhedron, box, hull
from dem_cli.core.geometry.rotation import matrices
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import smallest_edge

KN, KS = 1e9, 4e8


def one_joint(centred: bool = False, points: int = 2) -> JointProperties:
    """Every joint with KN and KS; with points at its corners, at its centre too, or so many along each side."""
    layout = PointLayout(points, centred) if centred or points > 2 else None
    table = np.zeros((1, 1), np.int64)
    return JointProperties(
        ("j",), table, np.array([KN]), np.array([KS]), np.zeros((1, 1)), np.zeros((1, 0)), (layout,), np.array([False]),
        np.array([False]),
    )  # fmt: skip


def start_joints(model: Model, centred: bool = False, points: int = 2) -> JointArrays:
    return joints_of_start(model, bodies_at_rest(model), one_joint(centred, points), smallest_edge(model))


def turned(solid: Polyhedron, random: np.random.Generator, angle: float | None = None) -> Polyhedron:
    """Turned at random, or by a small angle about a random axis."""
    quaternion = random.normal(size=(1, 4))
    if angle is not None:
        quaternion[:, 1:] *= 0.5 * angle / np.linalg.norm(quaternion[:, 1:])
        quaternion[:, 0] = 1.0
    turn = matrices(quaternion / np.linalg.norm(quaternion))[0]
    return Polyhedron(solid.vertices @ turn.T, solid.faces)


def shifted(solid: Polyhedron, shift) -> Polyhedron:
    return Polyhedron(solid.vertices + np.asarray(shift, float), solid.faces)


def random_solid(random: np.random.Generator) -> Polyhedron:
    """A box, or a hull of 4 to 15 points on an ellipsoid, turned at random."""
    if random.random() < 0.4:
        side = random.uniform(0.3, 1.0, 3)
        return turned(box(-side / 2, side / 2), random)
    points = random.normal(size=(random.integers(4, 16), 3))
    points *= random.uniform(0.2, 0.8, 3) / np.linalg.norm(points, axis=1)[:, None]
    return turned(hull(points[ConvexHull(points).vertices]), random)


def near_pairs(n: int, random: np.random.Generator) -> list[Polyhedron]:
    """n pairs of blocks, one after the other, some overlapping and some apart; the pairs are far from each other."""
    blocks = []
    for i in range(n):
        a, b = random_solid(random), random_solid(random)
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
        distance = (a.vertices @ way).max() - (b.vertices @ way).min()
        origin = np.array([10.0 * i, 0.0, 0.0])
        blocks += [shifted(a, origin), shifted(b, origin + way * distance * random.uniform(0.6, 1.02))]
    return blocks
