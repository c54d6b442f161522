"""Failure loads of all tests beside the thesis's: Tables B-1 and B-2, Figure B-4."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from reference import results, value

from dem_cli.bench.table import percent
from dem_cli.limit.rigid_wall import TopLoad, split_load
from dem_cli.post import style
from studies.appendix_b.sweep import outlines, swept
from studies.template import bracket, table

BOOK = "thesis_appendix_b"
WIDTH, HEIGHT, LOAD = 0.4, 0.595, 0.659  # m
SLOPE = {"stretchers": 2 * 17.5 / 80, "headers": 2 * 17.5 / 40, "square": 2.0}  # 2 h/b of the cut
WEIGHT = {"stretchers": 20.40, "headers": 40.81, "square": 40.81}  # kg
RIGID = {("stretchers", "A"): "rig_A46", ("stretchers", "B"): "rig_B46", ("headers", "A"): "rig_A23",
         ("headers", "B"): "rig_B23", ("headers", "C"): "rig_C23", ("headers", "D"): "rig_D23",
         ("square", "C"): "rig_C10"}  # fmt: skip
SQUARE = {"square B": "bh1_B", "square C": "bh1_C"}
LOST = ("B5_exp", "B8_exp")
RATIOS = {"A 4.6": 0.88, "B 4.6": 0.88, "A 2.3": 0.87, "B 2.3": 0.90, "C 2.3": 0.90}  # printed in Tables B-1 and B-2
GROUPS = {"A 4.6": (1,), "B 4.6": (2, 3), "A 2.3": (4,), "B 2.3": (5, 6, 7), "C 2.3": (8, 9), "D 2.3": (12, 13, 14)}


def measure() -> dict[str, Any]:
    """The sweep."""
    return {"rows": swept(), "outlines": outlines()}


def middle(value: float | Sequence[float]) -> float:
    return float(np.mean(value))


def thesis_dem(row: dict[str, Any]) -> Any:
    """What the thesis computed: a bracket, a number, or None."""
    name = SQUARE.get(row["name"]) or f"B{row['name'].split()[-1]}_num"
    return results(BOOK)[name]["value"] if name in results(BOOK) else None


def experiment(row: dict[str, Any]) -> tuple[float | None, str]:
    """What was measured, and a mark where the cell is lost."""
    name = f"B{row['name'].split()[-1]}_exp"
    if name not in results(BOOK):
        return None, ""
    return value(BOOK, name), "*" if name in LOST else ""


def by_rule(row: dict[str, Any]) -> float:
    """The rigid-body model of B3: what lies above the cut turns about the toe, or the whole wall."""
    at = {"A": [], "B": [(0.2, LOAD)], "C": [(0.2, LOAD)], "D": [(0.37, LOAD)]}[row["condition"]]
    top = [TopLoad(row["kg"], *place) for place in at]
    slope = SLOPE[row["bricks"]] if row["condition"] == "A" else 0.0
    return split_load(WIDTH, HEIGHT, slope, WEIGHT[row["bricks"]], top)


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What failure_loads.md.j2 shows."""
    rows = found["rows"]
    head = ("test", "bricks b/h", "condition", "load [kg]", "μ", "thesis DEM", "dem", "error", "measured", "error",
            "rigid part: thesis", "by its rule", "dem over it")  # fmt: skip
    limits = ("test", "dem", "path, no dilation", "associated", "mode", "moving bricks and loads",
              "top at failure [mm]")  # fmt: skip
    return {
        "loads": table(head, map(cells, rows)),
        "limits": table(limits, map(limit_cells, rows)),
        "ratios": ratios(rows),
        **errors(rows),
    }


def errors(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Numbers of the text: errors over the thesis's DEM, and what changes the load."""
    named = {row["name"]: row for row in rows}
    off = {row["name"]: load_of(row) / middle(thesis_dem(row)) - 1.0 for row in rows if thesis_dem(row) is not None}
    worst = max(off, key=lambda name: abs(off[name]))
    turning = [abs(off[name]) for name in off if named[name]["condition"] != "A"]
    b = [load_of(named[f"test {i}"]) for i in (5, 7)]
    sb, sc = load_of(named["square B"]), load_of(named["square C"])
    return {
        "dem": 100 * np.mean(np.abs(list(off.values()))), "n": len(off), "largest": 100 * abs(off[worst]),
        "worst": worst.removeprefix("test "), "ratio": mean_ratio(rows), "load": 100 * (b[0] / b[1] - 1.0), "sb": sb,
        "sc": sc, "up": 100 * (sc / sb - 1.0),
        "four": f"{percent(off['test 1'])} for stretchers, {percent(off['test 4'])} for headers",
        "four_path": named["test 4"]["path"], "turning": f"{100 * min(turning):.1f} to {100 * max(turning):.1f} %",
        "ten": f"{load_of(named['test 10']):.3f}", "twelve": f"{load_of(named['test 12']):.3f}",
    }  # fmt: skip


def shown(value: Any) -> str:
    if value is None:
        return "–"
    return " to ".join(f"{v:.2f}" for v in value) if isinstance(value, list) else f"{value:.2f}"


def load_of(row: dict[str, Any]) -> float:
    return 0.5 * (row["bracket"][0] + row["bracket"][1])


def cells(row: dict[str, Any]) -> tuple[str, ...]:
    """One line of the table."""
    dem, theirs = load_of(row), thesis_dem(row)
    test, mark = experiment(row)
    printed = RIGID.get((row["bricks"], row["condition"]))
    rigid = None if printed is None else value(BOOK, printed)
    ratio = {"stretchers": "4.6", "headers": "2.3", "square": "1"}[row["bricks"]]
    return (
        row["name"].removeprefix("test "), ratio, row["condition"], f"{row['kg']}", f"{row['friction']:g}",
        shown(theirs), f"{dem:.3f}", "–" if theirs is None else percent(dem / middle(theirs) - 1.0), shown(test) + mark,
        "–" if test is None else percent(dem / test - 1.0), shown(rigid), f"{by_rule(row):.3f}",
        percent(dem / by_rule(row) - 1.0),
    )  # fmt: skip


def limit_cells(row: dict[str, Any]) -> tuple[str, ...]:
    loads = ("not found" if load is None else f"{load:.4f}" for load in (row["path"], row["associated"]))
    return (row["name"].removeprefix("test "), bracket(row["bracket"]), *loads, row["mode"],
            f"{row['moving']} of {row['blocks']}", f"{row['top_mm']:.2f}")  # fmt: skip


def ratios(rows: list[dict[str, Any]]) -> str:
    """Test over dem, by brick and condition."""
    lines = [(name, shown(RATIOS.get(name)), f"{ratio:.2f}") for name, ratio in our_ratios(rows).items()]
    lines.append(("mean without D", f"{value(BOOK, 'ratio_exp_num'):.2f}", f"{mean_ratio(rows):.2f}"))
    return table(("condition, b/h", "thesis", "dem"), lines)


def mean_ratio(rows: list[dict[str, Any]]) -> float:
    """Of the groups that the thesis prints."""
    return float(np.mean([ratio for name, ratio in our_ratios(rows).items() if name in RATIOS]))


def our_ratios(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Mean measured load over our mean load, by group; lost cells as inferred."""
    by_number = {int(row["name"].split()[-1]): row for row in rows if row["name"].startswith("test")}
    found = {}
    for name, numbers in GROUPS.items():
        tests = [experiment(by_number[i])[0] for i in numbers]
        found[name] = float(np.mean(tests) / np.mean([load_of(by_number[i]) for i in numbers]))
    return found


PANELS = {
    "test 4": "A: self weight", "test 5": "B: five loads", "test 8": "C: loads on a beam",
    "test 11": "D: one load, μ = 0.65",
    "test 1": "A, b/h = 4.6", "test 10": "D: one load, μ = 0.5", "square B": "B, b/h = 1", "square C": "C, b/h = 1",
}  # fmt: skip


def draw(found: dict[str, Any], path: Path) -> None:
    """Collapses of conditions A to D with headers above; other bricks and friction below."""
    loads = {row["name"]: row for row in found["rows"]}
    with style.figure(path, figsize=(12.0, 7.6)) as figure:
        axes = figure.subplots(2, 4).ravel()
        for axis, (name, title) in zip(axes, PANELS.items(), strict=True):
            shape = found["outlines"][name]
            for corners, brick in zip(shape["moved"], shape["brick"], strict=True):
                axis.fill(*zip(*corners, strict=True), facecolor=style.STONE if brick else style.GREY,
                          edgecolor=style.STONE_EDGE, lw=0.35)  # fmt: skip
            axis.fill((-0.08, 0.48, 0.48, -0.08), (0.0, 0.0, -0.015, -0.015), facecolor=style.GROUND)
            theirs = thesis_dem(loads[name])
            axis.set_title(f"{title}\nλ = {load_of(loads[name]):.3f}, thesis {shown(theirs)}", fontsize=9)
            axis.set(aspect="equal", xlim=(-0.06, 0.56), ylim=(-0.02, 0.76))
            axis.axis("off")


PICTURES = {"mechanisms": draw}
