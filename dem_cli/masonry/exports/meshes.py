"""Export blocks as named meshes: OBJ with an object for each block, STL with a solid for each."""

from __future__ import annotations

import numpy as np

from dem_cli.masonry.exports.contents import ExportedCase, triangles, triple


def obj(exported: ExportedCase) -> str:
    """Write Wavefront OBJ, z upwards, in metres; parts of a compound are groups of its object."""
    lines = [f"# {exported.name}: {len(exported.solids)} blocks, metres, z upwards"]
    first = 1
    for block in exported.solids:
        lines += [f"o {block.name}", f"usemtl {block.material}"]
        for k, part in enumerate(block.parts, 1):
            lines += [f"g {block.name}-part-{k}"] if len(block.parts) > 1 else []
            lines += [f"v {triple(corner)}" for corner in part.vertices]
            lines += ["f " + " ".join(str(first + int(k)) for k in loop) for loop in part.faces]
            first += len(part.vertices)
    return "\n".join(lines) + "\n"


def stl(exported: ExportedCase) -> str:
    """Write ASCII STL, z upwards, in metres."""
    lines = []
    for block in exported.solids:
        lines.append(f"solid {block.name}")
        for part in block.parts:
            for corners in part.vertices[triangles(part)]:
                area = np.cross(corners[1] - corners[0], corners[2] - corners[0])
                lines += [f"facet normal {triple(area / np.linalg.norm(area))}", "outer loop"]
                lines += [f"vertex {triple(corner)}" for corner in corners]
                lines += ["endloop", "endfacet"]
        lines.append(f"endsolid {block.name}")
    return "\n".join(lines) + "\n"
