"""Generate rubble walls and polygonal masonry: Voronoi cells as prisms across the thickness of the wall."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import model_validator

from dem_cli.case.base import RandomStructure
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.patterns import voronoi
from dem_cli.masonry.structures.patterns.drawn_once import drawn_once
from dem_cli.masonry.structures.patterns.pattern_wall import PatternWall, masonry, stone_figures
from dem_cli.masonry.structures.patterns.tiling import Tiling

RELAXED = 3  # Lloyd steps from which most free-standing walls stand at 35°: 6 of 8; without any 2, with 10 all


class VoronoiWall(RandomStructure, PatternWall, voronoi.VoronoiPattern):
    """Wall of stones without courses, the Voronoi cells of random points: rubble, with many Lloyd steps polygonal
    masonry. Local origin: lower left corner of the wall, on top of its base; in 3D half of the thickness lies to either
    side.

    Block names: "<id>-<number>" from 1, from the lowest stone up; "<id>-base"; "<id>-lintel-<opening>",
    "<id>-arch-<opening>-<number>"; "<id>-side-<number>", "<id>-side-<number>-left" and so on. A stone that is not
    convex is a compound.
    """

    kind: Literal["voronoi-wall"] = "voronoi-wall"

    @model_validator(mode="after")
    def _enough_cells(self) -> VoronoiWall:
        self.count(self.panel.area)
        return self


def build(wall: VoronoiWall) -> list[Block]:
    """Generate the blocks of a Voronoi wall: the base first, lintels last."""
    return masonry(wall, stones(wall))


@drawn_once
def stones(wall: VoronoiWall) -> Tiling:
    """Draw the stones of a Voronoi wall."""
    return voronoi.stones_in(wall.panel, wall, np.random.default_rng(wall.seed))


def figures(wall: VoronoiWall) -> list[tuple[str, str]]:
    """Describe the drawn stones, for `dem check`."""
    return [("stones", stone_figures(stones(wall)))]


def loose_ends(wall: VoronoiWall) -> str:
    """Return the key by which stones may slide out at free ends; "": none."""
    return "relax" if wall.relax < RELAXED and wall.has_free_ends else ""
