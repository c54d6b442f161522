"""Wall outlines: the elevation of a façade as polylines, given or drawn (DXF, SVG), its openings as inner polylines."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Pair, StructureBase
from dem_cli.case.named_file import absolute_path, is_file, missing_file
from dem_cli.core.geometry import pockets, polygon
from dem_cli.input_limits import MOST_DRAWN
from dem_cli.masonry.imports.contents import UNITS, Contents, FileBody, FileProblem, unit_of
from dem_cli.masonry.imports.formats import FORMATS, format_of, read
from dem_cli.masonry.structures.openings import Lintel, Opening
from dem_cli.masonry.structures.voids import Void, overlap, plain_void

SAME = 1e-6  # of the size of an outline: what drawings round off
DRAWN = [suffix for suffix, each in FORMATS.items() if each.flat]
NOT_UPRIGHT = "an end of the outline is not upright from the foot on: there is no place for quoins"
Chords = Annotated[int, Field(ge=1, le=100)]
Loop = Annotated[tuple[Pair, ...], Field(min_length=3)]
Layers = Annotated[tuple[str, ...], Field(min_length=1)]


class DrawnOpening(NamedTuple):
    """Hole of an outline."""

    said: str  # what it is called in messages
    shape: np.ndarray  # counter-clockwise [m], (n, 2)

    def spanned(self, lintel: Lintel | None) -> Opening | None:
        """Convert the hole to an opening with a lintel; None: it is not an upright rectangle."""
        box = polygon.upright_box(self.shape)
        if box is None:
            return None
        x0, y0, x1, y1 = box
        return Opening.model_construct(x=x0, y=y0, width=x1 - x0, height=y1 - y0, lintel=lintel, arch=None)


class DrawnElevation(NamedTuple):
    """Elevation of a wall as drawn; the lower left corner of its bounding box is the origin.

    outline   corners of the masonry, doors and windows included, counter-clockwise [m], (n, 2)
    openings  in the order of the drawing, then doors around which the outline goes
    notes     how the drawing was read
    """

    outline: np.ndarray
    openings: tuple[DrawnOpening, ...]
    notes: tuple[str, ...] = ()

    @property
    def size(self) -> tuple[float, float]:
        """Length and height of the bounding box [m]."""
        length, height = self.outline.max(axis=0).tolist()
        return (length, height)

    @property
    def eaves(self) -> float:
        """Height up to which both ends are upright, from the foot [m]; 0: one is not."""
        after = np.roll(self.outline, -1, axis=0)
        tops = []
        for x in (0.0, self.size[0]):
            upright = (self.outline[:, 0] == x) & (after[:, 0] == x)
            heights = np.sort(np.stack([self.outline[:, 1], after[:, 1]], axis=1)[upright], axis=1)
            tops.append(max((top for foot, top in heights.tolist() if foot == 0.0), default=0.0))
        return min(tops)

    @property
    def beside_hull(self) -> list[np.ndarray]:
        """Convex pieces of the convex hull without masonry, openings apart."""
        return pockets.hull_pockets(self.outline)

    @property
    def beside_box(self) -> list[np.ndarray]:
        """Convex pieces of the bounding box without masonry, openings apart."""
        return [*self.beside_hull, *pockets.box_pockets(pockets.hull(self.outline))]


class WallOutline(CaseModel):
    """structure.outline: the elevation of a wall, drawn in a file or given as points, that is filled with masonry.

    Its lower left corner is that of the wall. Other closed polylines within it are openings.
    """

    file: Annotated[str, Field(min_length=1)] | None = Field(
        None, description="DXF or SVG, closed outlines; relative paths start at the case file", examples=["facade.dxf"]
    )
    layer: str | None = Field(
        None,
        description="layer (DXF) or group (SVG) of the outline, the largest one on it; others on it are openings; "
        "default: the only one that has outlines",
        examples=["WALL"],
    )
    openings: str | Layers | None = Field(
        None,
        description="layer or group of openings, or a list of them; default: none",
        examples=["OPENINGS", ["DOORS", "WINDOWS"]],
    )
    unit: Literal["m", "dm", "cm", "mm", "in", "ft"] | None = Field(
        None, description="of lengths in the file; default: what the file says (DXF), else m", examples=["mm"]
    )
    chords: Chords | None = Field(
        None, description="straight pieces of each curve of a drawing; default: curves are refused", examples=[4]
    )
    points: Loop | None = Field(
        None,
        description="corners of the outline [m], instead of file",
        examples=[[[0.0, 0.0], [6.0, 0.0], [6.0, 3.0], [3.0, 4.5], [0.0, 3.0]]],
    )
    holes: tuple[Loop, ...] = Field(
        (), description="corners of openings [m], with points", examples=[[[[1.0, 1.0], [2.0, 1.0], [1.5, 2.0]]]]
    )
    lintel: Lintel | None = Field(
        None,
        description="a block over each rectangular opening; default: none",
        examples=[{"height": 0.2, "bearing": 0.2}],
    )

    @field_validator("file")
    @classmethod
    def _absolute(cls, file: str | None, info: ValidationInfo) -> str | None:
        return file if file is None else absolute_path(file, info)

    @model_validator(mode="after")
    def _drawn_in_one_way(self) -> WallOutline:
        if (self.file is None) == (self.points is None):
            found = "found none" if self.file is None else "found both"
            raise KeyProblem(f"an outline has either file or points; {found}", "file")
        of_files, other = ("layer", "openings", "unit", "chords"), ("holes",)
        for key in of_files if self.file is None else other:
            if key in self.model_fields_set:
                raise KeyProblem(f"not used with {'points' if self.file is None else 'file'}", key)
        if self.file is not None:
            _check_file(Path(self.file))
        if self.layer is not None and self.layer in self.opening_layers:
            raise KeyProblem("openings on the layer of the outline need not be named", "openings")
        _check(self)
        return self

    @property
    def opening_layers(self) -> tuple[str, ...]:
        """Layers or groups of openings; none: all are on the layer of the outline."""
        return (self.openings,) if isinstance(self.openings, str) else self.openings or ()

    @cached_property
    def drawn(self) -> DrawnElevation:
        """Read the elevation. Raises KeyProblem."""
        if self.file is None:
            given = [("the outline", self.points or ()), *((f"holes.{i}", hole) for i, hole in enumerate(self.holes))]
            return _elevation([(said, np.array(loop, float)) for said, loop in given], ("points", "holes"))
        try:
            only = [self.layer, *self.opening_layers] if self.layer else []
            contents = read(self.file, self.chords, only)
            wall, inner = _wall_of(self, contents)
            unit = unit_of(contents, self.unit)
            drawn = [(_called(body), body.points * UNITS[unit]) for body in (wall, *inner)]
            found = _elevation(drawn, ("layer", "openings"))
        except FileProblem as error:
            raise KeyProblem(f"{Path(self.file).name}: {error}", "file") from None
        except KeyProblem as problem:
            raise KeyProblem(f"{Path(self.file).name}: {problem}", *problem.keys) from None
        note = f"{_called(wall)}, lengths in {unit}"
        left_out = (f"left out: {', '.join(contents.left_out)}",) if contents.left_out else ()
        return found._replace(notes=(f"{note}; {found.notes[0]}", *left_out))

    @cached_property
    def spanned(self) -> tuple[Opening, ...]:
        """Upright rectangular openings, with a lintel where one is given."""
        return tuple(found for each in self.drawn.openings if (found := each.spanned(self.lintel)))

    @cached_property
    def cut(self) -> tuple[np.ndarray, ...]:
        """Convex pieces of the other openings."""
        other = [each for each in self.drawn.openings if each.spanned(None) is None]
        return tuple(piece for each in other for piece in pockets.convex_pieces(each.shape))

    @property
    def unspanned(self) -> list[str]:
        """Names of openings with neither lintel nor arch."""
        return [each.said for each in self.drawn.openings if self.lintel is None or each.spanned(None) is None]


class Outlined(StructureBase):
    """Keys of walls that fill an outline."""

    outline: WallOutline | None = Field(
        None,
        description="elevation of the wall as it is drawn, instead of its size; default: a rectangle",
        examples=[{"points": [[0.0, 0.0], [6.0, 0.0], [6.0, 3.0], [3.0, 4.5], [0.0, 3.0]]}],
    )

    def with_drawn(self, openings: Sequence[Opening]) -> tuple[Opening, ...]:
        """Return the openings of a case followed by the rectangular ones of the drawing."""
        return (*openings, *self.outline.spanned) if self.outline else tuple(openings)

    def check_outlined(self, openings: Sequence[Opening], instead: Sequence[str]) -> None:
        """Raise KeyProblem: keys that an outline replaces (`instead`), openings that reach out of it."""
        if self.outline is None:
            return
        for key in instead:
            if key in self.model_fields_set:
                raise KeyProblem("not used with outline, which says it", key)
        for i, opening in enumerate(openings):
            if self.leaves_outline(opening.void.solids):
                raise KeyProblem("reaches out of the outline, or into an opening that is drawn", "openings", i)

    def leaves_outline(self, shapes: Sequence[np.ndarray]) -> bool:
        """Test whether convex shapes reach out of the outline, or into an opening of the drawing."""
        if self.outline is None:
            return False
        taken = [*self.outline.drawn.beside_box, *self.outline.cut]
        taken += [shape for opening in self.outline.spanned for shape in opening.void.outlines]
        return overlap(shapes, taken) > SAME * float(np.prod(self.outline.drawn.size))


def hollows(outline: WallOutline | None) -> list[Void]:
    """Return the voids between an outline and its bounding box, in convex pieces, rectangular openings apart."""
    return [plain_void(shape) for shape in (*outline.cut, *outline.drawn.beside_box)] if outline else []


def _check_file(path: Path) -> None:
    """Raise KeyProblem where a path is no drawing."""
    found = format_of(path)
    if found is None or not found.flat:
        message = f"'{path.suffix or path.name}' is not a drawing; the file ends in one of {', '.join(DRAWN)}"
        raise KeyProblem(message, "file")
    if not is_file(path):
        raise KeyProblem(missing_file(path, "a drawing"), "file")


def _wall_of(outline: WallOutline, contents: Contents) -> tuple[FileBody, list[FileBody]]:
    """Find the outline of the wall and those of its openings. Raises KeyProblem."""
    inner = [body for body in contents.bodies if body.layer in outline.opening_layers]
    for layer in outline.opening_layers:
        if all(body.layer != layer for body in inner):
            raise KeyProblem(f"no closed outline on layer '{layer}'; drawn on: {_names(contents)}", "openings")
    own = [body for body in contents.bodies if body.layer not in outline.opening_layers]
    layers = list(dict.fromkeys(body.layer for body in own))
    if outline.layer is None and len(layers) > 1:
        names = ", ".join(f"'{layer}'" for layer in layers)
        raise KeyProblem(f"there are outlines on {names}: which of them is the wall?", "layer")
    if not own:
        raise KeyProblem(f"no closed outline on layer '{outline.layer}'; drawn on: {_names(contents)}", "layer")
    wall = max(own, key=lambda body: polygon.area(body.points) if len(body.points) > 2 else 0.0)
    return wall, [*(body for body in own if body is not wall), *inner]


def _names(contents: Contents) -> str:
    return ", ".join(f"'{layer}'" for layer in contents.layers if layer) or "no layer"


def _called(body: FileBody) -> str:
    on = f" on layer '{body.layer}'" if body.layer else ""
    return f"{body.said or 'an outline'}{on}"


def _elevation(loops: Sequence[tuple[str, np.ndarray]], keys: tuple[str, str]) -> DrawnElevation:
    """Create the elevation from its outline, the first loop, and its openings. Raises KeyProblem with the key."""
    from dem_cli.masonry.imports.solids import closed_outline

    count = sum(len(loop) for _, loop in loops)
    if count > MOST_DRAWN:
        raise KeyProblem(f"{count:,} corners with those of the openings are too many; at most {MOST_DRAWN}", keys[0])
    closed = []
    for k, (said, loop) in enumerate(loops):
        try:
            closed.append((said, closed_outline(loop)))
        except FileProblem as error:
            raise KeyProblem(f"{said}: {error}", keys[min(k, 1)]) from None
    whole = closed[0][1]
    low = whole.min(axis=0)
    levels = [np.unique(whole[:, axis]) for axis in (0, 1)]
    gap = SAME * polygon.size(whole)
    aligned = []
    for said, loop in closed:
        places = [_onto(loop[:, axis], levels[axis], gap) - low[axis] for axis in (0, 1)]
        aligned.append((said, np.stack(places, axis=1)))
    if not aligned[0][1].any(axis=0).all():
        raise KeyProblem(f"{closed[0][0]}: its corners lie on one line but for {gap:.3g} m: it has no area", keys[0])
    outline, doors = _without_doors(aligned[0][1])
    openings = [*(DrawnOpening(*each) for each in aligned[1:]), *doors]
    length, height = outline.max(axis=0)
    squares = sum(each.spanned(None) is not None for each in openings)
    note = f"{len(outline)} corners, {length:.4g} m × {height:.4g} m, {len(openings)} openings"
    note += f", {squares} of them rectangular" if openings else ""
    return DrawnElevation(outline, tuple(openings), (note,))


def _onto(values: np.ndarray, levels: np.ndarray, gap: float) -> np.ndarray:
    """Snap coordinates within `gap` of a level to it, the lowest such one."""
    places = np.minimum(np.searchsorted(levels, values - gap), len(levels) - 1)
    near: np.ndarray = levels[places]
    return np.where(np.abs(near - values) <= gap, near, values)


def _without_doors(outline: np.ndarray) -> tuple[np.ndarray, list[DrawnOpening]]:
    """Straighten the foot of an outline that goes around doors; returns it and the doors."""
    on = np.flatnonzero(outline[:, 1] == 0.0).tolist()
    doors: list[DrawnOpening] = []
    dropped: set[int] = set()
    for i, j in zip(on, [*on[1:], on[0] + len(outline)], strict=True):
        around = np.arange(j, i - 1, -1) % len(outline)
        x1, x0 = outline[around[[0, -1]], 0].tolist()
        if len(around) > 2 and x1 > x0:
            doors.append(DrawnOpening(f"the door at x = {x0:.4g} to {x1:.4g}", outline[around]))
            dropped |= set(around[1:-1].tolist())
    kept = outline[[k for k in range(len(outline)) if k not in dropped]]
    return polygon.simplified(kept), doors


def _check(outline: WallOutline) -> None:
    """Raise KeyProblem where openings reach out of the outline or into each other, or lintels have no room."""
    key = "holes" if outline.file is None else "openings"
    drawn, (length, height) = outline.drawn, outline.drawn.size
    least, gap = SAME * length * height, SAME * polygon.size(drawn.outline)
    outside = drawn.beside_box
    shapes: list[tuple[str, list[np.ndarray]]] = []
    for each in drawn.openings:
        own = pockets.convex_pieces(each.shape)
        beyond = (each.shape < -gap).any() or (each.shape > np.array([length, height]) + gap).any()
        if beyond or overlap(own, outside) > least:
            raise KeyProblem(f"{each.said} reaches out of the outline of the wall; one outline makes one wall", key)
        for other, pieces in shapes:
            if overlap(own, pieces) > least:
                raise KeyProblem(f"{each.said} and {other} lie over each other", key)
        shapes.append((each.said, own))
    for each in drawn.openings:
        opening = each.spanned(outline.lintel)
        if opening is None or opening.lintel_box is None:
            continue
        x0, y0, x1, y1 = opening.lintel_box
        shape = [polygon.rectangle(x0, y0, x1 - x0, y1 - y0)]
        others = [piece for said, pieces in shapes if said != each.said for piece in pieces]
        if x0 < -gap or x1 > length + gap or y1 > height + gap or overlap(shape, [*outside, *others]) > least:
            message = f"the lintel of {each.said} would go from [{x0:.4g}, {y0:.4g}] to [{x1:.4g}, {y1:.4g}], out of "
            raise KeyProblem(f"{message}the wall or into another opening", "lintel")
