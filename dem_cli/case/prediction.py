"""Tables [[alternative]] and [[prediction]]: other values of inputs, and what was predicted before a measurement."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Pair

Word = Annotated[str, Field(min_length=1)]


class Alternative(CaseModel):
    """[[alternative]]: other values of keys with which a blind case is predicted as well; other commands ignore it."""

    of: Literal["input", "numerical"] = Field(
        default="input",
        description="what the difference that it makes belongs to: input: the source gives a range or is silent; "
        "numerical: contact points, steps, stiffness of the solver's choice",
    )
    why: Word = Field(
        description="what is not known, and where the values come from",
        examples=["friction is not given; sawn granite has 0.5 to 0.8"],
    )
    set: dict[str, Any] = Field(
        min_length=1,
        description="keys of the case and their values, as `--set` takes them",
        examples=[{"joints.dry.friction": 0.5}],
    )


class Prediction(CaseModel):
    """[[prediction]]: an answer before its measurement, of each blind reference; `dem verify --predict` writes it."""

    quantity: Word = Field(description="path of the number in summary.json", examples=["failure_load"])
    value: float = Field(description="what the case gives as it stands [unit of the quantity]", examples=[0.58])
    numerical: Pair = Field(
        description="least and largest one of its bracket and of the numerical alternatives [unit of the quantity]",
        examples=[[0.5799, 0.5801]],
    )
    inputs: Pair = Field(
        description="least and largest one of the alternatives of inputs [unit of the quantity]", examples=[[0.5, 0.66]]
    )
    band: Pair = Field(
        description="least and largest measured value that is expected: both differences added to the value, then "
        "the model's error on top [unit of the quantity]",
        examples=[[0.47, 0.68]],
    )
    date: Annotated[str, Field(pattern=r"^\d{4}-\d\d-\d\d$")] = Field(
        description="day on which it was written (UTC)", examples=["2026-11-29"]
    )
    version: Word = Field(description="version of dem that gave it", examples=["0.21.0"])
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] = Field(
        description="of the case without comments, predictions and measured values; a case whose keys changed is "
        "refused"
    )

    @model_validator(mode="after")
    def _in_order(self) -> Prediction:
        for key in ("numerical", "inputs", "band"):
            low, high = getattr(self, key)
            if low > high:
                raise KeyProblem(f"[{low:g}, {high:g}] is not allowed; must be [lowest, highest]", key)
        return self
