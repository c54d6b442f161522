"""Study of a joint with a profile: the moment that it carries as it turns to and fro, docs/profile_joint.png."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.core.contact.layout import PointLayout, draw
from dem_cli.core.laws.profile import Profile
from dem_cli.results.post import style
from studies.places import DOCS
from studies.study import StudyRunner

LENGTH, APERTURE = 0.04, 1e-4  # m: the blocks of the thesis
PRESSED = (1e-3, 1e-1)  # of the aperture, on one side: how far the weight presses stiff and soft joints together
FARTHEST = 1.9  # of the angle between two sides
ANGLE = APERTURE / (0.4 * LENGTH)  # rad


def moments(places: np.ndarray, gaps: np.ndarray, shares: np.ndarray, rotations: np.ndarray, soft: float) -> np.ndarray:
    """M / (N b) of a joint at these rotations [rad] under a constant force: points that only press, (n,)."""
    found = []
    x = places - 0.5 * LENGTH
    for rotation in rotations:
        heights = gaps + rotation * x  # how far each point is from closing, before the joint is pressed together
        low, high = heights.min(), heights.max() + 3.0 * soft
        for _ in range(100):
            sunk = 0.5 * (low + high)
            total = (shares * np.maximum(sunk - heights, 0.0)).sum()
            low, high = (low, sunk) if total > soft else (sunk, high)
        forces = shares * np.maximum(sunk - heights, 0.0) / soft
        found.append(-(forces * x).sum() / LENGTH)
    return np.array(found)


def draw_joint(path: Path) -> None:
    """The polygon of a joint, and its moment over its rotation."""
    profile = Profile(sides=3, central=0.2, aperture=APERTURE)
    polygon = draw(PointLayout(**profile.ranges), (0,), LENGTH)
    plane = draw(PointLayout(), (0,), LENGTH)
    rotations = np.linspace(-FARTHEST, FARTHEST, 1501) * ANGLE
    with style.figure(path, figsize=(8.4, 3.7)) as figure:
        shape, response = figure.subplots(1, 2, width_ratios=(1.0, 1.5))
        _draw_shape(shape, *polygon[:2])
        for soft, look in zip(PRESSED, ("-", "--")):
            label = f"pressed together by {soft * APERTURE * 1e6:.3g} µm"
            for points, colour in ((plane, style.GREY), (polygon, style.THRUST)):
                name = ("plane, " if points is plane else "three sides, ") + label
                values = moments(*points, rotations, soft * APERTURE)
                response.plot(rotations / ANGLE, values, look, color=colour, lw=1.4, label=name)
        response.set_xlabel("relative rotation θ / φ")
        response.set_ylabel("moment M / (N b)")
        response.set_xticks(np.arange(-1.5, 2.0, 0.5))
        figure.legend(loc="outside lower right", ncols=2, fontsize=8)
        figure.suptitle("A joint of three sides under constant force", x=0.01, ha="left", fontweight="bold")


def _draw_shape(axis: Any, places: np.ndarray, rises: np.ndarray) -> None:
    x, z = 1e3 * places, 1e3 * rises
    axis.fill([*x, x[-1], 0.0], [*z, 0.2, 0.2], fc=style.STONE, lw=0)
    axis.plot(x, z, color=style.THRUST)
    axis.plot(x, z, "o", color=style.THRUST, ms=5)
    axis.axhline(0.0, color=style.STONE_EDGE)
    axis.plot([x[0], x[-1]], [z[0], z[-1]], color=style.GREY, lw=0.9, ls=(0, (4, 3)))
    middle = 0.5 * (x[0] + x[-1])
    axis.annotate("", (middle, 0.0), (middle, z[0]), arrowprops={"arrowstyle": "<->", "color": style.INK, "lw": 1.0})
    axis.text(middle + 1.0, 0.5 * z[0], "aperture d", va="center", fontsize=9)
    axis.text(x[0] + 0.5, 0.02, "φ = d / l₁", fontsize=9, color=style.THRUST, ha="left")
    for i, length in enumerate(np.diff(x)):
        axis.text(x[i] + 0.5 * length, -0.016, f"{length:.3g}", ha="center", va="top", fontsize=9)
    axis.set_ylim(-0.04, 0.2)
    axis.set_xlabel("along the joint [mm]")
    axis.set_ylabel("across it, exaggerated [mm]")
    axis.grid(False)


class ProfileStudy(StudyRunner):
    """A picture; nothing is kept."""

    solves = False

    def said(self, section: str, found: Any) -> str:
        return "docs/profile_joint.png: drawn with --write"

    def write(self, found: Mapping[str, Any]) -> None:
        self.redraw()

    def redraw(self) -> None:
        draw_joint(DOCS / "profile_joint.png")


STUDY = ProfileStudy("profile", "The moment that a joint with a profile carries", {"joint": lambda: None})
