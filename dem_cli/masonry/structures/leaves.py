"""Leaves of a wall: parallel layers of its thickness, stones in one or through all of them, and their names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from dem_cli.masonry.structures.courses import Span
from dem_cli.masonry.structures.stones import Stone

LEAVES = "abc"  # names of leaves, from the right of the axis (the front, −y) to the left


def depths_of(whole: Span, leaves: int) -> list[Span]:
    """Divide the thickness of a wall into equal leaves; interval of each square to the wall [m]."""
    low, high = whole
    at = ((high - low) * np.arange(leaves + 1) / leaves + low).tolist()
    return list(zip(at[:-1], at[1:], strict=True))


def in_leaves(stone: Stone, depths: Sequence[Span]) -> Iterator[Stone]:
    """Split a through-stone into one stone in each leaf."""
    for leaf, across in zip(LEAVES, depths, strict=False):
        yield stone._replace(parts=tuple(part._replace(across=across) for part in stone.parts), leaf=leaf)


def numbered(stones: Sequence[Stone]) -> Iterator[tuple[str, Stone]]:
    """Name stones "<course>-<number>" from left to right, with a letter for leaves of their own.

    Those that go through count in every leaf and are named as in the first. Those with a name of their own keep it.
    """
    by_course: dict[int, list[Stone]] = {}
    for stone in stones:
        if stone.name:
            yield stone.name, stone
        else:
            by_course.setdefault(stone.course, []).append(stone)
    for course in sorted(by_course):
        ordered = sorted(by_course[course], key=lambda stone: tuple(np.round(stone.box[:2], 9)))
        leaves = sorted({stone.leaf for stone in ordered} - {""}) or [""]
        for leaf in leaves:
            for n, stone in enumerate([stone for stone in ordered if stone.leaf in ("", leaf)]):
                if stone.leaf == leaf or leaf == leaves[0]:
                    yield f"{course}-{n + 1}{stone.leaf}", stone
