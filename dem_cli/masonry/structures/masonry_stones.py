"""Lay the uncut stones of a wall: courses, leaves, through-stones, rubble core, quoins."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from dem_cli.core.geometry import cuts
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.masonry.structures import courses
from dem_cli.masonry.structures.course_layout import Interruption, interruption, laid_around, split
from dem_cli.masonry.structures.courses import Piece, Span
from dem_cli.masonry.structures.leaves import in_leaves
from dem_cli.masonry.structures.masonry import CORE_LEAF, Masonry
from dem_cli.masonry.structures.stones import Part, Stone
from dem_cli.masonry.structures.voids import Void


def uncut_stones(masonry: Masonry, voids: Sequence[Void]) -> Iterator[Stone]:
    """Yield the uncut stones of all courses, and quoins."""
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
        plan = masonry.plan(k, quoins, voids, joints[-1] if joints and masonry.bond != "stack" else [])
        tips_below = [x for one in (gaps[k - 1] if k else []) for tip in one.tips for x in tip]
        plan = plan._replace(stops=[*plan.stops, *tips_below])
        runs.append(laid_around(plan, gaps[k], masonry.small))
        joints.append([x for run in runs[k] for piece in run for x in (piece.start, piece.end)])
    plans = []
    for k, own in enumerate(runs):
        beyond = [x for other in joints[max(k - 1, 0) : k + 2] for x in other if other is not joints[k]]
        least = courses.LEAST_PIECE * masonry.block_length(k)
        stops = [x for void in voids for x in void.stops(*masonry.levels_of(k), masonry.small)]
        quoins = [span for (_, course), span in taken.items() if course == k]
        free = [span for one in gaps[k] for tip in one.tips for span in courses.without(tip, quoins, masonry.small)]
        tips = [part for tip in free for part in split(tip, beyond, stops, least)]
        plans.append((own, tips))
        yield from _in_leaves(masonry, k, own, tips)
    yield from _core_stones(masonry, plans)


def _quoin_spans(masonry: Masonry) -> dict[tuple[str, int], Span]:
    """Return the interval of each quoin: (end and number of the quoin, course) -> span."""
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
        yield Stone(first + 1, parts, masonry.full(first), material=material, name=f"quoin-{name}")


def _in_leaves(masonry: Masonry, k: int, runs: Sequence[Sequence[Piece]], tips: Sequence[Span]) -> Iterator[Stone]:
    """Yield the stones of course k: through the whole wall, or side by side in its leaves.

    tips: thin leftovers beside openings, which become parts of other stones.
    """
    for piece, whole in _through(masonry, k, runs):
        yield from _side_by_side(masonry, k, (piece.start, piece.end), whole)
    for tip in tips:
        yield from _side_by_side(masonry, k, tip, False)


def _through(masonry: Masonry, k: int, runs: Sequence[Sequence[Piece]]) -> list[tuple[Piece, bool]]:
    """Return the pieces of course k, and whether they go through all leaves."""
    pieces = [piece for run in runs for piece in run]
    through = courses.are_through(masonry.through_stones, len(pieces), k)
    return [(p, t or (p.header and masonry.leaves > 1)) for p, t in zip(pieces, through, strict=True)]


def _side_by_side(masonry: Masonry, k: int, span: Span, whole: bool) -> Iterator[Stone]:
    """Yield one through-stone, or one stone in each leaf except the core."""
    low, high = masonry.levels_of(k)
    shape = rectangle(span[0], low, span[1] - span[0], high - low)
    stone = Stone(k + 1, (Part(shape, masonry.whole),), masonry.full(k))
    if whole or masonry.leaves == 1:
        yield stone
        return
    for one in in_leaves(stone, masonry.depths):
        if masonry.core is None or one.leaf != CORE_LEAF:
            yield one


LaidCourse = tuple[Sequence[Sequence[Piece]], Sequence[Span]]  # runs of pieces, thin leftovers


def _core_stones(masonry: Masonry, laid: Sequence[LaidCourse]) -> Iterator[Stone]:
    """Yield rubble between the faces of all courses, where no stone goes through."""
    if masonry.core is None:
        return
    heads: list[float] = []  # upper ends of the head joints of the course below
    for k, (runs, tips) in enumerate(laid):
        size, (low, high) = masonry.core.size or masonry.block_length(k) / 2.0, masonry.levels_of(k)
        spans = _joined([(p.start, p.end) for p, whole in _through(masonry, k, runs) if not whole])
        shapes = [shape for span in (*spans, *tips) for shape in courses.rubble(span, (low, high), size, k, heads)]
        for shape in shapes:
            part = Part(shape, masonry.depths[1])
            yield Stone(k + 1, (part,), size * (high - low), CORE_LEAF, masonry.core.material)
        heads = [float(x) for shape in shapes for x in shape[2:, 0]]


def _joined(spans: Sequence[Span]) -> list[Span]:
    """Merge adjacent spans, from left to right."""
    found: list[Span] = []
    for span in spans:
        if found and found[-1][1] == span[0]:
            found[-1] = (found[-1][0], span[1])
        else:
            found.append(span)
    return found
