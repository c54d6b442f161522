"""Generate the blocks of a wall in courses: plain rectangles, or masonry without short pieces; base, sides, lintels."""

from __future__ import annotations

import numpy as np

from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures import tops
from dem_cli.masonry.structures.bases import base_block
from dem_cli.masonry.structures.masonry import Masonry
from dem_cli.masonry.structures.masonry_blocks import masonry_blocks
from dem_cli.masonry.structures.openings import NARROWEST_PIECE
from dem_cli.masonry.structures.sides import SupportedWall, side_blocks
from dem_cli.masonry.structures.wall import Wall
from dem_cli.masonry.structures.wall_outline import hollows


def build(wall: Wall) -> list[Block]:
    """Generate the blocks of a wall, course by course from below, the base first, lintels last."""
    if wall.is_plain:
        boxes = [_course(wall, k) for k in range(len(wall.levels) - 1)]
        ends = (min(box[0, 0] for box in boxes), max(box[-1, 2] for box in boxes))
        laid = _plain_blocks(wall, boxes)
    else:
        ends = (0.0, wall.extent)
        laid = masonry_blocks(masonry_of(wall))
    blocks = []
    if wall.base:
        left, right = ends[0] - wall.base_extension, ends[1] + wall.base_extension
        shape = rectangle(left, -wall.base_depth, right - left, wall.base_depth)
        blocks.append(base_block("base", shape, wall.thickness, wall.base_extension))
    foot = -wall.base_depth if wall.base and not wall.base_extension else 0.0
    blocks += side_blocks(wall.sides, SupportedWall(wall.extent, wall.courses_top, wall.thickness, foot))
    blocks += laid
    if all(block.fixed for block in blocks):
        raise ValueError("the openings leave nothing of the wall")
    return blocks


def masonry_of(wall: Wall) -> Masonry:
    """Describe the masonry of a wall that is laid without short pieces."""
    levels = wall.levels
    courses = len(levels) - 1
    if wall.gable:
        levels = tops.with_gable(levels, wall.gable, wall.block[1])
    top, stepped = wall.top_line, wall.gable is not None and wall.gable.edges == "stepped"
    spans = [((0.0, wall.extent),)] * courses
    if wall.gable and top is not None:
        edges = zip(levels[courses:-1].tolist(), levels[courses + 1 :].tolist(), strict=True)
        spans += [(tops.level_span(top, (low + high) / 2.0 if stepped else low),) for low, high in edges]
    return Masonry(
        length=wall.block[0],
        thickness=wall.thickness,
        levels=levels,
        spans=spans,
        bond=wall.bond or "running",
        offset=wall.offset,
        first=wall.first,
        lengths=wall.course_lengths and (*wall.course_lengths, *[wall.block[0]] * (len(spans) - courses)),
        leaves=wall.leaves,
        through_stones=wall.through_stones,
        core=wall.core,
        quoins=wall.quoins,
        quoin_courses=wall.quoin_courses,
        openings=wall.all_openings,
        hollows=hollows(wall.outline),
        top=None if stepped else top,
    )


def _plain_blocks(wall: Wall, boxes: list[np.ndarray]) -> list[Block]:
    """Create the blocks of rectangles (n, 4) cut by openings; lintels last."""
    holes = [opening.box for opening in wall.openings]
    lintels = [opening.lintel_box for opening in wall.openings]
    blocks = []
    small = NARROWEST_PIECE * min(wall.block[0], wall.block[1])
    for k, box in enumerate(boxes):
        pieces = box
        for hole in (*holes, *(lintel for lintel in lintels if lintel)):
            pieces = _cut(pieces, hole, small)
        for n, shape in enumerate(_corners(pieces)):
            blocks.append(Block(f"{k + 1}-{n + 1}", (shape,), "", wall.thickness, course=k + 1))
    for i, (opening, lintel_box) in enumerate(zip(wall.openings, lintels, strict=True)):
        if opening.lintel:
            shape = _corners(np.array([lintel_box]))[0]
            blocks.append(Block(f"lintel-{i + 1}", (shape,), opening.lintel.material, wall.thickness))
    return blocks


def _course(wall: Wall, k: int) -> np.ndarray:
    """Return the boxes [left, bottom, right, top] of course k (from 0), (n, 4), from left to right."""
    length = wall.course_lengths[k] if wall.course_lengths else wall.block[0]
    shift = wall.offset if wall.offset is not None else (0.0 if wall.bond == "stack" else length / 2.0)
    if k % 2 == (0 if wall.first == "full" else 1):
        shift = 0.0
    count = round(wall.extent / length, 6)
    if wall.ends == "toothed":
        heads = shift + length * np.arange(max(int(count), 1) + 1)
    else:
        inner = shift + length * np.arange(int(np.ceil(count)) + 1)
        small = NARROWEST_PIECE * length
        inner = inner[(inner > small) & (inner < wall.extent - small)]
        heads = np.concatenate([[0.0], inner, [wall.extent]])
    low, high = wall.levels[k : k + 2]
    ones = np.ones(len(heads) - 1)
    return np.stack([heads[:-1], low * ones, heads[1:], high * ones], axis=1)


def _cut(boxes: np.ndarray, hole: tuple[float, float, float, float], small: float) -> np.ndarray:
    """Subtract a hole from boxes (n, 4): pieces left and right at full height, others below and above it."""
    left, bottom, right, top = hole
    hit = (boxes[:, 0] < right - small) & (boxes[:, 2] > left + small)
    hit &= (boxes[:, 1] < top - small) & (boxes[:, 3] > bottom + small)
    if not hit.any():
        return boxes
    b = boxes[hit]
    x0, x1 = np.clip(left, b[:, 0], b[:, 2]), np.clip(right, b[:, 0], b[:, 2])
    y0, y1 = np.clip(bottom, b[:, 1], b[:, 3]), np.clip(top, b[:, 1], b[:, 3])
    pieces = np.concatenate(
        [
            np.stack([b[:, 0], b[:, 1], x0, b[:, 3]], axis=1),
            np.stack([x1, b[:, 1], b[:, 2], b[:, 3]], axis=1),
            np.stack([x0, b[:, 1], x1, y0], axis=1),
            np.stack([x0, y1, x1, b[:, 3]], axis=1),
        ]
    )
    pieces = pieces[(pieces[:, 2] - pieces[:, 0] > small) & (pieces[:, 3] - pieces[:, 1] > small)]
    kept = np.concatenate([boxes[~hit], pieces])
    return kept[np.lexsort((kept[:, 1], kept[:, 0]))]


def _corners(boxes: np.ndarray) -> np.ndarray:
    """Return the corners of boxes (n, 4), counter-clockwise, (n, 4, 2)."""
    x0, y0, x1, y1 = boxes.T
    return np.stack([x0, y0, x1, y0, x1, y1, x0, y1], axis=1).reshape(-1, 4, 2)
