"""Openings in masonry: doors and windows with lintels or arches, cut out of the courses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive
from dem_cli.core.geometry import polygon
from dem_cli.masonry.structures.arch import SHAPE_JOINTS, Arch
from dem_cli.masonry.structures.voids import Box, Void, overlap

NARROWEST_PIECE = 1e-6  # parts of a block below this fraction of its length or height are not made


class Lintel(CaseModel):
    """Lintel over an opening: a single block, which replaces the stones that it crosses."""

    height: Positive = Field(description="height [m]", examples=[0.2])
    bearing: NonNegative = Field(description="length that rests on the wall at each side [m]", examples=[0.15])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["wood"])


class OpeningArch(CaseModel):
    """Arch over an opening, of its width; courses are cut around its outer face."""

    shape: Literal["segmental", "semicircular", "pointed", "flat", "circle"] | None = Field(
        None,
        description="of the inner face; circle: all around a round opening; default: semicircular, with rise segmental",
        examples=["pointed"],
    )
    rise: Positive | None = Field(
        None, description="rise of the inner face above the opening [m] (segmental, pointed)", examples=[0.3]
    )
    skew_deg: float | None = Field(
        None,
        ge=0.0,
        lt=80.0,
        description="outermost joints against the vertical [deg] (flat); default: 20",
        examples=[20.0],
    )
    voussoirs: int = Field(ge=1, le=1000, description="number of voussoirs; even for a pointed arch", examples=[9])
    ring: Positive = Field(description="depth of the ring, from inner to outer face [m]", examples=[0.3])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["brick"])

    @property
    def form(self) -> str:
        """Shape of the arch, given or by default."""
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
        """Compute the joints [inner, outer] of the arch, about mid-span and the springing, (voussoirs + 1, 2, 2).

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


def _height_optional(schema: dict[str, Any]) -> None:
    """Mark `height` as optional in the JSON Schema, since a circle needs none."""
    schema["required"] = [key for key in schema["required"] if key != "height"]


class Opening(CaseModel):
    """Rectangular opening; the rest of each block that it cuts stays as rectangles."""

    model_config = ConfigDict(json_schema_extra=_height_optional)

    x: NonNegative = Field(description="left edge, from the left end of the wall [m]", examples=[0.8])
    y: NonNegative = Field(description="lower edge, from the foot of the wall [m]", examples=[0.0])
    width: Positive = Field(description="width [m]", examples=[0.9])
    height: Positive = Field(
        description="height, below an arch that of its jambs [m]; left out where the arch is a circle: the width",
        examples=[2.0],
    )
    lintel: Lintel | None = Field(
        None, description="a block over the opening; default: none", examples=[{"height": 0.2, "bearing": 0.15}]
    )
    arch: OpeningArch | None = Field(
        None, description="an arch over the opening; default: none", examples=[{"voussoirs": 9, "ring": 0.3}]
    )

    @model_validator(mode="before")
    @classmethod
    def _as_high_as_wide(cls, data: Any) -> Any:
        """Set the height of a circular opening to its width, and validate only the given one."""
        arch = data.get("arch") if isinstance(data, dict) else None
        if not isinstance(arch, dict) or arch.get("shape") != "circle":
            return data
        width = data.get("width")
        return {"height": width if isinstance(width, int | float) and width > 0.0 else 1.0} | data

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
            shapes = self.void.voussoirs
        except KeyProblem as problem:
            raise KeyProblem(str(problem), "arch", *problem.keys) from None
        if any(len(shape) < 3 for shape in shapes):  # all digits go into how far away they are
            message = f"{self.arch.ring:g} is not allowed; too thin to be told apart at y = {self.y + self.height:g}"
            raise KeyProblem(message, "arch", "ring")
        if not all(polygon.is_convex(shape) for shape in shapes):
            raise KeyProblem("voussoirs are not convex; use more of them or a thinner ring", "arch", "voussoirs")
        return self

    @property
    def box(self) -> Box:
        """Rectangle of the opening."""
        return (self.x, self.y, self.x + self.width, self.y + self.height)

    @property
    def lintel_box(self) -> Box | None:
        """Rectangle of the lintel; None: there is none."""
        if self.lintel is None:
            return None
        low, bearing = self.y + self.height, self.lintel.bearing
        return (self.x - bearing, low, self.x + self.width + bearing, low + self.lintel.height)

    @property
    def void(self) -> Void:
        """Void that the opening cuts out of the courses of its wall."""
        boxes = tuple(box for box in (self.box, self.lintel_box) if box)
        if self.arch is None:
            return Void(boxes, np.empty((0, 2, 2)))
        middle = self.x + self.width / 2.0
        if self.arch.form == "circle":
            return Void((), self.arch.joints(self.width) + np.array([middle, self.y + self.width / 2.0]), True)
        joints = self.arch.joints(self.width) + np.array([middle, self.y + self.height])
        joints[[0, -1], 0] = [[self.x, self.box[3]], [self.box[2], self.box[3]]]  # on the jambs, exactly
        return Void(boxes, joints)


def check_opening(opening: Opening, i: int, length: float, height: float) -> None:
    """Raise KeyProblem where the opening, its lintel or its arch does not lie within the wall."""
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
    x0, y0, x1, y1 = opening.void.reach
    gap = NARROWEST_PIECE * max(length, height)
    if min(x0, y0) < -gap or x1 > length + gap or y1 > height + gap:
        message = f"the arch would reach from [{x0:g}, {y0:g}] to [{x1:g}, {y1:g}]; the wall is {length:g} long and "
        raise KeyProblem(f"{message}{height:g} high", "openings", i, "arch")


def check_apart(openings: Sequence[Opening]) -> None:
    """Raise KeyProblem where an arch crosses another opening, its lintel or its arch."""
    for i, opening in enumerate(openings):
        for j, other in enumerate(openings[:i]):
            if opening.arch is None and other.arch is None:
                continue
            gap = NARROWEST_PIECE * min(opening.width, other.width)
            if overlap(opening.void.solids, other.void.solids) > gap * gap:
                message = f"crosses openings.{j}: arches, lintels and openings lie beside each other"
                raise KeyProblem(message, "openings", i, "arch" if opening.arch else "x")
