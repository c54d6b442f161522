"""[[initial]]: the initial state of blocks that start tilted, displaced or moving; 2D."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, Twist, Vector


class InitialState(CaseModel):
    """[[initial]]: how blocks start, once the structure has come to rest."""

    block: str | None = Field(default=None, description="id of a block that can move", examples=["column-1"])
    blocks: Annotated[tuple[str, ...], Field(min_length=1)] | None = Field(
        default=None,
        description="instead of block: ids of several, which are moved as one",
        examples=[["column-7", "column-8"]],
    )
    tilt: float = Field(
        default=0.0,
        gt=-1.6,
        lt=1.6,
        description="turn about the corner on which they then stand, counter-clockwise [rad]",
        examples=[0.1],
    )
    displacement: Vector = Field(default=(0.0, 0.0), description="how far they are moved [m]", examples=[[0.01, 0.0]])
    velocity: Twist = Field(
        default=(0.0, 0.0, 0.0),
        description="of each centroid [m/s], and of the turn, counter-clockwise [rad/s]",
        examples=[[0.1, 0.0, 0.0]],
    )

    @model_validator(mode="after")
    def _someone(self) -> InitialState:
        if (self.block is None) == (self.blocks is None):
            found = "'block' and 'blocks' are" if self.block else "neither 'block' nor 'blocks' is"
            raise ValueError(f"{found} given; one of them says what moves")
        if not (self.tilt or any(self.displacement) or any(self.velocity)):
            raise ValueError("nothing moves; give tilt, displacement or velocity")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Ids of all blocks that it moves."""
        return self.blocks if self.blocks is not None else (self.block or "",)
