"""Import meshes of COMPAS JSON files from compas, compas_assembly, compas_model and compas_dem as blocks.

What `compas.json_dump` writes: {"dtype": "compas.datastructures/Mesh", "data": {"vertex": {key: {x, y, z}}, "face":
{key: [keys]}, "attributes": {}}, "name": ...}, alone, in lists, as blocks of an Assembly, as geometry of the elements
of a Model. Read without compas; written by hand from version 2.15 of it, compas_assembly 0.7 and compas_dem 0.3.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.masonry.imports.contents import Contents, FileBody, FileProblem, finite

MESH, ELEMENTS = "compas.datastructures/Mesh", "elements"
COMPOUND = "compound_parts"  # attribute of a mesh that dem writes: how many of this name are one block
POLYHEDRON, BOX = "compas.geometry/Polyhedron", "compas.geometry/Box"


def read(path: Path) -> Contents:
    """Read the meshes of a COMPAS file in its order. Raises FileProblem."""
    try:
        data = json.loads(path.read_text(encoding="utf-8-sig"))
        found = list(_meshes(data, {}))
    except RecursionError:
        raise FileProblem("its lists and tables are nested too deeply") from None
    except ValueError as error:
        raise FileProblem(f"not JSON ({error})") from None
    materials = dict(_materials(data))
    names = {guid: str(each.get("name") or "") for guid, each in materials.items()}
    bodies = [_body(each, names) for each in found]
    given = {names[guid]: each["density"] for guid, each in materials.items() if each.get("density") is not None}
    return Contents(bodies, densities={name: _density(name, value) for name, value in given.items()})


def _density(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise FileProblem(f"material '{name}': its density {value!r} is not a number")
    return float(value)


def _materials(value: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the materials of a COMPAS model by their guid."""
    data = value.get("data") if isinstance(value, dict) else None
    found = data.get("materials") if isinstance(data, dict) else None
    for guid, each in found.items() if isinstance(found, dict) else ():
        if isinstance(each, dict) and isinstance(each.get("data"), dict):
            yield guid, each["data"]


def _meshes(value: Any, said: dict[str, Any]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Yield every mesh with the attributes around it: name, is_support, material, transformation."""
    if isinstance(value, list):
        for item in value:
            yield from _meshes(item, said)
        return
    if not isinstance(value, dict):
        return
    data = value.get("data")
    if isinstance(data, dict) and _draws(value, data):
        yield value, said
        return
    own = {**said, **{key: value[key] for key in ("is_support", "material", "transformation") if value.get(key)}}
    if "geometry" in value and value.get("name"):
        own["name"] = value["name"]
    for key, item in value.items():
        if key != "edge":  # contacts
            yield from _meshes(item, own)


def _draws(value: dict[str, Any], data: dict[str, Any]) -> bool:
    mesh = {"vertex", "face"} <= data.keys() and isinstance(data["vertex"], dict)
    return mesh or value.get("dtype") in (POLYHEDRON, BOX)


def _body(found: tuple[dict[str, Any], dict[str, Any]], materials: dict[str, str]) -> FileBody:
    value, said = found
    data = value["data"]
    attributes = data["attributes"] if isinstance(data.get("attributes"), dict) else {}
    name = str(said.get("name") or value.get("name") or attributes.get("name") or "")
    try:
        points, faces = _corners_and_faces(value.get("dtype"), data)
        points = _transformed(points, said.get("transformation"))
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise FileProblem(f"mesh '{name}' is not as compas writes it ({type(error).__name__}: {error})") from None
    material = said.get("material") or attributes.get("material") or ""
    fixed = bool(said.get("is_support") or attributes.get("is_support"))
    places, layer = finite(points, f"mesh '{name}'"), _layer(material, materials)
    return FileBody(name, places, faces, layer, fixed, compound=bool(attributes.get(COMPOUND)))


def _layer(material: Any, materials: dict[str, str]) -> str:
    """Return the name of a material given as text, by its guid in the model, or in full."""
    if isinstance(material, dict):
        within = material.get("data")
        return str((within.get("name") if isinstance(within, dict) else None) or material.get("name") or "")
    return materials.get(str(material), str(material))


def _corners_and_faces(dtype: Any, data: dict[str, Any]) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    if dtype == BOX:
        return _box(data)
    if dtype == POLYHEDRON:
        points, loops = data["vertices"], data["faces"]
        numbers = {str(k): k for k in range(len(points))}
    else:
        keys = list(data["vertex"])
        numbers = {key: k for k, key in enumerate(keys)}
        points, loops = [[data["vertex"][key][x] for x in "xyz"] for key in keys], list(data["face"].values())
    faces = tuple(np.array([numbers[str(corner)] for corner in loop], np.int64) for loop in loops)
    return np.array(points, float).reshape(-1, 3), faces


def _box(data: dict[str, Any]) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    frame = data["frame"].get("data", data["frame"])
    along, beside = (np.array(frame[key], float) for key in ("xaxis", "yaxis"))
    axes = np.stack([along, beside, np.cross(along, beside)])
    half = np.array([data[f"{x}size"] for x in "xyz"], float) / 2.0
    signs = np.array([[i, j, k] for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)], float)
    loops = ([0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5])
    return product(signs * half, axes) + np.array(frame["point"], float), tuple(np.array(loop) for loop in loops)


def _transformed(points: np.ndarray, transformation: Any) -> np.ndarray:
    if not transformation:
        return points
    data = transformation.get("data", transformation)
    matrix = np.array(data["matrix"] if isinstance(data, dict) else data, float)
    if (matrix == np.eye(4)).all():
        return points
    return product(points, matrix[:3, :3].T) + matrix[:3, 3]
