"""Table [sweep]: the keys of a case and their values in the runs of `dem sweep`."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import ConfigDict, Field

from dem_cli.case.base import CaseModel

Changes = dict[str, Any]  # key of the case, such as "joints.dry.friction" -> its value


class Sweep(CaseModel):
    """[sweep]: every key that is not one of these is a key of the case: "joints.dry.friction" = [0.5, 0.6].

    A list is values to be combined with all others (a grid), {from, to, count} is values at even distances, with
    log = true at even ratios; {uniform = [low, high]}, {loguniform = [low, high]}, {integers = [first, last]},
    {normal = [mean, deviation]} and {lognormal = [median, deviation of the logarithm]} are drawn, all together, as
    a Latin hypercube.
    """

    model_config = ConfigDict(extra="allow")

    zip: bool = Field(
        default=False, description="take the lists value by value, side by side, instead of combining them"
    )
    samples: Annotated[int, Field(ge=1)] | None = Field(
        default=None, description="how many points of the Latin hypercube; needed where keys are drawn", examples=[100]
    )
    run: tuple[Changes, ...] = Field(
        default=(),
        description="[[sweep.run]]: runs given one by one, each with its own keys; `name` is a label",
        examples=[[{"name": "weak", "joints.dry.friction": 0.5}]],
    )
    bundle: dict[str, dict[str, Changes]] = Field(
        default={},
        description="[sweep.bundle.AXIS.NAME]: keys that change together; AXIS is then a key of the sweep with the "
        "values NAME, and is combined over all of them unless a list or a run says otherwise",
        examples=[{"wall": {"low": {"structure.0.courses": 6}, "high": {"structure.0.courses": 10}}}],
    )
