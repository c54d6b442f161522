"""Bodies of blocks: from their convex parts to the arrays of a model, with masses and inertias, by dimension."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.geometry import polygon, solids
from dem_cli.core.geometry.polyhedron import Polyhedron
from dem_cli.core.geometry.topology import topology_of_polyhedra
from dem_cli.core.model.model import NO_AXES, NONE


class BodyArrays(NamedTuple):
    """Fields of Model that follow from shapes and densities: Model(**bodies._asdict(), ...)."""

    dimension: int
    masses: np.ndarray
    inertias: np.ndarray
    centroids: np.ndarray
    part_blocks: np.ndarray
    part_starts: np.ndarray
    vertices: np.ndarray
    part_faces: np.ndarray = NONE
    face_starts: np.ndarray = NONE
    face_corners: np.ndarray = NONE
    principal_axes: np.ndarray = NO_AXES


def bodies_of(
    dimension: int, blocks: Sequence[Sequence[Any]], densities: np.ndarray, thickness: np.ndarray
) -> BodyArrays:
    """Build the bodies of blocks, each from its parts (model.blocks.Block.parts).

    densities: [kg/m3], (n_blocks,); thickness: depth out of plane [m], (n_blocks,), in space 1.
    """
    return BUILDERS[dimension](blocks, densities, thickness)


def planar_bodies(blocks: Sequence[Sequence[np.ndarray]], densities: np.ndarray, thickness: np.ndarray) -> BodyArrays:
    """Build the bodies of blocks of polygons (n, 2), counter-clockwise."""
    part_blocks, part_starts, vertices, vertex_blocks = _corners(blocks, [part for parts in blocks for part in parts])
    areas = polygon.compound(polygon.properties_of_all(vertices, part_starts), part_blocks, len(blocks))
    return BodyArrays(
        dimension=2,
        masses=densities * thickness * areas.area,
        inertias=(densities * thickness * areas.polar_moment)[:, None],
        centroids=areas.centroid,
        part_blocks=part_blocks,
        part_starts=part_starts,
        vertices=vertices - areas.centroid[vertex_blocks],
    )


def spatial_bodies(
    blocks: Sequence[Sequence[Polyhedron]], densities: np.ndarray, thickness: np.ndarray | float = 1.0
) -> BodyArrays:
    """Build the bodies of blocks of polyhedra; they keep the axes of the world, with principal axes beside them."""
    parts = [part for of_block in blocks for part in of_block]
    part_blocks, part_starts, vertices, vertex_blocks = _corners(blocks, [part.vertices for part in parts])
    topology = topology_of_polyhedra(parts)
    volumes = solids.compound(solids.properties_of_all(vertices, part_starts, topology), part_blocks, len(blocks))
    moments, axes = solids.principal(solids.inertia_tensors(volumes.second_moments))
    return BodyArrays(
        dimension=3,
        masses=densities * thickness * volumes.volume,
        inertias=(densities * thickness)[:, None] * moments,
        centroids=volumes.centroid,
        part_blocks=part_blocks,
        part_starts=part_starts,
        vertices=vertices - volumes.centroid[vertex_blocks],
        part_faces=topology.part_faces,
        face_starts=topology.face_starts,
        face_corners=topology.face_corners,
        principal_axes=axes,
    )


BUILDERS: dict[int, Callable[..., BodyArrays]] = {2: planar_bodies, 3: spatial_bodies}


def _corners(
    blocks: Sequence[Sequence[Any]], parts: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Block of each part, first corner of each part, all corners [m], and the block of each corner."""
    part_blocks = np.repeat(np.arange(len(blocks)), [len(of_block) for of_block in blocks]).astype(np.int64)
    counts = [len(part) for part in parts]
    part_starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    return part_blocks, part_starts, np.concatenate(parts), np.repeat(part_blocks, counts)
