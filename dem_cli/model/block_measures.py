"""Measures of the shapes of blocks: volume, narrowest width, shortest edge, radius; what scales and tolerances ask for.

Of parts and of blocks apart: those of parts are what the checks of a case need before they know whether it is sound.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dem_cli.geometry import polygon
from dem_cli.geometry.topology import Topology


class PartMeasures(NamedTuple):
    """Of each convex part."""

    volumes: np.ndarray  # in the plane areas, negative where corners run clockwise [m^d], (n_parts,)
    sizes: np.ndarray  # diagonals of the boxes around them [m], (n_parts,)


class BlockMeasures(NamedTuple):
    """Of each block."""

    volumes: np.ndarray  # in the plane areas [m^d], (n_blocks,)
    widths: np.ndarray  # about the smaller side: volume over largest extent of the narrowest part [m], (n_blocks,)
    edges: np.ndarray  # length of the shortest edge [m], (n_blocks,)
    radii: np.ndarray  # largest distance of a corner from the centroid [m], (n_blocks,)


def part_measures(vertices: np.ndarray, part_starts: np.ndarray) -> PartMeasures:
    """Of parts in the plane, with corners as in Model."""
    return PartMeasures(polygon.properties_of_all(vertices, part_starts).area, polygon.sizes(vertices, part_starts))


def block_measures(
    vertices: np.ndarray, topology: Topology, part_blocks: np.ndarray, vertex_blocks: np.ndarray, parts: PartMeasures
) -> BlockMeasures:
    """Of blocks in the plane, with corners from their centroids as in Model."""
    n = int(part_blocks[-1]) + 1 if len(part_blocks) else 0
    start, end = vertices[topology.ends].swapaxes(0, 1)
    widths, edges, radii = np.full(n, np.inf), np.full(n, np.inf), np.zeros(n)
    np.minimum.at(widths, part_blocks, parts.volumes / parts.sizes)
    np.minimum.at(edges, part_blocks[topology.face_parts], np.sqrt(((end - start) ** 2).sum(axis=1)))
    np.maximum.at(radii, vertex_blocks, np.sqrt((vertices**2).sum(axis=1)))
    return BlockMeasures(np.bincount(part_blocks, parts.volumes, n), widths, edges, radii)
