"""Column, walls and single block on the thesis's own joint (microrotation.py), and the sweep over the load (7.3.2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from oracle.microrotation import SAFETY, Blocks, Joints, Rule, advance

TOUCH = 1e-9  # m: sides that are one line
Box = tuple[float, float, float, float]  # left, bottom, right, top [m]


class Structure(NamedTuple):
    """What stands on what, and from where its load is swept."""

    boxes: tuple[Box, ...]  # those below y = 0 are fixed; the last one is watched
    weight: float  # per area of the plane [N/m2]
    stiffness: float  # of a node [N/m]
    lengths: tuple[float, ...]  # sides of the polygon [m]
    aperture: float  # [m]
    friction: float
    start: float  # first load over the weight
    step: float


class Patience(NamedTuple):
    """When a load counts as carried."""

    ramp: int = 2000  # steps in which the load is raised
    tolerance: float = 1e-4  # unbalanced force over the weight of a block: at rest
    idle: int = 60_000  # steps without a turn completed in which nothing moves by `still`
    still: float = 1e-6  # [m]
    most: int = 400_000  # steps under one load; what still moves then is restless, and counts as carried
    limit: float = 0.015  # displacement in one step of the load [m]: failed


class Load(NamedTuple):
    """One load of a sweep."""

    load: float
    state: str  # rest, idle, restless, failed
    top: float  # horizontal displacement of the watched block's centroid [m]
    sinks: float  # farthest down that a centroid is from its place in the drawing [m]
    turns: int  # completed under this load
    steps: int


def wall(block: tuple[float, float], courses: int, per_course: int, whole_base: bool) -> tuple[Box, ...]:
    """Running bond, the lowest course with half blocks, on a fixed course of whole blocks or on one long block."""
    width, height = block
    whole = [i * width for i in range(per_course + 1)]
    halves = [0.0, *(x + 0.5 * width for x in whole[:-1]), whole[-1]]
    rows = [(-height, 0.0, [-width, whole[-1] + width] if whole_base else whole)]
    rows += [(i * height, (i + 1) * height, whole if i % 2 else halves) for i in range(courses)]
    return tuple((left, bottom, right, top) for bottom, top, ends in rows for left, right in zip(ends, ends[1:]))


def column(block: tuple[float, float], courses: int) -> tuple[Box, ...]:
    """One upon the other, on a wider fixed block."""
    width, height = block
    return (-width, -height, 2.0 * width, 0.0), *((0.0, i * height, width, (i + 1) * height) for i in range(courses))


def structures(whole_base: bool = False) -> dict[str, Structure]:
    """Those of 7.3.3, 7.4 and 7.5 by name; peperino of 2143 kg/m3, 80 mm thick."""
    joint, peperino = ((0.016, 0.008, 0.016), 1e-4, 0.6), (0.08 * 2143.0 * 9.81, 2e6)
    stones = {
        "column_14": (column((0.04, 0.0175), 14), 0.1, 0.0005),
        "t21": (wall((0.04, 0.0175), 6, 3, whole_base), 0.3, 0.01),
        "t110": (wall((0.08, 0.0175), 20, 5, whole_base), 0.4, 0.01),
        "t231": (wall((0.04, 0.0175), 22, 10, whole_base), 0.28, 0.01),
    }
    found = {name: Structure(boxes, *peperino, *joint, *sweep) for name, (boxes, *sweep) in stones.items()}
    return found | {"block": Structure(column((1.0, 1.0), 1), 10.0, 1e5, (0.2,) * 5, 0.01, 1.0, 0.0, 0.01)}


def polygon(lengths: Sequence[float], aperture: float, length: float, scaled: bool) -> tuple[np.ndarray, np.ndarray]:
    """Vertices from node 1 (sides + 1,) [m] and the angle to the middle side (sides,) on a joint of this length.

    Inscribed in a circle, all sides long beside the aperture (7.3.1). scaled: lengths are those of the whole block, and
    scale with the joint, not so the aperture; else they are kept, and the polygon is cut where the joint ends.
    """
    x = np.concatenate([[0.0], np.cumsum(lengths)]) - 0.5 * np.sum(lengths)
    if scaled:
        x *= length / np.sum(lengths)
    slopes = np.diff(aperture * x**2 / (x[0] ** 2 - (x[1:-1] ** 2).min())) / np.diff(x)
    places = x + 0.5 * length
    places[0], places[-1] = 0.0, length
    return places, slopes - slopes[len(slopes) // 2]


def touching(boxes: np.ndarray) -> list[tuple[int, int, bool, float]]:
    """Joints: block, block to the right of it or above, whether upright, length of the overlap [m]."""
    found = []
    for a, box in enumerate(boxes):
        for b, other in enumerate(boxes):
            if max(box[1], other[1]) < -TOUCH:  # both fixed
                continue
            for head, (across, along) in ((False, (1, 0)), (True, (0, 1))):
                overlap = min(box[along + 2], other[along + 2]) - max(box[along], other[along])
                if abs(box[across + 2] - other[across]) < TOUCH and overlap > TOUCH:
                    found.append((a, b, head, overlap))
    return found


def assemble(structure: Structure, scaled: bool) -> tuple[Blocks, Joints]:
    """Blocks and joints at the start; only bed joints have polygons."""
    boxes, pairs = np.array(structure.boxes), touching(np.array(structure.boxes))
    half = 0.5 * (boxes[:, 2:] - boxes[:, :2])
    n, m, sides = len(boxes), len(pairs), len(structure.lengths)
    mass = np.zeros((n, 3))
    for a, b, _, _ in pairs:
        for i in (a, b):
            mass[i] += SAFETY * 4.0 * structure.stiffness * np.array([1.0, 1.0, (half[i] ** 2).sum()])
    mass[boxes[:, 1] < -TOUCH] = 0.0
    first, second, head, length = (np.array(column) for column in zip(*pairs))
    vertex, angle, last = np.zeros((m, sides + 1)), np.zeros((m, sides)), np.zeros(m, np.int64)
    for j in np.flatnonzero(~head):
        vertex[j], angle[j] = polygon(structure.lengths, structure.aperture, length[j], scaled)
        last[j] = sides - 1
    blocks = Blocks(
        np.column_stack([0.5 * (boxes[:, :2] + boxes[:, 2:]), np.zeros(n)]), np.tile([1.0, 0.0], (n, 1)),
        np.zeros((n, 3)), np.zeros((n, 3)), half, structure.weight * 4.0 * half.prod(axis=1), mass,
    )  # fmt: skip
    joints = Joints(
        first, second, head, length, np.full(m, structure.stiffness), vertex, angle, last, last // 2, np.zeros(m),
        *(np.zeros((m, 2)) for _ in range(3)),
    )  # fmt: skip
    return blocks, joints


class Sweep:
    """One structure under gravity on plane joints, then under loads raised step by step."""

    def __init__(self, structure: Structure, rule: Rule, patience: Patience, scaled: bool) -> None:
        self.rule, self.patience = rule, patience
        self.blocks, self.joints = assemble(structure, scaled)
        self.begin, self.load = self.blocks.place.copy(), 0.0
        self.carry(0.0, flows=False)

    def carry(self, load: float, flows: bool = True) -> Load:
        """Raise the load to this one and wait; `flows`: joints turn, and more than `limit` is failure."""
        patience, place = self.patience, self.blocks.place
        before = mark = place.copy()
        steps, turns, since, state = 0, 0, 0, ""
        while not state:
            loads = (self.load, load, 0 if steps else patience.ramp)
            found = advance(self.blocks, self.joints, self.rule, loads, patience.ramp, flows)
            unbalanced, flowing, completed = found
            steps, turns = steps + patience.ramp, turns + completed
            if flows and _farthest(place - before) > patience.limit:
                state = "failed"
            elif unbalanced < patience.tolerance and flowing == 0:
                state = "rest"
            elif completed == 0 and steps - since >= patience.idle:
                state = "idle" if _farthest(place - mark) < patience.still else ""
                mark, since = place.copy(), steps
            if not state and steps >= patience.most:
                state = "restless"
        self.load = load
        moved = place - self.begin
        return Load(load, state, float(moved[-1, 0]), float(moved[:, 1].min()), turns, steps)


def _farthest(moved: np.ndarray) -> float:
    return float(np.abs(moved[:, :2]).max())


def sweep(structure: Structure, rule: Rule, patience: Patience, scaled: bool = True) -> Iterator[Load]:
    """Loads from `start` on by `step` until one fails, 1 at most; `scaled`: see `polygon`."""
    raised = Sweep(structure, rule, patience, scaled)
    for i in range(int((1.0 - structure.start) / structure.step + TOUCH) + 1):
        row = raised.carry(round(structure.start + i * structure.step, 9))
        yield row
        if row.state == "failed":
            return
