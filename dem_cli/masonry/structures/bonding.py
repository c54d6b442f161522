"""Masonry bond of walls in a case file: running, stack, English, Flemish, any offset; leaves and bonders."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative
from dem_cli.masonry.structures.courses import HEADER_BONDS


class BondKeys(CaseModel):
    """Keys of the bond of walls in courses."""

    bond: Literal["running", "stack", "english", "english-garden", "flemish"] | None = Field(
        None,
        description="running: every other course is shifted by half a block; stack: none is; english: courses of "
        "stretchers and of headers (half a block long) in turn; english-garden: three of stretchers, one of headers; "
        "flemish: stretchers and headers in turn in each course; headers go through all leaves; default: running",
        examples=["stack"],
    )
    offset: NonNegative | None = Field(
        None, description="shift of every other course [m], instead of bond; less than the block length", examples=[0.1]
    )
    leaves: int = Field(1, ge=1, le=3, description="walls side by side that the thickness consists of", examples=[2])
    through_stones: float = Field(
        0.0,
        ge=0.0,
        le=1.0,
        description="share of the stones of a face that go through all leaves, evenly spaced [-]",
        examples=[0.2],
    )

    def check_bond(self, length: float) -> None:
        """Raise KeyProblem where keys of the bond contradict each other; length: of the shortest block [m]."""
        if self.offset is not None:
            if self.bond is not None:
                raise KeyProblem("bond and offset say the same; give one of them", "offset")
            if self.offset >= length:
                message = f"{self.offset:g} is not allowed; must be less than the block length, {length:g}"
                raise KeyProblem(message, "offset")
        if self.through_stones and self.leaves == 1:
            raise KeyProblem("not used with leaves = 1: every stone goes through", "through_stones")
        if self.through_stones and self.bond in HEADER_BONDS:
            raise KeyProblem(f"not used with bond = '{self.bond}': its headers go through", "through_stones")
