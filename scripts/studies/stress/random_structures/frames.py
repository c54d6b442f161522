"""Random arches, arcades, columns of drums out of line, and colonnades that carry beams; on fixed blocks."""

from __future__ import annotations

from typing import Any

import numpy as np

from studies.polygons import rectangle
from studies.stress.random_structures.walls import Blocks, Rng, free, ground


def arch(rng: Rng) -> dict[str, Any]:
    """A [[structure]]: an arch of any shape, on springings, columns or buttresses."""
    shape = str(rng.choice(["circular", "segmental", "pointed", "flat"], p=[0.35, 0.35, 0.2, 0.1]))
    span = rng.uniform(1.0, 5.0)
    ring = span * rng.uniform(0.09, 0.2)
    table: dict[str, Any] = {"kind": "arch", "id": "arch", "shape": shape, "ring": ring}
    if shape == "circular":
        table |= {"radius": span / 2.0, "included_angle_deg": float(rng.choice([120.0, 140.0, 160.0, 180.0]))}
    elif shape == "segmental":
        table |= {"span": span, "rise": span * rng.uniform(0.15, 0.45)}
    elif shape == "pointed":
        table |= {"span": span, "rise": span * rng.uniform(0.6, 1.0)}
    else:
        table |= {"span": span, "skew_deg": rng.uniform(10.0, 30.0), "ring": 2.0 * ring}
    table["voussoirs"] = int(rng.integers(3, 14) * 2 + (shape != "pointed" and rng.random() < 0.7))
    if rng.random() < 0.6 and shape != "flat":
        wide = rng.random() < 0.6
        pier = {
            "width": ring * rng.uniform(1.6, 4.5 if wide else 2.2),
            "height": span * rng.uniform(0.2, 0.6),
            "courses": int(rng.integers(1, 7)),
        }
        table["buttresses" if wide else "columns"] = pier
    return table


def arcade(rng: Rng) -> Blocks:
    """Two to four arches of different spans on common piers, springing from a block with two skewed faces."""
    bays, ring = int(rng.integers(2, 5)), rng.uniform(0.15, 0.3)
    spans = rng.uniform(1.0, 2.4, bays)
    half_angle = np.radians(rng.uniform(50.0, 90.0))
    width = ring * rng.uniform(2.2, 3.6)
    height, count = rng.uniform(0.3, 1.8), int(rng.integers(1, 5))
    blocks: Blocks = []
    left = 0.0
    for i in range(bays + 1):
        foot = ground(left - 0.2, left + width + 0.2, name=f"ground-{i}")
        blocks += [foot, *pier(f"pier-{i}", left, width, height, count), springer(f"springer-{i}", left, width, height)]
        blocks[-1]["vertices"][2:] = skewback(left, width, height, ring, half_angle)
        if i < bays:
            number = int(rng.integers(3, 8)) * 2 + 1
            blocks += voussoirs(f"arch-{i}", (left + width, left + width + spans[i]), height, ring, half_angle, number)
            left += width + spans[i]
    return blocks


def pier(name: str, left: float, width: float, height: float, count: int) -> Blocks:
    """Equal courses of one block."""
    levels = np.linspace(0.0, 0.75 * height, count + 1).tolist()
    ends = zip(levels[:-1], levels[1:])
    return [free(f"{name}-{k + 1}", rectangle(left, low, left + width, top)) for k, (low, top) in enumerate(ends)]


def springer(name: str, left: float, width: float, height: float) -> dict[str, Any]:
    """The lower edge of the block that arches spring from; its upper corners are those of the skewback."""
    return free(name, rectangle(left, 0.75 * height, left + width, height))


def skewback(left: float, width: float, height: float, ring: float, half_angle: float) -> list[list[float]]:
    """Corners from lower right to lower left: inner and outer end of the right springing, those of the left one."""
    over, up = float(ring * np.sin(half_angle)), float(ring * np.cos(half_angle))
    right = left + width
    corners = [[right, height], [right - over, height + up], [left + over, height + up], [left, height]]
    return [corner for k, corner in enumerate(corners) if up > 1e-9 or k in (0, 3)]


def voussoirs(
    name: str, ends: tuple[float, float], height: float, ring: float, half_angle: float, number: int
) -> Blocks:
    """A ring between two springings, inner faces `ends` [m] apart."""
    inner = 0.5 * (ends[1] - ends[0]) / np.sin(half_angle)
    middle, centre = 0.5 * (ends[0] + ends[1]), height - inner * np.cos(half_angle)
    angles = half_angle * (1.0 - 2.0 * np.arange(number + 1) / number)
    ray = np.stack([-np.sin(angles), np.cos(angles)], axis=1)
    low, high = ([middle, centre] + radius * ray for radius in (inner, inner + ring))
    quads = [[low[k], low[k + 1], high[k + 1], high[k]] for k in range(number)]
    return [free(f"{name}-{k + 1}", quad) for k, quad in enumerate(quads)]


def drums(rng: Rng) -> Blocks:
    """One to three columns of drums that stand out of line."""
    blocks: Blocks = []
    for i in range(int(rng.choice([1, 2, 3], p=[0.6, 0.25, 0.15]))):
        width, count = rng.uniform(0.4, 0.9), int(rng.integers(4, 16))
        heights = rng.uniform(0.2, 0.6) * rng.uniform(0.7, 1.3, count)
        blocks += column(rng, f"c{i}", 3.0 * i, width, heights.tolist())
    places = [x for block in blocks for x, _ in block["vertices"]]
    return [ground(min(places) - 0.5, max(places) + 0.5), *blocks]


def column(rng: Rng, name: str, axis: float, width: float, heights: list[float]) -> Blocks:
    """Drums on top of each other, tapered as a whole, each off the axis by up to 6 % of its width."""
    taper, off = rng.uniform(0.0, 0.3), rng.uniform(0.0, 0.06)
    blocks, low = [], 0.0
    for k, high in enumerate(heights):
        half = 0.5 * width * (1.0 - taper * k / len(heights))
        middle = axis + width * off * rng.uniform(-1.0, 1.0)
        blocks.append(free(f"{name}-{k + 1}", rectangle(middle - half, low, middle + half, low + high)))
        low += high
    return blocks


def colonnade(rng: Rng) -> Blocks:
    """Columns of equal height, beams from axis to axis, maybe a course of blocks on them."""
    number, width, count = int(rng.integers(2, 6)), rng.uniform(0.4, 0.8), int(rng.integers(2, 7))
    clear, height, depth = rng.uniform(1.0, 2.0), rng.uniform(1.5, 3.5), rng.uniform(0.3, 0.6)
    axes = [(clear + width) * i for i in range(number)]
    blocks: Blocks = []
    for i, axis in enumerate(axes):
        shares = rng.uniform(0.7, 1.3, count)
        levels = height * np.concatenate([[0.0], np.cumsum(shares) / shares.sum()])
        levels[-1] = height
        made = column(rng, f"c{i}", axis, width, np.diff(levels).tolist())
        for k, block in enumerate(made):  # tops of all columns at one height, to the last bit
            for n, level in enumerate((levels[k], levels[k], levels[k + 1], levels[k + 1])):
                block["vertices"][n][1] = float(level)
        blocks += made
    ends = [axes[0] - 0.5 * width, *axes[1:-1], axes[-1] + 0.5 * width]
    for k in range(int(rng.integers(1, 3))):
        low = height + k * depth
        if k == 1:
            ends = sorted({ends[0], ends[-1], *(np.array(ends[:-1]) + 0.5 * np.diff(ends)).tolist()})
        spans = zip(ends[:-1], ends[1:])
        blocks += [free(f"beam-{k}-{n}", rectangle(a, low, b, low + depth)) for n, (a, b) in enumerate(spans)]
    return [ground(-1.0, axes[-1] + 1.0), *blocks]
