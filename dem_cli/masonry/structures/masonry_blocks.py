"""Create the blocks of a wall: stones cut around openings and below its top, small pieces merged, with names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from dem_cli.core.geometry import cuts
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.geometry.polyhedron import prism
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures import tops
from dem_cli.masonry.structures.leaves import numbered
from dem_cli.masonry.structures.masonry import Masonry
from dem_cli.masonry.structures.masonry_stones import uncut_stones
from dem_cli.masonry.structures.stones import Part, Stone, put_together
from dem_cli.masonry.structures.voids import Void

WELD = 1e-10  # of a block: round-off of corners that are the same


def masonry_blocks(masonry: Masonry) -> list[Block]:
    """Create the blocks of a wall in elevation, with their depth in space as `across`.

    Names: "<course>-<number>", in leaves of their own "<course>-<number>a" (front), "b", "c"; "quoin-left-<number>",
    "quoin-right-<number>"; "lintel-<opening>", "arch-<opening>-<number>". What is cut to less than a quarter of a block
    is one with its neighbour.
    """
    voids = [opening.void for opening in masonry.openings]
    if masonry.fit_rings:
        voids = [void.fitted(masonry.levels) for void in voids]
    over = list(_over_openings(masonry, voids))
    laid = list(_cut_stones(masonry, [*voids, *masonry.hollows]))
    exact = _welded([*laid, *over], WELD * masonry.length)
    together = put_together(exact[: len(laid)], masonry.small)
    named = [*numbered(together), *((one.name, one) for one in exact[len(laid) :])]
    return [_block(name, stone, masonry) for name, stone in named]


def _welded(stones: Sequence[Stone], gap: float) -> list[Stone]:
    """Make shared corners of stones exactly equal."""
    shapes = iter(cuts.welded([part.shape for stone in stones for part in stone.parts], gap))
    return [stone._replace(parts=tuple(Part(next(shapes), part.across) for part in stone.parts)) for stone in stones]


def _block(name: str, stone: Stone, masonry: Masonry) -> Block:
    shapes = [part.shape for part in stone.parts]
    depths = {part.across for part in stone.parts}
    others: dict[str, Any] = {"thickness": masonry.thickness, "course": stone.course, "row": stone.leaf}
    if depths == {masonry.whole}:
        return Block(name, tuple(shapes), stone.material, **others)
    if len(depths) == 1:
        return Block(name, tuple(shapes), stone.material, across=depths.pop(), **others)
    solids = (prism(shape, *part.across) for shape, part in zip(shapes, stone.parts, strict=True))
    return Block(name, tuple(solids), stone.material, **others)


def _over_openings(masonry: Masonry, voids: Sequence[Void]) -> Iterator[Stone]:
    """Yield lintels and voussoirs."""
    for i, (opening, void) in enumerate(zip(masonry.openings, voids, strict=True)):
        if opening.lintel and opening.lintel_box:
            x0, y0, x1, y1 = opening.lintel_box
            part = Part(rectangle(x0, y0, x1 - x0, y1 - y0), masonry.whole)
            yield Stone(0, (part,), 0.0, "", opening.lintel.material, f"lintel-{i + 1}")
        for n, shape in enumerate(void.voussoirs):
            assert opening.arch is not None
            part = Part(shape, masonry.whole)
            yield Stone(0, (part,), 0.0, "", opening.arch.material, f"arch-{i + 1}-{n + 1}")


def _cut_stones(masonry: Masonry, voids: Sequence[Void]) -> Iterator[Stone]:
    """Cut the stones of all courses around openings and below the top of the wall."""
    small, reaches = masonry.small, [(void, void.reach) for void in voids]
    for stone in uncut_stones(masonry, voids):
        x0, y0, x1, y1 = stone.box
        shapes = uncut = [part.shape for part in stone.parts]
        for void, (left, low, right, high) in reaches:
            if left < x1 and x0 < right and low < y1 and y0 < high:
                shapes = [piece for shape in shapes for piece in void.left_of(shape, small)]
        if masonry.top is not None:
            shapes = [piece for shape in shapes for piece in tops.below(shape, masonry.top, small)]
        cut = len(shapes) != len(uncut) or any(a is not b for a, b in zip(shapes, uncut, strict=True))
        groups = cuts.connected(shapes, small) if cut else [list(range(len(shapes)))]
        for group in groups:
            yield stone._replace(parts=tuple(Part(shapes[i], stone.parts[0].across) for i in group))
