"""The four walls of rigid stones on joints of the measured stiffness, beside the seven tests."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.results.post import style
from studies.shear_walls.walls import FORCES, KN, MM, draw_curve, draw_tests, legend_below, peak, wall
from studies.template import minus, table

DESIGN = (15.6, 48.5, 94.9, 117.1)  # peaks of the implicit path of the design [kN]


def measure() -> list[dict[str, Any]]:
    """Every wall."""
    return [wall(force) for force in FORCES]


def values(found: list[dict[str, Any]]) -> dict[str, Any]:
    """What the page shows."""
    peaks, errors, loads = [], [], []
    for one, design in zip(found, DESIGN, strict=True):
        highest, at = peak(one)
        low, high = (KN * load for load in one["bracket"])
        name, more = f"SW{one['force']}", minus(f"{100.0 * (KN * highest / design - 1.0):+.2f} %")
        peaks.append(
            (name, f"{KN * highest:.2f}", f"{MM * at:.1f}", f"{low:.2f} to {high:.2f}", more, f"{one['seconds']:.1f}")
        )
        loads.append((name, *(f"{KN * load:.2f}" for _, load in one["loads_at"])))
        errors += [(f"{name}.{number}", *_test(test)) for number, test in enumerate(one["tests"], 1)]
    places = [f"{MM * place:g} mm" for place, _ in found[0]["loads_at"]]
    return {
        "peaks": table(("wall", "peak [kN]", "at [mm]", "failure proved, load held to load that fails [kN]",
                        "peak over the implicit path", "CPU [s]"), peaks),
        "loads": table(("load at [kN]", *places), loads),
        "errors": table(("test", "peak [kN]", "at [mm]", "ours there [kN]", "over the test", "mean difference",
                         "largest"), errors),
        "closure": max(abs(one["closure"]) for one in found),
    }  # fmt: skip


def _test(test: Mapping[str, Any]) -> tuple[str, ...]:
    k = int(np.argmax(test["loads"]))
    highest, ours = test["loads"][k], test["found"][k]
    shares = (100.0 * value / highest for value in (ours - highest, test["mean"], test["largest"]))
    over, mean, most = (minus(f"{share:{sign}.0f} %") for share, sign in zip(shares, ("+", "", "+"), strict=True))
    return f"{KN * highest:.1f}", f"{MM * test['displacements'][k]:.1f}", f"{KN * ours:.1f}", over, mean, most


def draw_curves(found: list[dict[str, Any]], path: Path) -> None:
    """Each wall over its tests, with its bilinear system."""
    with style.figure(path, figsize=(10.0, 6.4)) as figure:
        for axis, one in zip(figure.subplots(2, 2).ravel(), found, strict=True):
            system = one["bilinear"]
            draw_tests(axis, one)
            draw_curve(axis, one, "dem, rigid stones", color=style.STAGE_COLOURS["loading"])
            ends = MM * np.array([0.0, system["yield_displacement"], system["ultimate_displacement"]])
            axis.plot(ends, KN * system["yield_load"] * np.array([0.0, 1.0, 1.0]), color=style.SYSTEM, lw=1.2,
                      ls=(0, (5, 2)), label="bilinear system")  # fmt: skip
        legend_below(figure)


PICTURES = {"curves": draw_curves}
