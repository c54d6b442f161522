"""Structures that move in space: a wall collapses, a column of drums shakes, a corner opens, an arch spreads."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from studies.motion_in_space.book import run
from studies.motion_in_space.single import ground, history
from studies.space.structures import box, corner_wall, prism, regular, solid

DASHPOTS = {"contact_fraction": 0.35}


def pushed_wall() -> list[dict]:
    """Sixty blocks of 0.4 × 0.2 × 0.2 m in running bond on a base that it can fall on: 6 courses of 10 and 11."""
    t, length = 0.2, 4.0
    blocks = [box("base", (-6.0, -6.0, -0.5), (10.0, 6.0, 0.0), fixed=True)]
    for k in range(6):
        shift = 0.0 if k % 2 == 0 else t
        cuts = [0.0, *np.arange(2 * t - shift, length - 1e-9, 2 * t), length]
        for i, (a, b) in enumerate(zip(cuts[:-1], cuts[1:])):
            blocks.append(box(f"b{k}-{i}", (a, 0.0, k * t), (b, t, (k + 1) * t)))
    return blocks


def wall_collapses(damping: dict | None, stiffness: float = 1e4, margin: float = 0.2) -> dict[str, Any]:
    """The wall, pushed out of its plane by 0.25 g for 0.45 s: it falls; energy is booked for 2.5 s."""
    case = history(
        *pushed_wall(),
        duration=2.5,
        friction=0.6,
        # X = kn A h / W of a block 0.2 m high
        stiffness=stiffness / 0.2 * 0.2,
        damping=damping or {"none": True},
        analysis={"margin": margin, "after_collapse": 10.0},
        motion={
            "kind": "pulse",
            "shape": "impulse",
            "amplitude": 0.25 * 9.81 * 2.0,
            "duration": 0.45,
            "direction": [0, 1, 0],
        },
        output={"frames": 0, "rate": 200.0},
    )
    found = run(case)
    words = "dashpots ζ 0.35" if damping else "no dashpots"
    return {
        "name": f"wall of {found.blocks} blocks collapses, {words}",
        "figure": "largest overlap [mm]",
        "exact": None,
        "found": 1e3 * max(row.overlap for row in found.seen.rows),
    } | found.books


def column_of_drums(duration: float = 20.0, sides: int = 8) -> dict[str, Any]:
    """Eight drums under three components of artificial records."""
    outline = regular(sides, 0.4)
    drums = [prism(f"drum-{k}", outline, 0.5 * k, 0.5 * (k + 1)) for k in range(8)]
    record = {"kind": "artificial", "spectrum": "EC8-1", "soil": "B", "ag": 2.0, "duration": duration}
    record |= {"plateau": min(10.0, 0.5 * duration), "rise": min(2.0, 0.1 * duration)}
    axes = (([1, 0, 0], 1.0, 1), ([0, 1, 0], 0.85, 2), ([0, 0, 1], 0.6, 3))
    case = history(
        ground(),
        *drums,
        duration=duration,
        friction=0.7,
        stiffness=1e4,
        damping=DASHPOTS,
        motion=[record | {"direction": d, "scale": scale, "seed": seed} for d, scale, seed in axes],
        monitor=[{"block": "drum-7", "component": c} for c in "xyz"],
        output={"frames": 0, "rate": 200.0},
    )
    found = run(case)
    top = float(np.linalg.norm(found.seen.values, axis=1).max())
    name = f"column of eight drums, three components, {duration:g} s"
    return {"name": name, "figure": "largest motion of the top [m]", "exact": None, "found": top} | found.books


def rocks_two_ways(duration: float = 6.0) -> dict[str, Any]:
    """A prism 0.4 × 0.5 × 1.5 m under a sine along each axis, out of phase: it rocks on edges and corners."""
    motions = [
        {"kind": "harmonic", "amplitude": a, "frequency": f, "duration": 3.0, "direction": d, "phase_deg": p}
        for a, f, d, p in ((4.0, 1.4, [1, 0, 0], 0.0), (4.5, 1.1, [0, 1, 0], 40.0))
    ]
    case = history(
        ground(),
        box("block", (-0.2, -0.25, 0.0), (0.2, 0.25, 1.5)),
        duration=duration,
        friction=0.8,
        damping=DASHPOTS,
        motion=motions,
        output={"frames": 0, "rate": 500.0},
    )
    case["monitor"] = [{"block": "block", "quantity": "rotation", "component": c} for c in "xyz"]
    found = run(case)
    tilt = float(np.linalg.norm(found.seen.values[:, :2], axis=1).max())
    return {"name": "prism rocks under two components", "figure": "largest tilt [rad]", "exact": None,
            "found": tilt} | found.books  # fmt: skip


def corner_opens() -> dict[str, Any]:
    """An L of two walls on a base that shakes across both: the corner opens."""
    case = history(
        *corner_wall(),
        duration=4.0,
        friction=0.6,
        stiffness=1e4,
        damping=DASHPOTS,
        motion={"kind": "harmonic", "amplitude": 4.0, "frequency": 2.0, "duration": 3.0, "direction": [1, 1, 0]},
        output={"frames": 0, "rate": 200.0},
    )
    case["monitor"] = [{"block": case["block"][-1]["id"], "component": c} for c in "xyz"]
    found = run(case)
    top = float(np.linalg.norm(found.seen.values, axis=1).max())
    return {"name": "L corner opens under 0.4 g at 45°", "figure": "largest motion of the end [m]", "exact": None,
            "found": top} | found.books  # fmt: skip


def barrel(voussoirs: int = 9, rows: int = 3) -> list[dict]:
    """A half barrel of rows of voussoirs on two springings."""
    inner, outer, width = 1.0, 1.25, 0.5
    angles = np.linspace(0.0, math.pi, voussoirs + 1)
    blocks = []
    for i, (a, b) in enumerate(zip(angles[:-1], angles[1:])):
        for r in range(rows):
            corners = [
                (-radius * math.cos(t), r * width + y, radius * math.sin(t))
                for radius in (inner, outer)
                for t in (a, b)
                for y in (0.0, width)
            ]
            blocks.append(solid(f"v{i}-{r}", corners))
    whole = rows * width
    left = box("left", (-1.4, 0.0, -0.3), (-0.9, whole, 0.0), fixed=True)
    right = box("right", (0.9, 0.0, -0.3), (1.4, whole, 0.0), fixed=True)
    return [left, right, *blocks]


def arch_spreads(apart: float = 0.02) -> dict[str, Any]:
    """The right springing moves out slowly: three hinge lines form, each row like the arch of the plane."""
    case = history(*barrel(), duration=1.0, friction=0.7, stiffness=1e5)
    for key in ("damping",):
        del case[key]
    case["analysis"] = {"kind": "settlement"}
    case["settlement"] = [{"block": "right", "displacement": [apart, 0.0, 0.0]}]
    case["monitor"] = [{"block": "v4-1", "component": "z"}]
    found = run(case)
    sinks = found.summary["monitors"]
    return {"name": "barrel arch on spreading supports", "figure": "crown sinks [mm]", "exact": None,
            "found": 1e3 * float(next(iter(sinks.values()))["value"])} | found.books  # fmt: skip
