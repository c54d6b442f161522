"""Pushover curves of paper 001, Figures 3 and 6: walls of regular, Voronoi and coursed stones out of their plane."""

from __future__ import annotations

import time
from collections.abc import Mapping
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
from studies.template import bracket, table

FOLDER = CASES / "validation"
FILES = {"regular": "lemos_wall", "voronoi": "lemos_voronoi", "coursed": "lemos_coursed"}  # every run of their sweeps
SQUARE, LONG = "1 × 1 m", "2 × 1 m"  # how names of regular walls begin
FIGURES = {"3": (SQUARE, "Voronoi"), "6": (LONG, "coursed")}  # of the paper: names of the curves begin so
OFFSETS = ("0", "0.1 m", "0.5 m")
EARLY = 0.02  # load at which stiffness is read off
FARTHEST = 300.0  # of what is drawn [mm]
COLOURS = {"offset 0": "#7c7c86", "offset 0.1 m": "#1f5fa8", "offset 0.5 m": "#2a8c5b"}
DRAWN = {"Voronoi": "#c0392b", "coursed": "#e08214"}
DASHES = {"1": "-", "2": (0, (5, 2)), "3": (0, (1.5, 1.5))}


def measure(kind: str) -> list[dict[str, Any]]:
    """Every wall of one kind."""
    file = FOLDER / f"{FILES[kind]}.toml"
    return [run_of(file, run) for run in runs_of_sweep(file)]


def runs_of_sweep(file: Path) -> tuple[SweepRun, ...]:
    """What the [sweep] of a case asks for."""
    case = api.load_case(file).case
    assert case.sweep is not None
    return plan_of(case.sweep, case.seed).runs


def run_of(file: Path, run: SweepRun) -> dict[str, Any]:
    """One wall: its load, and the curve of the top in the middle of its length."""
    loaded, seen, begun = api.load_case(file, run.overrides), RunKeeper(), time.process_time()
    model = api.build_model(loaded)
    try:
        summary = solve(loaded.case, model, seen).summary
    except SolverError as error:
        summary = {"status": str(error)}
    curve = [[1e3 * row.monitors[0], row.load] for row in seen.rows if row.stage in ("loading", "collapse")]
    return {
        "command": f"dem sweep cases/validation/{file.name}", "name": str(run.values["name"]),
        "status": summary["status"], "bracket": bracket_of(summary), "mode": summary.get("failure_mode"),
        "blocks": int((~model.fixed).sum()), "points": summary.get("contacts"), "steps": summary.get("steps"),
        "seconds": round(time.process_time() - begun, 1), "curve": thinned(curve),
    }  # fmt: skip


def thinned(curve: list[list[float]], points: int = 60) -> list[list[float]]:
    """What a picture needs of a curve [mm, -]: rows at about even lengths of it."""
    if len(curve) < 2:
        return []
    x, y = np.array(curve).T
    along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x) / FARTHEST, np.diff(y) / max(y.max(), 1e-9)))])
    kept = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], points)).clip(max=len(x) - 1))
    return [[round(float(x[i]), 3), round(float(y[i]), 5)] for i in kept]


def stiffness(run: dict[str, Any]) -> float | None:
    """Load over displacement of the top, at an early load [1/m]."""
    if not run["curve"]:
        return None
    x, y = np.array(run["curve"]).T
    rising = int(y.argmax()) + 1
    return 1e3 * EARLY / float(np.interp(EARLY, y[:rising], x[:rising]))


def load(run: dict[str, Any]) -> float:
    """Middle of the bracket."""
    return 0.5 * sum(run["bracket"])


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """What the page shows of all that is kept."""
    those = all_of(found)
    head = ("wall", "stones", "points", "failure load", "mode", "stiffness [1/m]", "top at the peak [mm]", "steps",
            "CPU [s]")  # fmt: skip
    return {
        "walls": table(head, map(cells, those)),
        "verdicts": table(("printed", "dem", "verdict"), verdicts({run["name"]: run for run in those})),
        "early": EARLY,
    }


def all_of(found: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Walls of all kinds that were measured."""
    return [run for kind in FILES for run in found.get(kind, ())]


def cells(run: dict[str, Any]) -> tuple[str, ...]:
    """One line of the table."""
    stiff, ends = stiffness(run), bracket(run["bracket"]) if stands(run) else run["status"]
    peak = max(run["curve"], key=lambda point: point[1])[0] if run["curve"] else None
    return (run["name"], str(run["blocks"]), counted(run["points"]), ends,
            run["mode"] or "–", f"{stiff:.1f}" if stiff else "–", f"{peak:.0f}" if peak else "–",
            counted(run["steps"]), f"{run['seconds']:.0f}")  # fmt: skip


def counted(number: int | None) -> str:
    """A number of many digits, or a dash."""
    return "–" if number is None else f"{number:,}"


def verdicts(runs: dict[str, Any]) -> list[tuple[str, str, str]]:
    """What the text of the paper prints of the figures, and whether it is so here."""
    rows = []
    for shape in (SQUARE, LONG):
        none, tenth, half = (runs[f"{shape}, offset {offset}"] for offset in OFFSETS)
        loads = [load(one) for one in (none, tenth, half)]
        rows.append(
            (f"{shape}: offset 0.1 m carries more than none", ratio(loads[1], loads[0]), said(loads[1] > loads[0]))
        )
        stiff = [stiffness(one) or 0.0 for one in (none, tenth)]
        rows.append((f"{shape}: it is stiffer at first as well", ratio(stiff[1], stiff[0]), said(stiff[1] > stiff[0])))
        rows.append((f"{shape}: 0.1 m only marginally below 0.5 m", ratio(loads[1], loads[2]),
                     said(near(loads[1], loads[2]), "within 5 %", "")))  # fmt: skip
    for offset in OFFSETS:
        pair = [load(runs[f"{shape}, offset {offset}"]) for shape in (LONG, SQUARE)]
        rows.append(
            (f"offset {offset}: {LONG} carries more than {SQUARE}", ratio(*pair), said(pair[0] > 1.01 * pair[1]))
        )
    return rows + irregular(runs)


def irregular(runs: dict[str, Any]) -> list[tuple[str, str, str]]:
    """The same of Voronoi and of coursed walls."""
    rows = []
    for figure, (shape, kind) in FIGURES.items():
        loads = [load(run) for name, run in runs.items() if name.startswith(kind) and stands(run)]
        count = sum(name.startswith(kind) for name in runs)
        if not count:
            continue
        if not loads:
            rows.append((f"Figure {figure}: {kind} walls", "none stands", said(False)))
            continue
        none, tenth = (load(runs[f"{shape}, offset {offset}"]) for offset in ("0", "0.1 m"))
        spread = max(loads) / min(loads)
        alike = f"{len(loads)} of {count} walls stand; largest over smallest {spread:.2f}"
        rows.append(
            (f"Figure {figure}: the {kind} walls are alike", alike, said(len(loads) == count and spread < 1.15))
        )
        rows.append((f"Figure {figure}: well above no offset", ratio(min(loads), none), said(min(loads) > 1.5 * none)))
        mean = float(np.mean(loads))
        if kind == "Voronoi":
            rows.append(("Figure 3: at or below offset 0.1 m", ratio(mean, tenth), said(mean <= 1.01 * tenth)))
        else:
            rows.append(("Figure 6: close to offset 0.1 m", ratio(mean, tenth), said(near(mean, tenth, 0.15))))
    return rows


def orderings(found: Mapping[str, Any]) -> dict[str, bool]:
    """The four sentences of the data book (lemos_2019_wall) on these curves, by its ids."""
    runs = {run["name"]: run for run in all_of(found)}
    loads = {name: load(run) for name, run in runs.items() if stands(run)}
    square, long = ([loads[f"{shape}, offset {offset}"] for offset in OFFSETS] for shape in (SQUARE, LONG))
    voronoi, coursed = (
        [value for name, value in loads.items() if name.startswith(kind)] for _, kind in FIGURES.values()
    )
    return {
        "order_offset": square[1] > square[0] and near(square[1], square[2]),
        "order_voronoi": together(voronoi) and max(voronoi) <= 1.01 * square[1],
        "order_irregular": together(coursed)
        and near(float(np.mean(coursed)), long[1], 0.15)
        and min(coursed) > 1.5 * long[0],
        "order_shape": all(a > b for a, b in zip(long[1:], square[1:], strict=True)),
    }


def together(loads: list[float]) -> bool:
    """Whether all three walls of a kind stand, and carry about the same."""
    return len(loads) == 3 and max(loads) < 1.15 * min(loads)


def stands(run: dict[str, Any]) -> bool:
    """Whether it has a load."""
    return bool(run["bracket"]) and None not in run["bracket"]


def near(one: float, other: float, share: float = 0.05) -> bool:
    """Whether two loads differ by no more than a share."""
    return abs(one / other - 1.0) <= share


def ratio(one: float, other: float) -> str:
    """Two numbers, and the first over the second."""
    return f"{one:.4g} over {other:.4g} = {one / other:.2f}"


def said(met: bool, how: str = "", missed: str = "") -> str:
    """A verdict."""
    words = how if met else missed
    return ("met" if met else "**missed**") + (f" ({words})" if words else "")


def draw_curves(found: Mapping[str, Any], path: Path) -> None:
    """Both figures side by side: load multiplier over the displacement of the top."""
    with style.figure(path, figsize=(11.0, 4.6)) as figure:
        axes = figure.subplots(1, 2, sharey=True)
        for axis, (number, kinds) in zip(axes, FIGURES.items(), strict=True):
            for run in all_of(found):
                if run["name"].startswith(kinds) and run["curve"]:
                    x, y = np.array(run["curve"]).T
                    axis.plot(x, y, label=run["name"], **look(run["name"]))
            axis.set(xlim=(0.0, FARTHEST), xlabel="displacement of the top, middle of the length [mm]")
            axis.set_title(f"As Figure {number}")
            axis.legend(loc=(0.36, 0.31), fontsize=8, ncols=2)
        axes[0].set(ylabel="load multiplier λ")
        axes[0].set_ylim(bottom=0.0)


def look(name: str) -> dict[str, Any]:
    """Colour and dashes of a curve."""
    kind = next((kind for kind in DRAWN if name.startswith(kind)), None)
    if kind:
        return {"color": DRAWN[kind], "ls": DASHES[name[-1]], "lw": 1.4}
    return {"color": COLOURS[name.partition(", ")[2]], "lw": 2.0}
