"""The three walls of Table 7-8 on the calibrated joint, and what a polygon is drawn over (thesis 7.5.2 to 7.5.4)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from bench.table import percent
from reference import results

from dem_cli.results.post import style
from studies import storage
from studies.chapter7.load_path import run
from studies.places import CASES
from studies.solution import corners_of, from_file, solve
from studies.template import bracket, commands, table

WALLS = {"21": "thesis_21_block_wall", "110": "thesis_110_block", "231": "thesis_231_block"}
PLANE = "joints.rough={ law = 'coulomb', friction = 0.6 }"
GROWING = "analysis={ resolution = 0.005 }"  # no step of its own
JOINT, FACE = "joints.rough.profile.over=joint", "joints.rough.profile.over=face"
DEEP = "joints.rough.profile.aperture=2e-4"
STAGES = (0.41, 0.43, 0.46, 0.48, 0.53)  # loads of the picture
DRAWN = 5  # digits of places that are drawn [m]
VISIBLE = 1e-4  # displacement that a drawing of the thesis may show [m]


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
    """As load_path.run, with the lowest load at which the block on the top right had moved visibly."""
    found = run(case, *overrides)
    return found | {"visible": min((row[0] for row in found["curve"] if abs(row[1]) > VISIBLE), default=None)}


def stages() -> dict[str, Any]:
    """Corners of all blocks of the small wall at the loads of STAGES [m], {load: [[[x, y], ...] of every block]}."""
    path = f"analysis={{ kind = 'cycle', path = {list(STAGES)}, step = 0.01 }}"
    model, _, seen = solve(from_file(CASES / "validation" / "wall_21_profile.toml", path, FACE))
    return {f"{frame.load:.2f}": corners_of(model, frame, DRAWN) for frame in seen.frames if frame.stage == "loading"}


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What walls.md.j2 shows."""
    rows, onsets, runs = [], [], []
    for name, file in WALLS.items():
        values, ours = {key: row["value"] for key, row in results(file).items()}, found["walls"][name]
        runs += list(ours.values())
        plane = values["planar" if "planar" in values else "lambda_dem_mu0.60"]
        thesis = float(np.mean(values["nc" if "nc" in values else "nc_failure"]))
        onset = values["nc_onset"] if "nc_onset" in values else values["nc_onset_ratio"] * np.max(values["nc"])
        rows.append((f"{name} blocks", f"{values['lambda_exp']:g}", f"{plane:g}",
                     bracket(ours["plane"]["bracket"]), f"{thesis:g}",
                     *_compared(ours["joint"], thesis), *_compared(ours["face"], thesis)))  # fmt: skip
        onsets.append((f"{name} blocks", f"{onset:.2f}", _first(ours["joint"]), _first(ours["face"])))
    face, deep = found["walls"]["21"]["face"], found["deep"]["face"]
    middle = 0.5 * sum(face["bracket"])
    head = (
        "wall", "experiment", "thesis, plane", "dem, plane", "thesis", "dem, over joints", "error", "over faces",
        "error",
    )  # fmt: skip
    return {
        "loads": table(head, rows),
        "onsets": table(("wall", "thesis", "dem, over joints", "over faces"), onsets),
        "own": _own(storage.read("thesis_joint").get("runs", [])),
        "onset": face["visible"], "six": six_of(face), "face": middle, "face_error": percent(middle / 0.54 - 1.0),
        "deep": 0.5 * sum(deep["bracket"]),
        "most": _compared(found["walls"]["110"]["joint"], results(WALLS["110"])["nc"]["value"])[1],
        "commands": commands(*runs, *found["deep"].values()),
    }  # fmt: skip


def _compared(run: dict[str, Any], thesis: float) -> tuple[str, str]:
    return bracket(run["bracket"]), percent(0.5 * sum(run["bracket"]) / thesis - 1.0)


def _first(run: dict[str, Any]) -> str:
    return "–" if run["visible"] is None else f"{run['visible']:.2f}"


def six_of(run: dict[str, Any]) -> float:
    """Load step with the largest motion of the block on the top right before failure."""
    load, moved = np.array(run["curve"])[:, :2].T
    held = load <= run["bracket"][0] * (1 - 0.05)
    return float(load[held][1:][np.diff(moved[held]).argmax()])


def _own(runs: list[dict[str, Any]]) -> str:
    """The thesis's own joint written once more, where its results are there."""
    rows = [
        (one["structure"], one["reading"], one["pivot"], f"{one['bracket'][0]:g} to {one['bracket'][1]:g}")
        for one in runs
    ]
    return table(("structure", "reading", "pivot", "load"), rows) if rows else ""


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
