"""Base class of walls of irregular masonry: size, openings with lintels, base and sides."""

from __future__ import annotations

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive
from dem_cli.core.geometry import pockets
from dem_cli.core.geometry.polygon import rectangle
from dem_cli.core.model.blocks import Block
from dem_cli.input_limits import MOST_STONES
from dem_cli.masonry.structures import tops
from dem_cli.masonry.structures.bases import base_block
from dem_cli.masonry.structures.openings import NARROWEST_PIECE, Opening, check_apart, check_opening
from dem_cli.masonry.structures.patterns.panel import WallPanel, blocks_of
from dem_cli.masonry.structures.patterns.tiling import Tiling
from dem_cli.masonry.structures.sides import Side, SupportedWall, side_blocks
from dem_cli.masonry.structures.wall_outline import NOT_UPRIGHT, Outlined


class DressedEnds(CaseModel):
    """Quoins: squared stones that close the ends of a wall of irregular stones, long and short in turn."""

    length: Positive = Field(description="length of the long ones [m]; the short ones are half of it", examples=[0.6])
    height: Positive = Field(description="height, stretched to fill the wall with a whole number [m]", examples=[0.3])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["ashlar"])

    def boxes(self, length: float, height: float) -> dict[str, np.ndarray]:
        """Return local name -> shape of each quoin in a wall of that size [m]."""
        count = max(round(height / self.height), 1)
        levels, found = [height * k / count for k in range(count)] + [height], {}
        for k, (low, high) in enumerate(zip(levels[:-1], levels[1:], strict=True)):
            for end, share in (("left", 1.0 - 0.5 * (k % 2)), ("right", 0.5 + 0.5 * (k % 2))):
                reach = self.length * share
                x0, x1 = (0.0, reach) if end == "left" else (length - reach, length)
                found[f"quoin-{end}-{k + 1}"] = np.array([[x0, low], [x1, low], [x1, high], [x0, high]])
        return found


class PatternWall(Outlined):
    """Keys of every wall of irregular masonry."""

    size: tuple[Positive, Positive] | None = Field(
        None,
        description="length and height of the wall, in 3D its thickness may follow [m]; default: those of the outline",
        examples=[[4.0, 3.0]],
        json_schema_extra={"maxItems": 3},
    )
    thickness: Positive = Field(1.0, description="depth out of plane [m]")
    openings: tuple[Opening, ...] = Field(
        (), description="doors and windows", examples=[[{"x": 0.8, "y": 0.0, "width": 0.9, "height": 2.0}]]
    )
    quoins: DressedEnds | None = Field(
        None, description="squared stones at both ends; default: none", examples=[{"length": 0.6, "height": 0.3}]
    )
    gable: tops.Gable | None = Field(
        None,
        description="a triangle of masonry on top, cut along its slopes; default: none",
        examples=[{"height": 1.5}],
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
        self.check_outlined(self.openings, ("size", "gable"))
        if self.size is None and self.outline is None:
            raise KeyProblem("missing; must be a list of 2 numbers above 0, length and height", "size")
        length, height = self.extent
        if self.gable:
            height += self.gable.height
            if self.gable.edges != "cut":
                raise KeyProblem("'stepped' is not allowed; must be 'cut'", "gable", "edges")
            if self.gable.ridge is not None and self.gable.ridge >= length:
                message = f"{self.gable.ridge:g} is not allowed; must be less than the length of the wall, {length:g}"
                raise KeyProblem(message, "gable", "ridge")
        top = self.face[2:] if not self.gable else self.face[[4, 3, 2]]
        for i, opening in enumerate(self.openings):
            check_opening(opening, i, length, height)
            if self.gable and any(tops.cuts_off(top, shape, NARROWEST_PIECE * length) for shape in opening.void.solids):
                raise KeyProblem("reaches above the top of the wall there", "openings", i)
        check_apart(self.openings)
        if self.quoins:
            _check_quoins(self, self.quoins)
        for i, side in enumerate(self.sides):
            widest = side.widest(length)
            if side.strip is not None and side.strip > widest * (1.0 + NARROWEST_PIECE):
                of = f"{'half ' if side.ends == 'both' else ''}the length of the wall"
                message = f"{side.strip:g} is not allowed; must be at most {widest:g}, {of}"
                raise KeyProblem(message, "sides", i, "strip")
        return self

    @property
    def has_free_ends(self) -> bool:
        """Tell whether an end of the wall has neither quoins nor a fixed side."""
        return not self.quoins and not {"-x", "+x"} <= {side.face for side in self.sides}

    @property
    def base_depth(self) -> float:
        """Height of the base [m]."""
        return self.base_height or self.extent[1] / 10.0

    @property
    def extent(self) -> tuple[float, float]:
        """Length and height, of an outline those of its bounding box [m]."""
        if self.outline:
            return self.outline.drawn.size
        assert self.size is not None
        return self.size

    @property
    def all_openings(self) -> tuple[Opening, ...]:
        """Openings of the case followed by those of the drawing."""
        return self.with_drawn(self.openings)

    @property
    def face(self) -> np.ndarray:
        """Corners of the face with the gable, of an outline those of its convex hull [m], (n, 2)."""
        if self.outline:
            return pockets.hull(self.outline.drawn.outline)
        length, height = self.extent
        whole = rectangle(0.0, 0.0, length, height)
        if not self.gable:
            return whole
        return np.insert(whole, 3, tops.gable_profile(self.gable, 0.0, length, height)[1], axis=0)

    @property
    def panel(self) -> WallPanel:
        """Face without openings, lintels, arches and quoins."""
        found = [hole for opening in self.all_openings for hole in opening.void.outlines]
        found += [*self.outline.cut, *self.outline.drawn.beside_hull] if self.outline else []
        return WallPanel(self.face, (*self.squared_ends.values(), *found))

    @property
    def squared_ends(self) -> dict[str, np.ndarray]:
        """Local name -> shape of each quoin; beside an outline as high as its ends are upright."""
        length, height = self.extent
        return self.quoins.boxes(length, self.outline.drawn.eaves if self.outline else height) if self.quoins else {}


def _check_quoins(wall: PatternWall, quoins: DressedEnds) -> None:
    """Raise KeyProblem where quoins leave nothing between them, or openings cross them."""
    length = wall.extent[0]
    if quoins.length > length / 3.0:
        message = f"{quoins.length:g} is not allowed; must be at most {length / 3.0:.4g}, a third of the wall"
        raise KeyProblem(message, "quoins", "length")
    if wall.outline and wall.outline.drawn.eaves == 0.0:
        raise KeyProblem(NOT_UPRIGHT, "quoins")
    count = 2.0 * wall.extent[1] / quoins.height
    if count > MOST_STONES:
        raise KeyProblem(f"makes {count:.3g} stones; at most {MOST_STONES:,}", "quoins", "height")
    if wall.leaves_outline(list(wall.squared_ends.values())):
        raise KeyProblem("would reach out of the outline, or into an opening that is drawn", "quoins", "length")
    for i, opening in enumerate(wall.openings):
        left, _, right, _ = opening.void.reach
        if left < quoins.length * (1.0 - 1e-9) or right > length - quoins.length * (1.0 - 1e-9):
            raise KeyProblem("crosses the quoins", "openings", i)


def masonry(wall: PatternWall, tiling: Tiling) -> list[Block]:
    """Create base, sides, stones, lintels and arches of a wall. Raises ValueError: openings leave nothing."""
    if not tiling.stones:
        raise ValueError("the openings leave nothing of the wall")
    return [*_supports(wall), *_quoins(wall), *blocks_of(tiling, wall.thickness), *_over_openings(wall)]


def _quoins(wall: PatternWall) -> list[Block]:
    if not wall.quoins:
        return []
    shapes = wall.squared_ends.items()
    return [Block(name, (shape,), wall.quoins.material, wall.thickness) for name, shape in shapes]


def _supports(wall: PatternWall) -> list[Block]:
    (length, height), blocks, extension = wall.extent, [], wall.base_extension
    if wall.base:
        shape = rectangle(-extension, -wall.base_depth, length + 2.0 * extension, wall.base_depth)
        blocks.append(base_block("base", shape, wall.thickness, extension))
    foot = -wall.base_depth if wall.base and not extension else 0.0
    return blocks + side_blocks(wall.sides, SupportedWall(length, height, wall.thickness, foot))


def _over_openings(wall: PatternWall) -> list[Block]:
    """Create lintels and voussoirs."""
    blocks = []
    for i, opening in enumerate(wall.all_openings):
        if opening.lintel and opening.lintel_box:
            x0, y0, x1, y1 = opening.lintel_box
            shape = rectangle(x0, y0, x1 - x0, y1 - y0)
            blocks.append(Block(f"lintel-{i + 1}", (shape,), opening.lintel.material, wall.thickness))
        for n, shape in enumerate(opening.void.voussoirs):
            material = opening.arch.material if opening.arch else ""
            blocks.append(Block(f"arch-{i + 1}-{n + 1}", (shape,), material, wall.thickness))
    return blocks


def stone_figures(tiling: Tiling) -> str:
    """Describe number and size of the stones and the share of compounds in words."""
    areas, compounds = tiling.areas(), sum(len(tiling.parts(k)) > 1 for k in range(len(tiling.stones)))
    text = (
        f"{len(areas):,} stones of {spread(areas)} m2 in elevation, shortest edge {tiling.edge_lengths().min():.3g} m"
    )
    return f"{text}; {compounds:,} are compounds of convex parts" if compounds else text


def spread(values: np.ndarray) -> str:
    """Format mean and standard deviation of some values, with the least and the largest."""
    return f"{values.mean():.4g} ± {values.std():.2g} ({values.min():.3g} to {values.max():.3g})"
