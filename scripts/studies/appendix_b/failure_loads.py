"""Failure loads of all tests beside the thesis's: Tables B-1 and B-2, Figure B-4."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bench.table import percent
from reference import results, value

from dem_cli.core.limit.rigid_wall import TopLoad, split_load
from dem_cli.results.post import style
from studies import storage
from studies.appendix_b.softness import power
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
    """The sweep, on joints as the thesis states them."""
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
    head = ("test", "bricks b/h", "condition", "load [kg]", "μ", "kn [Pa/m]", "thesis DEM", "dem", "error",
            "rigid joints", "error", "measured", "error of dem", "rigid part: thesis", "by its rule")  # fmt: skip
    limits = ("test", "dem", "rigid joints", "path, no dilation", "associated", "mode", "moving bricks and loads",
              "top at the last load held [mm]")  # fmt: skip
    return {
        "loads": table(head, map(cells, rows)),
        "limits": table(limits, map(limit_cells, rows)),
        "ratios": ratios(rows),
        **errors(rows),
    }


def rigid_load(name: str) -> float:
    """Middle of the bracket on rigid joints; test 13 is test 12 again."""
    return middle(rigid_run(name)["bracket"])


def rigid_run(name: str) -> dict[str, Any]:
    """The run on rigid joints."""
    return storage.read("appendix_b")["softness"]["rigid"]["test 12" if name == "test 13" else name]  # type: ignore[no-any-return]


def errors(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Numbers of the text: errors over the thesis's DEM, and what changes the load."""
    named = {row["name"]: row for row in rows}
    known = {row["name"]: middle(thesis_dem(row)) for row in rows if thesis_dem(row) is not None}
    off = {name: load_of(named[name]) / load - 1.0 for name, load in known.items()}
    rigid = {name: rigid_load(name) / load - 1.0 for name, load in known.items()}
    turning = [name for name in off if named[name]["condition"] != "A"]
    b = [load_of(named[f"test {i}"]) for i in (5, 7)]
    sb, sc = load_of(named["square B"]), load_of(named["square C"])
    return {
        "dem": mean_size(off.values()), "rigid": mean_size(rigid.values()), "n": len(off),
        "own": mean_size(off[name] for name in ("test 1", "test 4")),
        "own_rigid": mean_size(rigid[name] for name in ("test 1", "test 4")),
        "one": f"{percent(off['test 1'])} (rigid {percent(rigid['test 1'])})",
        "four": f"{percent(off['test 4'])} (rigid {percent(rigid['test 4'])})",
        "onset": named["test 4"]["onset"], "turning": span(off[name] for name in turning),
        "turning_rigid": span(rigid[name] for name in turning), "ratio": mean_ratio(rows),
        "ratio_rigid": mean_ratio(rows, rigid=True),
        "load": 100 * (b[0] / b[1] - 1.0), "sb": sb, "sc": sc, "up": 100 * (sc / sb - 1.0),
        "ten": f"{load_of(named['test 10']):.3f}", "twelve": f"{load_of(named['test 12']):.3f}",
    }  # fmt: skip


def mean_size(errors: Iterable[float]) -> float:
    """Of their absolute values, in per cent."""
    return float(100 * np.mean(np.abs(list(errors))))


def span(errors: Iterable[float]) -> str:
    """From the lowest to the highest."""
    found = sorted(errors)
    return f"{percent(found[0])} to {percent(found[-1])}"


def shown(value: Any) -> str:
    if value is None:
        return "–"
    return " to ".join(f"{v:.2f}" for v in value) if isinstance(value, list) else f"{value:.2f}"


def load_of(row: dict[str, Any]) -> float:
    return 0.5 * (row["bracket"][0] + row["bracket"][1])


def cells(row: dict[str, Any]) -> tuple[str, ...]:
    """One line of the table."""
    dem, theirs, stiff = load_of(row), thesis_dem(row), rigid_load(row["name"])
    test, mark = experiment(row)
    printed = RIGID.get((row["bricks"], row["condition"]))
    rigid = None if printed is None else value(BOOK, printed)
    ratio = {"stretchers": "4.6", "headers": "2.3", "square": "1"}[row["bricks"]]
    return (
        row["name"].removeprefix("test "), ratio, row["condition"], f"{row['kg']}", f"{row['friction']:g}",
        power(row["kn"]), shown(theirs), f"{dem:.3f}", over(dem, theirs), f"{stiff:.3f}",
        over(stiff, theirs), shown(test) + mark, over(dem, test), shown(rigid), f"{by_rule(row):.3f}",
    )  # fmt: skip


def over(load: float, known: Any) -> str:
    """Error over what is known."""
    return "–" if known is None else percent(load / middle(known) - 1.0)


def limit_cells(row: dict[str, Any]) -> tuple[str, ...]:
    loads = ("not found" if load is None else f"{load:.4f}" for load in (row["path"], row["associated"]))
    stiff = bracket(rigid_run(row["name"])["bracket"])
    return (row["name"].removeprefix("test "), bracket(row["bracket"]), stiff, *loads, row["mode"],
            f"{row['moving']} of {row['blocks']}", f"{row['top_mm']:.2f}")  # fmt: skip


def ratios(rows: list[dict[str, Any]]) -> str:
    """Test over dem, by brick and condition."""
    stated, rigid = our_ratios(rows), our_ratios(rows, rigid=True)
    lines = [(name, shown(RATIOS.get(name)), f"{stated[name]:.2f}", f"{rigid[name]:.2f}") for name in GROUPS]
    printed = f"{value(BOOK, 'ratio_exp_num'):.2f}"
    lines.append(("mean without D", printed, f"{mean_ratio(rows):.2f}", f"{mean_ratio(rows, rigid=True):.2f}"))
    return table(("condition, b/h", "thesis", "dem", "rigid joints"), lines)


def mean_ratio(rows: list[dict[str, Any]], rigid: bool = False) -> float:
    """Of the groups that the thesis prints."""
    return float(np.mean([ratio for name, ratio in our_ratios(rows, rigid).items() if name in RATIOS]))


def our_ratios(rows: list[dict[str, Any]], rigid: bool = False) -> dict[str, float]:
    """Mean measured load over our mean load, on joints as stated or rigid ones, by group; lost cells as inferred."""
    by_number = {int(row["name"].split()[-1]): row for row in rows if row["name"].startswith("test")}
    found = {}
    for name, numbers in GROUPS.items():
        tests = [experiment(by_number[i])[0] for i in numbers]
        ours = [rigid_load(f"test {i}") if rigid else load_of(by_number[i]) for i in numbers]
        found[name] = float(np.mean(tests) / np.mean(ours))
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
