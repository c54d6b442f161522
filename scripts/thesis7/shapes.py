"""Column of 14 blocks: five shapes of the joint, four apertures, and one of them in detail (thesis 7.4.1, 7.5.1)."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from dem_cli.bench.diagrams import COLOURS, MARKERS
from dem_cli.bench.table import lines_of, percent
from dem_cli.post import style
from thesis7 import statics
from thesis7.runs import book, commands, middle, run, top

BASE, HEIGHT, BLOCKS = 0.04, 0.0175, 14
PLANE = BASE / (BLOCKS * HEIGHT)  # b/H
STEP = 0.002  # last step of the load in the thesis: it prints the middle of it
DIGIT = 0.005  # half of the last one of a load over that of plane joints
APERTURE_DIGIT = 5e-5 * HEIGHT  # half of the last one of an aperture, in per cent of the height [m]
DETAILS = (("nc_E_top_032", 0.032), ("nc_E_top_040", 0.04), ("nc_E_top_116", 0.116))
EXPERIMENT = ("lambda_exp_norm", "top_exp")

INTRODUCTION = """\
Failure loads over b/H = {plane:.5f}, the load of plane joints, for which `cases/verification/column_14.toml` gives
{low:.5f} to {high:.5f} (thesis 0.162 to 0.164). They are the middle of the bracket, as in the thesis. *statics*: the
blocks roll on rigid polygons while the load is raised slowly from zero (`scripts/thesis7/statics.py`, no line of dem in
it). *all closed*: every joint on its last side; no equilibrium leads to a lower load. *digits and step*: how well the
thesis's load is known. Top: its upper edge, at the highest equilibrium.
"""
TEXT = """\
* **Load**: mean error {error:.2f} % of the thesis (largest {largest:.1f} %), {statics:.2f} % of statics.
* **Top displacement**: mean error {top:.1f} % of the thesis ({centroid:.1f} % if it watched the centroid of the top
  block), {top_statics:.1f} % of statics. Shape A, all of whose joints are closed, must move by φ h n (n + 1) / 2:
  5.58 mm for an aperture of 0.34 %. The thesis has 4.9 mm, 12 % less; the aperture's digits are 1.5 %.
* **What the thesis's digits explain**: a load printed to 0.01, the middle of a step of {step:g}, for an aperture
  printed to 0.01 % of h. {within} of {rows} rows differ by less, and {explained:.0f} % of the sum of all differences
  lies within.
* **What they do not explain**: {rest}.
  There the thesis is lower. {below} lie below the load with all joints
  closed, even at the end of their digits: no equilibrium on these polygons fails there. Statics has one way from
  gravity to failure, which dem takes; the thesis applies each step of the load at once (7.5.1.1), and a column that
  still moves turns over earlier.
"""
MORE = "  # and so on: {number} runs of {least:.1f} to {most:.1f} s"
FIVE_SIDES = """\
dem fails between {low:.4f} and {high:.4f}, statics at {load:.4f}; the thesis between 0.116 and 0.118.
"""
DETAIL = """\
* The lowest joint turns where the resultant leaves its middle side of 8 mm: λ H/2 = 4 mm, λ = {first:.5f}, and six
  joints above it follow at once. Before, joints only deform; the thesis's 0.113 mm at 0.032 depends on a stiffness that
  it does not give, that of dem on its own.
* The lowest joint reaches its third side where the resultant is 12 mm off, at λ = {second:.4f}. Under 0.040 even the
  equilibrium that is turned farthest moves the top by {far:.2f} mm only: the thesis's 8.2 mm was passed in motion.
* 14.6 mm at the top, bent as with all joints closed, move the centroid of the column by {centroid:.2f} mm and leave
  {left:.3f} by eq. 7-4; the thesis's column turned over at 0.116 to 0.118.
"""


class Row(NamedTuple):
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
    runs = {name: run("validation/column_14_profile", *overrides(row)) for name, row in table().items()}
    return {
        "runs": runs,
        "plane": run("verification/column_14", "analysis.follow=0.0"),
        "five_sides": run("validation/column_14_five_sides"),
    }


def table() -> dict[str, dict[str, Any]]:
    """Rows of Table 7-2 in the data book."""
    return {name: row for name, row in book("thesis_14_block_column").items() if name.startswith("T72_")}


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


def rows_of(found: dict[str, Any]) -> list[Row]:
    """Rows of the page."""
    return [_row(row, found["runs"][name]) for name, row in table().items()]


def _row(row: dict[str, Any], ours: dict[str, Any]) -> Row:
    made = column_of(row)
    last, held = statics.raised(made)[-1], ours["curve"][-1]
    # What is lost is in proportion to the aperture.
    from_aperture = (1.0 - row["value"]) * APERTURE_DIGIT / row["aperture_m"]
    resolution = (0.5 * STEP / PLANE + DIGIT + from_aperture) / row["value"]
    return Row(
        row["shape"], 100 * row["aperture_over_block_height"], row["value"], middle(ours) / PLANE,
        last.ends / PLANE, closed(made)[0] / PLANE, row["top_displacement_m"], top(held, HEIGHT), held[1],
        float(last.top[0]), resolution,
    )  # fmt: skip


def page(found: dict[str, Any]) -> list[str]:
    """This part of chapter7.md."""
    rows, (low, high) = rows_of(found), found["plane"]["bracket"]
    errors = [abs(row.error) for row in rows]
    rest = [row for row in rows if abs(row.error) > row.resolution]
    text = TEXT.format(
        error=100 * mean(errors), largest=100 * max(errors),
        statics=100 * mean([abs(r.ours / r.statics - 1) for r in rows]),
        top=100 * mean([abs(r.top_error) for r in rows]),
        centroid=100 * mean([abs(r.centroid / r.top_thesis - 1) for r in rows]),
        top_statics=100 * mean([abs(r.top / r.top_statics - 1) for r in rows]), step=STEP,
        within=len(rows) - len(rest), rows=len(rows),
        explained=100 * sum(min(abs(r.error), r.resolution) for r in rows) / sum(errors),
        rest=", ".join(r.name for r in rest), below=", ".join(r.name for r in beneath(rows)) or "None of them",
    )  # fmt: skip
    lines = lines_of(
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
    first = next(iter(found["runs"].values()))["command"]
    more = MORE.format(number=len(times), least=min(times), most=max(times))
    return [
        "## Column of 14 blocks, Table 7-2", "", INTRODUCTION.format(plane=PLANE, low=low, high=high), *lines, "", text,
        "```", first + more, "```", "", "![Table 7-2](chapter7_shapes.png)", "", *_details(found["five_sides"]),
    ]  # fmt: skip


def beneath(rows: list[Row]) -> list[Row]:
    """Rows whose printed load is below that of all joints closed, even at the end of its digits."""
    return [row for row in rows if row.thesis * (1.0 + row.resolution) < row.closed]


def _details(ours: dict[str, Any]) -> list[str]:
    """Shape E, 0.1 mm."""
    thesis, made = book("thesis_14_block_column"), five_sides()
    stages, rows = statics.raised(made), []
    for name, load in DETAILS:
        row = min(ours["curve"], key=lambda r: abs(r[0] - load))
        stage = next(s for s in stages if s.begins <= load < s.ends)
        cells = (thesis[name]["value"], stage.top[0], top(row, HEIGHT))
        rows.append((f"{load:g}", f"{1e3 * cells[0]:.3g}", *(f"{1e3 * cell:.3f}" for cell in cells[1:])))
    farthest = statics.most_turned(made, 0.04)
    _, closed_top, closed_centroid = closed(made)
    centroid = 0.0146 * closed_centroid / closed_top
    text = DETAIL.format(
        first=stages[0].ends, second=next(stage.begins for stage in stages if stage.sides[0] == 2),
        far=1e3 * statics.standing(made, farthest)[2][0],
        centroid=1e3 * centroid, left=(1 - 2 * centroid / BASE) * PLANE,
    )  # fmt: skip
    return [
        "### Shape E, aperture 0.1 mm (7.5.1.2)", "",
        FIVE_SIDES.format(low=ours["bracket"][0], high=ours["bracket"][1], load=stages[-1].ends),
        *lines_of(("λ", "top: thesis [mm]", "statics", "dem"), rows), "", text,
        *commands(ours), "![Shape E](chapter7_five_sides.png)",
    ]  # fmt: skip


def mean(values: list[float]) -> float:
    return sum(values) / len(values)


def draw(found: dict[str, Any], path: Path) -> None:
    """As Figures 7-39 and 7-40."""
    rows, thesis = rows_of(found), book("thesis_14_block_column")
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
    thesis, curve = book("thesis_14_block_column"), found["five_sides"]["curve"]
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
