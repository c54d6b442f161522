"""Table [analysis] with kind = "safety": how far a structure is from failure under given loads."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, NonNegative
from dem_cli.case.tables.analysis import LiveAnalysis

STRENGTH = "strength"
FACTORS = (0.05, 20.0)  # of strength, that are tried where the case does not say


class SafetyAnalysis(LiveAnalysis):
    """[analysis] with kind = "safety": the factor by which strengths may fall, or the least value of a key.

    Every value that is tried is a run of its own: it comes to rest under the loads, or fails, each with its proof.
    """

    kind: Literal["safety"] = "safety"
    vary: Annotated[str, Field(min_length=1)] = Field(
        default=STRENGTH,
        description="strength: joints with their strength divided by a factor; or the key of any number in the case, "
        "such as structure.0.ring: the last value of it with which the structure stands",
        examples=["structure.0.ring"],
    )
    reduce: tuple[Literal["friction", "cohesion", "tension"], ...] = Field(
        default=("friction", "cohesion", "tension"), min_length=1, description="which strengths the factor divides"
    )
    between: tuple[float, float] | None = Field(
        default=None,
        description="values between which failure is looked for [unit of the key] [-]; "
        "default: 0.05 and 20 for strength; a key needs them",
        examples=[[0.1, 0.3]],
    )
    resolution: float = Field(default=0.002, ge=1e-5, le=0.1, description="width of the bracket over the answer [-]")
    scan: int = Field(
        default=0,
        ge=0,
        le=1000,
        description="first try so many equal parts of between: shows structures that fail, stand and fail again",
    )
    load: NonNegative | None = Field(
        default=None,
        description="multiplier of the live load, which stays [-]; default: 1 for pattern = live, else 0",
        examples=[0.1],
    )
    start: Literal["auto", "gravity", "path", "limit"] = Field(
        default="auto",
        description="how each run comes under its live load; gravity: step by step; path, limit: from a state next to "
        "failure, as in a pushover; auto: by the number of blocks",
    )
    limit: bool = Field(
        default=True, description="limit analysis first: a bound, and where to look; runs decide all the same"
    )
    follow: float = Field(
        default=0.0, ge=0.0, description="follow the collapse until a block moved this far [m]", examples=[0.02]
    )

    @model_validator(mode="after")
    def _range(self) -> SafetyAnalysis:
        if self.between is None:
            if not self.of_strength:
                raise KeyProblem(f"missing; give two values of {self.vary} between which it is looked for", "between")
            return self
        low, high = self.between
        if not low < high:
            raise KeyProblem(f"[{low:g}, {high:g}] is not allowed; the second value is the larger one", "between")
        if self.of_strength and low <= 0.0:
            raise KeyProblem(f"{low:g} is not allowed; a factor of strength is more than 0", "between", 0)
        return self

    @model_validator(mode="after")
    def _reduces_strength(self) -> SafetyAnalysis:
        if "reduce" in self.model_fields_set and not self.of_strength:
            raise KeyProblem(f"not allowed beside vary = '{self.vary}'; it belongs to vary = 'strength'", "reduce")
        return self

    @property
    def of_strength(self) -> bool:
        """Tell whether the analysis varies the strengths instead of a key."""
        return self.vary == STRENGTH

    @property
    def ends(self) -> tuple[float, float]:
        """Least and largest value of the searched range."""
        return self.between or FACTORS

    @property
    def constant_load(self) -> float:
        """Constant multiplier of the live load during the search."""
        if self.load is not None:
            return self.load
        return 1.0 if self.pattern == "live" else 0.0
