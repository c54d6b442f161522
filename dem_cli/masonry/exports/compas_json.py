"""Export blocks as COMPAS JSON: meshes that `compas.json_load` reads, with supports, materials, densities.

As compas 2.15 writes them (compas.datastructures.Mesh.__data__): attributes carry what compas_assembly and compas_dem
call is_support, and name, material and density of the block. A compound is a mesh for each of its parts, of one name;
their attribute compound_parts says how many there are, for dem to read them as one block again.
"""

from __future__ import annotations

import json
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from dem_cli.core.geometry.polyhedron import Polyhedron
from dem_cli.masonry.exports.contents import ExportedBlock, ExportedCase


def compas_json(exported: ExportedCase) -> str:
    """Export the meshes of all parts of all blocks, in metres, z upwards."""
    density = {name: material.density for name, material in exported.case.materials.items()}
    meshes = [
        _mesh(block, part, density[block.material], f"{exported.name}/{block.name}/{k}")
        for block in exported.solids
        for k, part in enumerate(block.parts)
    ]
    return json.dumps(meshes, indent=None, separators=(", ", ": ")) + "\n"


def _mesh(block: ExportedBlock, part: Polyhedron, density: float, path: str) -> dict[str, Any]:
    vertices = {str(k): dict(zip("xyz", corner)) for k, corner in enumerate((part.vertices + 0.0).tolist())}
    faces = {str(k): loop.tolist() for k, loop in enumerate(part.faces)}
    attributes: dict[str, Any] = {"is_support": block.fixed, "material": block.material, "density": density}
    if len(block.parts) > 1:
        attributes["compound_parts"] = len(block.parts)
    return {
        "dtype": "compas.datastructures/Mesh",
        "data": {
            "attributes": attributes,
            "default_vertex_attributes": {"x": 0.0, "y": 0.0, "z": 0.0},
            "default_edge_attributes": {},
            "default_face_attributes": {},
            "vertex": vertices,
            "face": faces,
            "facedata": {key: {} for key in faces},
            "edgedata": {},
            "max_vertex": len(vertices) - 1,
            "max_face": len(faces) - 1,
        },
        "inheritance": [],
        "name": block.name,
        "guid": str(uuid5(NAMESPACE_URL, path)),
    }
