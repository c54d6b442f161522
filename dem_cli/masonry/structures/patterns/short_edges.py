"""Collapse short edges of tilings for all stones at once, and move corners near a hole onto it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from dem_cli.core.arithmetic.products import product
from dem_cli.core.geometry import polygon
from dem_cli.core.geometry.decomposition import is_simple
from dem_cli.masonry.structures.patterns.tiling import SAME, Loop, Tiling, around

Sides = np.ndarray  # straight sides of the region and of its holes: both ends of each [m], (n, 2, 2)


def sides_of(outlines: Sequence[np.ndarray]) -> Sides:
    """Return the sides of polygons (n, 2)."""
    return np.concatenate([np.stack([each, np.roll(each, -1, axis=0)], axis=1) for each in outlines])


def on_sides(points: np.ndarray, sides: Sides, gap: float) -> np.ndarray:
    """Test which points lie on which sides, (n_points, n_sides) bool."""
    start, along = sides[:, 0], sides[:, 1] - sides[:, 0]
    arms = points[:, None] - start
    share = np.clip((arms * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    return np.hypot(*np.moveaxis(arms - share[:, :, None] * along, 2, 0)) <= gap


def collapsed(tiling: Tiling, shortest: float, sides: Sides) -> Tiling:
    """Collapse the edges below a length [m]: both ends become one corner, for all stones around it.

    Corners on a side of the region stay on it, its own corners stay where they are. Ends that cannot be one (on two
    sides, or a stone would turn inside out) are left as they are. Stones that lose their area are gone.
    """
    gap = SAME * polygon.size(tiling.corners)
    on = on_sides(tiling.corners, sides, gap)
    short = _short_edges(tiling, shortest)
    while True:
        groups = _groups(short, len(tiling.corners))
        target, places, wrong = _places(tiling.corners, groups, on)
        if not wrong:
            loops = [_renamed(loop, target) for loop in tiling.stones]
            wrong = _bent(places, tiling.stones, loops, target)
        if not wrong:
            break
        short = [edge for edge in short if edge[0] not in wrong and edge[1] not in wrong]
    kept = [k for k, loop in enumerate(loops) if len(loop) > 2]
    used = sorted({i for k in kept for i in loops[k]})
    number = {i: n for n, i in enumerate(used)}
    stones = [tuple(number[i] for i in loops[k]) for k in kept]
    return Tiling(places[used], stones, [tiling.courses[k] for k in kept])


def drawn_onto(tiling: Tiling, holes: Sequence[np.ndarray], reach: float, sides: Sides) -> Tiling:
    """Move corners closer than `reach` [m] to a side of a hole onto it, so that openings have no slivers."""
    gap = SAME * polygon.size(tiling.corners)
    on = on_sides(tiling.corners, sides, gap)
    places = tiling.corners.copy()
    for hole in holes:
        for start, end in sides_of([hole]):
            places = _drawn_onto_side(places, start, end, reach)
    off = (places != tiling.corners).any(axis=1) & (on & ~on_sides(places, sides, gap)).any(axis=1)
    places[off] = tiling.corners[off]
    while True:
        changed = (places != tiling.corners).any(axis=1)
        wrong = [loop for loop in tiling.stones if changed[list(loop)].any() and not is_simple(places[list(loop)])]
        if not wrong:
            return Tiling(places, tiling.stones, tiling.courses)
        back = sorted({i for loop in wrong for i in loop})
        places[back] = tiling.corners[back]


def _drawn_onto_side(places: np.ndarray, start: np.ndarray, end: np.ndarray, reach: float) -> np.ndarray:
    """Move points near a side onto it, those near one of its ends to that end."""
    along, arms = end - start, places - start
    length = float(np.hypot(*along))
    share = np.clip(product(arms, along) / length**2, 0.0, 1.0)
    share[share * length < reach] = 0.0
    share[(1.0 - share) * length < reach] = 1.0
    feet = np.where((share == 1.0)[:, None], end, start + share[:, None] * along)
    for axis in (0, 1):
        if start[axis] == end[axis]:
            feet[:, axis] = start[axis]
    near: np.ndarray = np.hypot(*(places - feet).T) < reach
    return np.where(near[:, None], feet, places)


def _short_edges(tiling: Tiling, shortest: float) -> list[tuple[int, int]]:
    edges = sorted({(min(e), max(e)) for loop in tiling.stones for e in around(loop)})
    pairs = np.array(edges)
    lengths = np.hypot(*(tiling.corners[pairs[:, 1]] - tiling.corners[pairs[:, 0]]).T)
    return [edges[k] for k in np.flatnonzero(lengths < shortest)]


def _groups(edges: Sequence[tuple[int, int]], n: int) -> list[list[int]]:
    """Group corners that become one, by union-find: groups of two and more (corners in rising order)."""
    parent = list(range(n))

    def first(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for i, j in edges:
        low, high = sorted((first(i), first(j)))
        parent[high] = low
    found = defaultdict(list)
    for i in sorted({i for edge in edges for i in edge}):
        found[first(i)].append(i)
    return list(found.values())


def _places(
    corners: np.ndarray, groups: Sequence[list[int]], on: np.ndarray
) -> tuple[np.ndarray, np.ndarray, set[int]]:
    """Return the representative of each corner, their places, and corners of groups without a common place."""
    target, places, wrong = np.arange(len(corners)), corners.copy(), set()
    for group in groups:
        held = on[group].any(axis=0)  # sides on which the group has to stay
        most = [i for i in group if (on[i] == held).all()]
        if not most or (held.sum() > 1 and len(most) > 1):
            wrong |= set(group)
            continue
        target[group] = group[0]
        places[group[0]] = corners[most[0]] + (corners[most] - corners[most[0]]).mean(axis=0)
    return target, places, wrong


def _renamed(loop: Loop, target: np.ndarray) -> Loop:
    """Replace the corners of a loop by their representatives, each once; (): nothing is left of it."""
    names = [int(target[i]) for i in loop]
    kept = [i for k, i in enumerate(names) if i != names[k - 1]]
    return tuple(kept) if len(kept) > 2 else ()


def _bent(places: np.ndarray, before: Sequence[Loop], after: Sequence[Loop], target: np.ndarray) -> set[int]:
    """Find the corners of stones that now touch themselves or are inside out."""
    wrong: set[int] = set()
    moved = np.zeros(len(target), bool)
    lost = np.flatnonzero(target != np.arange(len(target)))
    moved[lost] = moved[target[lost]] = True
    for old, new in zip(before, after, strict=True):
        if not moved[list(old)].any() or not new:
            continue
        if len(set(new)) < len(new) or not is_simple(places[list(new)]):
            wrong |= set(old)
    return wrong
