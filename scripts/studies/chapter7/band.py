"""How wide the band is in which the wall of 231 blocks slides (thesis 7.5.5, Table 7-7)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from reference import results

from dem_cli.core.contact.drawn_joints import DrawnJoints
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.results.post import style
from studies.chapter7.walls import FACE, JOINT
from studies.places import CASES
from studies.solution import bracket_of, command_of, corners_of, from_file, solve
from studies.template import bracket, commands, table

CASE = CASES / "validation" / "wall_231_profile.toml"
DRAWN = 4  # digits of places that are drawn [m]
CORNER = 0.040  # displacement of the corner on the top right at which joints are counted [m]
LAYERS = 5  # from the top
OPEN = (1e-3, 2e-3, 3e-3)  # widths from which a vertical joint "appears opened" [m]
SOFT = "joints.rough.softening={{ residual = {}, slip_start = 0.0009, slip_length = 0.0001 }}"
CONDITIONS = {  # as Figure 7-72, polygons over joints as in the case
    "a": ("no profile", ("joints.rough={ law = 'coulomb', friction = 0.6 }",)),
    "b": ("profile", (JOINT,)),
    "c": ("profile, β = 0.9", (JOINT, SOFT.format(0.9))),
    "d": ("profile, β = 0.8", (JOINT, SOFT.format(0.8))),
}
FACES = {  # the other reading
    f"{key}_face": (f"{what}, over faces", (FACE, *words[1:]))
    for key, (what, words) in CONDITIONS.items()
    if key != "a"
}
FALL = (
    "analysis.follow=0.046", "analysis.collapse=load", "analysis.step=0.05", "analysis.resolution=0.02",
    "output.frames=40",
)  # fmt: skip


def measure() -> dict[str, Any]:
    """Counts of open joints and the places of all blocks of the four cases, of three with both readings."""
    return {key: fall(*overrides) for key, (_, overrides) in (CONDITIONS | FACES).items()}


def fall(*overrides: str) -> dict[str, Any]:
    """One collapse: bracket, open joints by width and layer, corners of all blocks with the corner moved by CORNER."""
    words = [*overrides, *FALL]
    model, summary, seen = solve(from_file(CASE, *words))
    start = corners_of(model, seen.frames[0])
    name = max((i for i, name in enumerate(model.block_ids) if "base" not in name), key=lambda i: np.sum(start[i]))
    far = int(np.argmax(np.sum(start[name], axis=1)))
    falling = [frame for frame in seen.frames if frame.stage == "collapse"]
    placed = [corners_of(model, frame) for frame in falling]
    moved = [corners[name][far][0] - start[name][far][0] for corners in placed]
    chosen = int(np.argmin(np.abs(np.array(moved) - CORNER)))
    return {
        "command": command_of(CASE, words),
        "status": summary["status"],
        "bracket": bracket_of(summary, 9),
        "moved": round(moved[chosen], 5),
        "widths": widths_of(model, falling[chosen]),
        "corners": corners_of(model, falling[chosen], DRAWN),
        "seconds": round(summary["solve_seconds"], 1),
        "warnings": summary["warnings"],
    }


def widths_of(model: Model, frame: Frame) -> list[list[float]]:
    """Mean widths of the head joints of the upper LAYERS [m], from the top and the left (`dem export --joints`)."""
    joints = DrawnJoints(model)
    openings = joints.at(frame.positions, frame.orientations, frame.contacts).states.opening
    heads = np.flatnonzero(np.abs(joints.places.normals[:, 0]) > np.abs(joints.places.normals[:, 1]))
    places = joints.places.ends.mean(axis=1)
    heights = np.round(places[heads, 1], DRAWN)
    layers = [heads[heights == height] for height in np.unique(heights)[: -LAYERS - 1 : -1]]
    return [np.round(openings[layer[np.argsort(places[layer, 0])]], 6).tolist() for layer in layers]


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What band.md.j2 shows."""
    thesis = results("thesis_231_block")
    rows = []
    for key, (what, _) in (CONDITIONS | FACES).items():
        one, counted = found[key], thesis[f"T77_{key[0]}"]["value"]
        counts = [[sum(w > width for w in layer) for layer in one["widths"]] for width in OPEN]
        open_ = [np.maximum(layer, 0.0) for layer in one["widths"]]
        effective = np.mean([w.sum() ** 2 / (w**2).sum() for w in open_])
        rows.append((f"({key[0]}) {what}", bracket(one["bracket"]), *map(_sum, (counted, *counts)), f"{effective:.2f}"))
    wider = (f"dem, > {1e3 * width:g} mm" for width in OPEN)
    head = ("case", "failure load", "thesis, open joints", *wider, "effective")
    return {"bands": table(head, rows), "commands": commands(*(found[key] for key in CONDITIONS | FACES))}


def _sum(counts: list[int]) -> str:
    return f"{' '.join(map(str, counts))} = {sum(counts)}"


def draw(found: dict[str, Any], path: Path) -> None:
    """As Figure 7-72: the four collapses side by side."""
    with style.figure(path, figsize=(11.0, 3.4)) as figure:
        for axis, (key, (what, _)) in zip(figure.subplots(1, 4, sharey=True), CONDITIONS.items(), strict=True):
            for corners in found[key]["corners"]:
                axis.fill(*np.array(corners).T, facecolor=style.STONE, edgecolor="0.35", lw=0.4)
            axis.set(title=f"({key}) {what}", aspect="equal", xlim=(0.05, 0.47), ylim=(-0.02, 0.42))
            axis.axis("off")


PICTURES = {"band": draw}
