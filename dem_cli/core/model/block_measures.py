"""Measures of block shapes: volume, narrowest width, shortest edge, radius; scales and tolerances use them.

Of parts and of blocks apart: those of parts are what the checks of a case need before they know whether it is sound.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dem_cli.core.geometry import parts
from dem_cli.core.geometry.parts import shapes_of
from dem_cli.core.geometry.solids import face_areas, unit_vectors
from dem_cli.core.geometry.topology import Topology


class PartMeasures(NamedTuple):
    """Volumes and sizes of each convex part."""

    volumes: np.ndarray  # in the plane areas, negative where corners run clockwise [m^d], (n_parts,)
    sizes: np.ndarray  # diagonals of the boxes around them [m], (n_parts,)


class BlockMeasures(NamedTuple):
    """Volumes, widths, shortest edges and radii of each block."""

    volumes: np.ndarray  # in the plane areas [m^d], (n_blocks,)
    widths: np.ndarray  # about the smallest side, of the narrowest part (geometry/parts.py) [m], (n_blocks,)
    edges: np.ndarray  # length of the shortest edge [m], (n_blocks,)
    radii: np.ndarray  # largest distance of a corner from the centroid [m], (n_blocks,)


class FaceMeasures(NamedTuple):
    """Areas, normals and sides of each face of a part in space, in the frame of its block."""

    areas: np.ndarray  # [m²], (n_faces,)
    normals: np.ndarray  # unit, outwards, (n_faces, 3)
    first_sides: np.ndarray  # unit, along the first side, (n_faces, 3)
    shortest_sides: np.ndarray  # [m], (n_faces,)
    typical_areas: np.ndarray  # median of each part [m²], (n_parts,)


def face_measures(vertices: np.ndarray, topology: Topology) -> FaceMeasures:
    """Compute areas, normals and sides of faces of polyhedra, with corners as in Model."""
    vectors = face_areas(vertices, topology)
    areas = np.linalg.norm(vectors, axis=1)
    start, end = vertices[topology.sides[:, :2]].swapaxes(0, 1)
    lengths, first = np.linalg.norm(end - start, axis=1), topology.face_starts[:-1]
    sides = unit_vectors((end - start)[first], lengths[first])
    typical = np.array([median(own) for own in np.split(areas, topology.part_faces[1:-1])])
    return FaceMeasures(areas, unit_vectors(vectors, areas), sides, np.minimum.reduceat(lengths, first), typical)


def part_measures(vertices: np.ndarray, part_starts: np.ndarray, topology: Topology) -> PartMeasures:
    """Compute volumes and sizes of parts, with corners as in Model."""
    volumes = shapes_of(vertices).volumes(vertices, part_starts, topology)
    return PartMeasures(volumes, parts.sizes(vertices, part_starts))


def block_measures(
    vertices: np.ndarray, part_starts: np.ndarray, topology: Topology, part_blocks: np.ndarray, of_parts: PartMeasures
) -> BlockMeasures:
    """Compute volumes, widths, shortest edges and radii of blocks, with corners from their centroids as in Model."""
    n, shapes = int(part_blocks[-1]) + 1 if len(part_blocks) else 0, shapes_of(vertices)
    ends, edge_parts = shapes.edges(topology)
    start, end = vertices[ends].swapaxes(0, 1)
    widths, edges, radii = np.full(n, np.inf), np.full(n, np.inf), np.zeros(n)
    np.minimum.at(widths, part_blocks, shapes.widths(vertices, part_starts, topology))
    np.minimum.at(edges, part_blocks[edge_parts], np.sqrt(((end - start) ** 2).sum(axis=1)))
    np.maximum.at(radii, np.repeat(part_blocks, np.diff(part_starts)), np.sqrt((vertices**2).sum(axis=1)))
    return BlockMeasures(np.bincount(part_blocks, of_parts.volumes, n), widths, edges, radii)


def half_extents(
    vertices: np.ndarray, vertex_blocks: np.ndarray, topology: Topology, part_blocks: np.ndarray
) -> np.ndarray:
    """Half of how far the block of each face reaches along its normal [m], (n_faces,); corners as in Model."""
    normals, blocks = shapes_of(vertices).normals(vertices, topology), part_blocks[topology.face_parts]
    order = np.argsort(vertex_blocks, kind="stable")
    counts = np.bincount(vertex_blocks, minlength=int(part_blocks[-1]) + 1)
    first = np.cumsum(counts) - counts
    starts = np.cumsum(counts[blocks]) - counts[blocks]
    inside = np.arange(counts[blocks].sum()) - np.repeat(starts, counts[blocks])
    corners = vertices[order[np.repeat(first[blocks], counts[blocks]) + inside]]
    along = (corners * np.repeat(normals, counts[blocks], axis=0)).sum(axis=1)
    return 0.5 * (np.maximum.reduceat(along, starts) - np.minimum.reduceat(along, starts))


def median(values: np.ndarray) -> float:
    """Compute the median of at least one value; numpy's own loads its masked arrays first, 30 ms."""
    ordered, half = np.sort(values), (len(values) - 1) / 2
    return float(ordered[[math.floor(half), math.ceil(half)]].mean())
