"""Rocking at default settings: blocks and frames drawn from seeds, against event-driven answers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from oracle import rocking_frame
from oracle.base_motion import Motion, Sine
from oracle.housner import Block, Rocking, rock

from studies.polygons import rectangle
from studies.rocking.single_block import FALLEN, one_block

KINDS = ("free", "pulse", "frame")
ASPECTS, HEIGHTS = (2.0, 10.0), (0.2, 10.0)  # h/b; [m], evenly in its logarithm
TILTS, STRENGTHS, SPEEDS = (0.3, 0.8), (1.1, 3.0), (1.0, 5.0)  # of α; amplitude over g tan α; pulse over p
BEAMS = (0.2, 3.0)  # mass over that of both columns, evenly in its logarithm
SHAPES = {"sine": (1.0, 0.0), "cosine": (1.0, 0.5 * math.pi), "half-sine": (0.5, 0.0)}  # cycles, phase
LEAST, MOST = 0.05, 0.95  # peaks that are compared, of α
CHANGE, STEADY = 1e-3, 5e-3  # of what drives it; well-conditioned: how far peaks change by that, at most
SWINGS = 4.0  # how long after the pulse is looked at, 1/p


class Drawn(NamedTuple):
    """One case: block or column, what moves it, and how long it is looked at."""

    kind: str
    seed: int
    block: Block
    beam: float  # mass of the beam over that of both columns; 0: no frame
    tilt: float  # of α
    shape: str
    motion: Sine | None
    duration: float  # [s]

    def exact(self, factor: float = 1.0) -> Rocking:
        """Event by event, with tilt and motion scaled."""
        body = rocking_frame.equivalent(self.block, self.beam)
        motion: Motion = Sine(0.0, 0.0)
        if self.motion is not None:
            m = self.motion
            motion = Sine(factor * m.amplitude, m.frequency, m.phase, m.duration)
        e = rocking_frame.restitution(self.block, self.beam)
        step = 2e-3 / body.p
        angle = factor * self.tilt * body.alpha
        return rock(body, motion, self.duration, angle=angle, restitution=e, step=step, bound=math.radians(FALLEN))

    def peaks(self, factor: float = 1.0) -> np.ndarray:
        """Those that are compared, of α: all swings above LEAST after a tilt, the largest under a pulse."""
        found = self.exact(factor)
        if self.motion is not None:
            return np.array([found.peak]) / self.block.alpha
        sizes = np.abs(found.extremes()[1]) / self.block.alpha
        return sizes

    @property
    def change(self) -> float:
        """How far the peaks change, at most, when the tilt or the pulse does by CHANGE."""
        now = self.peaks()
        others = [self.peaks(1.0 + sign * CHANGE) for sign in (-1.0, 1.0)]
        if any(len(o) != len(now) for o in others):
            return math.inf
        return float(max(np.abs(o / now - 1.0).max() for o in others))


def draw(kind: str, seed: int) -> Drawn:
    random = np.random.default_rng([seed, KINDS.index(kind)])
    aspect = random.uniform(*ASPECTS)
    height = float(np.exp(random.uniform(*np.log(HEIGHTS))))
    block = Block(height / aspect, height)
    beam = float(np.exp(random.uniform(*np.log(BEAMS)))) if kind == "frame" else 0.0
    p = rocking_frame.equivalent(block, beam).p
    if kind == "free":
        return Drawn(kind, seed, block, beam, random.uniform(*TILTS), "", None, 8.0 / p)
    shape = list(SHAPES)[random.integers(len(SHAPES))]
    cycles, phase = SHAPES[shape]
    frequency = random.uniform(*SPEEDS) * p / (2.0 * math.pi)
    strength = random.uniform(*STRENGTHS) * block.gravity * block.width / block.height
    motion = Sine(strength, frequency, phase, cycles / frequency)
    return Drawn(kind, seed, block, beam, 0.0, shape, motion, motion.duration + SWINGS / p)


def chosen(kind: str, count: int, first: int = 0) -> Iterator[Drawn]:
    """The first of them whose peaks are well-conditioned, and neither too small to be rocking nor overturning."""
    seed = first
    while count:
        case = draw(kind, seed)
        seed += 1
        peaks = case.peaks()
        if len(peaks) and LEAST < peaks.max() < MOST and np.isinf(case.exact().overturned) and case.change < STEADY:
            count -= 1
            yield case


def tables(case: Drawn, kn: Any = "auto") -> dict[str, Any]:
    """The case file of a drawn case."""
    motion = None
    if case.motion is not None:
        motion = {
            "kind": "pulse",
            "shape": case.shape,
            "amplitude": case.motion.amplitude,
            "frequency": case.motion.frequency,
        }
    rate = 300.0 * rocking_frame.equivalent(case.block, case.beam).p
    found = one_block(case.block, motion, case.duration, tilt=case.tilt * case.block.alpha, output={"rate": rate})
    found["joints"]["dry"]["kn"] = kn
    if case.beam:
        b, h = case.block.width, case.block.height
        gap = 2.0 * h
        left, right = -0.5 * b, 0.5 * b
        base = {"id": "base", "vertices": rectangle(-4 * h, -0.25 * h, gap + 4 * h, 0.0), "fixed": True}
        columns = [
            {"id": "block", "vertices": rectangle(left, 0.0, right, h)},
            {"id": "other", "vertices": rectangle(left + gap, 0.0, right + gap, h)},
        ]
        length = gap + 3.0 * b
        depth = 2.0 * case.beam * b * h / length
        beam = {"id": "beam", "vertices": rectangle(-1.5 * b, h, gap + 1.5 * b, h + depth)}
        found["block"] = [base, *columns, beam]
    return found


def peaks_of(case: Drawn, found) -> np.ndarray:
    if case.motion is not None:
        return np.array([np.abs(found.values[:, 0]).max()]) / case.block.alpha
    return found.extremes()[1] / case.block.alpha
