"""Generate cross-sections of three-leaf walls: two faces of coursed stones, a rubble core, through-stones."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, NonNegative, Positive, RandomStructure
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.model.blocks import Block
from dem_cli.input_limits import MOST_STONES
from dem_cli.masonry.structures.bases import base_block
from dem_cli.masonry.structures.patterns.coursed import Size, divided
from dem_cli.masonry.structures.patterns.drawn_once import drawn_once
from dem_cli.masonry.structures.patterns.panel import LEAST_SHARE, WallPanel, blocks_of
from dem_cli.masonry.structures.patterns.pattern_wall import stone_figures
from dem_cli.masonry.structures.patterns.tiling import Tiling
from dem_cli.masonry.structures.patterns.voronoi import VoronoiPattern, stones_in


class WallSection(RandomStructure):
    """Cross-section of a three-leaf wall, to study how it bulges, separates and falls out of its plane. Local
    origin: foot of the left face, on top of the base; in 3D half of the length `thickness` lies to either side.

    Block names: "<id>-left-<course>", "<id>-right-<course>" for the faces, "<id>-through-<course>",
    "<id>-core-<number>" from the lowest stone up, "<id>-base". Courses count from 1, over the whole height.
    """

    kind: Literal["wall-section"] = "wall-section"
    size: tuple[Positive, Positive] = Field(
        description="thickness of the wall, that is the width of its section, and height [m]", examples=[[0.6, 3.0]]
    )
    thickness: Positive = Field(1.0, description="length of wall that the section stands for, depth out of plane [m]")
    course: Size = Field(description="mean and deviation of the heights of the courses [m]", examples=[[0.2, 0.04]])
    face: Size = Field(description="mean and deviation of the depths of the face stones [m]", examples=[[0.2, 0.05]])
    through: int = Field(
        0, ge=0, le=1000, description="every so many courses one is a through-stone; 0: none", examples=[5]
    )
    cell: Positive = Field(description="mean side of the stones of the core [m]", examples=[0.12])
    relax: int = Field(3, ge=0, le=1000, description="Lloyd steps of the core; 0: as drawn at random")
    shortest: float = Field(0.05, ge=0.0, le=0.3, description="edges below this share of `cell` collapse [-]")
    core_material: str = Field("", description="a name in [materials]; default: that of the faces", examples=["rubble"])
    base: bool = Field(True, description="a fixed block below, as wide as the section")
    base_height: Positive | None = Field(None, description="height of the base [m]; default: a course", examples=[0.3])
    base_extension: NonNegative = Field(
        0.0, description="how far the base goes beyond each face, in 3D also beyond each end [m]", examples=[0.5]
    )

    @model_validator(mode="after")
    def _room_for_a_core(self) -> WallSection:
        for key in ("course", "face"):
            mean, deviation = getattr(self, key)
            most = (1.0 - LEAST_SHARE) * mean
            if deviation > most * (1.0 + 1e-9):
                message = f"a deviation of {deviation:g} is not allowed; must be at most {most:.4g}, so that "
                raise KeyProblem(f"{message}no stone is below a quarter of the mean, {mean:g}", key)
        width, height = self.size
        count = 2.0 * height / self.course[0]
        if count > MOST_STONES:
            raise KeyProblem(f"makes {count:.3g} stones; at most {MOST_STONES:,}", "course")
        least = width - 2.0 * sum(self.face)
        if least < self.cell:
            message = f"faces up to {sum(self.face):g} deep leave {max(least, 0.0):.4g} of {width:g} for a core"
            raise KeyProblem(f"{message} of stones of {self.cell:g}", "face")
        if self.course[0] > height:
            raise KeyProblem(f"{self.course[0]:g} is not allowed; the section is only {height:g} high", "course")
        return self


def build(section: WallSection) -> list[Block]:
    """Generate the blocks of a wall section: base, faces and through-stones by course, core."""
    width, blocks = section.size[0], []
    if section.base:
        depth, extension = section.base_height or section.course[0], section.base_extension
        shape = rectangle(-extension, -depth, width + 2.0 * extension, depth)
        blocks.append(base_block("base", shape, section.thickness, extension))
    faces, core = _stones(section)
    blocks += [Block(name, (shape,), "", section.thickness, course=course) for name, shape, course in faces]
    return blocks + [
        Block(block.id, block.parts, section.core_material, section.thickness)
        for block in (blocks_of(core, section.thickness, "core-") if core.stones else [])
    ]


def figures(section: WallSection) -> list[tuple[str, str]]:
    """Describe the drawn stones of the core, for `dem check`."""
    core = _stones(section)[1]
    return [("core", stone_figures(core) if core.stones else "none: every course is a through-stone")]


@drawn_once
def _stones(section: WallSection) -> tuple[list[tuple[str, np.ndarray, int]], Tiling]:
    """Generate names, shapes and courses of face and through-stones, and the stones of the core."""
    draws = np.random.default_rng(section.seed)
    (width, height), (mean, deviation) = section.size, section.face
    levels = divided(height, section.course, draws).tolist()
    found, holes, depths = [], [], [0.0, 0.0]
    for k, (low, high) in enumerate(zip(levels[:-1], levels[1:], strict=True)):
        drawn = draws.uniform(mean - deviation, mean + deviation, 2).tolist()
        depths = [b if abs(d - b) < section.shortest * section.cell else d for d, b in zip(drawn, depths)]
        if section.through and (k + 1) % section.through == 0:
            through = np.array([[0.0, low], [width, low], [width, high], [0.0, high]])
            found.append((f"through-{k + 1}", through, k + 1))
            holes.append(through)
            continue
        for name, x0, x1 in (("left", 0.0, depths[0]), ("right", width - depths[1], width)):
            shape = np.array([[x0, low], [x1, low], [x1, high], [x0, high]])
            found.append((f"{name}-{k + 1}", shape, k + 1))
            holes.append(shape)
    panel = WallPanel(rectangle(0.0, 0.0, width, height), tuple(holes))
    rubble = VoronoiPattern.model_validate(section.model_dump(include={"cell", "relax", "shortest"}))
    return found, stones_in(panel, rubble, draws)
