"""Table [[initial]]: initial state of blocks that start tilted, displaced or moving."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, Twist, Vector
from dem_cli.case.selection import Selection

TOWARDS_LEFT = (0.0, -1.0, 0.0)  # axis of a tilt towards −x, which is counter-clockwise in the plane of x and z


class InitialState(Selection):
    """[[initial]]: how blocks start, once the structure has come to rest; several are moved as one."""

    needs_blocks: ClassVar[bool] = False

    blocks: Annotated[tuple[str, ...], Field(min_length=1)] | None = Field(
        default=None,
        description="instead of block: several ids, patterns and groups",
        examples=[["column-7", "column-8"]],
    )
    tilt: float = Field(
        default=0.0,
        gt=-1.6,
        lt=1.6,
        description="turn about the corner on which they then stand, counter-clockwise; in 3D about the line along "
        "axis through the corner or edge on which they then stand, right-handed [rad]",
        examples=[0.1],
    )
    axis: tuple[float, float, float] = Field(
        default=TOWARDS_LEFT,
        description="direction of the axis of tilt, not vertical; its length does not matter [-]; default: "
        "[0.0, -1.0, 0.0], which tilts towards −x as in 2D",
        examples=[[1.0, 0.0, 0.0]],
    )
    displacement: Vector = Field(default=(0.0, 0.0), description="how far they are moved [m]", examples=[[0.01, 0.0]])
    velocity: Twist = Field(
        default=(0.0, 0.0, 0.0),
        description="of each centroid [m/s], and of the turn, counter-clockwise; in 3D spins about x, y and z [rad/s]",
        examples=[[0.1, 0.0, 0.0]],
    )

    @model_validator(mode="after")
    def _someone(self) -> InitialState:
        if (self.selected is None) == (self.blocks is None):
            given = "structure" if self.structure else "block"
            found = f"'{given}' and 'blocks' are" if self.blocks else "neither 'block' nor 'blocks' is"
            raise ValueError(f"{found} given; one of them says what moves")
        if not (self.tilt or any(self.displacement) or any(self.velocity)):
            raise ValueError("nothing moves; give tilt, displacement or velocity")
        if not any(self.axis[:2]):
            found = ", ".join(f"{x:g}" for x in self.axis)
            raise KeyProblem(f"[{found}] is not allowed; must not be vertical: nothing tilts about it", "axis")
        if self.axis != TOWARDS_LEFT and not self.tilt:
            raise KeyProblem("not used without tilt", "axis")
        return self

    @property
    def turn(self) -> tuple[float, ...]:
        """Rotation of the initial tilt [rad]: counter-clockwise in the plane, in space axis times angle."""
        if len(self.displacement) == 2:
            return (self.tilt,)
        length = math.hypot(*self.axis)
        return tuple(self.tilt * component / length for component in self.axis)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the blocks that the initial state moves."""
        return self.blocks if self.blocks is not None else (self.selected or "",)
