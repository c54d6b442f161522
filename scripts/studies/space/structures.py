"""Structures in space as tables of case files: boxes, prisms, drums, walls that meet."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

MU, DENSITY = 0.6, 2000.0
Map = Callable[[np.ndarray], np.ndarray]


def solid(name: str, vertices, **more) -> dict:
    """The hull of points."""
    return {"id": name, "vertices": [list(map(float, v)) for v in vertices], **more}


def box(name: str, low: Sequence[float], high: Sequence[float], **more) -> dict:
    """A box from its lowest to its highest corner."""
    x, y, z = (np.array(pair, float) for pair in zip(low, high, strict=True))
    return solid(name, [(a, b, c) for c in z for b in y for a in x], **more)


def prism(name: str, outline, low: float, high: float, **more) -> dict:
    """An outline (n, 2) in the x–y plane from one height to another."""
    return solid(name, [(x, y, z) for z in (low, high) for x, y in outline], **more)


def extruded(outline, low: float, high: float) -> list[tuple[float, float, float]]:
    """Corners of an outline (y, z) from one x to another."""
    return [(x, y, z) for x in (low, high) for y, z in outline]


def frustum(name: str, below, above, low: float, high: float, **more) -> dict:
    """From one outline (n, 2) at a height to another above it."""
    return solid(name, [(x, y, low) for x, y in below] + [(x, y, high) for x, y in above], **more)


def regular(sides: int, apothem: float) -> np.ndarray:
    """Corners of a regular polygon about the origin with a side across +x, (n, 2)."""
    angles = 2.0 * math.pi * (np.arange(sides) + 0.5) / sides
    return apothem / math.cos(math.pi / sides) * np.column_stack([np.cos(angles), np.sin(angles)])


def tables(*blocks: dict, friction: float = MU, direction=(1.0, 0.0, 0.0), density: float = DENSITY, **more) -> dict:
    """A pushover of explicit blocks; `more` adds tables or replaces them."""
    return {
        "dimension": 3,
        "materials": {"stone": {"density": density}},
        "joints": {"dry": {"friction": friction}},
        "block": list(blocks),
        "analysis": {"kind": "pushover", "direction": list(map(float, direction))},
        "output": {"frames": 0},
        **more,
    }


def towards(azimuth_deg: float) -> tuple[float, float, float]:
    """Horizontal direction at so many degrees from x towards y."""
    angle = math.radians(azimuth_deg)
    return math.cos(angle), math.sin(angle), 0.0


def mapped(case: dict, points: Map, directions: Map) -> dict:
    """The case with all points and all directions in other places: turned, mirrored."""
    blocks = [{**b, "vertices": points(np.array(b["vertices"])).tolist()} for b in case["block"]]
    analysis = dict(case["analysis"])
    analysis["direction"] = directions(np.array(analysis["direction"])).tolist()
    loads = [
        {**load, "force": directions(np.array(load["force"])).tolist()}
        | ({"at": points(np.array(load["at"])).tolist()} if "at" in load else {})
        for load in case.get("load", [])
    ]
    return {**case, "block": blocks, "analysis": analysis, **({"load": loads} if loads else {})}


def quarter(case: dict) -> dict:
    """The case turned by 90° about z."""

    def turned(vectors: np.ndarray) -> np.ndarray:
        return np.stack([-vectors[..., 1], vectors[..., 0], vectors[..., 2]], axis=-1)

    return mapped(case, turned, turned)


def mirrored(case: dict) -> dict:
    """The mirror image of the case, x turned to −x."""

    def flipped(vectors: np.ndarray) -> np.ndarray:
        return vectors * np.array([-1.0, 1.0, 1.0])

    return mapped(case, flipped, flipped)


# -- walls that meet: courses of boxes, corners bonded by courses that pass in turn ---------------------------------

Run = tuple[float, float, float, float]  # of a course in plan: low and high x, low and high y


def courses(runs: Callable[[int], Sequence[Run]], n: int, height: float, base: Run) -> list[dict]:
    """Boxes of n courses on a fixed base; runs: of course k, block by block."""
    x0, x1, y0, y1 = base
    blocks = [box("base", (x0, y0, -height), (x1, y1, 0.0), fixed=True)]
    for k in range(n):
        for i, (a, b, c, d) in enumerate(runs(k)):
            blocks.append(box(f"b{k}-{i}", (a, c, k * height), (b, d, (k + 1) * height)))
    return blocks


def cut(low: float, high: float, length: float, first: float) -> list[tuple[float, float]]:
    """A run from low to high in blocks of a length, of which the first is `first` long; no rest below a quarter."""
    heads = [low]
    at = low + first
    while at < high - 0.25 * length:
        heads.append(at)
        at += length
    return list(zip(heads, [*heads[1:], high]))


def along_x(low: float, high: float, first: float, t: float) -> list[Run]:
    """A piece of the wall along x, blocks twice as long as the wall is thick."""
    return [(a, b, 0.0, t) for a, b in cut(low, high, 2.0 * t, first)]


def along_y(x: float, low: float, high: float, t: float) -> list[Run]:
    """A leg that stands at x and reaches from low to high."""
    return [(x, x + t, a, b) for a, b in cut(low, high, 2.0 * t, 2.0 * t)]


def corner_wall(n: int = 6, t: float = 0.2, length: int = 3, leg: int = 2) -> list[dict]:
    """An L: a wall along x and a leg along y, `length` and `leg` blocks of 2 t; courses pass the corner in turn."""

    def runs(k: int) -> list[Run]:
        start, other = (0.0, t) if k % 2 == 0 else (t, 0.0)
        return along_x(start, 2 * t * length, 2.0 * t, t) + along_y(0.0, other, 2 * t * leg, t)

    return courses(runs, n, t, (-t, 2 * t * length + t, -t, 2 * t * leg + t))


def u_wall(n: int = 6, t: float = 0.2, length: int = 4, leg: int = 2, window: tuple[int, ...] = ()) -> list[dict]:
    """A U: a wall along x with a leg along y at both ends; window: courses without the blocks in the middle."""

    def runs(k: int) -> list[Run]:
        start, other = (0.0, t) if k % 2 == 0 else (t, 0.0)
        front = along_x(start, 2 * t * length - start, 2.0 * t, t)
        if k in window:
            middle = t * length
            front = [run for run in front if not run[0] < middle - 1e-9 < middle + 1e-9 < run[1] and run[1] != middle]
        legs = [along_y(x, other, 2 * t * leg, t) for x in (0.0, 2 * t * length - t)]
        return front + legs[0] + legs[1]

    return courses(runs, n, t, (-t, 2 * t * length + t, -t, 2 * t * leg + t))


def tee_wall(n: int = 6, t: float = 0.2, leg: int = 2) -> list[dict]:
    """A T: a wall of four blocks along x and a leg along y near its middle, bonded into it every other course."""

    stem = 2.5 * t  # within a block of the even courses

    def runs(k: int) -> list[Run]:
        if k % 2 == 0:
            return along_x(0.0, 8 * t, 2.0 * t, t) + along_y(stem, t, 2 * t * leg, t)
        sides = along_x(0.0, stem, t, t) + along_x(stem + t, 8 * t, 1.5 * t, t)
        return sides + along_y(stem, 0.0, 2 * t * leg, t)

    return courses(runs, n, t, (-t, 9 * t, -t, 2 * t * leg + t))


def bonded_barrel(voussoirs: int = 15, length: float = 1.5, radius: float = 1.0, ring: float = 0.2) -> list[dict]:
    """A barrel vault over 150° along y: voussoirs of 0.5 m in staggered rows, between two fixed springings."""
    half = math.radians(75.0)
    angles, blocks = np.linspace(-half, half, voussoirs + 1), []

    def voussoir(name: str, k: int, low: float, high: float, **more) -> dict:
        first = -half + (angles[1] - angles[0]) * k
        ends = [(r, a) for a in (first, first + angles[1] - angles[0]) for r in (radius, radius + ring)]
        return solid(name, [(r * math.sin(a), y, r * math.cos(a)) for y in (low, high) for r, a in ends], **more)

    for k in range(voussoirs):
        for i, (low, high) in enumerate(cut(0.0, length, 0.5, 0.5 if k % 2 == 0 else 0.25)):
            blocks.append(voussoir(f"v{k}-{i}", k, low, high))
    blocks.append(voussoir("left", -1, -0.1, length + 0.1, fixed=True))
    blocks.append(voussoir("right", voussoirs, -0.1, length + 0.1, fixed=True))
    return blocks
