"""Courses of masonry: bonds (stack, running, English, Flemish), leaves, through-stones and head joints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

LEAST_PIECE = 0.25  # of a block: no shorter piece is laid
SAME_PLACE = 1e-6  # of a block: head joints so close are one
Span = tuple[float, float]  # from where to where masonry is laid [m]


def bed_joints(courses: int, height: float, heights: Sequence[float] = ()) -> np.ndarray:
    """Return the heights of the bed joints from the foot to the top [m], (courses + 1,): equal or given courses."""
    return np.concatenate([[0.0], np.cumsum(heights)]) if heights else np.arange(courses + 1) * height


class Piece(NamedTuple):
    """Block of a course, seen from the front."""

    start: float
    end: float
    header: bool  # goes through the whole thickness


class Unit(NamedTuple):
    """Repeated block of a bond."""

    length: float  # of a full block's
    header: bool


STRETCHER, HEADER = Unit(1.0, False), Unit(0.5, True)


class Pattern(NamedTuple):
    """Bond pattern of a course: repeated units, the first one beginning `start` full blocks from the end."""

    units: tuple[Unit, ...]
    start: float


def _running(k: int, shift: float) -> Pattern:
    return Pattern((STRETCHER,), shift * (k % 2))


def _english(k: int, _: float) -> Pattern:
    return Pattern((HEADER,), 0.25) if k % 2 else Pattern((STRETCHER,), 0.0)


def _english_garden(k: int, _: float) -> Pattern:
    return Pattern((HEADER,), 0.25) if k % 4 == 3 else Pattern((STRETCHER,), 0.5 * (k % 2))


def _flemish(k: int, _: float) -> Pattern:
    return Pattern((STRETCHER, HEADER), 0.75 * (k % 2))


Bond = Callable[[int, float], Pattern]  # number of the course, shift of every other one in block lengths
BONDS: dict[str, Bond] = {
    "running": _running,
    "stack": lambda k, _: _running(0, 0.0),
    "english": _english,
    "english-garden": _english_garden,
    "flemish": _flemish,
}
HEADER_BONDS = ("english", "english-garden", "flemish")


def pattern_of(bond: str, offset: float | None, course: int, length: float) -> Pattern:
    """Return the bond pattern of a course, from 0; offset: shift of every other course [m], None: half of `length`."""
    return BONDS[bond](course, 0.5 if offset is None else offset / length)


def laid(pattern: Pattern, span: Span, length: float, anchor: float, below: Sequence[float]) -> list[Piece]:
    """Divide a course into blocks from left to right, none shorter than a quarter of a block if the span is longer.

    length     of a full block [m]
    anchor     where the pattern of the bond begins [m]
    below      head joints of the course below [m]: where blocks are cut, joints keep clear of them
    """
    pieces = _as_repeated(pattern, span, length, anchor)
    if len({unit.length for unit in pattern.units}) > 1 or pattern.units[0].header:
        pieces = _closers(pieces, length, below)
        pieces = _mirrored(_closers(_mirrored(pieces), length, [-x for x in below]))
    pieces = _closed(pieces, length, below)
    return _mirrored(_closed(_mirrored(pieces), length, [-x for x in below]))


def _as_repeated(pattern: Pattern, span: Span, length: float, anchor: float) -> list[Piece]:
    """Repeat the units of a pattern, cut off at the ends of the span."""
    low, high = span
    lengths = np.array([unit.length for unit in pattern.units]) * length
    period, steps = float(lengths.sum()), np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
    first = int(np.floor((low - anchor - pattern.start * length) / period)) - 1
    count = int(np.ceil((high - low) / period)) + 3
    begin = anchor + pattern.start * length + first * period
    edges = (begin + period * np.arange(count)[:, None] + steps[None, :]).ravel()
    small = SAME_PLACE * length
    joints = edges[(edges > low + small) & (edges < high - small)]
    ends = np.concatenate([[low], joints, [high]])
    which = np.searchsorted(edges, (ends[:-1] + ends[1:]) / 2.0, side="right") - 1
    return [
        Piece(a, b, pattern.units[k % len(pattern.units)].header)
        for a, b, k in zip(ends[:-1].tolist(), ends[1:].tolist(), which.tolist(), strict=True)
    ]


def _mirrored(pieces: Sequence[Piece]) -> list[Piece]:
    return [Piece(-piece.end, -piece.start, piece.header) for piece in reversed(pieces)]


def _closers(pieces: list[Piece], length: float, below: Sequence[float]) -> list[Piece]:
    """Move a quarter block from the left end to behind the adjacent header, as queen closers are placed."""
    if len(pieces) < 3:
        return pieces
    quarter, header = pieces[0], pieces[1]
    small = SAME_PLACE * length
    fits = abs(quarter.end - quarter.start - 0.25 * length) < small
    if not fits or not header.header or abs(header.end - header.start - 0.5 * length) > small:
        return pieces
    joint = quarter.start + 0.5 * length
    if below and _clearance(joint, below) < 0.1 * length:
        return pieces
    return [Piece(quarter.start, joint, True), Piece(joint, header.end, True), *pieces[2:]]


def _closed(pieces: list[Piece], length: float, below: Sequence[float]) -> list[Piece]:
    """Remove a piece shorter than a quarter block at the left end: the next one is cut, or joined to it.

    The joint between both goes where it is furthest from those below.
    """
    if len(pieces) < 2 or pieces[0].end - pieces[0].start >= (LEAST_PIECE - SAME_PLACE) * length:
        return pieces
    short, beside = pieces[0], pieces[1]
    low, high = short.start, beside.end
    if high - low <= length * (1.0 + SAME_PLACE):
        return [Piece(low, high, beside.header), *pieces[2:]]
    least, middle = LEAST_PIECE * length, (low + high) / 2.0
    obstacles = sorted([x for x in below if low < x < high])
    stops = [low + least, *obstacles, high - least]
    places = {low + least, high - least, middle} | {(a + b) / 2.0 for a, b in zip(stops[:-1], stops[1:], strict=True)}
    room = [x for x in places if low + least <= x <= high - least]
    joint = max(room, key=lambda x: (round(_clearance(x, obstacles) / length, 6), -abs(x - middle)))
    return [Piece(low, joint, short.header), Piece(joint, high, beside.header), *pieces[2:]]


def _clearance(x: float, others: Sequence[float]) -> float:
    return min((abs(x - other) for other in others), default=0.0)


def without(span: Span, gaps: Sequence[Span], small: float) -> list[Span]:
    """Subtract gaps from a span, from left to right; pieces narrower than `small` [m] are dropped."""
    found, low = [], span[0]
    for start, end in sorted(gaps):
        if start - low > small:
            found.append((low, min(start, span[1])))
        low = max(low, end)
        if low >= span[1]:
            return found
    if span[1] - low > small:
        found.append((low, span[1]))
    return found


def are_through(share: float, count: int, course: int) -> list[bool]:
    """Select the through-stones of a course, evenly spaced and staggered from course to course."""
    if share == 0.0:
        return [False] * count
    start = 0.5 * (course % 2)
    steps = np.floor(share * np.arange(count + 1) + start + 1e-9)
    return (np.diff(steps) > 0.0).tolist()


def rubble(span: Span, levels: Span, size: float, course: int, below: Sequence[float]) -> list[np.ndarray]:
    """Generate rubble stones of unequal lengths and inclined head joints, of a mean length [m]: shapes (4, 2).

    They look irregular and are always the same. below: upper ends of the head joints below [m], of which theirs keep
    clear.
    """
    low, high = span
    count = max(1, round((high - low) / size))
    spread = _scattered(count, 7 * course + 1) * 0.6 + 0.7
    joints = low + (high - low) * np.cumsum(spread)[:-1] / spread.sum()
    slope = (_scattered(count, 11 * course + 5)[1:] - 0.5) * 0.2 * size
    feet = np.array([_clear(x, below, 0.12 * size) for x in joints - slope])
    heads = feet + 2.0 * slope
    feet, heads = np.concatenate([[low], feet, [high]]), np.concatenate([[low], heads, [high]])
    bottom, top = levels
    return [
        np.array([[feet[i], bottom], [feet[i + 1], bottom], [heads[i + 1], top], [heads[i], top]]) for i in range(count)
    ]


def _clear(x: float, others: Sequence[float], reach: float) -> float:
    """Move a place aside where another one is closer than reach [m]."""
    nearest = min(others, key=lambda other: abs(other - x), default=np.inf)
    if abs(nearest - x) >= reach:
        return x
    return nearest + (reach if x > nearest else -reach)


def _scattered(count: int, start: int) -> np.ndarray:
    """Return reproducible scattered numbers from 0 to 1: multiples of the golden ratio."""
    return np.modf((start + np.arange(count)) * 0.6180339887498949)[0]
