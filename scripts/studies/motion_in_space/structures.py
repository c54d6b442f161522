"""Structures that move in space: a wall collapses, a column of drums shakes, a corner opens, an arch spreads."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from studies.motion_in_space.book import run
from studies.motion_in_space.single import ground, history
from studies.polygons import rectangle
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
        for a, f, d, p in ((3.4, 1.4, [1, 0, 0], 0.0), (4.0, 1.8, [0, 1, 0], 40.0))
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


INNER, OUTER, VOUSSOIRS = 1.0, 1.25, 9


def voussoirs() -> list[list[tuple[float, float]]]:
    """Corners (x, z) of the voussoirs of a half circle, counter-clockwise."""
    angles = np.linspace(math.pi, 0.0, VOUSSOIRS + 1)
    inner, outer = ([(r * math.cos(t), r * math.sin(t)) for t in angles] for r in (INNER, OUTER))
    return [[inner[i], inner[i + 1], outer[i + 1], outer[i]] for i in range(VOUSSOIRS)]


def spreading(*blocks: dict, apart: float, component: str) -> dict:
    """The right springing moves out slowly; the crown is watched."""
    case = history(*blocks, duration=1.0, friction=0.7)
    del case["damping"]
    flat = component == "y"
    case["joints"]["dry"]["points"] = 2 if flat else "vertices"  # the same at the ends of each joint
    moved = [apart, 0.0] if flat else [apart, 0.0, 0.0]
    case["analysis"] = {"kind": "settlement"}
    case["settlement"] = [{"block": "right", "displacement": moved}]
    case["monitor"] = [{"block": "v4" if flat else "v4-1", "component": component}]
    return case


def arch_spreads(apart: float = 0.02) -> dict[str, Any]:
    """A half barrel of three rows: three hinge lines form, and each row sinks as the arch of the plane does."""
    width, springs = 0.5, {"left": (-1.4, -0.9), "right": (0.9, 1.4)}
    rows = [
        solid(f"v{i}-{r}", [(x, r * width + y, z) for y in (0.0, width) for x, z in corners])
        for i, corners in enumerate(voussoirs())
        for r in range(3)
    ]
    fixed = [box(k, (a, 0.0, -0.3), (b, 3 * width, 0.0), fixed=True) for k, (a, b) in springs.items()]
    flat = [{"id": f"v{i}", "vertices": list(map(list, corners))} for i, corners in enumerate(voussoirs())]
    feet = [{"id": k, "vertices": rectangle(a, -0.3, b, 0.0), "fixed": True} for k, (a, b) in springs.items()]
    plane = spreading(*feet, *flat, apart=apart, component="y")
    del plane["dimension"]
    found, exact = run(spreading(*fixed, *rows, apart=apart, component="z")), run(plane)
    sinks = [1e3 * float(next(iter(one.summary["monitors"].values()))["value"]) for one in (exact, found)]
    return {"name": "barrel arch on spreading supports (exact: the arch of the plane)", "figure": "crown sinks [mm]",
            "exact": sinks[0], "found": sinks[1]} | found.books  # fmt: skip
