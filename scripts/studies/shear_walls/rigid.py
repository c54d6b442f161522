"""The four walls of rigid stones on joints of the measured stiffness, beside the seven tests."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli import api
from dem_cli.analyses.solve import solve
from dem_cli.output.reference import verdicts
from dem_cli.post import style
from studies.observer import RunKeeper
from studies.places import CASES
from studies.template import minus, table

FORCES = (30, 100, 200, 250)  # vertical loads [kN]
DESIGN = (15.6, 48.5, 94.9, 117.1)  # peaks of the implicit path of the design [kN]
KN, MM = 1e-3, 1e3


def measure() -> list[dict[str, Any]]:
    """Every wall."""
    return [wall(force) for force in FORCES]


def wall(force: int) -> dict[str, Any]:
    """One wall: its curve and what its case compares it with."""
    name = f"shear_wall_sw{force}.toml"
    begun = time.process_time()
    loaded, seen = api.load_case(CASES / "validation" / name), RunKeeper()
    model = api.build_model(loaded)
    summary = solve(loaded.case, model, seen).summary
    seconds = round(time.process_time() - begun, 1)
    curve, answers = summary["capacity_curve"], verdicts(summary, loaded.case.reference)
    tests = [answer for answer in answers if "displacements" in answer]
    return {
        "command": f"dem run cases/validation/{name}", "force": force, "status": summary["status"],
        "bracket": summary["failure_load_bracket"], "closure": float(f"{summary['energy_closure']:.2g}"),
        "bilinear": {name: rounded(value) for name, value in curve["bilinear"].items()},
        "displacements": [rounded(value) for value in curve["displacements"]],
        "loads": [rounded(value) for value in curve["loads"]],
        "loads_at": [[one["displacement"], rounded(one["load"])] for one in curve["loads_at"]],
        "tests": [
            {"displacements": test["displacements"], "loads": test["value"], "mean": rounded(test["mean_error"]),
             "largest": rounded(test["largest_error"]), "found": [rounded(value) for value in test["found"]]}
            for test in tests
        ],
        "seconds": seconds,
    }  # fmt: skip


def rounded(value: Any) -> Any:
    """A number with five digits."""
    return float(f"{value:.5g}") if isinstance(value, float) else value


def values(found: list[dict[str, Any]]) -> dict[str, Any]:
    """What the page shows."""
    peaks, errors, loads = [], [], []
    for one, design in zip(found, DESIGN, strict=True):
        highest = int(np.argmax(one["loads"]))
        peak, at = KN * one["loads"][highest], MM * one["displacements"][highest]
        low, high = (KN * load for load in one["bracket"])
        name, more = f"SW{one['force']}", minus(f"{100.0 * (peak / design - 1.0):+.2f} %")
        peaks.append((name, f"{peak:.2f}", f"{at:.1f}", f"{low:.2f} to {high:.2f}", more, f"{one['seconds']:.1f}"))
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
    peak, ours = test["loads"][k], test["found"][k]
    shares = (100.0 * value / peak for value in (ours - peak, test["mean"], test["largest"]))
    over, mean, most = (minus(f"{share:{sign}.0f} %") for share, sign in zip(shares, ("+", "", "+"), strict=True))
    return f"{KN * peak:.1f}", f"{MM * test['displacements'][k]:.1f}", f"{KN * ours:.1f}", over, mean, most


def draw_curves(found: list[dict[str, Any]], path: Path) -> None:
    """Each wall over its tests, with its bilinear system."""
    with style.figure(path, figsize=(10.0, 6.4)) as figure:
        for axis, one in zip(figure.subplots(2, 2).ravel(), found, strict=True):
            system = one["bilinear"]
            for number, test in enumerate(one["tests"], 1):
                x, y = MM * np.array(test["displacements"]), KN * np.array(test["loads"])
                label = f"test {number}"
                axis.plot(x, y, color=style.REFERENCE, lw=0.9, marker="os"[number - 1], ms=3, label=label)
            x, y = MM * np.array(one["displacements"]), KN * np.array(one["loads"])
            axis.plot(x, y, color=style.STAGE_COLOURS["loading"], label="dem, rigid stones")
            ends = MM * np.array([0.0, system["yield_displacement"], system["ultimate_displacement"]])
            axis.plot(ends, KN * system["yield_load"] * np.array([0.0, 1.0, 1.0]), color=style.SYSTEM, lw=1.2,
                      ls=(0, (5, 2)), label="bilinear system")  # fmt: skip
            axis.set_title(f"SW{one['force']}")
            axis.set(xlabel="displacement of the push [mm]", ylabel="horizontal load [kN]")
            axis.set_ylim(bottom=0.0)
            axis.set_xlim(left=0.0)
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))


PICTURES = {"curves": draw_curves}
