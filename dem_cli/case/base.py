"""The base of every table of a case file: strict about names, frozen after validation."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class CaseModel(BaseModel):
    """A table of the case file. Unknown keys are errors; values are not coerced between types."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
