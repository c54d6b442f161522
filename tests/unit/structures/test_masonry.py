"""Masonry: what is laid fills the wall, however it is bonded, pierced and topped; nothing short, nothing twice."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon, box

from dem_cli.geometry import polygon
from dem_cli.structures.wall import Wall, build

SHAPES = ("segmental", "semicircular", "pointed", "flat", "circle", "lintel", "none")


def wall(**keys) -> Wall:
    return Wall.model_validate({"block": [0.5, 0.25], "courses": 12, "length": 6.0} | keys)


def free(**keys):
    return [block for block in build(wall(**keys)) if not block.fixed]


def opening(shape: str, rng: np.random.Generator, left: float) -> dict:
    """A random opening 0.5 to 1.1 m wide, from `left` to 2.6 m further."""
    width = rng.uniform(0.5, 1.1)
    keys = {"x": left + rng.uniform(0.7, 1.4), "y": rng.choice([0.0, rng.uniform(0.4, 0.8)]), "width": width}
    keys["height"] = width if shape == "circle" else rng.uniform(0.4, 1.0)
    if shape == "lintel":
        return keys | {"lintel": {"height": rng.uniform(0.1, 0.3), "bearing": rng.uniform(0.1, 0.3)}}
    if shape == "none":
        return keys
    arch = {"shape": shape, "voussoirs": 2 * int(rng.integers(3, 8)), "ring": rng.uniform(0.15, 0.3)}
    if shape == "circle":
        keys["y"] = rng.uniform(0.4, 0.8)
    rises = {"segmental": rng.uniform(0.1, 0.4), "pointed": rng.uniform(0.6, 1.0)}
    return keys | {"arch": arch | ({"rise": width * rises[shape]} if shape in rises else {})}


def random_wall(seed: int) -> dict:
    """Keys of a wall 3 m high with two openings and any top."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(5.4, 7.0)
    first, second = rng.choice(SHAPES, 2)
    keys = {
        "length": length,
        "block": [rng.choice([0.4, 0.5, 0.6]), 0.25],
        "bond": str(rng.choice(["running", "stack", "english", "english-garden", "flemish"])),
        "first": str(rng.choice(["half", "full"])),
        "openings": [opening(str(first), rng, 0.0), opening(str(second), rng, length / 2.0)],
    }
    tops = [
        {"gable": {"height": rng.uniform(0.5, 2.0)}},
        {"profile": [[0.0, 3.0], [length * rng.uniform(0.2, 0.8), rng.uniform(2.6, 3.0)], [length, 2.7]]},
        {},
    ]
    keys |= tops[seed % 3]
    return keys | ({"quoins": {"length": 0.6, "height": int(rng.integers(1, 4))}} if seed % 4 == 0 else {})


def solid(table: Wall) -> Polygon:
    """What is to be filled, drawn by another library."""
    height = float(table.levels[-1])
    outline = [[0.0, 0.0], [table.extent, 0.0], [table.extent, height], [0.0, height]]
    if table.gable:
        outline.insert(3, [table.extent / 2.0, height + table.gable.height])
    if table.profile:
        outline[2:] = [list(point) for point in table.profile[::-1]]
    filled = Polygon(outline)
    for hole in table.openings:
        if hole.arch is None or hole.arch.form != "circle":
            filled = filled.difference(box(*hole.box))
        if hole.arch is not None and hole.arch.form != "flat":
            filled = filled.difference(Polygon(hole.void.joints[:, 0]))
    return filled


@pytest.mark.parametrize("seed", range(24))
def test_a_wall_is_filled_once_and_nothing_is_short(seed):
    table = wall(**random_wall(seed))
    blocks = [block for block in build(table) if not block.fixed]
    parts = [part for block in blocks for part in block.parts]
    area = sum(polygon.area(part) for part in parts)
    assert area == pytest.approx(solid(table).area, rel=1e-12)
    assert shapely.union_all([Polygon(part) for part in parts]).area == pytest.approx(area, rel=1e-9)  # its own error
    assert all(polygon.is_convex(part) for part in parts)
    assert len({block.id for block in blocks}) == len(blocks)
    full = table.block[0] * table.block[1]
    least = min(sum(map(polygon.area, block.parts)) for block in blocks if block.course)
    assert least >= 0.25 * full * (1.0 - 1e-5)
