"""Wallettes in four-point bending at different angles of the bed joints (Gazzola, Drysdale and Essawy 1985)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from oracle import brittle_plate, toothed_crack

from dem_cli.results.post import style
from studies.mortar import specimen
from studies.mortar.specimen import LENGTH, TENSION, WIDTH, blocks_of, strength, wallette
from studies.solution import from_tables, solve
from studies.template import table

ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
RATIOS = (0.2, 0.4, 0.6, 0.8, 1.0)
FINER = (4, 5, 9)
OF_TESTS = 2.5  # strength at 90° over that at 0°, as paper 002 prints


def measure() -> dict[str, Any]:
    """Strength [MPa], stands and fails, by angle and ks/kn; and with other points at 0 and 90°."""
    return {
        "angles": [run(angle, ratio) for angle in ANGLES for ratio in RATIOS],
        "points": [run(angle, 0.4, points) for points in FINER for angle in (0.0, 90.0)],
        "dilation": [run(angle, 0.4, dilation_deg=10.0, dilation_slip=1e-4) for angle in (0.0, 45.0, 90.0)],
        "toothed": [toothed(ratio) for ratio in RATIOS],
        "crack_by_crack": [
            *(crack_by_crack(angle, 0.4, 3) for angle in ANGLES),
            *(crack_by_crack(angle, 0.4, points) for points in FINER for angle in (15.0, 90.0)),
        ],
    }


def toothed(ratio: float) -> float:
    """Strength of a toothed crack between rigid halves, nine points a side [MPa]."""
    (long, high), thick = specimen.BLOCK, specimen.THICKNESS
    crack = toothed_crack.Toothed(long / 2.0, high, thick, TENSION, specimen.COHESION, specimen.KN, ratio * specimen.KN)
    return round(toothed_crack.strength(crack, brittle_plate.lobatto(9)) / 1e6, 3)


def crack_by_crack(angle: float, ratio: float, points: int) -> dict[str, Any]:
    """The same specimen without time steps: first crack and strength [MPa]."""
    outlines, loads = blocks_of(angle), specimen.lines_of_load(blocks_of(angle))
    friction = math.tan(math.radians(specimen.FRICTION_ANGLE))
    found = brittle_plate.cracks(
        outlines, specimen.THICKNESS, specimen.held_of(outlines),
        [(int(load["block"][1:]), np.array(load["at"]), np.array(load["force"])) for load in loads],
        brittle_plate.Mortar(TENSION, specimen.COHESION, friction, specimen.KN, ratio * specimen.KN),
        brittle_plate.nine() if points == 3 else brittle_plate.lobatto(points),
    )  # fmt: skip
    first, most = (round(strength(load) / 1e6, 4) for load in (found.first, found.strength))
    return {"angle": angle, "ratio": ratio, "points": points, "first": first, "strength": most}


def run(angle: float, ratio: float, points: int = 3, **joint: Any) -> dict[str, Any]:
    """One wallette."""
    summary = solve(from_tables(wallette(angle, ratio, points, **joint))).summary
    found = summary.get("failure_load_bracket") or [None, None]
    between = [load if load is None else round(strength(load) / 1e6, 4) for load in found]
    return {"angle": angle, "ratio": ratio, "points": points, "status": summary["status"], "between": between} | joint


def values(found: dict[str, Any]) -> dict[str, str]:
    """Tables of the page."""
    stood = {(row["angle"], row["ratio"]): row["between"][0] for row in found["angles"]}
    return {
        "angles": table(
            ["ks/kn", *(f"{angle:g}°" for angle in ANGLES), "90° over 0°"],
            [
                [
                    f"{ratio:g}",
                    *(f"{stood[angle, ratio]:.3f}" for angle in ANGLES),
                    f"{stood[90.0, ratio] / stood[0.0, ratio]:.2f}",
                ]
                for ratio in RATIOS
            ],
        ),
        "points": table(
            ["`points`", "0°", "90°", "90°, crack by crack"],
            [
                [
                    f"{n}",
                    *(f"{r['between'][0]:.3f}" for r in found["points"] if r["points"] == n),
                    *(
                        f"{r['strength']:.3f}"
                        for r in found["crack_by_crack"]
                        if (r["points"], r["angle"]) == (n, 90.0)
                    ),
                ]
                for n in FINER
            ],
        ),
        "crack_by_crack": table(
            ["ks/kn = 0.4", *(f"{angle:g}°" for angle in ANGLES)],
            [
                ["dem", *(f"{stood[angle, 0.4]:.3f}" for angle in ANGLES)],
                *(
                    [words, *(f"{r[key]:.3f}" for r in found["crack_by_crack"] if r["points"] == 3)]
                    for words, key in (("crack by crack", "strength"), ("its first crack", "first"))
                ),
            ],
        ),
        "toothed": ", ".join(f"{value:.2f}" for value in found["toothed"]),
        "skew": ", ".join(
            f"{r['strength']:.3f}" for r in found["crack_by_crack"] if r["points"] != 3 and r["angle"] == 15.0
        ),
        "dilation": ", ".join(f"{row['between'][0]:.3f} MPa at {row['angle']:g}°" for row in found["dilation"]),
    }


def draw(found: dict[str, Any], path: Path) -> None:
    """Strength over the angle, and three of the specimens."""
    with style.figure(path, figsize=(9.0, 4.2)) as figure:
        axes = figure.subplots(1, 4, gridspec_kw={"width_ratios": [3.4, 1, 1, 1]})
        curve = axes[0]
        for ratio, colour in zip(RATIOS, ("#9ecae1", "#6baed6", "#3182bd", "#1f5fa8", "#08306b"), strict=True):
            rows = [row for row in found["angles"] if row["ratio"] == ratio]
            heights = [row["between"][0] for row in rows]
            curve.plot(ANGLES, heights, "o-", color=colour, ms=4, label=f"ks/kn = {ratio:g}")
        alone = [row["strength"] for row in found["crack_by_crack"] if row["points"] == 3]
        curve.plot(ANGLES, alone, "k+", ms=9, label="crack by crack, ks/kn = 0.4")
        curve.axhline(TENSION / 1e6, color=style.GREY, lw=0.8, ls=":")
        curve.text(90.0, TENSION / 1e6 + 0.01, "ft", ha="right", fontsize=8)
        curve.plot([90.0], [OF_TESTS * TENSION / 1e6], "s", color=style.REFERENCE, label="paper 002: 2.5 times 0°")
        curve.set(xlabel="angle of the beds [deg]", ylabel="flexural strength [MPa]", ylim=(0.0, None), xticks=ANGLES)
        curve.legend(loc="upper left", fontsize=8)
        for axis, angle in zip(axes[1:], (0.0, 45.0, 90.0), strict=True):
            for corners in blocks_of(angle):
                axis.fill(*corners.T, facecolor=style.STONE, edgecolor=style.STONE_EDGE, lw=0.7)
            axis.set(xlim=(0.0, WIDTH), ylim=(0.0, LENGTH), aspect="equal", title=f"{angle:g}°")
            axis.axis("off")


PICTURES = {"wallettes": draw}
