"""Dressed jambs: squared stones beside the openings of a wall of irregular stones, alternately long and short."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from dem_cli.core.geometry.polygon import rectangle
from dem_cli.masonry.structures.building.bond import SHORTEST
from dem_cli.masonry.structures.building.elevation import SMALL, WallElevation
from dem_cli.masonry.structures.openings import Opening
from dem_cli.masonry.structures.voids import Box

SHORT = 0.5  # of the length of a block: the short ones, and the least that is left to the pattern beside one


def jamb_stones(wall: WallElevation, taken: Sequence[np.ndarray]) -> list[tuple[str, np.ndarray]]:
    """Generate the jamb stones of all openings of a wall by name, with shapes (4, 2); taken: shapes already dressed.

    As high as the courses of the wall; where a course is cut to less than a half, it is one with the next. A stone
    goes on to what is beside it where too little would be left between them.
    """
    small = SMALL * wall.length
    found: list[tuple[str, np.ndarray]] = []
    boxes = [_around(shape) for shape in (*taken, *(each for void in wall.voids for each in void.outlines))]
    for i, opening in enumerate(wall.table.openings):
        if opening.arch is not None and opening.arch.form == "circle":
            continue
        for n, (low, high) in enumerate(pairwise(_beds(wall, opening))):
            for side, word in ((-1, "left"), (1, "right")):
                start = opening.x if side < 0 else opening.box[2]
                room = _room(wall, (start, low, high), side, boxes)
                length = _length(room, wall.length * (1.0 if (n + (side > 0)) % 2 == 0 else SHORT), wall.length)
                if length > small:
                    left = min(start, start + side * length)
                    boxes.append((left, low, left + length, high))
                    found.append((f"jamb-{i + 1}-{word}-{n + 1}", rectangle(left, low, length, high - low)))
    return found


def _around(shape: np.ndarray) -> Box:
    (x0, y0), (x1, y1) = shape.min(axis=0).tolist(), shape.max(axis=0).tolist()
    return (x0, y0, x1, y1)


def _beds(wall: WallElevation, opening: Opening) -> Iterator[float]:
    """Yield the heights of the bed joints of the jambs [m]."""
    _, low, _, high = opening.box
    yield low
    for below, level, above in zip(wall.levels[:-2], wall.levels[1:-1], wall.levels[2:], strict=True):
        least = SHORT * min(level - below, above - level)
        if low + least * (1.0 - SMALL) <= level <= high - least * (1.0 - SMALL):
            yield float(level)
    yield high


def _room(wall: WallElevation, jamb: tuple[float, float, float], side: int, boxes: Sequence[Box]) -> float:
    """Return the room for a jamb stone (place along the wall, lower and upper level) to one side [m]."""
    (start, low, high), small = jamb, SMALL * wall.length
    ends = [side * wall.roof(high)[side > 0]]
    for x0, y0, x1, y1 in boxes:
        near, far = (x0, x1) if side > 0 else (-x1, -x0)
        if y0 < high - small and y1 > low + small and far > side * start + small:
            ends.append(max(near, side * start))
    return min(ends) - side * start


def _length(room: float, wanted: float, full: float) -> float:
    """Return the length of a stone in a given room [m]; 0.0: there is none."""
    if room < SHORTEST * full * (1.0 - SMALL):
        return 0.0
    if room - wanted >= SHORT * full:
        return wanted
    return room if room <= full * (1.0 + SMALL) else room - SHORT * full
