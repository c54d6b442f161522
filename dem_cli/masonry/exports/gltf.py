"""Export blocks as glTF 2.0 for viewers and game engines: .glb, or .gltf with its numbers inside; y upwards, in metres.

A node with a mesh of flat triangles for each block, under its name; a colour for each material, fixed blocks as ground.
Source: Khronos Group, glTF 2.0 Specification. Written here: the libraries for it bring more than these two chunks.
"""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

import numpy as np

from dem_cli.masonry.exports.contents import ExportedBlock, ExportedCase, triangles

STONES = ((0.86, 0.80, 0.69), (0.73, 0.62, 0.50), (0.66, 0.68, 0.70), (0.80, 0.66, 0.52), (0.60, 0.57, 0.48))
GROUND = (0.55, 0.53, 0.50)
MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
_FLOAT, _TRIANGLES, _VERTEX_DATA = 5126, 4, 34962


def glb(exported: ExportedCase) -> bytes:
    """Write a binary glTF file."""
    data, numbers = _scene(exported)
    text = json.dumps(data, ensure_ascii=False).encode()
    chunks = [(JSON_CHUNK, text + b" " * (-len(text) % 4)), (BINARY_CHUNK, numbers)]
    body = b"".join(struct.pack("<II", len(raw), kind) + raw for kind, raw in chunks)
    return struct.pack("<III", MAGIC, 2, 12 + len(body)) + body


def gltf(exported: ExportedCase) -> bytes:
    """Write a glTF file as text."""
    data, numbers = _scene(exported)
    data["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(numbers).decode()
    return json.dumps(data, ensure_ascii=False).encode()


def _scene(exported: ExportedCase) -> tuple[dict[str, Any], bytes]:
    names = list(exported.case.materials)
    colours = {name: STONES[k % len(STONES)] for k, name in enumerate(names)}
    colours["\0ground"] = GROUND
    numbers = {name: k for k, name in enumerate(colours)}
    places, normals, meshes = [], [], []
    accessors: list[dict[str, Any]] = []
    start = 0
    for block in exported.solids:
        corners, normal = _flat(block)
        places.append(corners)
        normals.append(normal)
        used = {"POSITION": len(accessors), "NORMAL": len(accessors) + 1}
        accessors += [_accessor(k, 12 * start, values) for k, values in enumerate((corners, normal))]
        start += len(corners)
        material = numbers["\0ground" if block.fixed else block.material]
        meshes.append({"name": block.name, "primitives": [{"attributes": used, "material": material}]})
    raw = np.concatenate(places + normals).astype("<f4").tobytes()
    half = len(raw) // 2
    views = [{"buffer": 0, "byteOffset": k * half, "byteLength": half, "target": _VERTEX_DATA} for k in (0, 1)]
    nodes = [{"name": mesh["name"], "mesh": k} for k, mesh in enumerate(meshes)]
    data = {
        "asset": {"version": "2.0", "generator": "dem"},
        "scene": 0,
        "scenes": [{"name": exported.name, "nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [_material(name.strip("\0"), colour) for name, colour in colours.items()],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(raw)}],
    }
    return data, raw


def _flat(block: ExportedBlock) -> tuple[np.ndarray, np.ndarray]:
    """Return corners and normals of all triangles of a block, y upwards, each (n, 3)."""
    corners = np.concatenate([part.vertices[triangles(part)] for part in block.parts])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    found = corners.reshape(-1, 3), np.repeat(normals, 3, axis=0)
    return found[0][:, [0, 2, 1]] * (1, 1, -1), found[1][:, [0, 2, 1]] * (1, 1, -1)


def _accessor(view: int, offset: int, values: np.ndarray) -> dict[str, Any]:
    limits = values.astype(np.float32)
    bounds = {"min": limits.min(axis=0).tolist(), "max": limits.max(axis=0).tolist()} if view == 0 else {}
    place = {"bufferView": view, "byteOffset": offset, "componentType": _FLOAT}
    return {**place, "count": len(values), "type": "VEC3", **bounds}


def _material(name: str, colour: tuple[float, float, float]) -> dict[str, Any]:
    surface = {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9}
    return {"name": name, "pbrMetallicRoughness": surface}
