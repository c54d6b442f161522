"""Joint stiffness, common to all laws that have an elastic part."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from dem_cli.case.base import CaseModel

Stiffness = Literal["auto"] | Annotated[float, Field(gt=0.0)]


class StiffJoint(CaseModel):
    """Normal and shear stiffness of a joint per unit area."""

    kn: Stiffness = Field(default="auto", description="normal stiffness [Pa/m], or 'auto': stiff enough to drop out")
    ks: Stiffness = Field(default="auto", description="shear stiffness [Pa/m], or 'auto': equal to kn")
