"""Files of blocks as other programs write them: walls of boxes by trimesh, façades by ezdxf."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

Box = tuple[str, tuple[float, float, float], tuple[float, float, float]]  # name, lower and upper corner [m]


def wall_boxes(courses: int, length: int, size: tuple[float, float, float] = (0.4, 0.2, 0.25)) -> list[Box]:
    """Boxes of a wall in running bond with half blocks at its ends, and of the ground below it."""
    long, t, h = size
    found: list[Box] = [("ground", (-0.2, -t, -h), (length * long + 0.2, t, 0.0))]
    for k in range(courses):
        inner = [long * (i + 0.5 * (k % 2)) for i in range(length + 1)]
        heads = [0.0, *(x for x in inner if 1e-9 < x < length * long - 1e-9), length * long]
        found += [
            (f"stone-{k + 1}-{i + 1}", (a, -t / 2, k * h), (b, t / 2, (k + 1) * h))
            for i, (a, b) in enumerate(zip(heads, heads[1:]))
        ]
    return found


def by_trimesh(boxes: list[Box], path: Path, **options: Any) -> Path:
    """The boxes in one file: with their names where the format has them."""
    import trimesh

    meshes = {name: trimesh.creation.box(bounds=[low, high]) for name, low, high in boxes}
    if path.suffix == ".obj":
        trimesh.Scene(meshes).export(path, **options)
    else:
        trimesh.util.concatenate(list(meshes.values())).export(path, **options)
    return path


def facade_by_ezdxf(path: Path) -> Path:
    """A façade 4 m × 2 m in mm with a door 1.2 m × 1.4 m, a lintel over it, ground, and a caption."""
    import ezdxf

    drawing = ezdxf.new(units=4)
    space = drawing.modelspace()
    for layer in ("stone", "ground", "lintel"):
        drawing.layers.add(layer)

    def rectangle(x0: float, y0: float, x1: float, y1: float, layer: str) -> None:
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})

    rectangle(-200, -200, 4200, 0, "ground")
    for k in range(10):
        heads = [0, *range(400 if k % 2 == 0 else 200, 4000, 400), 4000]
        y = 200 * k
        gap = (1400, 2600) if k < 7 else (1200, 2800) if k == 7 else (0, 0)
        for a, b in zip(heads, heads[1:]):
            for x0, x1 in ((a, min(b, gap[0])), (max(a, gap[1]), b)) if gap[1] else ((a, b),):
                if x1 > x0:
                    rectangle(x0, y, x1, y + 200, "stone")
    rectangle(1200, 1400, 2800, 1600, "lintel")
    space.add_text("FACADE")
    drawing.saveas(path)
    return path


def obj_text(objects: dict[str, tuple[np.ndarray, list[list[int]]]]) -> str:
    """An OBJ file of objects with corners (n, 3) and faces from 0."""
    lines, first = [], 1
    for name, (points, faces) in objects.items():
        lines += [f"o {name}", *("v " + " ".join(map(repr, map(float, point))) for point in points)]
        lines += ["f " + " ".join(str(first + k) for k in face) for face in faces]
        first += len(points)
    return "\n".join(lines) + "\n"


def prism_faces(n: int) -> list[list[int]]:
    """Faces of a prism over n corners below and n above, outwards where they run counter-clockwise from above."""
    sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return [list(range(n))[::-1], list(range(n, 2 * n)), *sides]


def prism(outline: list[tuple[float, float]], low: float, high: float) -> tuple[np.ndarray, list[list[int]]]:
    """Corners and faces of an upright prism over an outline in plan, counter-clockwise."""
    flat = np.array(outline, float)
    points = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in (low, high)])
    return points, prism_faces(len(flat))


def elevation_by_ezdxf(path: Path) -> Path:
    """The elevation of a gabled façade in mm, 6 m × 4.8 m: a door, a window, an arched window, a dimension line."""
    import ezdxf

    drawing = ezdxf.new(units=4)
    space = drawing.modelspace()
    for layer in ("WALL", "OPENINGS", "TEXT"):
        drawing.layers.add(layer)
    wall = [(0, 0), (6000, 0), (6000, 3000), (3000, 4800), (0, 3000)]
    space.add_lwpolyline(wall, close=True, dxfattribs={"layer": "WALL"})
    for x0, y0, x1, y1 in ((2500, 0, 3500, 2100), (800, 900, 1700, 2100)):
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "OPENINGS"})
    arched = [(4400, 900, 0), (5300, 900, 0), (5300, 1700, 1), (4400, 1700, 0)]
    space.add_lwpolyline(arched, format="xyb", close=True, dxfattribs={"layer": "OPENINGS"})
    space.add_line((0, -500), (6000, -500), dxfattribs={"layer": "TEXT"})
    drawing.saveas(path)
    return path
