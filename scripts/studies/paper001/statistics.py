"""What moves the load of an irregular coursed wall: statistics of its stones, drawn together, and rank correlations."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.app.sweep.plan import SweepRun, plan_of
from dem_cli.errors import SolverError
from dem_cli.results.post import style
from studies.observer import RunKeeper
from studies.places import CASES
from studies.solution import bracket_of
from studies.template import minus, table

FILE = CASES / "validation" / "lemos_coursed_sweep.toml"
OF = "structure.0."
KEYS = {  # of the sweep: what the paper calls them
    "spacing.1": "deviation of bed spacing sd [m]",
    "segment.0": "mean length of straight beds tm [m]",
    "deviation.1": "deviation of kinks hd [m]",
    "head_spacing.0": "mean length of stones bm [m]",
    "head_angle_deg.1": "deviation of head angles ad [°]",
}


def measure() -> list[dict[str, Any]]:
    """Every run of the sweep."""
    case = api.load_case(FILE).case
    assert case.sweep is not None
    return [run_of(run) for run in plan_of(case.sweep, case.seed).runs]


def run_of(run: SweepRun) -> dict[str, Any]:
    """One wall: what was drawn for it, and its load."""
    begun = time.process_time()
    loaded = api.load_case(FILE, run.overrides)
    model = api.build_model(loaded)
    try:
        summary = solve(loaded.case, model, RunKeeper()).summary
    except SolverError as error:
        summary = {"status": str(error)}
    drawn = {key: round(float(run.values[OF + key]), 5) for key in KEYS}
    return {
        "command": "dem sweep cases/validation/lemos_coursed_sweep.toml",
        "seed": int(run.values[f"{OF}seed"]),
        **drawn,
        "status": summary["status"],
        "bracket": bracket_of(summary),
        "stones": int((~model.fixed).sum()),
        "seconds": round(time.process_time() - begun, 1),
    }


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """What the page shows of them."""
    runs = found["statistics"]
    loaded = standing(runs)
    loads = loads_of(loaded)
    rows = []
    for key, name in KEYS.items():
        drawn = np.array([run[key] for run in loaded])
        halves = [loads[drawn <= np.median(drawn)].mean(), loads[drawn > np.median(drawn)].mean()]
        correlation = minus(f"{rank_correlation(drawn, loads):+.2f}")
        span = f"{drawn.min():.2g} to {drawn.max():.2g}"
        rows.append((name, span, correlation, *(f"{half:.3f}" for half in halves)))
    return {
        "statistics": table(("statistic", "drawn", "rank correlation", "mean load, lower half", "upper half"), rows),
        "count": len(runs), "standing": len(loaded), "lowest": loads.min(), "highest": loads.max(),
        "sure": 2.0 / np.sqrt(len(loaded)), "cost": sum(run["seconds"] for run in runs),
    }  # fmt: skip


def standing(runs: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Those with a failure load."""
    return [run for run in runs if run["bracket"] and None not in run["bracket"]]


def loads_of(runs: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """Middles of their brackets."""
    return np.array([0.5 * sum(run["bracket"]) for run in runs])


def rank_correlation(x: np.ndarray, y: np.ndarray) -> float:
    """Spearman's, of values without ties."""
    return float(np.corrcoef(x.argsort().argsort(), y.argsort().argsort())[0, 1])


def draw_statistics(runs: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Failure load over each of the statistics."""
    loaded = standing(runs)
    loads = loads_of(loaded)
    with style.figure(path, figsize=(12.0, 3.0)) as figure:
        axes = figure.subplots(1, len(KEYS), sharey=True)
        for axis, (key, name) in zip(axes, KEYS.items(), strict=True):
            axis.plot([run[key] for run in loaded], loads, "o", ms=4, color=style.STAGE_COLOURS["loading"])
            axis.set_xlabel(name, fontsize=8.5)
        axes[0].set(ylabel="failure load λ")
        axes[0].set_ylim(bottom=0.0)
