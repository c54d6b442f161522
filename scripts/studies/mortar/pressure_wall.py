"""Wall with return walls under pressure, with and without bars (paper 002, 4.2): pressure over deflection, cracks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.analyses.solve import solve
from dem_cli.app import api
from dem_cli.core.contact.drawn_joints import DrawnJoints
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.results.post import style
from studies.observer import RunKeeper
from studies.places import CASES
from studies.template import minus, table

CASES_OF = {"without bars": "bui_pressure_wall", "with bars": "bui_pressure_wall_bars"}
KINK, PEAK, DEFLECTION = 34.0, 58.0, 26.7  # of the test [kPa, mm]
LENGTH, DEPTH, HEIGHT = 2.9, 1.6, 2.0  # m
FACES = {
    "left return": (0, 0.0),
    "main wall": (1, 0.0),
    "right return": (0, LENGTH),
}  # which coordinate has which value
FIRST = 5e-6  # m: a joint that is open so far has cracked
SOFT = 0.5  # of the first stiffness, below which a curve has its kink
CORNERS = ('joints.mortar.points="vertices"',)
STIFF = ("bars.corner.bond_stiffness=2e10", "bars.top.bond_stiffness=3e10")
READINGS = [  # of the paper, beside that of the cases: words, wall, keys that are changed
    ("points at the corners alone", "without bars", CORNERS),
    ("points at the corners alone", "with bars", CORNERS),
    ("bond ten times as stiff", "with bars", STIFF),
    ("both", "with bars", (*CORNERS, *STIFF)),
]


def measure() -> dict[str, Any]:
    """Both walls, and what other readings of the paper make of them."""
    kept = ("words", "status", "closure", "bracket", "deflections", "pressures")
    others = [(words, of, wall(of, CASES_OF[of], changes)) for words, of, changes in READINGS]
    return {
        "walls": [wall(words, name) for words, name in CASES_OF.items()],
        "readings": [{"reading": words} | {key: found[key] for key in kept} for words, _, found in others],
    }


def wall(words: str, name: str, changes: Sequence[str] = ()) -> dict[str, Any]:
    """Pressure [kPa], deflection of the middle [mm] and cracks where it was furthest."""
    path = CASES / "validation" / f"{name}.toml"
    loaded, seen = api.load_case(path, changes), RunKeeper()
    model = api.build_model(loaded)
    summary = solve(loaded.case, model, seen).summary
    rows = [row for row in seen.rows if row.stage in ("gravity", "loading", "collapse")]
    until = int(np.argmax([row.live_displacement for row in rows])) + 1  # a proof of the peak follows the curve
    rows = rows[:until]
    furthest = max(seen.frames, key=lambda frame: np.abs(frame.positions - model.centroids).max())
    return {
        "command": f"dem run cases/validation/{name}.toml", "words": words, "status": summary["status"],
        "closure": float(f"{summary['energy_closure']:.2g}"), "blocks": model.n_blocks,
        "bracket": summary.get("failure_load_bracket"),
        "deflections": [float(f"{1e3 * row.monitors[0]:.4g}") for row in rows],
        "pressures": [float(f"{row.load:.4g}") for row in rows],
        "cracks": cracks(model, furthest), "shown": float(f"{1e3 * furthest.displacement:.3g}"),
    }  # fmt: skip


def cracks(model: Model, frame: Frame) -> list[list[Any]]:
    """Joints that are open, as they show on the outer faces: face, both ends [m], width [mm]."""
    drawn = DrawnJoints(model)
    widths = drawn.at(frame.positions, frame.orientations, frame.contacts).states.crack_width
    places, found = drawn.faces.on_first, list[list[Any]]()
    for face, (axis, value) in FACES.items():
        on = np.abs(places[:, axis] - value) < 1e-6
        for joint in np.flatnonzero(widths > FIRST):
            ends = places[on & (drawn.owners == joint)][:, [1 - axis, 2]]
            if len(ends) > 1:
                line = ends[np.lexsort(ends.T)][[0, -1]].ravel()
                found.append([face, *(round(float(x), 4) for x in line), float(f"{1e3 * widths[joint]:.3g}")])
    return found


def kink(found: dict[str, Any]) -> float:
    """Pressure up to which a curve has at least half of its first stiffness [kPa]."""
    u, p = np.array(found["deflections"]), np.array(found["pressures"])
    first = (p[1] - p[0]) / (u[1] - u[0])
    soft = np.flatnonzero(np.diff(p) / np.maximum(np.diff(u), 1e-12) < SOFT * first)
    return float(p[soft[0]])


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What the page shows."""
    rows = []
    for one in [*found["walls"], *found["readings"]]:
        u, p = np.array(one["deflections"]), np.array(one["pressures"])
        straight, most = kink(one), p.max()
        there = float(np.interp(DEFLECTION, u, p)) if u.max() >= 0.97 * DEFLECTION else None
        first = one["bracket"][0] if one["bracket"] else None
        rows.append(
            [
                ", ".join(filter(None, (one["words"], one.get("reading")))),
                f"{straight:.1f}", minus(f"{100.0 * (straight / KINK - 1.0):+.0f} %"),
                f"{max(most, first or 0.0):.1f}", minus(f"{100.0 * (max(most, first or 0.0) / PEAK - 1.0):+.0f} %"),
                f"{u[int(np.argmax(p))]:.1f}", "–" if there is None else f"{there:.1f}", f"{abs(one['closure']):.0e}",
            ]
        )  # fmt: skip
    head = ("", "half as stiff from [kPa]", "test: 34", "highest [kPa]", "test: 58", "middle there [mm]",
            "at 26.7 mm [kPa]", "energy closes to")  # fmt: skip
    plain, bars = found["walls"]
    after, most = plain["pressures"][-1], [max(one["pressures"]) for one in (bars, *found["readings"][1:3])]
    peaks = {name: f"{value:.1f}" for name, value in zip(("bars", "corners", "stiff"), most, strict=True)}
    return {"curves": table(head, rows), "after": f"{after:.1f}", "closure": f"{abs(bars['closure']):.0e}"} | peaks


def draw_curves(found: dict[str, Any], path: Path) -> None:
    """Pressure over deflection, both walls and what is printed of the test."""
    with style.figure(path, figsize=(6.4, 4.0)) as figure:
        axis = figure.subplots()
        for one, colour in zip(found["walls"], (style.GREY, style.STAGE_COLOURS["loading"]), strict=True):
            axis.plot(one["deflections"], one["pressures"], color=colour, label=f"dem, {one['words']}")
        axis.plot([DEFLECTION], [PEAK], "s", color=style.REFERENCE, label="test: largest pressure")
        axis.axhline(KINK, color=style.REFERENCE, ls=":", lw=1.0, label="test: first cracks")
        axis.set(xlabel="deflection of the middle [mm]", ylabel="pressure [kPa]", ylim=(0.0, None), xlim=(0.0, 30.0))
        axis.legend(fontsize=8)


def draw_cracks(found: dict[str, Any], path: Path) -> None:
    """Open joints on the outer faces of both walls, unfolded, as wide as they are open."""
    with style.figure(path, figsize=(9.0, 5.4)) as figure:
        for axis, one in zip(figure.subplots(2, 1), found["walls"], strict=True):
            widest = max((crack[-1] for crack in one["cracks"]), default=1.0)
            for face, (shift, turned, width) in _unfolded().items():
                outline = [shift, shift + width, shift + width, shift], [0.0, 0.0, HEIGHT, HEIGHT]
                axis.fill(*outline, facecolor=style.STONE, edgecolor=style.STONE_EDGE, lw=0.7)
                axis.text(shift + width / 2.0, HEIGHT + 0.05, face, ha="center", fontsize=8)
                for name, a, z, b, y, open_by in one["cracks"]:
                    if name == face:
                        xs = [shift + (width - x if turned else x) for x in (a, b)]
                        axis.plot(xs, [z, y], color=style.REFERENCE, lw=0.4 + 4.0 * (open_by / widest) ** 0.5)
            axis.set(xlim=(-0.1, 2 * DEPTH + LENGTH + 0.5), ylim=(-0.05, HEIGHT + 0.25), aspect="equal")
            axis.set_title(
                f"{one['words']}, moved by {one['shown']:g} mm, joints open by up to {widest:.3g} mm", fontsize=9
            )
            axis.axis("off")


def _unfolded() -> dict[str, tuple[float, bool, float]]:
    """Where each face begins, whether it is turned round, how long it is, as one sees the walls from outside."""
    return {
        "left return": (0.0, True, DEPTH), "main wall": (DEPTH + 0.2, False, LENGTH),
        "right return": (DEPTH + LENGTH + 0.4, False, DEPTH),
    }  # fmt: skip


PICTURES = {"pressure": draw_curves, "pressure_cracks": draw_cracks}
