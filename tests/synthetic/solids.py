"""Structures in space built by hand, without any search for contacts: extruded from the plane, or from named faces.

x and y are horizontal, z is up; the plane of a structure in 2D becomes the plane y = 0. A frame is n (from a to b),
t1 and t2 = n × t1; a lever is arm × direction.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry.rotation import frames
from dem_cli.core.kernels.records import Joints, MovingJoints
from dem_cli.core.model.block_measures import BlockMeasures
from dem_cli.core.model.model import Model

DEPTH = 0.4  # of extruded structures [m]


class Solid(NamedTuple):
    """A rigid block, of which statics needs no more than this."""

    centroid: Sequence[float]
    weight: float = 1.0  # [N]
    fixed: bool = False


class Face(NamedTuple):
    """Where two solids touch."""

    a: int
    b: int
    normal: Sequence[float]  # from a to b
    corners: Sequence[Sequence[float]]  # in any order [m], (n, 3)
    area: float = 1.0  # [m²]; every corner has the same share of it


def model_of(solids: Sequence[Solid], push: Sequence[float], down: Sequence[float] = (0.0, 0.0, -1.0)) -> Model:
    """Blocks under their weight along `down`; the live loads are their weights along `push`."""
    n, weights = len(solids), np.array([solid.weight for solid in solids])
    dead, live = np.zeros((n, 6)), np.zeros((n, 6))
    dead[:, :3] = weights[:, None] * np.array(down)
    live[:, :3] = weights[:, None] * np.array(push)
    centroids = np.array([solid.centroid for solid in solids], float)
    return _model(centroids, np.array([solid.fixed for solid in solids]), dead, live)


def joints_of(model: Model, faces: Sequence[Face], kn: float = 1e6, ks: float = 4e5) -> Joints:
    """A point in each corner of each face; kn, ks [Pa/m]."""
    counts = np.array([len(face.corners) for face in faces])
    owners = np.repeat(np.arange(len(faces)), counts)
    normals = np.array([face.normal for face in faces], float)[owners]
    along = np.eye(3)[np.abs(normals).argmin(axis=1)]
    tangents = along - (along * normals).sum(axis=1, keepdims=True) * normals
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    areas = np.array([face.area for face in faces])
    return _joints(
        model,
        np.array([(face.a, face.b) for face in faces]),
        counts,
        np.stack([normals, tangents, np.cross(normals, tangents)], axis=1),
        np.concatenate([np.array(face.corners, float) for face in faces]),
        np.multiply.outer((kn, ks), (areas / counts)[owners]),
        np.zeros((len(faces), 1)),
    )


def extruded(model: Model, joints: Joints, depth: float = DEPTH) -> tuple[Model, Joints]:
    """Blocks and joints of the plane as prisms around y = 0: each point becomes two of half its stiffness."""
    up = np.insert(np.eye(2), 1, 0.0, axis=1)  # (x, y) of the plane in space
    loads = [
        np.hstack([values[:, :2] @ up, np.zeros_like(values[:, :1]), -values[:, 2:], np.zeros_like(values[:, :1])])
        for values in (model.dead_loads, model.live_loads)
    ]  # turning from x to z is turning about −y
    spatial = _model(model.centroids @ up, model.fixed, *loads, radii=model.shapes.radii)
    directions = np.repeat(frames(joints.frames, 2) @ up, 2, axis=0)
    directions = np.concatenate([directions, np.cross(directions[:, 0], directions[:, 1])[:, None]], axis=1)
    points = np.repeat(joints.points @ up, 2, axis=0)
    points[:, 1] += depth * np.tile((-0.5, 0.5), len(joints.points))
    stiffness = 0.5 * np.repeat([joints.kn, joints.ks], 2, axis=1)
    return spatial, _joints(
        spatial, joints.blocks, 2 * np.diff(joints.starts), directions, points, stiffness, joints.law
    )


def prism_on(corners: np.ndarray, height: float, area: float = 1.0) -> tuple[list[Solid], list[Face]]:
    """One upright prism of weight one over these corners, on ground at z = 0."""
    middle = (*np.mean(corners, axis=0)[:2], 0.5 * height)
    return [Solid((0.0, 0.0, -1.0), fixed=True), Solid(middle)], [Face(0, 1, (0, 0, 1), corners, area)]


def wedge(half_angle: float) -> tuple[list[Solid], list[Face]]:
    """A long wedge in a groove along x with that half angle [rad]."""
    rise, faces = 0.5 / np.tan(half_angle), []
    for side in (-1.0, 1.0):
        corners = [(x, side * y, z) for x in (-2.0, 2.0) for y, z in ((0.0, 0.0), (0.5, rise))]
        faces.append(Face(0, 1, (0.0, -side * np.cos(half_angle), np.sin(half_angle)), corners))
    return [Solid((0.0, 0.0, -1.0), fixed=True), Solid((0.0, 0.0, 2.0 / 3.0 * rise))], faces


def panel(
    courses: int, per_course: int, block: Sequence[float], offset: float = 0.5, held: float = 0.0
) -> tuple[list[Solid], list[Face]]:
    """A wall of blocks (length, depth, height) on a fixed base, along x and around y = 0.

    offset: of every other course, in blocks; held: length of what it leans on behind (+y) both ends [m].
    """
    length, depth, height = block
    end = per_course * length
    solids, faces = [Solid((0.0, 0.0, -height), fixed=True)], []
    posts = [(0.0, held), (end - held, end)] if held else []
    solids += [Solid((0.5 * (x0 + x1), depth, 0.0), fixed=True) for x0, x1 in posts]
    below = [(0, 0.0, end)]  # number, from, to
    for course in range(courses):
        shift = offset * (course % 2)
        cuts = np.unique(np.clip(length * (np.arange(per_course + 2) - 1.0 + shift), 0.0, end))
        here = [(len(solids) + i, x0, x1) for i, (x0, x1) in enumerate(zip(cuts, [*cuts[1:], end]))]
        here = [(i, x0, x1) for i, x0, x1 in here if x1 > x0]
        z = course * height
        solids += [Solid((0.5 * (x0 + x1), 0.0, z + 0.5 * height), (x1 - x0) / length) for _, x0, x1 in here]
        faces += [Face(a, b, (0, 0, 1), box((x0, x1), depth, (z, z)), (x1 - x0) * depth)
                  for a, b, x0, x1 in shared(below, here)]  # fmt: skip
        faces += [Face(a, b, (1, 0, 0), box((x, x), depth, (z, z + height)), depth * height)
                  for (a, _, x), (b, _, _) in zip(here, here[1:])]  # fmt: skip
        behind = [(k, *post) for k, post in enumerate(posts, start=1)]
        for a, b, x0, x1 in shared(here, behind):
            corners = [(x, 0.5 * depth, h) for x in (x0, x1) for h in (z, z + height)]
            faces.append(Face(a, b, (0, 1, 0), corners, (x1 - x0) * height))
        below = here
    return solids, faces


Span = tuple[int, float, float]  # number of a solid, from, to


def shared(one: Sequence[Span], other: Sequence[Span]) -> list[tuple[int, int, float, float]]:
    """What spans of two rows have in common."""
    pairs = [(a, b, max(a0, b0), min(a1, b1)) for a, a0, a1 in one for b, b0, b1 in other]
    return [pair for pair in pairs if pair[3] - pair[2] > 1e-9]


def box(xs: Sequence[float], depth: float, zs: Sequence[float]) -> np.ndarray:
    """The four corners of a rectangle as deep as that, along x or upright, (4, 3)."""
    return np.array([(x, y, z) for x, z in zip(xs, zs) for y in (-0.5 * depth, 0.5 * depth)])


def turned(solids: Sequence[Solid], faces: Sequence[Face], rotation: np.ndarray) -> tuple[list[Solid], list[Face]]:
    """The same structure turned as a whole; rotation: (3, 3)."""
    return (
        [solid._replace(centroid=rotation @ solid.centroid) for solid in solids],
        [face._replace(normal=rotation @ face.normal, corners=np.array(face.corners) @ rotation.T) for face in faces],
    )


def _model(
    centroids: np.ndarray, fixed: np.ndarray, dead: np.ndarray, live: np.ndarray, radii: np.ndarray | None = None
) -> Model:
    n = len(centroids)
    weights = np.linalg.norm(dead[:, :3], axis=1)
    model = Model(
        dimension=3, block_ids=tuple(f"b{i}" for i in range(n)), material_names=("stone",),
        block_material=np.zeros(n, np.int64), fixed=fixed, thickness=np.ones(n), masses=weights / 9.81,
        inertias=np.ones((n, 3)), centroids=centroids, part_blocks=np.arange(n),
        part_starts=np.zeros(n + 1, np.int64), vertices=np.zeros((0, 3)), dead_loads=dead, live_loads=live,
    )  # fmt: skip
    ones = np.ones(n)
    vars(model)["shapes"] = BlockMeasures(ones, ones, ones, ones if radii is None else radii)
    return model


def _joints(
    model: Model,
    blocks: np.ndarray,
    counts: np.ndarray,
    directions: np.ndarray,
    points: np.ndarray,
    stiffness: np.ndarray,
    law: np.ndarray,
) -> Joints:
    """counts: points of each joint; directions: n, t1, t2 of each point, (n_points, 3, 3)."""
    arms = points[:, None] - model.centroids[np.repeat(blocks, counts, axis=0)]  # (n_points, 2 blocks, 3)
    levers = np.cross(arms[:, :, None], directions[:, None])
    n = len(points)
    return MovingJoints(
        blocks, np.concatenate([[0], np.cumsum(counts)]), directions.reshape(n, 9), levers.reshape(n, 18), points,
        stiffness[0], stiffness[1], law,
    )  # fmt: skip
