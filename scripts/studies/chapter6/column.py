"""One column of the arch alone: free rocking, and rocking on a base in harmonic motion (thesis 6.2, 6.2.1)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from bench.table import percent
from reference import results

from dem_cli.results.post import style
from studies.bisection import bisect
from studies.chapter6.shaken_case import ShakenCase, extremes, run
from studies.storage import rounded
from studies.template import commands, table

LATERAL, GRAVITY = 0.5, 9.81  # λ of the column: b/h
TILT, ALPHA = 0.2318, math.atan(0.5)
LEVELS = (0.90, 0.98, 1.00, 1.02, 1.05, 1.10, 1.20)
STARTS = {"from rest": (), "from a tilt of 0.008 rad": ('initial=[{ block = "column", tilt = 0.008 }]',)}
STIFFER = ("joints.dry.kn=8.5625e9", "joints.dry.ks=8.5625e9")
WAYS = {
    "as the thesis": (),
    "sine at 90°": ("motion.phase_deg=90",),
    "10 cycles to rise": ("motion.ramp=10",),
    "kn and ks × 10": STIFFER,
    "kn and ks × 100": ("joints.dry.kn=8.5625e10", "joints.dry.ks=8.5625e10"),
}
LATE = 5.0  # [s]: motion is steady from here
ROCKS = 1e-3  # rad


def measure() -> dict[str, Any]:
    """Free rocking, levels from rest and from a tilt, onsets."""
    free = run("column_arch_rocking")
    swings = np.concatenate([[TILT], extremes(free.times, free.values[:, 0])[1]])
    swings = swings[swings > 0.02 * ALPHA]
    heights = np.cos(ALPHA - swings) - math.cos(ALPHA)
    levels = [_level(a, name) for a in LEVELS for name in STARTS]
    onsets = {name: bisect(1.0, 1.2, 0.005, lambda a, more=more: _rocks(a, more)) for name, more in WAYS.items()}
    return {
        "free": {"run": free.answer, "each": rounded(heights[1:] / heights[:-1]), "swings": rounded(swings)},
        "levels": levels, "onsets": onsets,
    }  # fmt: skip


def _shaken(a: float, *more: str) -> ShakenCase:
    return run("column_arch_rocking_harmonic", f"motion.amplitude={a * LATERAL * GRAVITY:.5g}", *more)


def _rocks(a: float, more: tuple[str, ...]) -> bool:
    """Whether the column rocks late in the motion, from rest."""
    found = _shaken(a, *more)
    return bool(np.abs(found.values[found.times > LATE, 0]).max() > ROCKS)


def _level(a: float, start: str) -> dict[str, Any]:
    found = _shaken(a, *STARTS[start])
    late = found.times > LATE
    angles = found.values[late, 0]
    peaks = extremes(found.times[late], angles)[1]
    last = found.times > found.times[-1] - 0.5
    return {
        "a": a, "start": start, "amplitude": rounded(peaks.mean()) if len(peaks) else 0.0,
        "highest": rounded(angles.max()), "lowest": rounded(angles.min()), "run": found.answer,
        "curve": rounded(np.column_stack([found.times, found.values[:, 0]])[last][::4]) if a == 1.02 else None,
    }  # fmt: skip


def amplitude(found: dict[str, Any], a: float, start: str) -> float:
    """Mean of the peaks late in the motion [rad]."""
    return next(row["amplitude"] for row in found["levels"] if (row["a"], row["start"]) == (a, start))


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What column.md.j2 shows."""
    thesis, (rest, tilt) = results("thesis_arch_shaking"), STARTS
    each = found["free"]["each"]
    dem, test = thesis["col_r_dem"]["value"], thesis["col_r_exp"]["value"]
    ratios = [
        (name, f"{ours:.3f}", f"{dem:g}", percent(ours / dem - 1.0), f"{test:g}", percent(ours / test - 1.0))
        for name, ours in (("first impact", each[0]), ("mean of all", float(np.mean(each))))
    ]
    rows = [
        (f"{a:.2f}", f"{amplitude(found, a, rest):.5f}", f"{amplitude(found, a, tilt):.5f}",
         "0.008 (0.007)" if a == 1.02 else "–",
         percent(amplitude(found, a, tilt) / thesis["col_rot_dem"]["value"] - 1.0) if a == 1.02 else "–",
         percent(amplitude(found, a, tilt) / thesis["col_rot_exp"]["value"] - 1.0) if a == 1.02 else "–")
        for a in LEVELS
    ]  # fmt: skip
    steady = next(row for row in found["levels"] if (row["a"], row["start"]) == (1.02, tilt))
    onsets = {name: sum(bracket) / 2 for name, bracket in found["onsets"].items()}
    return {
        "ratios": table(("", "dem", "thesis DEM", "error", "test", "error"), ratios),
        "levels": table(("a", rest, tilt, "thesis DEM (test)", "error over DEM", "over test"), rows),
        "late": LATE, "onset": onsets["as the thesis"],
        "ways": ", ".join(f"{name}: {a:.3f}" for name, a in onsets.items() if name != "as the thesis"),
        "small": amplitude(found, 1.02, rest), "tilted": amplitude(found, 1.02, tilt),
        "least": amplitude(found, 0.9, tilt), "most": amplitude(found, 1.2, tilt),
        "symmetry": percent(abs(steady["highest"] / steady["lowest"] + 1.0)).lstrip("+"),
        "commands": commands(found["free"]["run"], steady["run"], more=len(found["levels"]) - 1),
    }  # fmt: skip


def draw(found: dict[str, Any], path: Path) -> None:
    """The two motions at a = 1.02, and amplitudes over a."""
    rest, tilt = STARTS
    with style.figure(path, figsize=(10.0, 3.6)) as figure:
        left, right = figure.subplots(1, 2)
        for start, colour in ((tilt, style.THRUST), (rest, style.COLLAPSE)):
            row = next(r for r in found["levels"] if (r["a"], r["start"]) == (1.02, start))
            times, angles = np.array(row["curve"]).T
            left.plot(times, 1e3 * angles, color=colour, lw=1.2, label=start)
            values = [1e3 * amplitude(found, a, start) for a in LEVELS]
            right.plot(LEVELS, values, "o-", ms=5, lw=1.0, color=colour, label=f"dem, {start}")
        for name, marker, label in (("col_rot_dem", "s", "thesis DEM"), ("col_rot_exp", "*", "test")):
            value = results("thesis_arch_shaking")[name]["value"]
            right.plot(1.02, 1e3 * value, marker, ms=10, mfc="none", color=style.REFERENCE, label=label)
        left.set(xlabel="time [s]", ylabel="rotation [mrad]")
        left.set_title("a = 1.02, 10.5 Hz")
        right.set(xlabel="a", ylabel="mean peak rotation [mrad]", ylim=(-0.5, 12.0))
        left.legend(loc="upper right", ncols=2)
        left.set_ylim(-11, 14)
        right.legend(loc="center left", bbox_to_anchor=(0.0, 0.33))


PICTURES = {"column": draw}
