"""Tables of a case file for walls of a building in irregular stones: patterns, and the panel that they fill."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from dem_cli.case.base import CaseModel
from dem_cli.masonry.structures.patterns import coursed, voronoi
from dem_cli.masonry.structures.patterns.panel import WallPanel
from dem_cli.masonry.structures.patterns.tiling import Tiling


class BuildingPatternKeys(CaseModel):
    """Keys of every stone pattern of a building."""

    jambs: Literal["dressed", "rubble"] = Field(
        "dressed",
        description="beside openings; dressed: squared stones, long and short in turn; rubble: stones of the pattern, "
        "which may slide out",
    )


class VoronoiRubble(voronoi.VoronoiPattern, BuildingPatternKeys):
    """Walls of a building without courses: rubble, with many Lloyd steps polygonal masonry. `cells`: of each wall."""

    kind: Literal["voronoi"] = Field("voronoi", description="cells of random points, without courses")

    def stones_in(self, panel: WallPanel, draws: np.random.Generator) -> Tiling:
        """Generate the stones of a panel. Raises KeyProblem."""
        return voronoi.stones_in(panel, self, draws)

    def mean(self, panel: WallPanel) -> float:
        """Return the area of a mean stone [m2]. Raises KeyProblem: too few or too many stones."""
        return panel.area / self.count(panel.area)


class CoursedRubble(coursed.CoursedPattern, BuildingPatternKeys):
    """Walls of a building in irregular courses."""

    kind: Literal["coursed"] = Field("coursed", description="irregular courses")

    def stones_in(self, panel: WallPanel, draws: np.random.Generator) -> Tiling:
        """Generate the stones of a panel. Raises KeyProblem."""
        return coursed.stones_in(panel, self, draws).tiling

    def mean(self, panel: WallPanel) -> float:
        """Return the area of a mean stone [m2]."""
        return self.spacing[0] * self.head_spacing[0]


BuildingPattern = Annotated[VoronoiRubble | CoursedRubble, Field(discriminator="kind")]
