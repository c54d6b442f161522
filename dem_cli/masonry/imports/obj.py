"""Import Wavefront OBJ files: objects (o) and groups (g) are blocks, usemtl names their material.

An object NAME whose faces all stand in groups NAME-part-1, NAME-part-2, ... is a compound, as dem writes them.
Read here because meshio and trimesh lose names, or take what is broken without a word. Source: Wavefront, Object Files
(.obj), Advanced Visualizer manual, appendix B1. Lines that draw nothing that has a volume are left out.
"""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

import numpy as np

from dem_cli.masonry.imports.contents import Contents, FileBody, FileProblem, check_corners

QUIET = {"vn", "vt", "vp", "s", "mtllib", "usemap", "maplib", "lod", "bevel", "c_interp", "d_interp", "shadow_obj"}
CURVED = {"curv", "curv2", "surf", "cstype", "parm", "trim", "hole", "bmat"}


class _NamedFaces:
    """Faces of an OBJ file below one o or g line."""

    def __init__(self, name: str):
        self.name = name
        self.loops: list[list[int]] = []
        self.materials: Counter[str] = Counter()
        self.groups: set[str] = set()

    @property
    def compound(self) -> bool:
        """Test whether the groups of an object are named as parts of one block, as exports/meshes.py names them."""
        return len(self.groups) > 1 and self.groups == {f"{self.name}-part-{k + 1}" for k in range(len(self.groups))}


def read(path: Path) -> Contents:
    """Read the objects of an OBJ file, or its groups where it has no objects. Raises FileProblem."""
    points: list[list[float]] = []
    objects = [_NamedFaces("")]
    groups = [_NamedFaces("")]
    material = ""
    left_out: Counter[str] = Counter()
    for number, words in _lines(path):
        key, rest = words[0], words[1:]
        if key == "v":
            points.append(_point(rest, number))
        elif key in ("o", "g"):
            (objects if key == "o" else groups).append(_NamedFaces(" ".join(rest)))
            if key == "o":
                groups.append(_NamedFaces(""))
        elif key == "usemtl":
            material = " ".join(rest)
        elif key == "f":
            loop = _loop(rest, len(points), number)
            for kept in (objects[-1], groups[-1]):
                kept.loops.append(loop)
                kept.materials[material] += 1
                kept.groups.add(groups[-1].name)
        elif key in CURVED:
            raise FileProblem(f"line {number}: '{key}': curved surfaces are not read; export it as a mesh")
        elif key not in QUIET:
            left_out[key] += 1
    chosen = objects if any(body.name and body.loops for body in objects) else groups
    places = np.array(points, float).reshape(-1, 3)
    bodies = [_body(each, places) for each in _together(chosen)]
    return Contents(bodies, left_out=[f"{count} '{key}' lines" for key, count in left_out.items()])


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    """Split each line of a file into words with its line number; a backslash joins lines."""
    found: list[tuple[int, list[str]]] = []
    waiting: list[str] = []
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
        words = line.partition("#")[0].split()
        if words and words[-1] == "\\":
            waiting += words[:-1]
            continue
        if waiting + words:
            found.append((number, waiting + words))
        waiting = []
    return found


def _point(words: list[str], number: int) -> list[float]:
    try:
        found = [float(word) for word in words[:3]]
    except ValueError:
        found = []
    if len(found) != 3 or not all(map(math.isfinite, found)):
        raise FileProblem(f"line {number}: 'v {' '.join(words[:4])}' is not three finite coordinates")
    return found


def _loop(words: list[str], n_points: int, number: int) -> list[int]:
    """Parse the corner numbers of a face, counted from 0; the file counts from 1, or back from the last one."""
    check_corners(f"line {number}: a face", len(words))
    found = []
    for word in words:
        try:
            k = int(word.partition("/")[0])
        except ValueError:
            raise FileProblem(f"line {number}: '{word}' is not the number of a corner") from None
        k = k - 1 if k > 0 else n_points + k
        if not 0 <= k < n_points:
            raise FileProblem(f"line {number}: a face names corner {word}; there are {n_points} so far")
        found.append(k)
    if len(found) < 3:
        raise FileProblem(f"line {number}: a face with {len(found)} corners; it needs 3")
    return found


def _together(found: list[_NamedFaces]) -> list[_NamedFaces]:
    """Merge faces of one name from several places of the file; names without faces are left out."""
    by_name: dict[str, _NamedFaces] = {}
    for each in found:
        if each.loops:
            kept = by_name.setdefault(each.name, _NamedFaces(each.name))
            kept.loops += each.loops
            kept.materials += each.materials
            kept.groups |= each.groups
    return list(by_name.values())


def _body(found: _NamedFaces, points: np.ndarray) -> FileBody:
    used, numbers = np.unique(np.concatenate(found.loops), return_inverse=True)
    ends = np.cumsum([len(loop) for loop in found.loops])[:-1]
    layer = found.materials.most_common(1)[0][0]
    return FileBody(
        found.name, points[used], tuple(np.split(numbers.astype(np.int64), ends)), layer, compound=found.compound
    )
