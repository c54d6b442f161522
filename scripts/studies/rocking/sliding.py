"""Sliding, bouncing, two blocks on each other, and the energy of a column that is shaken for 20 s."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from oracle import bouncing, two_blocks
from oracle.base_motion import Motion, Record, Sine, pulse, rectangle
from oracle.housner import Block
from oracle.newmark_slider import Slope, slide
from oracle.pairs import pair

from studies.polygons import rectangle as corners_of
from studies.rocking import single_block

FLAT = Block(1.0, 0.3)  # slides rather than rocks
SLIDES: dict[str, tuple[Motion, dict[str, Any], float, float]] = {  # exact motion, the same as a table, μ, β [°]
    "sine": (pulse(9.0, 1.0), {"kind": "pulse", "shape": "sine", "amplitude": 9.0, "frequency": 1.0}, 0.2, 0.0),
    "sine, it comes back": (
        pulse(6.0, 1.0), {"kind": "pulse", "shape": "sine", "amplitude": 6.0, "frequency": 1.0}, 0.3, 0.0
    ),
    "half sine": (
        pulse(6.0, 2.0, 0.5), {"kind": "pulse", "shape": "half-sine", "amplitude": 6.0, "frequency": 2.0}, 0.3, 0.0
    ),
    "rectangle": (
        rectangle(5.0, 0.3), {"kind": "pulse", "shape": "impulse", "amplitude": 5.0, "duration": 0.3}, 0.3, 0.0
    ),
    "10 cycles of 2 Hz": (
        Sine(5.0, 2.0, duration=5.0), {"kind": "harmonic", "amplitude": 5.0, "frequency": 2.0, "cycles": 10.0}, 0.3, 0.0
    ),
    "10 cycles on a slope of 10°": (
        Sine(4.0, 2.0, duration=5.0),
        {"kind": "harmonic", "amplitude": 4.0, "frequency": 2.0, "cycles": 10.0}, 0.4, 10.0,
    ),
}  # fmt: skip
COLUMN_BLOCKS, COLUMN_BLOCK, COLUMN_PEAK = 8, (0.4, 0.5), 1.4  # width and height [m], [m/s2]


def sliding(name: str, **how: Any) -> dict[str, Any]:
    """Final slip along the base, ours and exact [m]."""
    motion, table, friction, degrees = SLIDES[name]
    duration = motion.duration + 1.5
    exact = slide(Slope(friction, math.radians(degrees)), motion, duration)
    wanted = ({"quantity": "displacement", "component": "x"}, {"quantity": "displacement", "component": "y"})
    case = single_block.one_block(FLAT, table, duration, friction=friction, quantities=wanted, **how)
    _turn(case, math.radians(degrees))
    along = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
    slips = single_block.solve(case).values @ along
    return {"name": name, "exact": exact.final, "path": exact.path, "slip": float(slips[-1])}


def _turn(case: dict[str, Any], angle: float) -> None:
    """Base and block on a slope."""
    c, s = math.cos(angle), math.sin(angle)
    for block in case["block"]:
        block["vertices"] = [[c * x - s * y, s * x + c * y] for x, y in block["vertices"]]


def bounce(height: float = 0.05, count: int = 3, ratio: float = 0.0, **how: Any) -> dict[str, Any]:
    """Errors of the heights of the first bounces, and of the time at which the first of them is highest.

    ratio: of the dashpot of the joint, of critical; without one the largest overlap is compared too.
    """
    block = Block(1.0, 1.0)
    joint = bouncing.Joint(single_block.STIFFNESS * single_block.DENSITY * 9.81, single_block.DENSITY, ratio)
    exact = bouncing.heights(joint, height, count)
    speed = math.sqrt(2.0 * 9.81 * height)
    top = speed / 9.81 + bouncing.contact_time(joint, speed) + math.sqrt(2.0 * exact[0] / 9.81)
    damping = {"contact_fraction": ratio} if ratio else {"none": True}
    case = single_block.one_block(
        block, None, 0.75, damping, quantities=({"quantity": "displacement", "component": "y"},), **how
    )
    case["initial"] = [{"block": "block", "displacement": [0.0, height + joint.static]}]
    found = single_block.solve(case)
    tops = [(t, y) for t, y in zip(*found.extremes()) if found.at(t) > 0.0]
    heights = np.array([y for _, y in tops[:count]])
    overlap = -float(found.values.min()) / bouncing.peak_overlap(joint, height) - 1.0
    return {
        "ratio": ratio,
        "heights": (heights / exact[: len(heights)] - 1.0).tolist(),
        "time": float(tops[0][0] / top - 1.0),
        "overlap": None if ratio else overlap,
    }


STACKS = {"both to the left": (0.06, 0.10), "against each other": (0.06, -0.04), "the upper alone": (0.0, 0.15)}
LOWER, UPPER = (0.5, 1.0), (0.4, 1.2)  # width, height [m]


def stack(name: str, **how: Any) -> dict[str, Any]:
    """Two blocks that rock freely until a joint closes: largest error of both angles over the largest angle."""
    angles = STACKS[name]
    exact = two_blocks.rock(two_blocks.Rectangle(*LOWER), two_blocks.Rectangle(*UPPER), angles)
    case = single_block.one_block(Block(*LOWER), None, float(exact.times[-1]) + 0.1, **how)
    half = UPPER[0] / 2
    case["block"].append({"id": "upper", "vertices": corners_of(-half, LOWER[1], half, LOWER[1] + UPPER[1])})
    case["initial"] = [{"block": "upper", "tilt": angles[1] - angles[0]}]
    if angles[0]:
        case["initial"].append({"blocks": ["block", "upper"], "tilt": angles[0]})
    case["monitor"].append({"block": "upper", "quantity": "rotation"})
    found = single_block.solve(case)
    until = found.times <= exact.times[-1]
    wanted = [np.interp(found.times[until], exact.times, exact.angles[:, k]) for k in (0, 1)]
    error = np.abs(found.values[until, :2] - np.column_stack(wanted)).max()
    relative = found.values[:, 1] - found.values[:, 0] if exact.closed == "joint" else found.values[:, 0]
    first = np.flatnonzero(relative * relative[0] <= 0.0)
    closed = float(found.times[first[0]]) if len(first) else math.nan
    return {
        "name": name,
        "closes": exact.closed,
        "time": float(exact.times[-1]),
        "angles": float(error / np.abs(exact.angles).max()),
        "closure": closed / float(exact.times[-1]) - 1.0,
    }


def column(folder: Path, margin: float, seed: int, **how: Any) -> float:
    """Energy error over the largest energy of a column of 8 blocks that rocks for 20 s under a record, and stands."""
    width, height = COLUMN_BLOCK
    shaken = pair(seed).record
    strong = Record(shaken.dt, shaken.values * COLUMN_PEAK / np.abs(shaken.values).max())
    case = single_block.one_block(Block(width, height), single_block.record_file(folder, "column", strong), 20.0, **how)
    case["block"][1:] = [
        {"id": f"b{i}", "vertices": corners_of(-width / 2, i * height, width / 2, (i + 1) * height)}
        for i in range(COLUMN_BLOCKS)
    ]
    case["monitor"] = []
    case["analysis"]["margin"] = margin
    summary = single_block.solve(case).summary
    assert not summary["collapsed"], f"record {seed}: the column fell"
    return float(summary["energy_closure"])
