"""Rocking on joints of "auto" stiffness: blocks and two-column frames drawn from seeds, against exact peaks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from oracle import rocking_frame
from oracle.base_motion import REST, Sine
from oracle.housner import Block, Rocking, rock

from dem_cli.core.engine.settings import DEFAULT, Settings
from studies.polygons import rectangle
from studies.rocking.single_block import Response, fallen_angle, one_block, solve

KINDS = ("free", "pulse", "frame")
ASPECTS, HEIGHTS = (2.0, 10.0), (0.2, 10.0)  # h/b; [m], evenly in its logarithm
TILTS, STRENGTHS, SPEEDS = (0.3, 0.8), (1.1, 3.0), (1.0, 5.0)  # of α; amplitude over g tan α; pulse over p
BEAMS = (0.2, 3.0)  # mass over that of both columns, evenly in its logarithm
SHAPES = {"sine": (1.0, 0.0), "cosine": (1.0, 0.5 * math.pi), "half-sine": (0.5, 0.0)}  # cycles, phase
LEAST, MOST = 0.1, 0.95  # peaks that are compared, of α
CHANGE, STEADY = 1e-3, 5e-3  # of what drives it; well-conditioned: how far peaks change by that, at most
SWINGS, AFTER = 30.0, 6.0  # how long is looked after a tilt, and after a pulse, 1/p
ENDS = 0.98  # of that time: later impacts may come too late here or there
FIRST, COUNT = 14_000, 10  # seed, and cases of each kind
TURNS = {"before": math.inf, "1e-4": 1e-4, "1e-5": 1e-5, "default": DEFAULT.rocking.turn}  # rad


class DrawnCase(NamedTuple):
    """One case: block or column, what moves it, and how long it is looked at."""

    kind: str
    seed: int
    block: Block
    beam: float  # mass of the beam over that of both columns; 0: no frame
    tilt: float  # of α
    shape: str
    motion: Sine
    duration: float  # [s]

    def exact(self, factor: float = 1.0) -> Rocking:
        """Event by event, with tilt and motion scaled."""
        body = rocking_frame.equivalent(self.block, self.beam)
        motion = replace(self.motion, amplitude=factor * self.motion.amplitude)
        return rock(
            body, motion, self.duration, angle=factor * self.tilt * body.alpha, step=2e-3 / body.p,
            restitution=rocking_frame.restitution(self.block, self.beam), bound=fallen_angle(),
        )  # fmt: skip

    def peaks(self, factor: float = 1.0) -> np.ndarray:
        """Of α: all swings after a tilt, the largest angle under a pulse."""
        found = self.exact(factor)
        whole = int((found.impacts < ENDS * self.duration).sum()) - 1  # swings between two impacts
        sizes = np.abs(found.extremes()[1][:whole]) if self.tilt else np.array([found.peak])
        return sizes / self.block.alpha

    def compared(self) -> np.ndarray:
        """Peaks that are not too small to be rocking."""
        peaks = self.peaks()
        return peaks[peaks > LEAST]

    def change(self) -> float:
        """How far these change, at most, when the tilt or the pulse does by CHANGE."""
        now = self.compared()
        others = [self.peaks(1.0 + sign * CHANGE)[: len(now)] for sign in (-1.0, 1.0)]
        return float(max(np.abs(other / now - 1.0).max() for other in others))

    def well_conditioned(self) -> bool:
        """Whether it rocks, does not overturn, and its peaks mean something."""
        peaks = self.compared()
        if not len(peaks) or peaks.max() > MOST or np.isfinite(self.exact().overturned):
            return False
        return self.change() < STEADY


def draw(kind: str, seed: int) -> DrawnCase:
    """Sizes, and a tilt or a pulse."""
    random = np.random.default_rng([seed, KINDS.index(kind)])
    aspect, height = random.uniform(*ASPECTS), evenly(random, HEIGHTS)
    block = Block(height / aspect, height)
    beam = evenly(random, BEAMS) if kind == "frame" else 0.0
    p = rocking_frame.equivalent(block, beam).p
    if kind == "free":
        return DrawnCase(kind, seed, block, beam, random.uniform(*TILTS), "", REST, SWINGS / p)
    shape = list(SHAPES)[random.integers(len(SHAPES))]
    cycles, phase = SHAPES[shape]
    frequency = random.uniform(*SPEEDS) * p / (2.0 * math.pi)
    strength = random.uniform(*STRENGTHS) * block.gravity * block.width / block.height
    motion = Sine(strength, frequency, phase, cycles / frequency)
    return DrawnCase(kind, seed, block, beam, 0.0, shape, motion, motion.duration + AFTER / p)


def evenly(random: np.random.Generator, ends: tuple[float, float]) -> float:
    """Evenly in its logarithm."""
    return float(np.exp(random.uniform(*np.log(ends))))


def drawn(kind: str, count: int, first: int = FIRST) -> Iterator[DrawnCase]:
    """The first well-conditioned ones from a seed on."""
    seed = first
    while count:
        case = draw(kind, seed)
        seed += 1
        if case.well_conditioned():
            count -= 1
            yield case


def tables(case: DrawnCase) -> dict[str, Any]:
    """Its case file, with joints of "auto" stiffness."""
    sine = case.motion
    motion = {"kind": "pulse", "shape": case.shape, "amplitude": sine.amplitude, "frequency": sine.frequency}
    rate = 300.0 * rocking_frame.equivalent(case.block, case.beam).p
    found = one_block(
        case.block, motion if case.shape else None, case.duration, tilt=case.tilt * case.block.alpha,
        output={"rate": rate},
    )  # fmt: skip
    found["joints"]["dry"]["kn"] = "auto"
    if case.beam:
        found["block"] = frame(case.block, case.beam)
    return found


def frame(column: Block, beam: float) -> list[dict[str, Any]]:
    """Two columns on a base, the first called "block", and a beam that is longer than they are apart."""
    b, h = column.width, column.height
    apart = 2.0 * h
    depth = 2.0 * beam * b * h / (apart + 3.0 * b)
    return [
        {"id": "base", "vertices": rectangle(-4.0 * h, -0.25 * h, apart + 4.0 * h, 0.0), "fixed": True},
        {"id": "block", "vertices": rectangle(-0.5 * b, 0.0, 0.5 * b, h)},
        {"id": "other", "vertices": rectangle(apart - 0.5 * b, 0.0, apart + 0.5 * b, h)},
        {"id": "beam", "vertices": rectangle(-1.5 * b, h, apart + 1.5 * b, h + depth)},
    ]


def error(case: DrawnCase, found: Response) -> float:
    """The largest of all compared peaks, with its sign."""
    exact = case.compared()
    sizes = found.extremes()[1] if case.tilt else np.array([np.abs(found.values[:, 0]).max()])
    sizes = sizes[: len(exact)] / case.block.alpha
    errors = np.append(sizes / exact[: len(sizes)] - 1.0, [-1.0] * (len(exact) - len(sizes)))  # −1: a swing is missing
    return float(errors[np.abs(errors).argmax()])


def at(turn: float) -> Settings:
    """Settings with which blocks turn elastically by so much [rad]; infinite: the softest joints."""
    return replace(DEFAULT, rocking=replace(DEFAULT.rocking, turn=turn))


def compared(case: DrawnCase) -> dict[str, Any]:
    """Errors and steps on softer joints and at default settings, with what that run said of itself."""
    errors, steps = {}, {}
    for name, turn in TURNS.items():
        found = solve(tables(case), settings=at(turn))
        errors[name], steps[name] = error(case, found), found.summary["steps"]
    peaks, block = case.compared(), case.block
    return {
        "kind": case.kind, "seed": case.seed, "aspect": block.height / block.width, "height": block.height,
        "beam": case.beam, "tilt": case.tilt, "shape": case.shape,
        "strength": case.motion.amplitude / (block.gravity * block.width / block.height),
        "speed": 2.0 * math.pi * case.motion.frequency / rocking_frame.equivalent(block, case.beam).p,
        "swings": len(peaks), "peak": float(peaks.max()), "change": case.change(), "errors": errors, "steps": steps,
        "moved": found.summary["softer_joints_move"], "warnings": len(found.summary["warnings"]),
    }  # fmt: skip


def slender_block() -> DrawnCase:
    """A block that stayed at rest on joints of kn h/W = 1e5, for which its motion is too ill-conditioned."""
    block = Block(0.305 / 6.9, 0.305)
    motion = Sine(1.19 * block.gravity * block.width / block.height, 2.23, 0.5 * math.pi, 1.0 / 2.23)
    return DrawnCase("slender", 0, block, 0.0, 0.0, "cosine", motion, 2.0)


def rows() -> Iterator[dict[str, Any]]:
    """The slender block, then all that are drawn."""
    yield compared(slender_block())
    yield from (compared(case) for kind in KINDS for case in drawn(kind, COUNT))
