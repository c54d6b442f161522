"""The three walls of Table 7-8 on the calibrated joint, and what a polygon is drawn over (thesis 7.5.2 to 7.5.4)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli import api
from dem_cli.analyses import solve as solver
from dem_cli.bench.table import lines_of, percent
from dem_cli.model.model import Model
from dem_cli.output.record import Frame
from dem_cli.output.vertices import placed_vertices
from dem_cli.post import style
from thesis7.runs import ROOT, Rows, book, commands, run

WALLS = {"21": "thesis_21_block_wall", "110": "thesis_110_block", "231": "thesis_231_block"}
PLANE = "joints.rough={ law = 'coulomb', friction = 0.6 }"
GROWING = "analysis={ resolution = 0.005 }"  # no step of its own
JOINT, FACE = "joints.rough.profile.over=joint", "joints.rough.profile.over=face"
DEEP = "joints.rough.profile.aperture=2e-4"
STAGES = (0.41, 0.43, 0.46, 0.48, 0.53)  # loads of the picture
VISIBLE = 1e-4  # displacement that a drawing of the thesis may show [m]
OWN = ROOT / "docs" / "chapter7_own_joint.json"

TEXT = """\
* **Over each joint** is what 7.3.1 says: "for any joint of length L". In a running bond a joint is half a block. The
  block then turns about a vertex inside that joint and *lifts* its far end, on which others lie. The thesis turns it
  about the end node of the joint and softens the other one (7-6 to 7-8), which *sinks*: 7.2.3 calls that a slight
  approximation. In a column only angles count, in a bond heights do as well. No surface gives a block that is turned
  to and fro the height back that it loses there, so that no profile can do the same.
* **The thesis's own joint** was therefore written once more, beside dem and without a line of it
  (`scripts/thesis_joint`), with both pivots and nothing else different. The pivot explains the wall of 231 blocks:
  with that of the thesis it fails between 0.37 and 0.38, as there, with the vertex as in dem. It explains a step of
  the load at most for 110 blocks and nothing for 21.
* **Over the face** of each upper block, of which each joint has its part, the wall of 21 blocks does all that the
  thesis describes: first displacements at {onset:.2f} (0.42), the blocks on the right turn at {six:.2f} (0.48), failure
  by sliding of the block on the top right at {face:.4f} ({face_error} of 0.54). A middle side of 8 mm, as long as on
  the column, is what makes the first displacements late; on joints of half a block it is 4 mm. In the larger walls
  this reading leaves less motion.
* **The wall of 110 blocks** fails {most} above the thesis, and nearly so with its own joint written once more. To
  slide at 0.55 on a friction of 0.6 the block on the top right must be inclined by 0.038, six times the angle of a
  microrotation; here it is inclined by two. How the six come about is not explained.
* With twice the aperture the six blocks of the small wall do not stop: they take the two on top with them at
  {deep:.3f} (thesis 0.50, where all velocities are set to zero after each microrotation, and the six blocks turn at
  0.48 as well).
"""


def measure() -> dict[str, Any]:
    """Every wall with plane joints, polygons over joints and over faces; the small one in stages."""
    cases = {name: f"validation/wall_{name}_profile" for name in WALLS}
    return {
        "walls": {
            name: {"plane": wall(case, PLANE, GROWING), "joint": wall(case, JOINT), "face": wall(case, FACE)}
            for name, case in cases.items()
        },
        "deep": {"joint": wall(cases["21"], JOINT, DEEP), "face": wall(cases["21"], FACE, DEEP)},
        "stages": stages(),
    }


def wall(case: str, *overrides: str) -> dict[str, Any]:
    """As thesis7.runs.run, with the lowest load at which the block on the top right had moved visibly."""
    found = run(case, *overrides)
    found["visible"] = min((row[0] for row in found["curve"] if abs(row[1]) > VISIBLE), default=None)
    return found


class Pictures(Rows):
    """An observer that keeps the frames."""

    def __init__(self) -> None:
        super().__init__()
        self.frames: list[Frame] = []

    def frame(self, frame: Frame) -> None:
        self.frames.append(frame)


def stages() -> dict[str, Any]:
    """Corners of all blocks of the small wall at the loads of STAGES [m], {load: [[[x, y], ...] of every block]}."""
    path = f"analysis={{ kind = 'cycle', path = {list(STAGES)}, step = 0.01 }}"
    loaded = api.load_case(ROOT / "cases/validation/wall_21_profile.toml", [path, FACE])
    observer, model = Pictures(), api.build_model(loaded)
    solver.solve(loaded.case, model, observer)
    return {
        f"{frame.load:.2f}": corners_of(model, frame)
        for frame in observer.frames if frame.stage == "loading"
    }  # fmt: skip


def corners_of(model: Model, frame: Frame) -> list[Any]:
    """Corners of all blocks in a frame, rounded to 1 µm, [[[x, y], ...] of every block]."""
    corners = np.round(placed_vertices(model, frame.positions, frame.orientations), 6)
    return [part.tolist() for part in np.split(corners, model.part_starts[1:-1])]


def page(found: dict[str, Any]) -> list[str]:
    """This part of chapter7.md."""
    rows, onsets, runs = [], [], []
    own = json.loads(OWN.read_text(encoding="utf-8"))["runs"] if OWN.exists() else []
    for name, file in WALLS.items():
        values, ours = {key: row["value"] for key, row in book(file).items()}, found["walls"][name]
        runs += list(ours.values())
        plane = values["planar" if "planar" in values else "lambda_dem_mu0.60"]
        thesis = float(np.mean(values["nc" if "nc" in values else "nc_failure"]))
        onset = values["nc_onset"] if "nc_onset" in values else values["nc_onset_ratio"] * np.max(values["nc"])
        rows.append((f"{name} blocks", f"{values['lambda_exp']:g}", f"{plane:g}", _load(ours["plane"]), f"{thesis:g}",
                     *_compared(ours["joint"], thesis), *_compared(ours["face"], thesis)))  # fmt: skip
        onsets.append((f"{name} blocks", f"{onset:.2f}", _first(ours["joint"]), _first(ours["face"])))
    face, deep = found["walls"]["21"]["face"], found["deep"]["face"]
    middle = 0.5 * sum(face["bracket"])
    head = (
        "wall", "experiment", "thesis, plane", "dem, plane", "thesis", "dem, over joints", "error", "over faces",
        "error",
    )  # fmt: skip
    return [
        "## Walls in their plane, Table 7-8", "",
        "Failure loads; the thesis raised its load by 0.01 a step. Of 0.37 to 0.38, for 231 blocks, the middle is",
        "compared; its Table 7-8 has 0.38.", "",
        *lines_of(head, rows), "",
        "First load at which the block on the top right had moved by 0.1 mm:", "",
        *lines_of(("wall", "thesis", "dem, over joints", "over faces"), onsets), "",
        *_own_rows(own),
        TEXT.format(
            onset=face["visible"], six=_six(face), face=middle, face_error=percent(middle / 0.54 - 1.0),
            deep=0.5 * sum(deep["bracket"]),
            most=_compared(found["walls"]["110"]["joint"], book(WALLS["110"])["nc"]["value"])[1],
        ),
        *commands(*runs, *found["deep"].values()),
        "![The wall of 21 blocks](chapter7_stages.png)",
    ]  # fmt: skip


def _load(run: dict[str, Any]) -> str:
    low, high = run["bracket"]
    return f"{low:.4f} to {high:.4f}"


def _compared(run: dict[str, Any], thesis: float) -> tuple[str, str]:
    return _load(run), percent(0.5 * sum(run["bracket"]) / thesis - 1.0)


def _first(run: dict[str, Any]) -> str:
    return "–" if run["visible"] is None else f"{run['visible']:.2f}"


def _six(run: dict[str, Any]) -> float:
    """Load step with the largest motion of the block on the top right before failure."""
    load, moved = np.array(run["curve"])[:, :2].T
    held = load <= run["bracket"][0] * (1 - 0.05)
    return float(load[held][1:][np.diff(moved[held]).argmax()])


def _own_rows(own: list[dict[str, Any]]) -> list[str]:
    """The thesis's own joint written once more, where its results are there."""
    if not own:
        return []
    rows = [
        (one["structure"], one["reading"], one["pivot"], f"{one['bracket'][0]:g} to {one['bracket'][1]:g}")
        for one in own
    ]
    head = ("structure", "reading", "pivot", "load")
    return ["The thesis's joint, written once more:", "", *lines_of(head, rows), ""]


def draw(found: dict[str, Any], path: Path) -> None:
    """The small wall at the loads of Figure 7-64."""
    panels = found["stages"]
    with style.figure(path, figsize=(10.0, 2.6)) as figure:
        axes = figure.subplots(1, len(panels), sharey=True)
        for axis, (load, blocks) in zip(axes, panels.items(), strict=True):
            for corners in blocks:
                axis.fill(*np.array(corners).T, facecolor=style.STONE, edgecolor="0.35", lw=0.6)
            axis.set(title=f"λ = {load}", aspect="equal", xlim=(-0.005, 0.135), ylim=(-0.02, 0.115))
            axis.axis("off")


PICTURES = {"stages": draw}
