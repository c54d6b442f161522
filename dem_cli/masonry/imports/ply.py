"""Import PLY files (Stanford polygon format, meshio) as one body; its solids share no corners."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dem_cli.masonry.imports.contents import Contents, FileBody, FileProblem, finite

HEADER = 1 << 16  # bytes


def read(path: Path) -> Contents:
    """Read the surface of a PLY file. Raises FileProblem."""
    from meshio import ply

    if b"end_header" not in path.read_bytes()[:HEADER]:  # meshio would look for it without end
        raise FileProblem("not a PLY file that can be read (its header has no end)")
    try:
        mesh = ply.read(path)
    except (Exception, SystemExit) as error:  # of meshio: whatever its reader stumbles over, and its own exit
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise FileProblem(f"not a PLY file that can be read ({reason})") from None
    faces = [
        np.asarray(loop, np.int64)
        for block in mesh.cells
        for loop in block.data
        if block.type in ("triangle", "quad", "polygon")
    ]
    points = finite(np.asarray(mesh.points, float), "the surface")
    if any(len(loop) < 3 for loop in faces):
        raise FileProblem("a face with fewer than 3 corners")
    if faces and (max(map(np.max, faces)) >= len(points) or min(map(np.min, faces)) < 0):
        raise FileProblem(f"a face names a corner that does not exist; there are {len(points)}")
    return Contents([FileBody("", points, tuple(faces))] if faces else [])
