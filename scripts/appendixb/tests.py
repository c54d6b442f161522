"""Tables B-1 and B-2, Figure B-4: failure loads of all tests, ours beside the thesis's."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from appendixb.runs import ROOT, outlines, swept
from dem_cli.bench.table import lines_of, percent
from dem_cli.limit.rigid_wall import TopLoad, split_load
from dem_cli.post import style

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

TEXT = """\
* **Against the thesis's DEM**: mean error {dem:.1f} % over {n} loads, largest {largest:.0f} % (test {worst}). Errors
  are over the middle of its bracket, or of the printed value.
* **Self weight** is where we differ: {four}. No length is lost in
  condition A. Many bricks slide and turn before this wall fails, and how much it carries depends on the way: next to
  failure from the static path dem and the path have {four_path:.3f}; raised from gravity dem has 0.42, and first bricks
  move at 0.40 (below). Most of the difference is not explained. The tests are lower than either.
* **Walls that turn** (B, C, D): dem is {turning} from the thesis. Heights of loads were inferred from loads of 0.33
  for the whole wall, whose digits alone are worth 1.5 %, and with that height the lighter wall of stretchers turns
  at 0.317. dem is below the rule, as blocks stay behind below the stepped crack.
* **Against the tests**: dem is above all of them. Mean of test over dem, by condition, is {ratio:.2f}, 0.89 in the
  thesis; it explains this by uneven bricks, which neither model has.
* **Top load**: 250, 500 and 750 kg change condition B by {load:.1f} %, as the thesis says of its preliminary runs
  ("not significantly"); measured loads fall from 0.29 under
  500 kg to 0.27 under 750 kg.
* **Condition D**: with friction of 0.5 the wall slides, at {ten}, the friction; with 0.65 it turns as one. With 0.6
  dem has {twelve} and turns, the thesis expects 0.57, the tests had 0.39 to 0.44.
* **Connection of the top course**: walls of square bricks fall apart at {sb:.3f} under five loads and turn at
  {sc:.3f} under a beam, {up:.0f} % more; in the thesis 0.22 and 0.32, 45 % more.
"""

NOTES = """\
\\* cell lost, inferred from the printed ratio. The load of test 13 is inferred, as is the number of test 3. Thesis and
experiment: data book. *By its rule*: what lies above a cut through the toe at 2h/b turns (A), or the wall (B to D).

The same by limit analysis of the same case (`dem limit`); the mode is that of dem. No path: it ends before its load
stops growing, or finds no state under dead loads (bricks that carry a thousandth of what others do).
"""


@cache
def book() -> dict[str, dict[str, Any]]:
    """Results of the data book."""
    file: Path = ROOT / "tests" / "reference" / "thesis_appendix_b.toml"
    return {row["id"]: row for row in tomllib.loads(file.read_text(encoding="utf-8"))["result"]}


def measure() -> dict[str, Any]:
    """The sweep."""
    return {"rows": swept(), "outlines": outlines()}


def middle(value: float | Sequence[float]) -> float:
    return float(np.mean(value))


def thesis_dem(row: dict[str, Any]) -> Any:
    """What the thesis computed: a bracket, a number, or None."""
    name = SQUARE.get(row["name"]) or f"B{row['name'].split()[-1]}_num"
    return book()[name]["value"] if name in book() else None


def experiment(row: dict[str, Any]) -> tuple[float | None, str]:
    """What was measured, and a mark where the cell is lost."""
    name = f"B{row['name'].split()[-1]}_exp"
    if name not in book():
        return None, ""
    return book()[name]["value"], "*" if name in LOST else ""


def by_rule(row: dict[str, Any]) -> float:
    """The rigid-body model of B3: what lies above the cut turns about the toe, or the whole wall."""
    at = {"A": [], "B": [(0.2, LOAD)], "C": [(0.2, LOAD)], "D": [(0.37, LOAD)]}[row["condition"]]
    top = [TopLoad(row["kg"], *place) for place in at]
    slope = SLOPE[row["bricks"]] if row["condition"] == "A" else 0.0
    return split_load(WIDTH, HEIGHT, slope, WEIGHT[row["bricks"]], top)


def page(found: dict[str, Any]) -> list[str]:
    """This part of appendix_b.md."""
    rows = found["rows"]
    head = ("test", "bricks b/h", "condition", "load [kg]", "μ", "thesis DEM", "dem", "error", "measured", "error",
            "rigid part: thesis", "by its rule", "dem over it")  # fmt: skip
    limits = ("test", "dem", "path, no dilation", "associated", "mode", "moving bricks and loads",
              "top at failure [mm]")  # fmt: skip
    return [
        "## Tables B-1 and B-2, Figure B-4", "",
        *lines_of(head, [cells(row) for row in rows]), "",
        NOTES,
        *lines_of(limits, [limit_cells(row) for row in rows]), "",
        *ratios(rows), "", words(rows),
        "![Mechanisms of conditions A to D](appendix_b_mechanisms.png)", "",
    ]  # fmt: skip


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
    rigid = None if printed is None else book()[printed]["value"]
    ratio = {"stretchers": "4.6", "headers": "2.3", "square": "1"}[row["bricks"]]
    return (
        row["name"].removeprefix("test "), ratio, row["condition"], f"{row['kg']}", f"{row['friction']:g}",
        shown(theirs), f"{dem:.3f}", "–" if theirs is None else percent(dem / middle(theirs) - 1.0), shown(test) + mark,
        "–" if test is None else percent(dem / test - 1.0), shown(rigid), f"{by_rule(row):.3f}",
        percent(dem / by_rule(row) - 1.0),
    )  # fmt: skip


def limit_cells(row: dict[str, Any]) -> tuple[str, ...]:
    low, high = row["bracket"]
    loads = ("not found" if load is None else f"{load:.4f}" for load in (row["path"], row["associated"]))
    return (row["name"].removeprefix("test "), f"{low:.4f} to {high:.4f}", *loads, row["mode"],
            f"{row['moving']} of {row['blocks']}", f"{row['top_mm']:.2f}")  # fmt: skip


def ratios(rows: list[dict[str, Any]]) -> list[str]:
    """Test over dem, by brick and condition."""
    lines = [(name, shown(RATIOS.get(name)), f"{value:.2f}") for name, value in our_ratios(rows).items()]
    mean = float(np.mean([value for name, value in our_ratios(rows).items() if name in RATIOS]))
    lines.append(("mean without D", f"{book()['ratio_exp_num']['value']:.2f}", f"{mean:.2f}"))
    return ["Mean of the tests over the DEM load:", "", *lines_of(("condition, b/h", "thesis", "dem"), lines)]


def our_ratios(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Mean measured load over our mean load, by group; lost cells as inferred."""
    by_number = {int(row["name"].split()[-1]): row for row in rows if row["name"].startswith("test")}
    found = {}
    for name, numbers in GROUPS.items():
        tests = [experiment(by_number[i])[0] for i in numbers]
        found[name] = float(np.mean(tests) / np.mean([load_of(by_number[i]) for i in numbers]))
    return found


def words(rows: list[dict[str, Any]]) -> str:
    """What the table says."""
    named = {row["name"]: row for row in rows}
    errors = {row["name"]: load_of(row) / middle(thesis_dem(row)) - 1.0 for row in rows if thesis_dem(row) is not None}
    worst = max(errors, key=lambda name: abs(errors[name]))
    turning = [abs(errors[name]) for name in errors if named[name]["condition"] != "A"]
    b = [load_of(named[f"test {i}"]) for i in (5, 7)]
    sb, sc = load_of(named["square B"]), load_of(named["square C"])
    ratio = float(np.mean([value for name, value in our_ratios(rows).items() if name in RATIOS]))
    return TEXT.format(
        dem=100 * np.mean(np.abs(list(errors.values()))), n=len(errors), largest=100 * abs(errors[worst]),
        worst=worst.removeprefix("test "), ratio=ratio, load=100 * (b[0] / b[1] - 1.0), sb=sb, sc=sc,
        up=100 * (sc / sb - 1.0),
        four=f"{percent(errors['test 1'])} for stretchers, {percent(errors['test 4'])} for headers",
        four_path=named["test 4"]["path"], turning=f"{100 * min(turning):.1f} to {100 * max(turning):.1f} %",
        ten=f"{load_of(named['test 10']):.3f}", twelve=f"{load_of(named['test 12']):.3f}",
    )  # fmt: skip


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
