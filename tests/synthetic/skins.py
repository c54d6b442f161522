"""Outside of a structure: area of all faces less, twice, that of the joints; what is left is in the open."""

from __future__ import annotations

from typing import Any

import numpy as np
from shapely.geometry import Polygon

from dem_cli.core.contact.between import StartJoints
from dem_cli.core.geometry.polyhedron import newell
from dem_cli.core.geometry.rotation import beside
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.validate import problems
from synthetic.spatial_case import spatial_case


def model_of(*structures: dict[str, Any], **tables: Any) -> Model:
    """The model of structures in 3D, without a problem of their geometry."""
    case = spatial_case(structure=list(structures), **tables)
    made = assembly(case)
    found = [str(problem.message) for problem in problems(case, made.model, made.blocks)]
    assert [message for message in found if "no block is fixed" not in message] == []
    return made.model


def open_area(model: Model) -> float:
    """Area of all faces that no other block touches and that do not lie within a compound [m²].

    What pairs of blocks share is found apart, by shapely; the joints of the model must cover all of it.
    """
    faces = loops_of(model)
    own = sum(float(np.linalg.norm(newell(loop))) for _, _, loop in faces)
    shared, joints = _between_blocks(faces), StartJoints(model).faces
    areas: dict[tuple[int, int], float] = {}
    for pair, area in zip(np.sort(joints.blocks, axis=1).tolist(), joints.areas.tolist(), strict=True):
        areas[tuple(pair)] = areas.get(tuple(pair), 0.0) + area
    for pair, area in shared.items():
        if not model.fixed[list(pair)].all():
            assert areas.get(pair, 0.0) > area * (1.0 - 1e-9) - 1e-12, [model.block_ids[i] for i in pair]
    return own - 2.0 * sum(shared.values()) - 2.0 * _within_compounds(faces)


def _between_blocks(faces: list[tuple[int, int, np.ndarray]]) -> dict[tuple[int, int], float]:
    """Area that each pair of blocks shares [m²]."""
    boxes = np.array([[loop.min(axis=0) - 1e-9, loop.max(axis=0) + 1e-9] for _, _, loop in faces])
    areas = np.array([newell(loop) for _, _, loop in faces])
    normals = areas / np.linalg.norm(areas, axis=1)[:, None]
    found: dict[tuple[int, int], float] = {}
    for i, (block, _, loop) in enumerate(faces):
        near = normals[:i] @ normals[i] < -0.999999
        near &= (boxes[:i, 0] <= boxes[i, 1]).all(axis=1) & (boxes[:i, 1] >= boxes[i, 0]).all(axis=1)
        for k in np.flatnonzero(near).tolist():
            other = faces[k]
            if other[0] != block and (area := _shared(loop, other[2])):
                pair = (min(block, other[0]), max(block, other[0]))
                found[pair] = found.get(pair, 0.0) + area
    return found


def loops_of(model: Model) -> list[tuple[int, int, np.ndarray]]:
    """Block, part and corners in place of every face."""
    corners, topology = undeformed(model), model.topology
    return [
        (int(model.part_blocks[part]), int(part), corners[topology.face_corners[start:end]])
        for part, start, end in zip(
            topology.face_parts, topology.face_starts[:-1], topology.face_starts[1:], strict=True
        )
    ]


def _within_compounds(faces: list[tuple[int, int, np.ndarray]]) -> float:
    """Area in which parts of one block touch [m²], by shapely."""
    blocks: dict[int, list[tuple[int, np.ndarray]]] = {}
    for block, part, loop in faces:
        blocks.setdefault(block, []).append((part, loop))
    return sum(
        _shared(loop, other)
        for own in blocks.values()
        for i, (part, loop) in enumerate(own)
        for other_part, other in own[:i]
        if other_part != part
    )


def _shared(one: np.ndarray, other: np.ndarray) -> float:
    """Area that two faces which look at each other in one plane have in common [m²]."""
    area = newell(one)
    normal = area / np.linalg.norm(area)
    against = newell(other)
    if against @ normal > -0.999999 * np.linalg.norm(against) or np.abs((other - one[0]) @ normal).max() > 1e-9:
        return 0.0
    first = beside(normal[None])[0]
    axes = np.column_stack([first, np.cross(normal, first)])
    return Polygon(one @ axes).intersection(Polygon(other @ axes)).area


def free_volume(model: Model) -> float:
    """Volume of all blocks that can move [m³]."""
    return float(model.shapes.volumes[~model.fixed].sum())
