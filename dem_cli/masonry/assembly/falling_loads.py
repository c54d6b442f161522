"""Distribute an axle load at a point or a load along a line to the faces under it, spread through fill.

A load at a point spreads over a disc, one along a line to either side of it: both turn with the structure.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dem_cli.case.wording import show
from dem_cli.core.arithmetic.products import norm, product
from dem_cli.core.geometry import surface_pieces
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import smallest_edge
from dem_cli.errors import KeyPath
from dem_cli.masonry.assembly.exposure import SurfacePiece, Surfaces
from dem_cli.masonry.assembly.point_forces import LOOKS_UP, POINT, AppliedLoad, acts_on_nothing

if TYPE_CHECKING:
    from dem_cli.case.load_tables import Load

ON_IT = 0.01  # of the shortest edge: a load so far below the top of a block is on it (rounded coordinates)
ROUND_OFF = 1e-12  # of the square of a radius: less of a disc lies over no piece
BESIDE = 1e-3  # of a load: so much of it may lie over no block


def falling_load(model: Model, surfaces: Surfaces | None, path: KeyPath, table: Load) -> AppliedLoad:
    """Compute the point forces of a load at a point or along a line on the highest faces under it."""
    assert surfaces is not None  # applied_loads
    key = "at" if table.line is None else "line"
    ends = np.array([table.at, table.at] if table.line is None else table.line)
    blocks = model.chosen(table.selected) if table.selected is not None else np.arange(model.n_blocks)
    edge = smallest_edge(model)
    small, top = POINT * edge, float(ends[:, -1].max()) + ON_IT * edge
    found = _under(surfaces, blocks, top, ends, (0.0, small))
    if not len(found.areas):
        where = "block" if table.selected is None else table.said
        raise acts_on_nothing(path, key, f"there is no {where} under {show(table.at or table.line)}")
    if table.spread:
        depth = float(product(ends.mean(axis=0)[-1] - found.points[:, -1], found.areas) / found.areas.sum())
        found = _under(surfaces, blocks, top, ends, (table.spread * max(depth, 0.0), small))
    force = np.array(table.force if table.line is None else table.force_per_length)
    if table.line is not None:
        length = float(np.hypot.reduce((ends[1] - ends[0])[:-1]))
        over = found.areas.sum() / (2.0 * small) ** (model.dimension - 2) / length if not table.spread else 1.0
        if over < 1.0 - BESIDE:
            message = f"{(1.0 - over) * length:.3g} m of it lie over no block; shorten it, or give spread"
            raise acts_on_nothing(path, key, message)
        force = force * float(norm(ends[1] - ends[0]))
    forces = np.outer(found.areas / found.areas.sum(), force)
    return AppliedLoad(path, table.kind == "dead", found.blocks, found.points, forces, np.zeros(len(forces)))


class _Carried(NamedTuple):
    """Points and areas of blocks over which a load uniform in plan is distributed."""

    blocks: np.ndarray  # (n,)
    points: np.ndarray  # (n, d) [m]
    areas: np.ndarray  # seen from above (n,) [m^(d-1)]


def _under(
    surfaces: Surfaces, blocks: np.ndarray, top: float, ends: np.ndarray, reach: tuple[float, float]
) -> _Carried:
    """Find the highest faces of some blocks below a height [m] around a point or line (2, d), cut to the loaded strip.

    reach: how far a load spreads to each side, and what it is wide at least [m].
    """
    strip = _strip(ends, reach[1], reach[0])
    normals = np.vstack([strip[0], np.eye(strip[0].shape[1])[-1]])
    offsets = np.append(strip[1], top)
    looking_up = (surfaces.normals[:, -1] > LOOKS_UP) & surfaces.near(normals, offsets)
    cut = [
        piece._replace(corners=surface_pieces.inside(piece.corners, normals, offsets), least=0.0)
        for piece in surfaces.exposed(blocks, looking_up)
    ]
    cut = surfaces.open_above([piece for piece in cut if surface_pieces.measure(piece.corners) > 0.0], top, blocks)
    if ends.shape[1] == 3 and (ends[0] == ends[1]).all():
        return _on_disc(cut, ends[0, :-1], max(reach))
    return _quadrature(cut, ends.shape[1])


def _strip(ends: np.ndarray, small: float, wider: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return upright half-spaces around a point or line (2, d): `wider` to each side, `small` across at least [m].

    Around a point in space a square, in which the disc lies that counts.
    """
    flat = ends[:, :-1]
    way = flat[1] - flat[0]
    length = np.hypot.reduce(way)
    along = way / length if length > 0.0 else np.eye(len(way))[0]
    axes = [along] if len(way) == 1 else [along, np.array([-along[1], along[0]])]
    normals, offsets = [], []
    for k, axis in enumerate(axes):
        reach = max(wider, small if length == 0.0 or k else 0.0)
        heights = product(flat, axis)
        normals += [np.append(axis, 0.0), np.append(-axis, 0.0)]
        offsets += [heights.max() + reach, reach - heights.min()]
    return np.array(normals), np.array(offsets)


def _quadrature(pieces: Sequence[SurfacePiece], dimension: int) -> _Carried:
    """Integrate over pieces of faces at points that are exact for linear functions."""
    blocks, points, areas = list[int](), [np.empty((0, dimension))], [np.empty(0)]
    for piece in pieces:
        places, weights = surface_pieces.quadrature(piece.corners)
        blocks += [piece.block] * len(places)
        points.append(places)
        areas.append(weights * piece.normal[-1])
    return _Carried(np.array(blocks, np.int64), np.concatenate(points), np.concatenate(areas))


def _on_disc(pieces: Sequence[SurfacePiece], centre: np.ndarray, radius: float) -> _Carried:
    """Return the area and centroid of each piece within a disc, seen from above."""
    found = [(piece.block, *surface_pieces.over_disc(piece.corners, centre, radius)) for piece in pieces]
    found = [each for each in found if each[1] > ROUND_OFF * radius**2]
    blocks, areas, points = ([each[k] for each in found] for k in range(3))
    return _Carried(np.array(blocks, np.int64), np.array(points), np.array(areas))
