"""Distances of points from outlines of joints: lines between two places, and plane convex polygons in space."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry.polygon import following


def away_from(
    points: np.ndarray, which: np.ndarray, places: np.ndarray, starts: np.ndarray, normals: np.ndarray
) -> np.ndarray:
    """Compute the distance of each point (n, d) from the outline `which` (n,) [m], (n,).

    Outline j has the places starts[j]:starts[j + 1]: one or two of them are a line, more the corners of a polygon in
    space, counter-clockwise about its normal. Of points beside a polygon the distance from the line of its furthest
    side counts.
    """
    found = _from_lines(points, places[starts[which]], places[starts[which + 1] - 1])
    wide = np.flatnonzero(np.diff(starts)[which] > 2)
    if len(wide):
        found[wide] = _from_polygons(points[wide], which[wide], places, starts, normals)
    return found


def furthest(places: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Find the two places of each outline that are furthest from each other, (n, 2)."""
    counts, found = np.diff(starts), np.empty((len(starts) - 1, 2), np.int64)
    for count in np.unique(counts):
        joints = np.flatnonzero(counts == count)
        first = starts[joints]
        corners = places[first[:, np.newaxis] + np.arange(count)]
        apart = ((corners[:, :, np.newaxis] - corners[:, np.newaxis]) ** 2).sum(axis=3).reshape(len(joints), -1)
        pairs = np.stack(np.divmod(apart.argmax(axis=1), count), axis=1)
        found[joints] = first[:, np.newaxis] + np.sort(pairs, axis=1)
    return found


def _from_lines(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    along = end - start
    share = ((points - start) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    nearest = start + np.clip(share, 0.0, 1.0)[:, np.newaxis] * along
    return np.hypot.reduce(points - nearest, axis=1)


def _from_polygons(
    points: np.ndarray, which: np.ndarray, places: np.ndarray, starts: np.ndarray, normals: np.ndarray
) -> np.ndarray:
    counts = np.diff(starts)[which]
    upto = np.concatenate([[0], np.cumsum(counts)])
    point = np.repeat(np.arange(len(points)), counts)
    side = starts[which][point] + np.arange(upto[-1]) - upto[point]
    along = places[following(starts)[side]] - places[side]
    outwards = np.cross(along, normals[which][point])
    lengths = np.maximum(np.linalg.norm(outwards, axis=1), np.finfo(float).tiny)
    arms = points[point] - places[side]
    beside = np.maximum.reduceat((arms * outwards).sum(axis=1) / lengths, upto[:-1])
    over = (arms[upto[:-1]] * normals[which]).sum(axis=1)
    return np.hypot(np.maximum(beside, 0.0), over)
