"""`profile` of a joint: contact surfaces that are not plane (thesis 7.2.3, 7.3.1)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive

MOST_SIDES = 50
SHORTEST = 1e-6  # of the longest side: below it corners are one

Sides = Annotated[int, Field(ge=2, le=MOST_SIDES)]
Share = Annotated[float, Field(gt=0.0, lt=1.0)]


class ProfileShape(CaseModel):
    """A convex polygon on a flat surface, but for its size: each number is a value or a range to draw from."""

    sides: Sides | tuple[Sides, Sides] | None = Field(
        default=None, description="number of sides, or [lowest, highest]; default: as many as lengths", examples=[3]
    )
    lengths: Annotated[tuple[Positive | tuple[Positive, Positive], ...], Field(min_length=1)] | None = Field(
        default=None,
        description="lengths of the sides [m], from left to right or from top to bottom; scaled to the length of "
        "the joint; each a value or [lowest, highest], one for all sides or one per side; default: equal sides",
        examples=[[0.016, 0.008, 0.016]],
    )
    central: Share | tuple[Share, Share] | None = Field(
        default=None,
        description="instead of lengths: share of the middle side [-]; the others are equal",
        examples=[0.2],
    )
    keep: Literal["aperture", "angle", "lengths"] = Field(
        default="aperture",
        description="what stays where a joint is not as long as the lengths add up to; lengths: the polygon keeps its "
        "size, its middle in the middle of the joint, its outer sides cut off or longer",
    )
    over: Literal["joint", "face"] = Field(
        default="joint",
        description="what the polygon spans; joint: each joint has its own; face: the whole edge of the upper block, "
        "of which each joint has a part",
    )
    only: Literal["bed", "head", "all"] = Field(
        default="all", description="which joints have it; bed: those flatter than 45°; head: steeper ones; all: both"
    )

    @model_validator(mode="after")
    def _sides_and_lengths(self) -> ProfileShape:
        given = 0 if self.lengths is None else len(self.lengths)
        if self.lengths is not None and self.central is not None:
            raise ValueError("'lengths' and 'central' are given; a profile has one of them")
        if self.sides is None and given < 2:
            raise ValueError("missing 'sides'")
        for key in ("sides", "central"):
            _in_order(getattr(self, key), key)
        for i, length in enumerate(self.lengths or ()):
            _in_order(length, "lengths", i)
        sides = [pair(length) for length in self.lengths or ()]
        if sides and min(low for low, _ in sides) < SHORTEST * max(high for _, high in sides):
            raise KeyProblem(f"a side is shorter than {SHORTEST:g} of another one", "lengths")
        low, high = self.number
        if given > 1 and (low, high) != (given, given):
            several = f"{low} sides" if low == high else f"{low} to {high} sides"
            raise KeyProblem(f"{given} lengths for {several}; give one per side, or one for all", "lengths")
        if self.central is not None and (low % 2 == 0 or high % 2 == 0):
            found = low if low % 2 == 0 else high
            raise KeyProblem(f"{found} sides have none in the middle; with 'central' the number is odd", "sides")
        if self.keep != "aperture" and self.lengths is None:
            raise KeyProblem(f"'{self.keep}' is not allowed without 'lengths' [m]: no length to keep it from", "keep")
        return self

    @property
    def number(self) -> tuple[int, int]:
        """Lowest and highest number of sides."""
        return pair(len(self.lengths or ()) if self.sides is None else self.sides)


class Profile(ProfileShape):
    """[joints.NAME.profile]: contact surfaces that are not plane."""

    aperture: Positive | tuple[NonNegative, Positive] = Field(
        description="distance from the line through the ends of the polygon to its lowest point [m]", examples=[1e-4]
    )

    @model_validator(mode="after")
    def _apertures(self) -> Profile:
        _in_order(self.aperture, "aperture")
        return self

    @property
    def ranges(self) -> dict[str, Any]:
        """All of it as plain numbers, every value a pair (lowest, highest), by the names of contact.layout.Layout."""
        return {
            "sides": self.number,
            "aperture": pair(self.aperture),
            "lengths": tuple(map(pair, self.lengths or ())),
            "central": None if self.central is None else pair(self.central),
            "keep": self.keep,
            "over": self.over,
            "only": self.only,
        }


def pair(value: Any) -> tuple[Any, Any]:
    """(lowest, highest) of a value or a range."""
    return value if isinstance(value, tuple) else (value, value)


def _in_order(value: Any, *keys: str | int) -> None:
    if isinstance(value, tuple) and value[0] > value[1]:
        raise KeyProblem(f"[{value[0]:g}, {value[1]:g}] is not allowed; give [lowest, highest]", *keys)
