"""Sliding block whose friction falls with the slip (thesis 7.5.5, Figures 7-70 and 7-71)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from bench.table import percent

from dem_cli.results.post import style
from studies.chapter7.load_path import run
from studies.template import commands, table

FRICTION, RESIDUAL, START, END = 0.6, 0.38, 0.9e-3, 1.0e-3  # μ, β, ΔU1 and ΔU1 + ΔU2 [m]


def measure() -> dict[str, Any]:
    """The block, followed over 2 mm."""
    return {"run": run("validation/sliding_softening")}


def law(slip: np.ndarray) -> np.ndarray:
    """Friction over normal force, eq. 7-10 to 7-14."""
    return np.interp(slip, [START, END], [FRICTION, RESIDUAL * FRICTION])


def slid(found: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, float]:
    """Slip [m] and load multiplier of all rows in which the block slides, and what the joint deforms under μ [m]."""
    load, moved = np.array(found["run"]["curve"])[:, :2].T
    first = int(np.argmax(load >= FRICTION * (1 - 1e-6)))
    half = int(np.argmax(load >= 0.5 * FRICTION))
    elastic = moved[half] * FRICTION / load[half]
    slip = moved[first:] - elastic * load[first:] / FRICTION
    return slip, load[first:], elastic


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What softening.md.j2 shows."""
    slip, load, elastic = slid(found)
    full, least = load > FRICTION * (1 - 1e-4), load < RESIDUAL * FRICTION * (1 + 1e-4)
    rows = [
        (what, f"{law_value:g}", f"{ours:.5f}", percent(ours / law_value - 1.0))
        for what, law_value, ours in (
            ("friction before", FRICTION, load[slip < 0.8 * START].mean()),
            ("friction after, β μ", RESIDUAL * FRICTION, load[slip > 1.2 * END].mean()),
        )
    ]
    edges = (("fall begins [mm]", START, slip[full].max(), slip[~full].min()),
             ("fall ends [mm]", END, slip[~least].max(), slip[least].min()))  # fmt: skip
    rows += [(what, f"{1e3 * at:g}", f"{1e3 * a:.4f} to {1e3 * b:.4f}", "–") for what, at, a, b in edges]
    off = np.abs(load - law(slip)).max() / FRICTION
    return {
        "friction": table(("", "thesis", "dem", "error"), rows),
        "off": off,
        "elastic": 1e6 * elastic,
        "commands": commands(found["run"]),
    }


def draw(found: dict[str, Any], path: Path) -> None:
    """As Figure 7-71."""
    curve = np.array(found["run"]["curve"])
    slip = np.linspace(0.0, 2e-3, 401)
    with style.figure(path, figsize=(5.6, 3.4)) as figure:
        axis = figure.subplots()
        axis.plot(1e3 * slip, law(slip), color=style.LIMIT, lw=1.4, label="eq. 7-10 to 7-14")
        axis.plot(1e3 * curve[:, 1], curve[:, 0], "o", ms=3, color=style.THRUST, label="dem")
        axis.set(xlabel="displacement [mm]", ylabel="friction force over weight", ylim=(0.0, 0.65))
        axis.legend(loc="upper right")


PICTURES = {"softening": draw}
