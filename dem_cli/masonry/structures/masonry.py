"""Masonry of one straight wall: courses around openings, below its top, in leaves, and its blocks.

Drawn in the elevation of the wall, x along it, y up. Each course may begin and end where it likes and be interrupted,
so that walls that meet pass through each other in alternate courses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from dem_cli.case.base import CaseModel, Positive
from dem_cli.masonry.structures import courses, tops
from dem_cli.masonry.structures.course_layout import CoursePlan
from dem_cli.masonry.structures.courses import Span
from dem_cli.masonry.structures.leaves import depths_of
from dem_cli.masonry.structures.openings import Opening
from dem_cli.masonry.structures.voids import Void

CORE_LEAF = "b"
SMALL = 1e-6  # of a block's smaller side: what is narrower is not made


class Core(CaseModel):
    """Core of rubble between the two faces of a wall."""

    thickness: Positive = Field(description="across the wall; the faces share the rest [m]", examples=[0.3])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["rubble"])
    size: Positive | None = Field(
        None, description="mean length of its stones [m]; default: half of a block", examples=[0.2]
    )


class Quoins(CaseModel):
    """Quoins: larger stones at both ends of a wall, through its whole thickness, alternately long and short."""

    length: Positive = Field(description="length of the long ones [m]; the short ones are half of it", examples=[0.6])
    height: int = Field(1, ge=1, le=100, description="courses that one of them is high", examples=[2])
    material: str = Field("", description="a name in [materials]; default: that of the wall", examples=["ashlar"])


@dataclass(frozen=True)
class Masonry:
    """Masonry of a wall in elevation: courses, bond, leaves, openings and top."""

    length: float  # of a full block [m]
    thickness: float  # of the wall [m]; half of it lies to either side
    levels: np.ndarray  # bed joints from the foot to the top [m], (n + 1,)
    spans: Sequence[Sequence[Span]]  # of each course from below, from where to where it goes [m]; several: with gaps
    bond: str = "running"
    offset: float | None = None  # shift of every other course [m]; None: that of the bond
    first: str = "half"  # the lowest course: "full" as the bond begins, "half" as its second course
    lengths: Sequence[float] = ()  # of a full block, of each course where they differ [m]
    anchor: float = 0.0  # where the bond begins [m]
    leaves: int = 1
    through_stones: float = 0.0
    core: Core | None = None
    quoins: Quoins | None = None
    quoin_courses: int = 0  # the lowest ones have quoins; gables do without
    openings: Sequence[Opening] = ()
    hollows: Sequence[Void] = ()  # beside an outline that is drawn, and openings in it that are not rectangles
    fit_rings: bool = True  # whether outer corners of arches are drawn to bed joints close by
    top: tops.Profile | None = None

    def pattern(self, k: int) -> courses.Pattern:
        """Return the bond pattern of course k, from 0."""
        course = k + (0 if self.first == "full" else 1)
        return courses.pattern_of(self.bond, self.offset, course, self.block_length(k))

    def block_length(self, k: int) -> float:
        """Return the length of a full block in course k [m]."""
        return self.lengths[k] if self.lengths else self.length

    def levels_of(self, k: int) -> Span:
        """Return the lower and upper bed joint of course k [m]."""
        low, high = self.levels[k : k + 2].tolist()
        return (low, high)

    @property
    def whole(self) -> Span:
        """Interval of the whole thickness [m]."""
        return (-self.thickness / 2.0, self.thickness / 2.0)

    @property
    def depths(self) -> list[Span]:
        """Interval of each leaf across the wall [m]."""
        if self.core is None:
            return depths_of(self.whole, self.leaves)
        half = self.thickness / 2.0
        at = [-half, -self.core.thickness / 2.0, self.core.thickness / 2.0, half]
        return list(zip(at[:-1], at[1:], strict=True))

    def plan(self, k: int, taken: Sequence[Span], voids: Sequence[Void], below: Sequence[float]) -> CoursePlan:
        """Plan course k with quoins and openings in its way, above these head joints."""
        low, high = self.levels_of(k)
        stops = [x for void in voids for x in void.stops(low, high, self.small)]
        stops += [] if self.top is None else tops.stops(self.top, low, high)
        length, pattern = self.block_length(k), self.pattern(k)
        return CoursePlan(low, high, self.spans[k], taken, length, pattern, self.anchor, stops, below)

    def full(self, k: int) -> float:
        """Return the area of a full block of course k [m2]."""
        low, high = self.levels_of(k)
        return self.block_length(k) * (high - low)

    @property
    def small(self) -> float:
        """Least width of a piece; narrower ones are not made [m]."""
        return SMALL * min(self.length, float(np.diff(self.levels).min()))
