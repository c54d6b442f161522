"""Openings in masonry: doors and windows, lintels, arches of voussoirs over them; what is cut out of the courses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive
from dem_cli.geometry import cuts, polygon
from dem_cli.structures.arch import SHAPE_JOINTS, Arch

Box = tuple[float, float, float, float]  # left, bottom, right, top [m]
NARROWEST_PIECE = 1e-6  # parts of a block below this fraction of its length or height are not made


class Lintel(CaseModel):
    """One block over an opening, in place of whatever it crosses."""

    height: Positive = Field(description="height [m]", examples=[0.2])
    bearing: NonNegative = Field(description="length that rests on the wall at each side [m]", examples=[0.15])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["wood"])


class OpeningArch(CaseModel):
    """An arch over an opening, as wide as it; courses are cut around its outer face."""

    shape: Literal["segmental", "semicircular", "pointed", "flat", "circle"] | None = Field(
        None,
        description="of the inner face; circle: all around a round opening; default: semicircular, with rise segmental",
        examples=["pointed"],
    )
    rise: Positive | None = Field(
        None, description="rise of the inner face above the opening [m] (segmental, pointed)", examples=[0.3]
    )
    skew_deg: float | None = Field(
        None, ge=0.0, lt=80.0, description="outermost joints against the vertical [deg] (flat); default: 20"
    )
    voussoirs: int = Field(ge=1, le=1000, description="number of voussoirs; even for a pointed arch", examples=[9])
    ring: Positive = Field(description="depth of the ring, from inner to outer face [m]", examples=[0.3])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["brick"])

    @property
    def form(self) -> str:
        """Its shape, given or by default."""
        return self.shape or ("segmental" if self.rise is not None else "semicircular")

    @model_validator(mode="after")
    def _consistent(self) -> OpeningArch:
        for key, forms in (("rise", ("segmental", "pointed")), ("skew_deg", ("flat",))):
            if getattr(self, key) is not None and self.form not in forms:
                raise KeyProblem(f"not used by a {self.form} arch", key)
        if self.form == "circle" and self.voussoirs < 3:
            raise KeyProblem(f"{self.voussoirs} is not allowed; a ring has at least 3", "voussoirs")
        return self

    def joints(self, span: float) -> np.ndarray:
        """Its joints [inner, outer] from left to right, about mid-span and the springing, (voussoirs + 1, 2, 2).

        A circle: clockwise from below, about its centre, the first as the last.
        """
        if self.form == "circle":
            angles = 2.0 * np.pi * np.arange(self.voussoirs + 1) / self.voussoirs + np.pi / self.voussoirs
            angles[-1] = angles[0]
            ways = np.stack([-np.sin(angles), -np.cos(angles)], axis=1)
            return ways[:, None, :] * np.array([span / 2.0, span / 2.0 + self.ring])[None, :, None]
        half_round = self.form == "semicircular"
        shape, rise = ("segmental", span / 2.0) if half_round else (self.form, self.rise)
        arch = Arch.model_construct(
            shape=shape, span=span, rise=rise, skew_deg=self.skew_deg, voussoirs=self.voussoirs, ring=self.ring
        )
        return SHAPE_JOINTS[shape](arch)


class Opening(CaseModel):
    """A rectangular hole; blocks that it cuts keep what is left of them as rectangles."""

    x: NonNegative = Field(description="left edge, from the left end of the wall [m]", examples=[0.8])
    y: NonNegative = Field(description="lower edge, from the foot of the wall [m]", examples=[0.0])
    width: Positive = Field(description="width [m]", examples=[0.9])
    height: Positive = Field(description="height, below an arch that of its jambs [m]", examples=[2.0])
    lintel: Lintel | None = Field(
        None, description="a block over the opening; default: none", examples=[{"height": 0.2, "bearing": 0.15}]
    )
    arch: OpeningArch | None = Field(
        None, description="an arch over the opening; default: none", examples=[{"voussoirs": 9, "ring": 0.3}]
    )

    @model_validator(mode="after")
    def _consistent(self) -> Opening:
        if self.arch is None:
            return self
        if self.lintel is not None:
            raise KeyProblem("an opening has a lintel or an arch, not both", "arch")
        if self.arch.form == "circle" and abs(self.height - self.width) > NARROWEST_PIECE * self.width:
            message = f"{self.height:g} is not allowed; a circle is as high as it is wide, {self.width:g}"
            raise KeyProblem(message, "height")
        try:
            shapes = self.voussoirs
        except KeyProblem as problem:
            raise KeyProblem(str(problem), "arch", *problem.keys) from None
        if not all(polygon.is_convex(shape) for shape in shapes):
            raise KeyProblem("voussoirs are not convex; use more of them or a thinner ring", "arch", "voussoirs")
        return self

    @property
    def box(self) -> Box:
        """Its rectangle."""
        return (self.x, self.y, self.x + self.width, self.y + self.height)

    @property
    def lintel_box(self) -> Box | None:
        """The rectangle of its lintel."""
        if self.lintel is None:
            return None
        low, bearing = self.y + self.height, self.lintel.bearing
        return (self.x - bearing, low, self.x + self.width + bearing, low + self.lintel.height)

    @property
    def arch_joints(self) -> np.ndarray:
        """Joints of its arch in the place of the wall, (n + 1, 2, 2); of none: (0, 2, 2)."""
        if self.arch is None:
            return np.empty((0, 2, 2))
        up = self.height / 2.0 if self.arch.form == "circle" else self.height
        joints = self.arch.joints(self.width) + np.array([self.x + self.width / 2.0, self.y + up])
        if self.arch.form != "circle":
            joints[[0, -1], 0] = [[self.x, self.y + up], [self.x + self.width, self.y + up]]  # on the jambs, exactly
        return joints

    @property
    def voussoirs(self) -> list[np.ndarray]:
        """Shapes of the voussoirs from left to right, of a circle clockwise from below."""
        joints = self.arch_joints
        found = [np.array([a[0], b[0], b[1], a[1]]) for a, b in zip(joints[:-1], joints[1:], strict=True)]
        return [polygon.simplified(shape) for shape in found]

    @property
    def reach(self) -> Box:
        """The box around all that is not laid in courses."""
        boxes = [*self.arch_joints.reshape(-1, 2), self.box[:2], self.box[2:]]
        if self.lintel_box:
            boxes += [self.lintel_box[:2], self.lintel_box[2:]]
        corners = np.array(boxes)
        (x0, y0), (x1, y1) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        return (x0, y0, x1, y1)

    @property
    def solids(self) -> list[np.ndarray]:
        """Convex shapes of the hole, its lintel and its voussoirs."""
        boxes = [box for box in (self.box, self.lintel_box) if box]
        return [polygon.rectangle(x0, y0, x1 - x0, y1 - y0) for x0, y0, x1, y1 in boxes] + self.voussoirs

    @property
    def holes(self) -> list[Hole]:
        """What is cut out of the courses."""
        found: list[Hole] = []
        round_one = self.arch is not None and self.arch.form == "circle"
        if not round_one:
            found.append(BoxHole(self.box))
        if self.lintel_box:
            found.append(BoxHole(self.lintel_box))
        if self.arch is not None:
            found.append(ArchHole(self.arch_joints, round_one))
        return found


class BoxHole(NamedTuple):
    """A rectangle that is cut out."""

    box: Box

    def left_of(self, shape: np.ndarray, gap: float) -> list[np.ndarray]:
        """Convex pieces that are left of a convex polygon."""
        return cuts.less_box(shape, self.box, gap)


class ArchHole(NamedTuple):
    """What lies within the outer face of an arch, above its springing; or within a ring."""

    joints: np.ndarray  # [inner, outer] from left to right, (n + 1, 2, 2) [m]
    full: bool  # a ring

    @property
    def box(self) -> Box:
        """The box around it."""
        (x0, y0), (x1, y1) = self.joints.reshape(-1, 2).min(axis=0), self.joints.reshape(-1, 2).max(axis=0)
        return (float(x0), float(y0), float(x1), float(y1))

    def left_of(self, shape: np.ndarray, gap: float) -> list[np.ndarray]:
        """Convex pieces that are left of a convex polygon: divided by the joints of the arch, drawn on outwards."""
        if not self._within(shape, gap):
            return [shape]
        joints, found, rest = self.joints, [], shape
        if not self.full:
            rest, below = cuts.halves(rest, joints[0, 0], joints[-1, 0], gap)
            left = cuts.halves(rest, joints[0, 0], joints[0, 1], gap)[0]
            right = cuts.halves(rest, joints[-1, 0], joints[-1, 1], gap)[1]
            found += [below, left, right]
        for a, b in zip(joints[:-1], joints[1:], strict=True):
            wedge = cuts.halves(cuts.halves(rest, a[0], a[1], gap)[1], b[0], b[1], gap)[0]
            found.append(cuts.halves(wedge, a[1], b[1], gap)[0])
        return [piece for piece in found if len(piece)]

    def _within(self, shape: np.ndarray, gap: float) -> bool:
        """Whether something of a polygon lies within."""
        rest = shape
        edges = list(zip(self.joints[1:, 1], self.joints[:-1, 1], strict=True))
        if not self.full:
            edges += [(self.joints[0, 1], self.joints[0, 0]), (self.joints[0, 0], self.joints[-1, 0])]
            edges.append((self.joints[-1, 0], self.joints[-1, 1]))
        for start, end in edges:
            rest = cuts.halves(rest, start, end, gap)[0]
        return len(rest) > 0


Hole = BoxHole | ArchHole


def check_opening(opening: Opening, i: int, length: float, height: float) -> None:
    """Raises KeyProblem where the opening, its lintel or its arch does not lie within the wall."""
    slack = 1.0 + NARROWEST_PIECE
    limits = [
        ("width", opening.x + opening.width, length, "x + width", "length"),
        ("height", opening.y + opening.height, height, "y + height", "height"),
    ]
    for key, value, limit, what, name in limits:
        if value > limit * slack:
            message = f"{what} = {value:g} is not allowed; must be at most the {name} of the wall, {limit:g}"
            raise KeyProblem(message, "openings", i, key)
    if opening.arch is not None:
        _check_arch(opening, i, length, height)
    if opening.lintel is None:
        return
    bearing, top = opening.lintel.bearing, opening.y + opening.height + opening.lintel.height
    room = min(opening.x, length - opening.x - opening.width)
    if bearing > room + NARROWEST_PIECE * length:
        message = f"{bearing:g} is not allowed; must be at most {room:g}, what is left beside the opening"
        raise KeyProblem(message, "openings", i, "lintel", "bearing")
    if top > height * slack:
        message = f"the lintel would reach up to {top:g}; the wall is {height:g} high"
        raise KeyProblem(message, "openings", i, "lintel", "height")


def _check_arch(opening: Opening, i: int, length: float, height: float) -> None:
    x0, y0, x1, y1 = opening.reach
    gap = NARROWEST_PIECE * max(length, height)
    if min(x0, y0) < -gap or x1 > length + gap or y1 > height + gap:
        message = f"the arch would reach from [{x0:g}, {y0:g}] to [{x1:g}, {y1:g}]; the wall is {length:g} long and "
        raise KeyProblem(f"{message}{height:g} high", "openings", i, "arch")


def check_apart(openings: Sequence[Opening]) -> None:
    """Raises KeyProblem where an arch crosses another opening, its lintel or its arch."""
    for i, opening in enumerate(openings):
        for j, other in enumerate(openings[:i]):
            if opening.arch is None and other.arch is None:
                continue
            a, b = opening.solids, other.solids
            gap = NARROWEST_PIECE * min(opening.width, other.width)
            if any(_overlap(p, q) > gap * gap for p in a for q in b):
                message = f"crosses openings[{j + 1}]: arches, lintels and openings lie beside each other"
                raise KeyProblem(message, "openings", i, "arch" if opening.arch else "x")


def _overlap(a: np.ndarray, b: np.ndarray) -> float:
    from dem_cli.geometry.compounds import clipped

    common = clipped(a, b if polygon.signed_area(b) > 0.0 else b[::-1])
    return polygon.area(common) if len(common) > 2 else 0.0
