"""Dry brick wall over ground that settles by 0.14 m (paper 002, section 3), in the plane and in space."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.results.output.paraview.vertices import placed_vertices
from dem_cli.results.post import style
from studies.observer import RunKeeper
from studies.places import CASES
from studies.template import minus, table

CASES_OF = {"in the plane": "bui_settlement_plane", "by load": "bui_settlement_load", "in space": "bui_settlement"}
BORNE = 3489.8  # N: what the ground carries before it gives way, 7/15 of the wall
FRONT = -1e-6  # m: corners in front of this in space


def measure() -> list[dict[str, Any]]:
    """Both walls."""
    return [wall(words, name) for words, name in CASES_OF.items()]


def wall(words: str, name: str) -> dict[str, Any]:
    """The mode, and the outlines of all bricks in the end, of those in space their front."""
    loaded, seen = api.load_case(CASES / "validation" / f"{name}.toml"), RunKeeper()
    model = api.build_model(loaded)
    summary = solve(loaded.case, model, seen).summary
    frame = seen.frames[-1]
    corners = placed_vertices(model, frame.positions, frame.orientations)
    outlines = []
    for block in range(model.n_blocks):
        own = corners[model.vertex_blocks == block]
        if model.dimension == 3:
            own = _around(own[:, [0, 2]])
        outlines.append(np.round(own, 4).ravel().tolist())
    found = dict(zip((str(one.name) for one in loaded.case.monitor), seen.rows[-1].monitors, strict=True))
    return {
        "command": f"dem run cases/validation/{name}.toml", "words": words, "status": summary["status"],
        "closure": float(f"{summary['energy_closure']:.2g}"), "monitors": {k: round(v, 5) for k, v in found.items()},
        "ground": ground(loaded.case, seen), "open": summary["joint_state"]["open"],
        "crack": round(summary["joint_state"]["crack_width"]["value"], 4),
        "outlines": outlines, "fixed": model.fixed.tolist(),
    }  # fmt: skip


def ground(case: Any, seen: RunKeeper) -> list[list[float]]:
    """What the ground carries [N] at each settlement [mm]; nothing where no monitor has it."""
    if case.analysis.kind == "cycle":
        return [[round(1e3 * row.live_displacement, 2), round(BORNE * (1.0 - row.load), 1)] for row in seen.rows]
    names = [one.name for one in case.monitor]
    if "ground" not in names:
        return []
    down = 1e3 * abs(case.settlement[0].displacement[-1])
    rows = [row for row in seen.rows if row.stage in ("gravity", "settlement")]
    last = len(rows) - 1
    return [[round(down * i / last, 2), round(row.monitors[names.index("ground")], 1)] for i, row in enumerate(rows)]


def _around(points: np.ndarray) -> np.ndarray:
    """Convex outline of points in an elevation, in order."""
    from scipy.spatial import ConvexHull

    return points[ConvexHull(points).vertices]


def values(found: list[dict[str, Any]]) -> dict[str, Any]:
    """What the page shows."""
    names = [name for name in found[0]["monitors"] if name in found[-1]["monitors"]]
    rows = [
        [
            one["words"], one["status"], *(minus(f"{1e3 * one['monitors'][name]:.1f}") for name in names),
            f"{1e3 * one['crack']:.0f}", f"{abs(one['closure']):.0e}",
        ]
        for one in found
    ]  # fmt: skip
    forces = {one["words"]: [force for _, force in one["ground"]] for one in found}
    least = {"moved": min(forces["in the plane"]), "loaded": min(forces["by load"])}
    said = {name: f"{value:,.0f}" for name, value in least.items()}
    said["first"] = f"{found[1]['ground'][1][1]:,.0f}"
    return said | {
        "walls": table(("", "status", *(f"{n} [mm]" for n in names), "widest crack [mm]", "energy closes to"), rows)
    }


def draw(found: list[dict[str, Any]], path: Path) -> None:
    """The walls in the end."""
    with style.figure(path, figsize=(9.6, 3.8)) as figure:
        for axis, one in zip(figure.subplots(1, len(found), squeeze=False)[0], found, strict=True):
            for outline, fixed in zip(one["outlines"], one["fixed"], strict=True):
                corners = np.reshape(outline, (-1, 2))
                axis.fill(*corners.T, facecolor="#c8c4bb" if fixed else style.STONE, edgecolor=style.STONE_EDGE, lw=0.5)
            axis.set(aspect="equal", title=one["words"], xlim=(-0.2, 1.8), ylim=(-0.35, 1.1))
            axis.axis("off")


def draw_ground(found: list[dict[str, Any]], path: Path) -> None:
    """What the ground carries over its settlement: moved at a steady pace, and by load."""
    with style.figure(path, figsize=(5.6, 3.6)) as figure:
        axis = figure.subplots()
        for one, colour in zip(found[:2], (style.GREY, style.STAGE_COLOURS["loading"]), strict=True):
            words = "by load" if one["words"] == "by load" else "moved"
            axis.plot(*np.transpose(one["ground"]), color=colour, label=words)
        axis.set(xlabel="settlement [mm]", ylabel="the ground carries [N]", ylim=(0.0, None))
        axis.legend(fontsize=8)


PICTURES = {"settlement": draw, "settlement_ground": draw_ground}
