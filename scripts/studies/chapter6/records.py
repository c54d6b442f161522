"""Artificial records: the vulnerability curve of Figure 6-8, tests on the table, how long records last (6.2.2)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from bench.diagrams import COLOURS
from bench.table import percent
from reference import results

from dem_cli.results.post import style
from studies.chapter6.arch import SEMICIRCLE, UNIT, sizes
from studies.chapter6.shaken_case import run
from studies.storage import rounded
from studies.template import commands, table

LEVELS = (0.9, *(round(1.0 + 0.05 * k, 2) for k in range(21)), 2.2, 2.4, 2.6, 2.8, 3.0, 3.2, 3.5, 4.0)
COMPRESSED = 2.5  # 20 s in 8 s


def shape(period: float, corner: float, far: float) -> float:
    """Elastic spectrum of Eurocode 8 over S ag at a period [s]; corner and far: the ends of constant velocity [s]."""
    if period < 0.15:
        return 1.0 + period / 0.15 * 1.5
    return 2.5 * min(1.0, corner / period) * min(1.0, far / period)


SHORT = ("motion.duration=8.0", "motion.rise=1.0", "motion.plateau=4.0")
# Elastic spectrum of ENV 1998-1-1 (1994), soil B: S = 1, β0 = 2.5, corners 0.15, 0.60 and 3 s (recalled, not in the
# sources here). Eurocode 8 of 2004, which dem knows, has its corner at 0.5 s.
_PERIODS = (0.0, *np.round(np.geomspace(0.15, 0.6, 2), 3), *np.round(np.geomspace(0.65, 4.0, 24), 3))
ENV = [[float(t), round(3.0 * shape(float(t), 0.6, 3.0), 4)] for t in _PERIODS]
ENV_MOTION = f'{{ kind = "artificial", spectrum = {ENV}, duration = 20.0, count = 20 }}'
# That of 2004, S = 1.2, with its time compressed: 20 s in 8 s.
_CORNERS = [0.0, 0.15, *np.geomspace(0.5, 4.0, 24).round(4).tolist()]
FASTER = [[round(t / COMPRESSED, 5), round(3.6 * shape(t, 0.5, 2.0), 4)] for t in _CORNERS]
FAST_MOTION = (
    f'{{ kind = "artificial", spectrum = {FASTER}, duration = 8.0, rise = 0.8, plateau = 4.0, time_step = 0.004,'
    " count = 10 }"
)
SEMI, FAST = "20 s, semicircle, 10 records", "20 s in 8 s: time × 0.4, 10 records"
TEN = ("motion.count=10",)
SUITES: dict[str, tuple[str, ...]] = {
    "20 s": (),
    "8 s": SHORT,
    "20 s, spectrum of 1994": (f"motion={ENV_MOTION}",),
    "20 s, 110°, ring 0.10 m, 10 records": (*sizes(110.0, 0.10, 0.2312), *TEN),
    "20 s, 90°, ring 0.08 m, 10 records": (*sizes(90.0, 0.08, 0.2019), *TEN),
    SEMI: (*SEMICIRCLE, *TEN),
    FAST: (f"motion={FAST_MOTION}",),
}


def measure() -> dict[str, Any]:
    """Lowest collapses of 20 records each, bisected among the levels."""
    found = {}
    for name, more in SUITES.items():
        levels = f"analysis.intensities={[float(a) for a in LEVELS]}"
        one = run("arch_8_fragility", levels, 'analysis.search="bisection"', *more)
        keys = ("collapse_intensities", "stood_up_to", "median", "dispersion", "runs", "never_collapsed")
        found[name] = one.answer | {key: rounded(one.summary.get(key)) for key in keys}
    return found


def capacities(one: dict[str, Any]) -> np.ndarray:
    """Lowest level at which each record made the arch collapse; infinite where none did."""
    return np.array([np.inf if a is None else a for a in one["collapse_intensities"]])


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What records.md.j2 shows."""
    rows = []
    for name, one in found.items():
        a = capacities(one)
        rows.append((name, f"{a.min():.2f} to {_upper(a.max())}", _mean(a), f"{np.median(a):.2f}",
                     "–" if one["dispersion"] is None else f"{one['dispersion']:.2f}"))  # fmt: skip
    mean = {name: float(capacities(one).mean()) for name, one in found.items()}
    short, long = mean["8 s"], mean["20 s"]
    thesis = [
        ("*thesis DEM, 20 records of 20 s*", "1.15 to 1.40", "1.27", "–", "–"),
        ("*tests, one record of 8 s, Table 6-3*", "2.76 to 2.95", "2.85", "–", "–"),
    ]
    return {
        "levels": LEVELS,
        "capacities": table(("records", "range", "mean", "median", "dispersion"), [*rows, *thesis]),
        "tests": _tests(found),
        "short": short, "long": long, "change": percent(short / long - 1.0),
        "within": int(((a := capacities(found["20 s"])) >= 1.15).sum() - (a > 1.40).sum()),
        "thesis_error": percent(long / results("thesis_arch_shaking")["dem_mean"]["value"] - 1.0),
        "env": mean["20 s, spectrum of 1994"], "semicircle": mean[SEMI], "fast": mean[FAST],
        "commands": commands(found["20 s"], found["8 s"], more=len(found) - 2),
    }  # fmt: skip


def _upper(value: float) -> str:
    return f"more than {LEVELS[-1]:g}" if np.isinf(value) else f"{value:.2f}"


def _mean(a: np.ndarray) -> str:
    return f"{a.mean():.2f}" if np.isfinite(a).all() else "–"


def _tests(found: dict[str, Any]) -> str:
    """Tables 6-1 to 6-3: collapses, and what share of our records of 8 s would have made ours collapse."""
    ours, rows = capacities(found["8 s"]), []
    for history in (1, 2, 3):
        tests = sorted((row["peak_accel_m_s2"], row["value"]) for name, row in results("thesis_arch_shaking").items()
                       if name.startswith("test_") and row["base_history"] == history)  # fmt: skip
        stood = max((peak for peak, fell in tests if not fell), default=None)
        fell = min((peak for peak, fell in tests if fell), default=None)
        share = [f"{(ours <= peak / UNIT).mean():.0%}" for peak in (stood, fell) if peak is not None]
        rows.append((f"6-{history}", f"{len(tests)}", f"{stood:g} ({stood / UNIT:.2f})",
                     f"{fell:g} ({fell / UNIT:.2f})" if fell else "none", " and ".join(share)))  # fmt: skip
    share_head = "dem: share of 8 s records that collapse there"
    head = ("table", "tests", "highest that stood [m/s²] (a)", "lowest that fell", share_head)
    return table(head, rows)


def draw(found: dict[str, Any], path: Path) -> None:
    """As Figure 6-8."""
    with style.figure(path, figsize=(7.0, 4.8)) as figure:
        axis = figure.subplots()
        for name, colour in zip(("20 s", "8 s", SEMI, FAST), COLOURS):
            a = np.sort(capacities(found[name]))
            share = np.arange(1, len(a) + 1) / len(a)
            near = np.isfinite(a)
            ends = np.append(LEVELS[0], a[near]), np.append(0.0, share[near])
            axis.step(*ends, where="post", color=colour, lw=1.6, label=f"dem, {name}")
        axis.axvspan(1.15, 1.40, color=style.REFERENCE, alpha=0.15, lw=0, label="thesis DEM, 20 s")
        axis.axvspan(2.76, 2.95, color=style.INK, alpha=0.15, lw=0, label="tests, 8 s")
        axis.set(xlabel="a = peak over 0.325 g", ylabel="share of records that made it collapse", ylim=(0, 1.02))
        figure.legend(loc="outside lower center", ncols=2)


PICTURES = {"records": draw}
