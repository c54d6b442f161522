"""Column of 14 blocks: five shapes of the joint, four apertures, and one of them in detail (thesis 7.4.1, 7.5.1)."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from bench.diagrams import COLOURS, MARKERS
from bench.table import percent
from oracle import rolling_polygons as statics
from reference import results

from dem_cli.results.post import style
from studies.chapter7.load_path import middle, run, top, without_curve
from studies.template import commands, table

BASE, HEIGHT, BLOCKS = 0.04, 0.0175, 14
PLANE = BASE / (BLOCKS * HEIGHT)  # b/H
STEP = 0.002  # last step of the load in the thesis: it prints the middle of it
DIGIT = 0.005  # half of the last one of a load over that of plane joints
APERTURE_DIGIT = 5e-5 * HEIGHT  # half of the last one of an aperture, in per cent of the height [m]
DETAILS = (("nc_E_top_032", 0.032), ("nc_E_top_040", 0.04), ("nc_E_top_116", 0.116))
EXPERIMENT = ("lambda_exp_norm", "top_exp")


class ShapeRow(NamedTuple):
    """A row of Table 7-2 as the page has it; loads over that of plane joints, errors relative."""

    shape: str
    percent: float  # aperture over height
    thesis: float
    ours: float
    statics: float  # raised slowly, rolling
    closed: float  # all joints closed
    top_thesis: float  # [m]
    top: float  # [m]
    centroid: float  # displacement of the centroid of the top block [m]
    top_statics: float  # [m]
    resolution: float  # of the thesis's load, relative

    @property
    def error(self) -> float:
        return self.ours / self.thesis - 1.0

    @property
    def top_error(self) -> float:
        return self.top / self.top_thesis - 1.0

    @property
    def name(self) -> str:
        return f"{self.shape} {self.percent:.2f} %"


def measure() -> dict[str, Any]:
    """Table 7-2, the planar column, and shape E in detail."""
    runs = {
        name: without_curve(run("validation/column_14_profile", *overrides(row)), 1)
        for name, row in rows_of_book().items()
    }
    return {
        "runs": runs,
        "plane": without_curve(run("verification/column_14", "analysis.follow=0.0")),
        "five_sides": run("validation/column_14_five_sides"),
    }


def rows_of_book() -> dict[str, dict[str, Any]]:
    """Rows of Table 7-2 in the data book."""
    return {name: row for name, row in results("thesis_14_block_column").items() if name.startswith("T72_")}


def overrides(row: dict[str, Any]) -> list[str]:
    """What makes column_14_profile.toml this row."""
    profile = "joints.rough.profile"
    return [
        f"{profile}.sides={row['sides']}",
        f"{profile}.central={row['central_side_over_joint']:g}",
        f"{profile}.aperture={row['aperture_m']:g}",
    ]


def column_of(row: dict[str, Any]) -> statics.Column:
    """The column of a row for statics."""
    sides, central = row["sides"], row["central_side_over_joint"]
    shares = [(1.0 - central) / (sides - 1)] * sides
    shares[sides // 2] = central
    return statics.column(BLOCKS, HEIGHT, [BASE * share for share in shares], row["aperture_m"])


def five_sides() -> statics.Column:
    """Shape E with an aperture of 0.1 mm."""
    return statics.column(BLOCKS, HEIGHT, [0.2 * BASE] * 5, 1e-4)


def closed(made: statics.Column) -> tuple[float, float, float]:
    """Every joint on its last side: failure load, displacement of the top and of the centroid of the column [m]."""
    sides = [len(made.foot) - 2 - made.rest] * made.blocks
    centroids, _, upper, _ = statics.standing(made, sides)
    return float(statics.limits(made, sides)[:, 1].min()), float(upper[0]), float(centroids[:, 0].mean())


def rows_of(found: dict[str, Any]) -> list[ShapeRow]:
    """Rows of the page."""
    return [_row(row, found["runs"][name]) for name, row in rows_of_book().items()]


def _row(row: dict[str, Any], ours: dict[str, Any]) -> ShapeRow:
    made = column_of(row)
    last, held = statics.raised(made)[-1], ours["curve"][-1]
    # What is lost is in proportion to the aperture.
    from_aperture = (1.0 - row["value"]) * APERTURE_DIGIT / row["aperture_m"]
    resolution = (0.5 * STEP / PLANE + DIGIT + from_aperture) / row["value"]
    return ShapeRow(
        row["shape"], 100 * row["aperture_over_block_height"], row["value"], middle(ours) / PLANE,
        last.ends / PLANE, closed(made)[0] / PLANE, row["top_displacement_m"], top(held, HEIGHT), held[1],
        float(last.top[0]), resolution,
    )  # fmt: skip


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What shapes.md.j2 shows."""
    rows, (low, high) = rows_of(found), found["plane"]["bracket"]
    errors = [abs(row.error) for row in rows]
    rest = [row for row in rows if abs(row.error) > row.resolution]
    lines = table(
        ("shape, aperture/h", "thesis", "dem", "error", "digits and step", "statics", "all closed",
         "top: thesis [mm]", "dem", "error", "statics"),
        [
            (r.name, f"{r.thesis:.2f}", f"{r.ours:.4f}", percent(r.error), f"±{100 * r.resolution:.1f} %",
             f"{r.statics:.4f}", f"{r.closed:.4f}", f"{1e3 * r.top_thesis:.1f}", f"{1e3 * r.top:.2f}",
             percent(r.top_error), f"{1e3 * r.top_statics:.2f}")
            for r in rows
        ],
    )  # fmt: skip
    times = [one["seconds"] for one in found["runs"].values()]
    return {
        "plane": PLANE, "low": low, "high": high, "shapes": lines,
        "error": 100 * mean(errors), "largest": 100 * max(errors),
        "statics": 100 * mean([abs(r.ours / r.statics - 1) for r in rows]),
        "top": 100 * mean([abs(r.top_error) for r in rows]),
        "centroid": 100 * mean([abs(r.centroid / r.top_thesis - 1) for r in rows]),
        "top_statics": 100 * mean([abs(r.top / r.top_statics - 1) for r in rows]), "step": STEP,
        "within": len(rows) - len(rest), "rows": len(rows),
        "explained": 100 * sum(min(abs(r.error), r.resolution) for r in rows) / sum(errors),
        "rest": ", ".join(r.name for r in rest), "below": ", ".join(r.name for r in beneath(rows)) or "None of them",
        "first_command": next(iter(found["runs"].values()))["command"],
        "number": len(times), "least": min(times), "most": max(times), **_details(found["five_sides"]),
    }  # fmt: skip


def beneath(rows: list[ShapeRow]) -> list[ShapeRow]:
    """Rows whose printed load is below that of all joints closed, even at the end of its digits."""
    return [row for row in rows if row.thesis * (1.0 + row.resolution) < row.closed]


def _details(ours: dict[str, Any]) -> dict[str, Any]:
    """Shape E, 0.1 mm."""
    thesis, made = results("thesis_14_block_column"), five_sides()
    stages, rows = statics.raised(made), []
    for name, load in DETAILS:
        row = min(ours["curve"], key=lambda r: abs(r[0] - load))
        stage = next(s for s in stages if s.begins <= load < s.ends)
        cells = (thesis[name]["value"], stage.top[0], top(row, HEIGHT))
        rows.append((f"{load:g}", f"{1e3 * cells[0]:.3g}", *(f"{1e3 * cell:.3f}" for cell in cells[1:])))
    farthest = statics.most_turned(made, 0.04)
    _, closed_top, closed_centroid = closed(made)
    centroid = 0.0146 * closed_centroid / closed_top
    return {
        "e_low": ours["bracket"][0], "e_high": ours["bracket"][1], "load": stages[-1].ends,
        "details": table(("λ", "top: thesis [mm]", "statics", "dem"), rows), "first": stages[0].ends,
        "second": next(stage.begins for stage in stages if stage.sides[0] == 2),
        "far": 1e3 * statics.standing(made, farthest)[2][0],
        "e_centroid": 1e3 * centroid, "left": (1 - 2 * centroid / BASE) * PLANE, "commands": commands(ours),
    }  # fmt: skip


def mean(values: list[float]) -> float:
    return sum(values) / len(values)


def draw(found: dict[str, Any], path: Path) -> None:
    """As Figures 7-39 and 7-40."""
    rows, thesis = rows_of(found), results("thesis_14_block_column")
    with style.figure(path, figsize=(9.6, 4.4)) as figure:
        left, right = figure.subplots(1, 2)
        for i, shape in enumerate(dict.fromkeys(row.shape for row in rows)):
            mine = [row for row in rows if row.shape == shape]
            look: Any = {"color": COLOURS[i], "marker": MARKERS[i], "ms": 5}
            left.plot([r.percent for r in mine], [r.ours for r in mine], lw=1.2, label=f"{shape}: dem", **look)
            left.plot([r.percent for r in mine], [r.thesis for r in mine], ls=":", lw=1.0, mfc="none", **look)
            right.plot([1e3 * r.top for r in mine], [r.ours for r in mine], ls="", **look)
            right.plot([1e3 * r.top_thesis for r in mine], [r.thesis for r in mine], ls="", mfc="none", **look)
        measured = [thesis[name]["value"] for name in EXPERIMENT]
        left.axhline(measured[0], color=style.GREY, lw=1.0, label="experiment")
        right.plot(1e3 * measured[1], measured[0], "*", ms=13, color=style.FAILURE)
        left.plot([], [], ls=":", marker="o", mfc="none", color=style.GREY, label="thesis (hollow)")
        left.set(xlabel="aperture over height of a block [%]", ylabel="failure load over b/H")
        right.set(xlabel="top before failure [mm]", ylabel="failure load over b/H")
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=7)


def draw_five_sides(found: dict[str, Any], path: Path) -> None:
    """As Figure 7-60."""
    thesis, curve = results("thesis_14_block_column"), found["five_sides"]["curve"]
    stages = statics.raised(five_sides())
    tops = [value for s in stages for value in (1e3 * s.top[0],) * 2]
    loads = [value for s in stages for value in (s.begins, s.ends)]
    ours = [1e3 * top(row, HEIGHT) for row in curve], [row[0] for row in curve]
    theirs = [1e3 * thesis[name]["value"] for name, _ in DETAILS], [load for _, load in DETAILS]
    with style.figure(path, figsize=(6.4, 4.2)) as figure:
        axis = figure.subplots()
        axis.plot([*tops, tops[-1] + 2.0], [*loads, loads[-1]], color=style.LIMIT, lw=1.4, label="statics")
        axis.plot(*ours, "o", ms=4, color=style.THRUST, label="dem")
        axis.plot(*theirs, "s", ms=7, mfc="none", color=style.FAILURE, label="thesis")
        axis.set(xlabel="top displacement [mm]", ylabel="load multiplier λ")
        axis.set_title("Shape E, five sides, 0.1 mm")
        axis.legend(loc="lower right")


PICTURES = {"shapes": draw, "five_sides": draw_five_sides}
