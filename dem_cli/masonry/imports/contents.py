"""Contents of a geometry file: blocks as corners and faces, or as outlines, with their names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from dem_cli.errors import CONTROLS, printable
from dem_cli.input_limits import DRAWING_BYTES, MOST_BLOCKS, MOST_CORNERS, MOST_FACES, MOST_SHAPES, what_else

UNITS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}


class FileProblem(ValueError):
    """Error of a geometry file that cannot be read or contains no blocks: one message, without the file name."""

    def __init__(self, message: str):
        """Escape what names of a damaged file hold and no message can."""
        super().__init__(printable(" ".join(message.split())))


class FileBody(NamedTuple):
    """Body of a geometry file: surfaces of one or several solids, or the outline of one polygon.

    points   corners [units of the file], (n, 3), of an outline (n, 2)
    faces    of each face the numbers of its corners; none: an outline, the corners one after the other
    indexed  whether faces that meet share the numbers of their corners; triangles of an STL file never do
    """

    name: str
    points: np.ndarray
    faces: tuple[np.ndarray, ...] = ()
    layer: str = ""  # material of an OBJ file, layer of a DXF file, group of an SVG file; "": the file has none
    fixed: bool = False
    indexed: bool = True
    said: str = ""  # how a drawing calls it: kind and handle of an entity (DXF), id (SVG)
    compound: bool = False  # the file says that its solids, and those of the same name, are parts of one block


class Contents(NamedTuple):
    """All bodies of a geometry file in its order."""

    bodies: Sequence[FileBody]
    unit: str = ""  # of lengths, where the file says it
    left_out: Sequence[str] = ()  # what the file holds beside blocks, in words such as "3 TEXT"
    densities: Mapping[str, float] = MappingProxyType({})  # of layers, where the file says them [kg/m3]
    layers: Sequence[str] = ()  # of a drawing: those on which anything is drawn


def check_file(path: Path) -> None:
    """Raise FileProblem for a path that is no file or a file that is too large; OSError where it does not exist."""
    if not path.is_file():
        path.stat()
        raise FileProblem(f"is {what_else(path)}; a drawing or mesh is a file")
    size = path.stat().st_size
    if size > DRAWING_BYTES:
        raise FileProblem(f"has {size / 1e6:,.0f} MB; at most {DRAWING_BYTES / 1e6:,.0f} MB are read")


def check_shapes(bodies: Sequence[FileBody]) -> None:
    """Raise FileProblem for too many blocks, too many corners, or a name that cannot be shown."""
    if len(bodies) > MOST_BLOCKS:
        raise FileProblem(f"it holds {len(bodies):,} shapes; at most {MOST_BLOCKS:,} are read")
    faces = sum(len(body.faces) for body in bodies)
    if faces > MOST_FACES:
        raise FileProblem(f"it holds {faces:,} faces; at most {MOST_FACES:,} are read")
    for number, body in enumerate(bodies, 1):
        for name in (body.name, body.layer, body.said):
            if CONTROLS.search(name) or "\n" in name:
                raise FileProblem(f"the name {name!a} has control characters, which no name may have")
        named = f"'{body.name}'" if body.name else body.said or f"shape {number}"
        check_corners(named, max(map(len, body.faces)) if body.faces else len(body.points))


def check_corners(named: str, count: int) -> None:
    """Raise FileProblem where an outline, a face or a solid has too many corners."""
    if count > MOST_CORNERS:
        raise FileProblem(f"{named} has {count:,} corners; outlines, faces and solids have at most {MOST_CORNERS:,}")


def written_out(root: str, parts: Callable[[str], Iterable[tuple[str | None, int]]]) -> int:
    """Count the shapes of a drawing after its references to parts are expanded.

    parts: of a name, what it consists of: (None, n) are n shapes, (name, n) is another part n times. Raises
    FileProblem: a part holds itself, or there are too many.
    """
    counts: dict[str, int] = {}
    begun: list[str] = []

    def count(name: str) -> int:
        if name in begun:
            raise FileProblem(
                f"'{name}' refers to itself, by way of {len(begun) - begun.index(name)} parts; it has no end"
            )
        if name not in counts:
            begun.append(name)
            counts[name] = sum(n * (1 if inner is None else count(inner)) for inner, n in parts(name))
            begun.pop()
            if counts[name] > MOST_SHAPES:
                raise FileProblem(
                    f"it draws {counts[name]:,} shapes, all that it repeats; at most {MOST_SHAPES:,} are read"
                )
        return counts[name]

    try:
        return count(root)
    except RecursionError:
        raise FileProblem(f"its parts refer to each other over {len(begun)} levels; that is too many") from None


def unit_of(contents: Contents, given: str | None) -> str:
    """Return the unit of length: given in the case, else stated by the file, else m. Raises FileProblem."""
    found = given or contents.unit or "m"
    if found not in UNITS:
        raise FileProblem(f"its lengths are in {found}, which are not read; give unit, one of {', '.join(UNITS)}")
    return found


def finite(points: Sequence | np.ndarray, what: str) -> np.ndarray:
    """Convert points to an array; raises FileProblem where one is not finite."""
    found = np.asarray(points, float)
    bad = ~np.isfinite(found).all(axis=-1)
    if bad.any():
        k = int(np.flatnonzero(bad)[0])
        raise FileProblem(f"{what}: corner {k + 1} is not finite, {found[k].tolist()}")
    return found
