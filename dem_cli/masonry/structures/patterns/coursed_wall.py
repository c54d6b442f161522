"""Generate irregular coursed masonry: kinked bed joints, random stones, inclined head joints (Lemos 2019, 3.3)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import model_validator

from dem_cli.case.base import RandomStructure
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.patterns import coursed
from dem_cli.masonry.structures.patterns.drawn_once import drawn_once
from dem_cli.masonry.structures.patterns.pattern_wall import PatternWall, masonry, spread, stone_figures

UNITS = {"head_angle_deg": "deg"}


class CoursedWall(RandomStructure, PatternWall, coursed.CoursedPattern):
    """Wall of stones in irregular courses: beds kink, stones differ in height and length. Local origin: lower left
    corner of the wall, on top of its base; in 3D half of the thickness lies to either side.

    Block names: "<id>-<course>-<number>", both from 1, numbers from left to right; "<id>-base";
    "<id>-lintel-<opening>", "<id>-arch-<opening>-<number>"; "<id>-side-<number>", "<id>-side-<number>-left" and so on.
    A stone that is not convex is a compound.
    """

    kind: Literal["coursed-wall"] = "coursed-wall"

    @model_validator(mode="after")
    def _beds_and_heads_apart(self) -> CoursedWall:
        self.check(*self.extent)
        return self


def build(wall: CoursedWall) -> list[Block]:
    """Generate the blocks of a coursed wall: the base first, lintels last."""
    return masonry(wall, stones(wall).tiling)


@drawn_once
def stones(wall: CoursedWall) -> coursed.CoursedStones:
    """Draw the stones of a coursed wall, with the random values."""
    return coursed.stones_in(wall.panel, wall, np.random.default_rng(wall.seed))


def figures(wall: CoursedWall) -> list[tuple[str, str]]:
    """Describe the drawn parameters by mean and standard deviation, for `dem check`."""
    found = stones(wall)
    drawn = [
        (key, f"{spread(values)} {UNITS.get(key, 'm')}, {len(values):,} drawn")
        for key, values in found.drawn.items()
        if len(values)
    ]
    return [("stones", stone_figures(found.tiling)), *drawn]
