"""Table [[imperfection]]: geometric imperfections of blocks, their deviations from the drawn shape and place."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Pair, Positive
from dem_cli.case.selection import Selection
from dem_cli.case.wording import show
from dem_cli.core.arithmetic.chance import chance

ERRORS = ("height", "length", "wedge", "shift", "lean")  # the keys that change something


class NormalDistribution(CaseModel):
    """{ mean = 0.0, deviation = 0.001 }: drawn from the normal distribution."""

    mean: float = Field(default=0.0, description="mean of what is drawn [unit of the key]")
    deviation: Positive = Field(description="standard deviation of what is drawn [unit of the key]", examples=[0.001])


Error = float | Pair | NormalDistribution  # for all the same | [least, most], drawn uniformly | drawn normally


class Imperfection(Selection):
    """[[imperfection]]: errors of one block, of the free blocks of a structure or group, or of all free blocks.

    Errors are in the axes of the structure before it is turned. A number is the same for every block; [least, most]
    is drawn uniformly and { mean, deviation } normally, for each block from `seed`, the number of the table and
    the name of the block, so that it does not depend on what other blocks there are. Errors of several tables add
    up; the blocks are laid again with all errors of tables with `restack`, those of the others come on top. In 3D
    errors are those of structures alone, in the plane in which they are drawn: x along them, y upwards.
    """

    needs_blocks: ClassVar[bool] = False

    block: str | None = Field(
        default=None,
        description="id of a block, a pattern of ids with * and ?, or a name in [groups]; default: all free blocks",
        examples=["wall-4-2"],
    )
    structure: str | None = Field(default=None, description="id of a structure: its free blocks", examples=["wall"])
    height: Error = Field(default=0.0, description="added to the height, at the top [m]", examples=[[-0.0005, 0.0005]])
    length: Error = Field(
        default=0.0,
        description="added to the length, half of it at each end [m]",
        examples=[{"mean": 0.0, "deviation": 0.0001}],
    )
    wedge: Error = Field(
        default=0.0,
        description="added to the height at the right end, less towards the left, where it is 0 [m]",
        examples=[-0.0003],
    )
    shift: tuple[Error, Error] = Field(default=(0.0, 0.0), description="moved by [x, y] [m]", examples=[[0.002, 0.0]])
    lean: Error = Field(
        default=0.0,
        description="out of plumb: shift to the right per height above the foot [-], course by course; drawn per "
        "structure",
        examples=[0.01],
    )
    restack: bool = Field(
        default=True,
        description="lay the blocks again: pushed to the right off their neighbours, then set down from the lowest up",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Imperfection:
        if not self.model_fields_set.intersection(ERRORS):
            raise ValueError("no error is given: height, length, wedge, shift or lean")
        for key in ("height", "length", "wedge", "lean"):
            _check_range(getattr(self, key), key)
        for axis, error in enumerate(self.shift):
            _check_range(error, "shift", axis)
        for key in ("block", "course"):
            if getattr(self, key) is not None and self.lean != 0.0:
                raise KeyProblem(f"not allowed beside '{key}': a structure leans, a block is shifted", "lean")
        if self.restack and self.shift[1] != 0.0:
            message = f"{show(self.shift[1])} is not allowed beside restack = true, which sets the blocks down again"
            raise KeyProblem(message, "shift", 1)
        return self


def drawn(error: Error, seed: int, table: int, key: str, name: str) -> float:
    """Draw the error of a block or structure from its seed, table, key and name alone, or return the given number."""
    if isinstance(error, float):
        return error
    share = chance(seed, table, key, name)
    if isinstance(error, tuple):
        return error[0] + share * (error[1] - error[0])
    from statistics import NormalDist

    return NormalDist(error.mean, error.deviation).inv_cdf(share)


def _check_range(error: Any, *keys: str | int) -> None:
    """Raise KeyProblem where the upper end of a range lies below the lower one."""
    if isinstance(error, tuple) and error[0] > error[1]:
        raise KeyProblem(f"{show(error)} is not allowed; a range is [least, most]", *keys)
