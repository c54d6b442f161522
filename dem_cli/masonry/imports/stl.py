"""Import STL files, ASCII or binary: each solid of an ASCII file is a body of separate triangles.

Read here because meshio loses the names of solids and trimesh takes a truncated file without a word. Source: 3D
Systems, Stereolithography Interface Specification, 1988; a file that says "solid" may still be binary: its size tells.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dem_cli.masonry.imports.contents import Contents, FileBody, FileProblem, finite

HEADER, PER_TRIANGLE = 84, 50  # bytes
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def read(path: Path) -> Contents:
    """Read the solids of an STL file. Raises FileProblem."""
    raw = path.read_bytes()
    count = int.from_bytes(raw[80:HEADER], "little") if len(raw) >= HEADER else 0
    if len(raw) >= HEADER and len(raw) == HEADER + PER_TRIANGLE * count:
        return Contents([_body("", _binary(raw, count))] if count else [])
    if raw[:256].lstrip()[:5].lower() == b"solid" and b"\0" not in raw:
        return Contents(_ascii(raw.decode("utf-8", errors="replace")))
    if len(raw) < HEADER:
        raise FileProblem(f"{len(raw)} bytes, too short for an STL file")
    room = (len(raw) - HEADER) // PER_TRIANGLE
    raise FileProblem(f"the header says {count:,} triangles, the file has room for {room:,}: it is not whole")


def _binary(raw: bytes, count: int) -> np.ndarray:
    return np.frombuffer(raw, _RECORD, count, HEADER)["corners"].astype(float).reshape(-1, 3)


def _ascii(text: str) -> list[FileBody]:
    """Parse the solids of an ASCII STL file, those without triangles left out."""
    found: list[FileBody] = []
    name, inside, number = "", False, 0
    corners: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        key = words[0].lower() if words else ""
        if key == "solid":
            if inside:
                raise FileProblem(f"line {number}: a solid begins before '{name or 'the one above'}' has an end")
            name, corners, inside = " ".join(words[1:]), [], True
        elif key == "vertex":
            corners.append(_corner(words, number))
        elif key == "endfacet" and len(corners) % 3:
            raise FileProblem(f"line {number}: a facet with {len(corners) % 3 or 3} corners; it has 3")
        elif key == "endsolid":
            inside = False
            found += [_body(name, np.array(corners, float))] if corners else []
    if inside:
        raise FileProblem(f"it ends at line {number} within solid '{name}': the file is not whole")
    return found


def _corner(words: list[str], number: int) -> list[float]:
    try:
        found = [float(word) for word in words[1:]]
    except ValueError:
        found = []
    if len(found) != 3:
        raise FileProblem(f"line {number}: '{' '.join(words[:5])}' is not three coordinates")
    return found


def _body(name: str, corners: np.ndarray) -> FileBody:
    finite(corners, f"solid '{name}'" if name else "the solid")
    faces = np.arange(len(corners)).reshape(-1, 3)
    return FileBody(name, corners, tuple(faces), indexed=False)
