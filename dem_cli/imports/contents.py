"""Contents of a geometry file: blocks as corners and faces, or as outlines, with the names that the file gives them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

UNITS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}


class FileProblem(ValueError):
    """A geometry file that cannot be read, or holds no blocks: one message, without the name of the file."""


class FileBody(NamedTuple):
    """What a file has under one name: surfaces of one or several solids, or the outline of one polygon.

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
    """All bodies of a file in its order."""

    bodies: Sequence[FileBody]
    unit: str = ""  # of lengths, where the file says it
    left_out: Sequence[str] = ()  # what the file holds beside blocks, in words such as "3 TEXT"
    densities: Mapping[str, float] = MappingProxyType({})  # of layers, where the file says them [kg/m3]
    layers: Sequence[str] = ()  # of a drawing: those on which anything is drawn


def unit_of(contents: Contents, given: str | None) -> str:
    """The unit of lengths: given in the case, else what the file says, else m. Raises FileProblem: one of others."""
    found = given or contents.unit or "m"
    if found not in UNITS:
        raise FileProblem(f"its lengths are in {found}, which are not read; give unit, one of {', '.join(UNITS)}")
    return found


def finite(points: Sequence | np.ndarray, what: str) -> np.ndarray:
    """Points as an array; raises FileProblem where one is not a number."""
    found = np.asarray(points, float)
    bad = ~np.isfinite(found).all(axis=-1)
    if bad.any():
        k = int(np.flatnonzero(bad)[0])
        raise FileProblem(f"{what}: corner {k + 1} is not finite, {found[k].tolist()}")
    return found
