"""Single block on a polygon of five sides (thesis 7.3.3, Table 7-1, Figures 7-14 to 7-37)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from bench.table import percent
from oracle import rolling_polygons as statics
from reference import results

from dem_cli.results.post import style
from studies.bisection import bisect
from studies.chapter7.load_path import run
from studies.template import commands, minus, table

CASES = ("block_on_polygon", "block_on_polygon_cycle", "block_on_plane")
ANGLE = 1.0 / 60.0  # between two sides [rad]
WIDTH = 1e-3  # of a load at which the block turns
SHOWN = ((0.25, 1), (0.8, 2), (0.5, 1), (0.15, 0), (-0.25, -1), (-0.8, -2), (-0.5, -1), (0.0, 0))  # Figures 7-36, 7-37
MADE = statics.column(1, 1.0, [0.2] * 5, 0.01)
NUMBERS = {8: "Eight"}


def measure() -> dict[str, Any]:
    """Three turns, displacements and the cycle."""
    polygon, cycle, plane = (f"validation/{name}" for name in CASES)

    def turned(angle: float, load: float) -> bool:
        found = run(cycle, f"analysis.path=[{load!r}]", "analysis.step=0.05")
        return -found["curve"][-1][2] > angle

    return {
        "runs": {"raised": run(polygon), "cycle": run(cycle), "plane": run(plane)},
        "turns": [
            bisect(0.0, 0.4, WIDTH, lambda load: turned(0.5 * ANGLE, load)),
            bisect(0.4, 0.8, WIDTH, lambda load: turned(1.5 * ANGLE, load)),
        ],
    }


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What block.md.j2 shows."""
    runs, value = found["runs"], results("thesis_single_block_noncoplanar")["lambda3_rolling"]["value"]
    turns = events(runs["cycle"]["curve"])
    cycle = table(
        ("turn", "from side", "to side", "statics [N]", "dem, between [N]"),
        [
            (str(i + 1), signed(turn["from"]), signed(turn["to"]), signed(10 * load),
             " and ".join(signed(10 * other) for other in turn["loads"]))
            for i, (turn, load) in enumerate(zip(turns, cycle_loads()))
        ],
    )  # fmt: skip
    sides = ", ".join(signed(side) for side in shown(runs["cycle"]["curve"]))
    return {
        "loads": _table(found),
        "width": 100 * WIDTH, "book": value, "off": percent(sum(runs["raised"]["bracket"]) / 2 / value - 1.0),
        "side": 1e6 * at(runs["raised"]["curve"], 0.1)[1], "by_hand": 1e6 * elastic_on_a_side(1.0),
        "number": NUMBERS.get(len(turns), len(turns)), "cycle": cycle, "sides": sides,
        "commands": commands(*runs.values()),
    }  # fmt: skip


def _table(found: dict[str, Any]) -> str:
    thesis, runs = results("thesis_single_block_noncoplanar"), found["runs"]
    exact, rows = rolling(), []
    for i, what in enumerate(("λ1, first turn", "λ2, second turn", "λ3, overturning")):
        low, high = [*found["turns"], runs["raised"]["bracket"]][i]
        theirs = thesis[f"dem{i + 1}"]["value"]
        rows.append(
            (what, f"{first_order(i):.5f}", f"{exact['loads'][i]:.5f}", f"{theirs[0]:g} to {theirs[1]:g}",
             f"{low:.5g} to {high:.5g}", percent(0.5 * (low + high) / exact["loads"][i] - 1.0))
        )  # fmt: skip
    for i, load in enumerate((0.22, 0.6)):
        theirs, right = thesis[f"u{i + 1}_dem"]["value"], exact["corners"][i]
        ours = at(runs["raised"]["curve"], load)[1]
        rows.append(
            (f"upper corner at {load:g} [cm]", f"{100 * math.tan((i + 1) * ANGLE):.3f}", f"{100 * right:.3f}",
             f"{100 * theirs:.2f}", f"{100 * ours:.3f}", percent(ours / right - 1.0))
        )  # fmt: skip
    ours, by_hand = at(runs["plane"]["curve"], 0.2)[1], thesis["u_elastic_exact"]["value"]
    rows.append(
        ("the same at 0.2, plane joint [µm]", f"{1e6 * by_hand:.3f}", f"{1e6 * by_hand:.3f}",
         f"{1e6 * thesis['u_elastic']['value']:.3f}", f"{1e6 * ours:.3f}", percent(ours / by_hand - 1.0))
    )  # fmt: skip
    return table(("", "first order", "finite rotation", "thesis DEM", "dem", "error over finite rotation"), rows)


def first_order(i: int) -> float:
    """Load of the turn i + 1 as the thesis has it, for b = h = 1."""
    return 0.2 * (1 + 2 * i) - math.tan(i * ANGLE)


def rolling() -> dict[str, list[float]]:
    """Loads of the turns, and how far the upper right corner moves in each [m], with finite rotations."""
    stages = statics.raised(MADE)
    corners = [float(s.top[0]) + 0.5 * math.cos(s.turned) - 0.5 for s in stages[1:]]
    return {"loads": [s.ends for s in stages], "corners": corners}


def cycle_loads() -> list[float]:
    """Loads of the eight turns of the cycle."""
    none, first, second = (statics.limits(MADE, [side])[0] for side in (0, 1, 2))
    half = [float(none[1]), float(first[1]), float(second[0]), float(first[0])]
    return [*half, *(-load for load in half)]


def elastic_on_a_side(force: float) -> float:
    """Displacement of the top [m] under a force [N] at the centroid, on springs of 5e6 N/m at the ends of 0.2 m."""
    return force / 1e7 + 0.5 * force / (1e7 * 0.1**2)


def at(curve: list[list[float]], load: float) -> list[float]:
    """The row at this load."""
    return min(curve, key=lambda row: abs(row[0] - load))


def side(row: list[float]) -> int:
    """Number of the side that carries, from the middle one to the right."""
    return round(-row[2] / ANGLE)


def events(curve: list[list[float]]) -> list[dict[str, Any]]:
    """Turns on the way: sides before and after, and the loads between which it happened."""
    return [
        {"from": side(a), "to": side(b), "loads": [a[0], b[0]]} for a, b in zip(curve, curve[1:]) if side(a) != side(b)
    ]


def shown(curve: list[list[float]]) -> list[int]:
    """Sides at the loads that the thesis shows, in the order of the cycle."""
    found, begin = [], 0
    for load, _ in SHOWN:
        begin = next(i for i in range(begin, len(curve)) if abs(curve[i][0] - load) < 1e-6)
        found.append(side(curve[begin]))
        begin += 1
    return found


def signed(value: float) -> str:
    """Four digits, with a true minus."""
    return minus(f"{value:.4g}")


def draw(found: dict[str, Any], path: Path) -> None:
    """Displacement against load: raised, and to and fro."""
    runs, exact = found["runs"], rolling()
    with style.figure(path, figsize=(9.0, 3.9)) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        for i, load in enumerate(exact["loads"]):
            left.axvline(10 * load, color=style.LIMIT, lw=1.0, label="" if i else "rolling, finite rotation")
            left.axvline(10 * first_order(i), color=style.REFERENCE, lw=1.2, ls=":", label="" if i else "first order")
        _curve(left, runs["raised"]["curve"])
        left.set(xlabel="horizontal force [N]", ylabel="upper corner [cm]")
        left.set_title("raised until it falls")
        for load in cycle_loads():
            right.axvline(10 * load, color=style.LIMIT, lw=1.0)
        _curve(right, runs["cycle"]["curve"])
        right.set(xlabel="horizontal force [N]")
        right.set_title("0, +8, 0, −8, 0 N")
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)


def _curve(axis: Any, curve: list[list[float]]) -> None:
    loads, moved = [10 * row[0] for row in curve], [100 * row[1] for row in curve]
    axis.plot(loads, moved, "o-", ms=2.5, lw=1.0, color=style.THRUST, label="dem")


PICTURES = {"block": draw}
