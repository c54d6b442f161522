"""Walls of irregular masonry: what all kinds have in common, size, openings with lintels, base and sides."""

from __future__ import annotations

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, NonNegative, Positive, RandomStructure
from dem_cli.geometry.polygon import rectangle
from dem_cli.model.blocks import Block
from dem_cli.structures.bases import base_block
from dem_cli.structures.openings import NARROWEST_PIECE, Opening, check_opening
from dem_cli.structures.patterns.panel import WallPanel, blocks_of, rectangular
from dem_cli.structures.patterns.tiling import Tiling
from dem_cli.structures.sides import Side, SupportedWall, side_blocks
from dem_cli.structures.wall import _corners


class PatternWall(RandomStructure):
    """What every wall of irregular masonry accepts."""

    size: tuple[Positive, Positive] = Field(
        description="length and height of the wall, in 3D its thickness may follow [m]",
        examples=[[4.0, 3.0]],
        json_schema_extra={"maxItems": 3},
    )
    thickness: Positive = Field(1.0, description="depth out of plane [m]")
    openings: tuple[Opening, ...] = Field(
        (), description="doors and windows", examples=[[{"x": 0.8, "y": 0.0, "width": 0.9, "height": 2.0}]]
    )
    base: bool = Field(True, description="a fixed block below, as long as the wall")
    base_height: Positive | None = Field(
        None, description="height of the base [m]; default: a tenth of that of the wall", examples=[0.3]
    )
    base_extension: NonNegative = Field(
        0.0, description="how far the base goes beyond each end, in 3D also beyond each face [m]", examples=[0.5]
    )
    sides: tuple[Side, ...] = Field(
        (), description="fixed supports behind faces of the wall", examples=[[{"face": "-y", "strip": 0.8}]]
    )

    @model_validator(mode="after")
    def _fits(self) -> PatternWall:
        length, height = self.size
        for i, opening in enumerate(self.openings):
            check_opening(opening, i, length, height)
        for i, side in enumerate(self.sides):
            widest = side.widest(length)
            if side.strip is not None and side.strip > widest * (1.0 + NARROWEST_PIECE):
                of = f"{'half ' if side.ends == 'both' else ''}the length of the wall"
                message = f"{side.strip:g} is not allowed; must be at most {widest:g}, {of}"
                raise KeyProblem(message, "sides", i, "strip")
        return self

    @property
    def base_depth(self) -> float:
        """Height of the base [m]."""
        return self.base_height or self.size[1] / 10.0

    @property
    def panel(self) -> WallPanel:
        """The rectangle of the wall without its openings and lintels."""
        lintels = [box for opening in self.openings if (box := opening.lintel_box)]
        holes = [(o.x, o.y, o.x + o.width, o.y + o.height) for o in self.openings]
        return rectangular(*self.size, [*holes, *lintels])


def masonry(wall: PatternWall, tiling: Tiling) -> list[Block]:
    """Base, sides, stones and lintels of a wall, in local places. Raises ValueError: openings leave nothing of it."""
    if not tiling.stones:
        raise ValueError("the openings leave nothing of the wall")
    return [*_supports(wall), *blocks_of(tiling, wall.thickness), *_lintels(wall)]


def _supports(wall: PatternWall) -> list[Block]:
    (length, height), blocks, extension = wall.size, [], wall.base_extension
    if wall.base:
        shape = rectangle(-extension, -wall.base_depth, length + 2.0 * extension, wall.base_depth)
        blocks.append(base_block("base", shape, wall.thickness, extension))
    foot = -wall.base_depth if wall.base and not extension else 0.0
    return blocks + side_blocks(wall.sides, SupportedWall(length, height, wall.thickness, foot))


def _lintels(wall: PatternWall) -> list[Block]:
    return [
        Block(f"lintel-{i + 1}", (_corners(np.array([box]))[0],), opening.lintel.material, wall.thickness)
        for i, opening in enumerate(wall.openings)
        if opening.lintel and (box := opening.lintel_box)
    ]


def stone_figures(tiling: Tiling) -> str:
    """How many stones there are, of which size, and how many are compounds, in words."""
    areas, compounds = tiling.areas(), sum(len(tiling.parts(k)) > 1 for k in range(len(tiling.stones)))
    text = (
        f"{len(areas):,} stones of {spread(areas)} m2 in elevation, shortest edge {tiling.edge_lengths().min():.3g} m"
    )
    return f"{text}; {compounds:,} are compounds of convex parts" if compounds else text


def spread(values: np.ndarray) -> str:
    """Mean and standard deviation of some values, with the least and the largest."""
    return f"{values.mean():.4g} ± {values.std():.2g} ({values.min():.3g} to {values.max():.3g})"
