"""Generate arch bridges and arcades: spans with shared piers, abutments, spandrel walls in courses, fill."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np
from pydantic import Field, ValidationError, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive, StructureBase, check_count
from dem_cli.core.geometry import polygon
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.bases import base_block
from dem_cli.masonry.structures.masonry import Masonry
from dem_cli.masonry.structures.masonry_blocks import masonry_blocks
from dem_cli.masonry.structures.openings import Opening
from dem_cli.masonry.structures.vaults.barrel import cut_along
from dem_cli.masonry.structures.vaults.profile import heads_along

MATERIAL = "a name in [materials]; default: that of the bridge"


class Support(CaseModel):
    """Piers or abutments of equal blocks, cut to the springings above."""

    width: Positive = Field(description="along the bridge [m]", examples=[1.2])
    courses: int = Field(1, ge=1, le=10_000, description="number of blocks from the ground to the springings")
    material: str = Field("", description=MATERIAL, examples=["granite"])


class Spandrels(CaseModel):
    """Spandrel walls from the piers up to a level deck, in running bond, its courses cut around the arches."""

    block: tuple[Positive, Positive] = Field(description="length and height of a full block [m]", examples=[[0.8, 0.3]])
    cover: NonNegative = Field(0.0, description="from the crown of the highest arch to the deck [m]", examples=[0.3])
    thickness: Positive | None = Field(
        None, description="of a wall at either side [m] (3D); default: one as wide as the bridge", examples=[0.4]
    )
    material: str = Field("", description=MATERIAL, examples=["rubble"])


class BridgeFill(CaseModel):
    """Fill between spandrel walls, as blocks in the same courses."""

    material: str = Field("", description=MATERIAL, examples=["fill"])


class Bridge(StructureBase):
    """Arch bridge or arcade over several spans. Local origin: left end of the first span, on the ground; in 3D in the
    middle of its width.

    Block names: "<id>-arch-<span>-<number>" for voussoirs from left to right, in several rows
    "<id>-arch-<span>-<number>-<row>"; "<id>-pier-<pier>-<course>", "<id>-left-<course>", "<id>-right-<course>" for
    abutments, from below; "<id>-<course>-<number>" for spandrels, with walls of their own "...a" in front, "...b" for
    the fill, "...c" behind; "<id>-base-left", "<id>-base-right", "<id>-base-<pier>".
    """

    kind: Literal["bridge"] = "bridge"
    spans: tuple[Positive, ...] = Field((), description="clear spans from the left [m]", examples=[[4.0, 6.0, 4.0]])
    span: Positive | None = Field(None, description="clear span, the same `count` times [m]", examples=[5.0])
    count: int = Field(1, ge=1, le=1000, description="number of spans, with span")
    rise: Positive | None = Field(None, description="of the inner faces [m]; default: semicircles", examples=[1.5])
    ring: Positive = Field(description="depth of the rings, from inner to outer face [m]", examples=[0.45])
    voussoirs: int = Field(ge=2, le=10_000, description="number of voussoirs of each arch", examples=[21])
    width: Positive = Field(1.0, description="square to the elevation [m]; in 2D of a strip")
    rows: int = Field(1, ge=1, le=10_000, description="stones across the bridge, heads staggered (3D)", examples=[6])
    height: NonNegative = Field(0.0, description="from the ground to the springings [m]", examples=[3.0])
    piers: Support | None = Field(
        None, description="between the spans; none for one span", examples=[{"width": 1.2, "courses": 6}]
    )
    abutments: Support | None = Field(
        None, description="at both ends; default: fixed springings", examples=[{"width": 2.0, "courses": 6}]
    )
    spandrels: Spandrels | None = Field(
        None,
        description="masonry between the arches and the deck; default: none",
        examples=[{"block": [0.8, 0.3], "cover": 0.3}],
    )
    fill: BridgeFill | None = Field(
        None, description="blocks between the spandrel walls (3D); default: none", examples=[{"material": "fill"}]
    )
    base: bool = Field(True, description="fixed blocks below piers and abutments, or behind the end springings")
    base_extension: NonNegative = Field(
        0.0, description="how far those go beyond piers and abutments [m]", examples=[0.5]
    )

    @property
    def on_ground(self) -> bool:
        """Tell whether a [ground] block replaces the bases; without abutments the end springings stay fixed."""
        return self.abutments is not None

    @property
    def all_spans(self) -> tuple[float, ...]:
        """Clear spans from the left [m]."""
        return self.spans or (self.span or 0.0,) * self.count

    @model_validator(mode="after")
    def _consistent(self) -> Bridge:
        if bool(self.spans) == (self.span is not None):
            found = "both" if self.spans else "none"
            raise KeyProblem(f"a bridge needs either spans or span; found {found}", "spans")
        spans = self.all_spans
        check_count(len(spans) * self.voussoirs * self.rows, "voussoirs")
        if self.rise is not None and self.rise > min(spans) / 2.0 * (1.0 + 1e-9):
            message = f"{self.rise:g} is not allowed; must be at most {min(spans) / 2.0:g}, half the least span"
            raise KeyProblem(message, "rise")
        _check_supports(self)
        if len(set(spans)) > 1 and self.rise is not None and not self.spandrels:
            raise KeyProblem(
                "missing: rings of unequal spans meet piers at unequal levels; give spandrels", "spandrels"
            )
        if self.fill and not (self.spandrels and self.spandrels.thickness):
            raise KeyProblem("not used without spandrels.thickness, walls at either side", "fill")
        if self.spandrels and (self.spandrels.thickness or 0.0) > self.width / 2.0:
            message = (
                f"{self.spandrels.thickness:g} is not allowed; must be at most {self.width / 2.0:g}, half the width"
            )
            raise KeyProblem(message, "spandrels", "thickness")
        elevation = _elevation(self)
        if self.spandrels:
            levels = _spandrel_levels(self.spandrels, elevation)
            check_count(levels.courses * float(elevation.faces[-1, 1]) / self.spandrels.block[0], "spandrels", "block")
        return self


def _check_supports(bridge: Bridge) -> None:
    """Raise KeyProblem where piers, abutments and the height contradict each other."""
    several = len(bridge.all_spans) > 1
    if several != (bridge.piers is not None):
        message = "missing: there are several spans" if several else "not used with one span"
        raise KeyProblem(message, "piers")
    if (several or bridge.abutments) and not bridge.height:
        raise KeyProblem("0 is not allowed with piers or abutments; must be greater than 0", "height")
    if bridge.height and not (several or bridge.abutments):
        raise KeyProblem("not used without piers or abutments", "height")


class Elevation(NamedTuple):
    """Elevation of a bridge, x from its left end, y from its springings or the ground, whichever is lower."""

    openings: tuple[Opening, ...]  # the arches
    faces: np.ndarray  # of piers and abutments: left and right face [m], (spans + 1, 2)
    springing: float  # level of the inner feet [m]
    top: float  # of piers and abutments [m]


def _elevation(bridge: Bridge) -> Elevation:
    """Compute the elevation. Raises KeyProblem: voussoirs not convex, supports narrower than the springings."""
    spans, lift = bridge.all_spans, bridge.height or 1.0
    pier, end = bridge.piers.width if bridge.piers else 0.0, _end_width(bridge)
    widths = [end, *[pier] * (len(spans) - 1), end]
    starts = np.cumsum(np.array(widths)) + np.concatenate([[0.0], np.cumsum(spans)])
    faces = np.column_stack([starts - widths, starts])
    try:
        arch = {"rise": bridge.rise, "voussoirs": bridge.voussoirs, "ring": bridge.ring}
        openings = tuple(
            Opening.model_validate({"x": float(x), "y": 0.0, "width": span, "height": lift, "arch": arch})
            for x, span in zip(starts[:-1], spans, strict=True)
        )
    except ValidationError:
        message = f"{bridge.voussoirs} of a ring of {bridge.ring:g} are not convex; use more of them or a thinner ring"
        raise KeyProblem(message, "voussoirs") from None
    top = min(float(opening.void.joints[0, 1, 1]) for opening in openings)
    found = Elevation(openings, faces, lift, top)
    for i in range(len(found.faces)):
        joints = [opening.void.joints[-1] for opening in openings[max(i - 1, 0) : i]]
        joints += [opening.void.joints[0] for opening in openings[i : i + 1]]
        least = sum(_reach(joint, top) for joint in joints)
        key, table = ("piers", bridge.piers) if 0 < i < len(spans) else ("abutments", bridge.abutments)
        if table and table.width < least * (1.0 - 1e-9):
            message = f"{table.width:g} is not allowed; must be at least {least:g}, as the springings"
            raise KeyProblem(message, key, "width")
    return found


def _end_width(bridge: Bridge) -> float:
    """Return the width of an abutment; fixed springings are twice as wide as the ring is deep [m]."""
    return bridge.abutments.width if bridge.abutments else 2.0 * bridge.ring


def _toes(elevation: Elevation) -> list[np.ndarray]:
    """Return the outlines of the tops of piers and abutments above the springing level, (6, 2) each.

    From the right face at the springing, along the joint to the top, over to the other one and down to the left face.
    """
    found, n = [], len(elevation.openings)
    for i, (left, right) in enumerate(elevation.faces.tolist()):
        corners = [[left, elevation.springing], [right, elevation.springing]]
        if i < n:  # what springs to the right
            corners.append(_at_level(elevation.openings[i].void.joints[0], elevation.top))
        else:
            corners.append([right, elevation.top])
        if i:
            corners.append(_at_level(elevation.openings[i - 1].void.joints[-1], elevation.top))
        else:
            corners.append([left, elevation.top])
        found.append(np.array([corners[0], corners[1], corners[2], corners[2], corners[3], corners[0]]))
    return found


def _reach(joint: np.ndarray, level: float) -> float:
    """Return how far a springing joint extends over its support, up to a level; a level joint with all its length
    [m].
    """
    (x0, y0), (x1, y1) = joint.tolist()
    return abs((x1 if y1 <= y0 else _at_level(joint, level)[0]) - x0)


def _at_level(joint: np.ndarray, level: float) -> list[float]:
    """Return the point of a springing joint at a level; its outer end as it is."""
    (x0, y0), (x1, y1) = joint.tolist()
    if y1 - y0 <= 0.0 or level >= y1:
        return [x1, y1] if y1 > y0 else [x0, y0]
    return [x0 + (x1 - x0) * (level - y0) / (y1 - y0), level]


def build(bridge: Bridge) -> list[Block]:
    """Generate the blocks of a bridge: fixed ones, piers and abutments from below, arches, spandrels."""
    elevation = _elevation(bridge)
    shift = np.array([-float(elevation.faces[0, 1]), bridge.height - elevation.springing])
    blocks = [*_supports(bridge, elevation), *_laid(bridge, elevation)]
    return [replace(block, parts=tuple(part + shift for part in block.parts)) for block in blocks]


def _supports(bridge: Bridge, elevation: Elevation) -> Iterator[Block]:
    """Yield fixed blocks, then piers and abutments from below."""
    names = ["left", *(f"{k}" for k in range(1, len(elevation.faces) - 1)), "right"]
    stacks: list[Block] = []
    for name, top, (left, right) in zip(names, _toes(elevation), elevation.faces.tolist(), strict=True):
        table = bridge.abutments if name in ("left", "right") else bridge.piers
        floor = 0.0 if table else elevation.springing
        if table:
            prefix = name if name in ("left", "right") else f"pier-{name}"
            stacks += _stack(prefix, table, top, elevation.springing, bridge.width)
        if bridge.base:
            depth, reach = bridge.ring, bridge.base_extension
            shape = polygon.rectangle(left - reach, floor - depth, right - left + 2.0 * reach, depth)
            if not table:
                shape = _merged([[left, floor - depth], [right, floor - depth], *top[1:]])
            yield base_block(f"base-{name}", shape, bridge.width, reach)
    yield from stacks


def _stack(name: str, table: Support, top: np.ndarray, springing: float, width: float) -> Iterator[Block]:
    """Yield the blocks of a pier from below; the uppermost one is cut to the springings."""
    (left, _), (right, _) = top[0], top[1]
    levels = springing * np.arange(table.courses + 1) / table.courses
    for k, (low, high) in enumerate(zip(levels[:-1].tolist(), levels[1:].tolist(), strict=True), 1):
        corners = [[left, low], [right, low], [right, high], [left, high]]
        if k == table.courses:
            corners = [[left, low], [right, low], *top[1:]]
        yield Block(f"{name}-{k}", (_merged(corners),), table.material, width, course=k)


def _merged(corners: Sequence) -> np.ndarray:
    """Simplify a polygon: no repeated corners and none on an edge."""
    return polygon.simplified(np.array(list(dict.fromkeys(tuple(map(float, corner)) for corner in corners))))


def _laid(bridge: Bridge, elevation: Elevation) -> Iterator[Block]:
    """Yield voussoirs and spandrels around them, drawn together so that their corners coincide."""
    table, length = bridge.spandrels, float(elevation.faces[-1, 1])
    block, levels, spans = (length, 1.0), elevation.top + np.arange(2.0), list[tuple[tuple[float, float]]]()
    if table:
        block, (count, high) = table.block, _spandrel_levels(table, elevation)
        levels, spans = np.linspace(elevation.top, high, count + 1), [((0.0, length),)] * count
    masonry = Masonry(
        length=block[0],
        thickness=bridge.width,
        levels=levels,
        spans=spans,
        openings=elevation.openings,
        fit_rings=False,
    )
    for one in masonry_blocks(masonry):
        yield from _voussoir(bridge, one) if not one.course else _spandrel(bridge, one)


class SpandrelLevels(NamedTuple):
    """Number of courses of spandrels, and the level of the deck [m]."""

    courses: int
    deck: float


def _spandrel_levels(table: Spandrels, elevation: Elevation) -> SpandrelLevels:
    deck = max(opening.void.reach[3] for opening in elevation.openings) + table.cover
    return SpandrelLevels(max(1, round((deck - elevation.top) / table.block[1])), deck)


def _voussoir(bridge: Bridge, block: Block) -> list[Block]:
    """Split a voussoir in 3D into a row of stones across the bridge, staggered from voussoir to voussoir."""
    if bridge.rows == 1:
        return [block]
    stone = bridge.width / bridge.rows
    shift = stone / 2.0 if int(block.id.rpartition("-")[2]) % 2 == 0 else 0.0
    return cut_along(block, heads_along(bridge.width, stone, shift) - bridge.width / 2.0)


def _spandrel(bridge: Bridge, block: Block) -> Iterator[Block]:
    """Split a spandrel stone: as wide as the bridge, or one in each wall, with fill between."""
    table = bridge.spandrels
    assert table is not None
    lift = bridge.piers.courses if bridge.piers else (bridge.abutments.courses if bridge.abutments else 0)
    block = replace(block, material=table.material, course=block.course + lift)
    if table.thickness is None:
        yield block
        return
    half, inner = bridge.width / 2.0, bridge.width / 2.0 - table.thickness
    yield replace(block, id=f"{block.id}a", across=(-half, -inner))
    if bridge.fill:
        yield replace(block, id=f"{block.id}b", material=bridge.fill.material, across=(-inner, inner))
    yield replace(block, id=f"{block.id}c", across=(inner, half))
