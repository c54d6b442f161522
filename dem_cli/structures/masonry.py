"""Masonry of one wall, straight in plan: courses around openings, below its top, in leaves; the blocks that it has.

Drawn in the elevation of the wall, x along it, y up. Each course may begin and end where it likes and be interrupted,
so that walls that meet pass through each other in alternate courses.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import Field

from dem_cli.case.base import CaseModel, Positive
from dem_cli.geometry import cuts
from dem_cli.geometry.polygon import rectangle
from dem_cli.geometry.polyhedron import prism
from dem_cli.model.blocks import Block
from dem_cli.structures import courses, tops
from dem_cli.structures.course_layout import Band, Interruption, interruption, laid_around, split
from dem_cli.structures.courses import Piece, Span
from dem_cli.structures.openings import Opening
from dem_cli.structures.stones import Part, Stone, put_together
from dem_cli.structures.voids import Void

LEAVES = "abc"  # names of leaves, from the front (y = −thickness / 2) to the back
CORE_LEAF = "b"
WELD = 1e-10  # of a block: round-off of corners that are the same
SMALL = 1e-6  # of a block's smaller side: what is narrower is not made


class Core(CaseModel):
    """Rubble between the two faces of a wall."""

    thickness: Positive = Field(description="across the wall; the faces share the rest [m]", examples=[0.3])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["rubble"])
    size: Positive | None = Field(
        None, description="mean length of its stones [m]; default: half of a block", examples=[0.2]
    )


class Quoins(CaseModel):
    """Larger stones at both ends of a wall, through its whole thickness, alternately long and short."""

    length: Positive = Field(description="length of the long ones [m]; the short ones are half of it", examples=[0.6])
    height: int = Field(1, ge=1, le=100, description="courses that one of them is high", examples=[2])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["ashlar"])


@dataclass(frozen=True)
class Masonry:
    """What a wall is made of, in its elevation."""

    length: float  # of a full block [m]
    thickness: float  # of the wall [m]; half of it lies to either side
    levels: np.ndarray  # bed joints from the foot to the top [m], (n + 1,)
    spans: Sequence[Sequence[Span]]  # of each course from below, from where to where it goes [m]; several: with gaps
    bond: str = "running"
    offset: float | None = None  # shift of every other course [m]; None: that of the bond
    first: str = "half"  # the lowest course: "full" as the bond begins, "half" as its second course
    lengths: Sequence[float] = ()  # of a full block, of each course where they differ [m]
    anchor: float = 0.0  # where the bond begins [m]
    leaves: int = 1
    through_stones: float = 0.0
    core: Core | None = None
    quoins: Quoins | None = None
    quoin_courses: int = 0  # the lowest ones have quoins; gables do without
    openings: Sequence[Opening] = ()
    top: tops.Profile | None = None

    def pattern(self, k: int) -> courses.Pattern:
        """What its bond lays in course k, from 0."""
        shift = 0.5 if self.offset is None else self.offset / self.block_length(k)
        return courses.BONDS[self.bond](k + (0 if self.first == "full" else 1), shift)

    def block_length(self, k: int) -> float:
        """Of a full block in course k [m]."""
        return self.lengths[k] if self.lengths else self.length

    def levels_of(self, k: int) -> Span:
        """Lower and upper bed joint of course k [m]."""
        low, high = self.levels[k : k + 2].tolist()
        return (low, high)

    @property
    def whole(self) -> Span:
        """From where to where it goes square to itself [m]."""
        return (-self.thickness / 2.0, self.thickness / 2.0)

    @property
    def depths(self) -> list[Span]:
        """Of each leaf from where to where it goes square to the wall [m]."""
        half = self.thickness / 2.0
        if self.core is None:
            at = (self.thickness * np.arange(self.leaves + 1) / self.leaves - half).tolist()
        else:
            at = [-half, -self.core.thickness / 2.0, self.core.thickness / 2.0, half]
        return list(zip(at[:-1], at[1:], strict=True))

    def band(self, k: int, taken: Sequence[Span], voids: Sequence[Void], below: Sequence[float]) -> Band:
        """Course k, with quoins and openings in its way, above these head joints."""
        low, high = self.levels_of(k)
        stops = [x for void in voids for x in void.stops(low, high, self.small)]
        stops += [] if self.top is None else tops.stops(self.top, low, high)
        length, pattern = self.block_length(k), self.pattern(k)
        return Band(low, high, self.spans[k], taken, length, pattern, self.anchor, stops, below)

    @property
    def small(self) -> float:
        """What is narrower is not made [m]."""
        return SMALL * min(self.length, float(np.diff(self.levels).min()))


def masonry_blocks(masonry: Masonry) -> list[Block]:
    """Blocks of a wall in its elevation, with the depth that they have in space as `across`.

    Names: "<course>-<number>", in leaves of their own "<course>-<number>a" (front), "b", "c"; "quoin-left-<number>",
    "quoin-right-<number>"; "lintel-<opening>", "arch-<opening>-<number>". What is cut to less than a quarter of a block
    is one with its neighbour.
    """
    voids = [opening.void.fitted(masonry.levels) for opening in masonry.openings]
    over = list(_over_openings(masonry, voids))
    laid = list(_cut_stones(masonry, voids))
    exact = _welded([*laid, *over], WELD * masonry.length)
    named = [*_named(put_together(exact[: len(laid)], masonry.small)), *((one.name, one) for one in exact[len(laid) :])]
    return [_block(name, stone, masonry) for name, stone in named]


def _welded(stones: Sequence[Stone], gap: float) -> list[Stone]:
    """With the same corners where they share them, exactly."""
    shapes = iter(cuts.welded([part.shape for stone in stones for part in stone.parts], gap))
    return [stone._replace(parts=tuple(Part(next(shapes), part.across) for part in stone.parts)) for stone in stones]


def _block(name: str, stone: Stone, masonry: Masonry) -> Block:
    shapes = [part.shape for part in stone.parts]
    depths = {part.across for part in stone.parts}
    others: dict[str, Any] = {"thickness": masonry.thickness, "course": stone.course}
    if depths == {masonry.whole}:
        return Block(name, tuple(shapes), stone.material, **others)
    if len(depths) == 1:
        return Block(name, tuple(shapes), stone.material, across=depths.pop(), **others)
    solids = (prism(shape, *part.across) for shape, part in zip(shapes, stone.parts, strict=True))
    return Block(name, tuple(solids), stone.material, **others)


def _named(stones: Sequence[Stone]) -> Iterator[tuple[str, Stone]]:
    """Stones by course, from left to right; those that go through count in every leaf and are named as in the first."""
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


def _over_openings(masonry: Masonry, voids: Sequence[Void]) -> Iterator[Stone]:
    """Lintels and voussoirs."""
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
    """Stones of all courses, with what openings and the top of the wall leave of each."""
    small = masonry.small
    for stone in _stones(masonry, voids):
        x0, y0, x1, y1 = stone.box
        shapes = uncut = [part.shape for part in stone.parts]
        for void in voids:
            left, low, right, high = void.reach
            if left < x1 and x0 < right and low < y1 and y0 < high:
                shapes = [piece for shape in shapes for piece in void.left_of(shape, small)]
        if masonry.top is not None:
            shapes = [piece for shape in shapes for piece in tops.below(shape, masonry.top, small)]
        cut = len(shapes) != len(uncut) or any(a is not b for a, b in zip(shapes, uncut, strict=True))
        groups = cuts.connected(shapes, small) if cut else [list(range(len(shapes)))]
        for group in groups:
            yield stone._replace(parts=tuple(Part(shapes[i], stone.parts[0].across) for i in group))


def _stones(masonry: Masonry, voids: Sequence[Void]) -> Iterator[Stone]:
    """Stones of all courses, uncut, and quoins."""
    taken = _quoin_spans(masonry)
    yield from _quoins(masonry, taken)
    runs: list[list[list[Piece]]] = []
    gaps: list[list[Interruption]] = []
    joints: list[list[float]] = []
    for k in range(len(masonry.spans)):
        low, high = masonry.levels_of(k)
        quoins = [span for (_, course), span in taken.items() if course == k]
        found = [interruption(void, low, high, masonry.small) for void in voids]
        gaps.append([one for one in found if one is not None])
        below = joints[-1] if joints and masonry.bond != "stack" else []
        runs.append(laid_around(masonry.band(k, quoins, voids, below), gaps[k], masonry.small))
        joints.append([x for run in runs[k] for piece in run for x in (piece.start, piece.end)])
    for k, own in enumerate(runs):
        beyond = [x for other in joints[max(k - 1, 0) : k + 2] for x in other if other is not joints[k]]
        least = courses.LEAST_PIECE * masonry.block_length(k)
        stops = [x for void in voids for x in void.stops(*masonry.levels_of(k), masonry.small)]
        quoins = [span for (_, course), span in taken.items() if course == k]
        free = [span for one in gaps[k] for tip in one.tips for span in courses.without(tip, quoins, masonry.small)]
        tips = [part for tip in free for part in split(tip, beyond, stops, least)]
        yield from _in_leaves(masonry, k, own, tips)


def _quoin_spans(masonry: Masonry) -> dict[tuple[str, int], Span]:
    """(end and number of the quoin, course) -> from where to where it goes."""
    quoins, found = masonry.quoins, {}
    if quoins is None:
        return {}
    for k, spans in enumerate(masonry.spans[: masonry.quoin_courses]):
        n = k // quoins.height
        length = quoins.length / (1.0 + n % 2)
        group = [
            other
            for other in masonry.spans[n * quoins.height : min((n + 1) * quoins.height, masonry.quoin_courses)]
            if other
        ]
        if not spans or spans[-1][1] - spans[0][0] < 2.0 * length:
            continue
        start, end = min(other[0][0] for other in group), max(other[-1][1] for other in group)
        found[f"left-{n + 1}", k] = (spans[0][0], start + length)
        found[f"right-{n + 1}", k] = (end - length, spans[-1][1])
    return found


def _quoins(masonry: Masonry, taken: dict[tuple[str, int], Span]) -> Iterator[Stone]:
    assert masonry.quoins is not None or not taken
    for name in dict.fromkeys(name for name, _ in taken):
        own = {k: span for (other, k), span in taken.items() if other == name}
        boxes = [(span, masonry.levels_of(k)) for k, span in own.items()]
        shapes = cuts.unions([rectangle(x0, y0, x1 - x0, y1 - y0) for (x0, x1), (y0, y1) in boxes], masonry.small)
        parts = tuple(Part(shape, masonry.whole) for shape in shapes)
        first = min(own)
        material = masonry.quoins.material if masonry.quoins else ""
        yield Stone(first + 1, parts, _full(masonry, first), material=material, name=f"quoin-{name}")


def _full(masonry: Masonry, k: int) -> float:
    """Area of a full block of course k [m2]."""
    low, high = masonry.levels_of(k)
    return masonry.block_length(k) * (high - low)


def _in_leaves(masonry: Masonry, k: int, runs: Sequence[Sequence[Piece]], tips: Sequence[Span]) -> Iterator[Stone]:
    """Stones of course k: pieces through the whole wall, or side by side in its leaves, with a core between them.

    tips: thin leftovers beside openings, which become parts of other stones.
    """
    through = iter(courses.are_through(masonry.through_stones, sum(map(len, runs)), k))
    for run in runs:
        whole = [next(through) or (piece.header and masonry.leaves > 1) for piece in run]
        for piece, is_whole in zip(run, whole, strict=True):
            yield from _side_by_side(masonry, k, (piece.start, piece.end), is_whole)
        if masonry.core is not None:
            yield from _in_core(masonry, k, [p for p, is_whole in zip(run, whole, strict=True) if not is_whole])
    for tip in tips:
        yield from _side_by_side(masonry, k, tip, False)
        if masonry.core is not None:
            yield from _in_core(masonry, k, [Piece(*tip, False)])


def _side_by_side(masonry: Masonry, k: int, span: Span, whole: bool) -> Iterator[Stone]:
    """One stone, or one in each leaf but the core."""
    low, high = masonry.levels_of(k)
    shape, full = rectangle(span[0], low, span[1] - span[0], high - low), _full(masonry, k)
    if whole or masonry.leaves == 1:
        yield Stone(k + 1, (Part(shape, masonry.whole),), full)
        return
    for leaf, across in zip(LEAVES, masonry.depths, strict=False):
        if masonry.core is None or leaf != CORE_LEAF:
            yield Stone(k + 1, (Part(shape, across),), full, leaf)


def _in_core(masonry: Masonry, k: int, pieces: Sequence[Piece]) -> Iterator[Stone]:
    """Rubble between the faces, where they do not touch."""
    assert masonry.core is not None
    size = masonry.core.size or masonry.block_length(k) / 2.0
    low, high = masonry.levels_of(k)
    starts = [piece.start for i, piece in enumerate(pieces) if not i or pieces[i - 1].end != piece.start]
    ends = [piece.end for i, piece in enumerate(pieces, 1) if i == len(pieces) or pieces[i].start != piece.end]
    for span in zip(starts, ends, strict=True):
        for shape in courses.rubble(span, (low, high), size, k):
            part = Part(shape, masonry.depths[1])
            yield Stone(k + 1, (part,), size * (high - low), CORE_LEAF, masonry.core.material)
