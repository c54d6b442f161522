"""Random walls: coursed with openings, stepped as buttresses and gables, with a buttress, rubble with sloping joints.

Each function draws one wall from a random generator, its lower left corner at the origin, on a fixed block.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from studies.polygons import rectangle

Rng = np.random.Generator
Blocks = list[dict[str, Any]]
Span = tuple[float, float]  # left and right end of a part of a course [m]


def free(name: str, corners: Sequence, **more: Any) -> dict[str, Any]:
    """A block by its corners, [[x, y], ...] [m]."""
    return {"id": name, "vertices": [[float(x), float(y)] for x, y in corners], **more}


def ground(left: float, right: float, depth: float = 0.3, name: str = "ground") -> dict[str, Any]:
    """A fixed block whose top is at y = 0."""
    return free(name, rectangle(left, -depth, right, 0.0), fixed=True)


def divided(rng: Rng, span: Span, mean: float) -> list[Span]:
    """A part of a course as blocks of random lengths, about `mean` long."""
    left, right = span
    count = max(1, round((right - left) / mean))
    shares = rng.uniform(0.6, 1.4, count)
    ends = left + (right - left) * np.concatenate([[0.0], np.cumsum(shares) / shares.sum()])
    ends[-1] = right
    return list(zip(ends[:-1].tolist(), ends[1:].tolist()))


def courses(rng: Rng, spans: Sequence[Sequence[Any]], levels: Sequence[float], mean: float, name: str = "w") -> Blocks:
    """Blocks of all courses; `spans`: where each course has any, (left, right), with a third item where it is one."""
    blocks: Blocks = []
    for k, parts in enumerate(spans):
        pieces = [piece for part in parts for piece in ([part[:2]] if len(part) > 2 else divided(rng, part, mean))]
        for n, (left, right) in enumerate(sorted(pieces)):
            blocks.append(free(f"{name}-{k + 1}-{n + 1}", rectangle(left, levels[k], right, levels[k + 1])))
    return blocks


def levels_of(rng: Rng, count: int, height: float) -> list[float]:
    """Bed joints of courses of random heights [m]."""
    heights = height * (rng.uniform(0.75, 1.3, count) if rng.random() < 0.5 else np.ones(count))
    return np.concatenate([[0.0], np.cumsum(heights)]).tolist()


def coursed(rng: Rng) -> Blocks:
    """A wall with a random bond and up to two openings, most of them with lintels."""
    block, height, count = rng.uniform(0.3, 0.7), rng.uniform(0.15, 0.35), int(rng.integers(3, 11))
    if rng.random() < 0.15:
        count += int(rng.integers(4, 10))
    length, levels = block * (0.6 * count if count > 11 else rng.uniform(2.5, 7.5)), levels_of(rng, count, height)
    spans: list[list[Any]] = [[(0.0, length)] for _ in range(count)]
    openings = int(rng.choice([0, 1, 2], p=[0.45, 0.4, 0.15])) if length > 3.6 * block and count >= 4 else 0
    for i in range(openings):
        bay = length / openings
        width = min(rng.uniform(0.7, 1.3) * block, bay - 2.4 * block)
        if width < 0.4 * block:
            continue
        left = i * bay + rng.uniform(1.0 * block, bay - width - 1.0 * block)
        low = int(rng.integers(0, count - 3))
        high = int(rng.integers(low + 2, count))
        for k in range(low, high):
            spans[k] = less(spans[k], (left, left + width))
        if rng.random() < 0.9:
            bearing = rng.uniform(0.25, 0.7) * block
            lintel = (left - bearing, left + width + bearing)
            spans[high] = [*less(spans[high], lintel), (*lintel, "lintel")]
    return [ground(-0.5, length + 0.5), *courses(rng, spans, levels, block)]


def bonded(rng: Rng) -> dict[str, Any]:
    """A [[structure]]: a wall of equal blocks in a regular bond, on a slope or not, its ends flush or toothed."""
    block, count = [rng.uniform(0.25, 0.6), rng.uniform(0.12, 0.3)], int(rng.integers(3, 10))
    table: dict[str, Any] = {"kind": "wall", "id": "wall", "block": block, "courses": count}
    table |= {"blocks_per_course": int(rng.integers(2, 7)), "ends": str(rng.choice(["half", "toothed"], p=[0.7, 0.3]))}
    bond = str(rng.choice(["running", "stack", "offset"], p=[0.5, 0.15, 0.35]))
    table |= {"offset": block[0] * rng.uniform(0.2, 0.8)} if bond == "offset" else {"bond": bond}
    if rng.random() < 0.2:
        table["rotation_deg"] = rng.uniform(-4.0, 4.0)
    return table


def less(spans: Sequence[Any], hole: Span) -> list[Any]:
    """What is left of a course beside a hole."""
    kept: list[Any] = []
    for left, right, *lintel in spans:
        if lintel or right <= hole[0] or left >= hole[1]:
            kept.append((left, right, *lintel))
            continue
        kept += [span for span in ((left, hole[0]), (hole[1], right)) if span[1] - span[0] > 1e-6]
    return kept


def stepped(rng: Rng) -> Blocks:
    """A wall that gets shorter from course to course, on one side (a buttress) or on both (a gable)."""
    block, height, count = rng.uniform(0.3, 0.6), rng.uniform(0.15, 0.35), int(rng.integers(4, 13))
    foot, top = block * rng.uniform(2.5, 8.0), block * rng.uniform(1.0, 2.0)
    steps = np.sort(rng.uniform(0.0, max(foot - top, 0.0), count - 1))
    rights = np.concatenate([[foot], foot - steps])
    both = rng.random() < 0.4
    lefts = np.concatenate([[0.0], 0.45 * steps]) if both else np.zeros(count)
    rights = foot - np.concatenate([[0.0], 0.45 * steps]) if both else rights
    spans = [[(left, right)] for left, right in zip(lefts.tolist(), rights.tolist())]
    blocks = [ground(-0.5, foot + 0.5), *courses(rng, spans, levels_of(rng, count, height), block)]
    return mirrored(blocks) if rng.random() < 0.5 else blocks


def side_by_side(rng: Rng) -> Blocks:
    """A thin wall and a buttress against it, each in courses of its own, with a straight joint between them."""
    height, count, width = rng.uniform(0.15, 0.3), int(rng.integers(5, 14)), rng.uniform(0.3, 0.6)
    levels = levels_of(rng, count, height)
    wall = courses(rng, [[(0.0, width)]] * count, levels, width * rng.uniform(0.5, 1.1), "wall")
    depth, share = rng.uniform(0.3, 0.9), rng.uniform(0.3, 0.9)
    fewer = max(2, round(count * share * rng.uniform(0.7, 1.2)))
    own = np.linspace(0.0, share * levels[-1], fewer + 1).tolist()
    buttress = courses(rng, [[(width, width + depth)]] * fewer, own, depth * rng.uniform(0.6, 1.2), "buttress")
    blocks = [ground(-0.6, width + depth + 0.6), *wall, *buttress]
    return mirrored(blocks) if rng.random() < 0.5 else blocks


def rubble(rng: Rng) -> Blocks:
    """Convex blocks with sloping bed and head joints, in an outline with a batter."""
    count, block = int(rng.integers(3, 10)), rng.uniform(0.3, 0.6)
    length, height = block * rng.uniform(2.0, 6.0), count * rng.uniform(0.2, 0.4)
    batter = rng.uniform(0.0, 0.12, 2) * height
    beds = np.arange(count + 1) / count + np.concatenate([[0.0], rng.uniform(-0.15, 0.15, count - 1), [0.0]]) / count
    slope = rng.uniform(-0.06, 0.06, count + 1) * (np.arange(count + 1) > 0) * length / height
    slope = np.clip(slope, -0.3 / count, 0.3 / count)

    def side(k: int, right: bool) -> np.ndarray:
        share = beds[k] + (0.5 if right else -0.5) * slope[k]
        lean = batter[1] if right else -batter[0]
        return np.array([(length if right else 0.0) - lean * share, height * share])

    blocks = [ground(-0.5, length + 0.5)]
    for k in range(count):
        cuts = np.array([share for _, share in divided(rng, (0.0, 1.0), block / length)])[:-1]
        lean = rng.uniform(-0.03, 0.03, len(cuts))
        low, high = ([0.0, *(cuts + sign * lean), 1.0] for sign in (-1.0, 1.0))
        foot, head = ([side(i, False), side(i, True)] for i in (k, k + 1))
        for n in range(len(low) - 1):
            corners = [on(foot, low[n]), on(foot, low[n + 1]), on(head, high[n + 1]), on(head, high[n])]
            blocks.append(free(f"r-{k + 1}-{n + 1}", corners))
    return blocks


def propped(rng: Rng) -> Blocks:
    """A thin wall with a slab that leans against it, on one side or on both: corners on faces."""
    width, height, count = rng.uniform(0.3, 0.6), rng.uniform(0.2, 0.4), int(rng.integers(4, 12))
    levels = levels_of(rng, count, height)
    blocks = courses(rng, [[(0.0, width)]] * count, levels, width * rng.uniform(0.6, 1.2))
    reach = 0.0
    for face, sign in ((0.0, -1.0), (width, 1.0))[: 1 + int(rng.random() < 0.4)]:
        k, angle = int(rng.integers(count // 2, count)), np.radians(rng.uniform(55.0, 80.0))
        top = levels[k] + rng.uniform(0.2, 0.8) * (levels[k + 1] - levels[k])
        foot, thick = top / np.tan(angle), rng.uniform(0.12, 0.3)
        up, back = thick * np.cos(angle), -thick * np.sin(angle)
        corners = [[-foot, 0.0], [0.0, top], [back, top + up], [back - foot, up]]
        turned = [[face - sign * x, y] for x, y in corners]
        blocks.append(free(f"prop{len(blocks)}", turned if sign < 0.0 else turned[::-1]))
        reach = max(reach, foot - back)
    blocks = [ground(-reach - 0.5, width + reach + 0.5), *blocks]
    return mirrored(blocks) if rng.random() < 0.5 else blocks


def on(ends: Sequence[np.ndarray], share: float) -> np.ndarray:
    """A point between two others."""
    return ends[0] + share * (ends[1] - ends[0])


def mirrored(blocks: Blocks) -> Blocks:
    """Left for right, about x = 0."""
    return [block | {"vertices": [[-x, y] for x, y in block["vertices"]][::-1]} for block in blocks]
