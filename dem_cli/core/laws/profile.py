"""Table `profile` of a joint: contact surfaces that are not plane (thesis 7.2.3, 7.3.1)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from dem_cli.declarations import KeyProblem, Limits, NonNegative, Parameters, Positive, Share, parameter

MOST_SIDES = 50
SHORTEST = 1e-6  # of the longest side: below it corners are one

Sides = Annotated[int, Limits(ge=2, le=MOST_SIDES)]


class ProfileShape(Parameters):
    """Convex polygon on a flat surface, without its size: each number is a value or a range to draw from."""

    sides: Sides | tuple[Sides, Sides] | None = parameter(
        default=None, description="number of sides, or [lowest, highest]; default: as many as lengths", examples=[3]
    )
    lengths: Annotated[tuple[Positive | tuple[Positive, Positive], ...], Limits(min_length=1)] | None = parameter(
        default=None,
        description="lengths of the sides [m], from left to right or from top to bottom; scaled to the length of "
        "the joint; each a value or [lowest, highest], one for all sides or one per side; default: equal sides",
        examples=[[0.016, 0.008, 0.016]],
    )
    central: Share | tuple[Share, Share] | None = parameter(
        default=None,
        description="instead of lengths: share of the middle side [-]; the others are equal",
        examples=[0.2],
    )
    keep: Literal["aperture", "angle", "lengths"] = parameter(
        default="aperture",
        description="what stays where a joint is not as long as the lengths add up to; lengths: the polygon keeps its "
        "size, its middle in the middle of the joint, its outer sides cut off or longer",
    )
    over: Literal["joint", "face"] = parameter(
        default="joint",
        description="what the polygon spans; joint: each joint has its own; face: the whole edge of the upper block, "
        "of which each joint has a part",
    )
    only: Literal["bed", "head", "all"] = parameter(
        default="all", description="which joints have it; bed: those flatter than 45°; head: steeper ones; all: both"
    )

    def check(self) -> None:
        """Check that sides, lengths and the share of the middle side go together."""
        super().check()
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

    @property
    def number(self) -> tuple[int, int]:
        """Lowest and highest number of sides of a profile."""
        return pair(len(self.lengths or ()) if self.sides is None else self.sides)


class Profile(ProfileShape):
    """[joints.NAME.profile]: contact surfaces that are not plane."""

    aperture: Positive | tuple[NonNegative, Positive] = parameter(
        description="distance from the line through the ends of the polygon to its lowest point [m]", examples=[1e-4]
    )

    def check(self) -> None:
        """Check that the aperture, too, runs from its lowest to its highest value."""
        super().check()
        _in_order(self.aperture, "aperture")

    @property
    def ranges(self) -> dict[str, Any]:
        """Convert to plain numbers, every value a pair (lowest, highest), by the names of contact.layout.Layout."""
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
    """Return (lowest, highest) of a value or a range."""
    return value if isinstance(value, tuple) else (value, value)


def _in_order(value: Any, *keys: str | int) -> None:
    if isinstance(value, tuple) and value[0] > value[1]:
        raise KeyProblem(f"[{value[0]:g}, {value[1]:g}] is not allowed; give [lowest, highest]", *keys)
