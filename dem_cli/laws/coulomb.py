"""Coulomb joint without tension and cohesion (thesis 4.3).

    N = kn ⟨−gap⟩,   s = s_old − ks Δu,   |s| ≤ μ N

The shear spring is incremental, so that a joint below its limit truly sticks.
"""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field, model_validator

from dem_cli.kernels.jit import inline
from dem_cli.kernels.vec import axpy, dot, scale
from dem_cli.laws.law import Law
from dem_cli.laws.stiffness import StiffJoint


class CoulombJoint(StiffJoint):
    """[joints.*] with law = "coulomb"."""

    law: Literal["coulomb"] = "coulomb"
    friction: float | None = Field(default=None, ge=0.0, le=1000.0, description="friction coefficient tan(φ) [-]")
    friction_angle_deg: float | None = Field(
        default=None, ge=0.0, lt=90.0, description="friction angle φ [deg], instead of friction"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> CoulombJoint:
        if (self.friction is None) == (self.friction_angle_deg is None):
            given = "both are given" if self.friction is not None else "none is given"
            raise ValueError(f"give either 'friction' or 'friction_angle_deg' ({given})")
        return self

    @property
    def coefficient(self) -> float:
        """Friction coefficient tan(φ) [-]."""
        if self.friction is not None:
            return self.friction
        return math.tan(math.radians(self.friction_angle_deg))


@inline
def coulomb(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Normal force and shear force at a Coulomb contact point."""
    if gap >= 0.0:
        return 0.0, scale(0.0, shear), True
    normal = -kn * gap
    trial = axpy(-ks, slide, shear)
    limit = parameters[joint, 0] * normal
    square = dot(trial, trial)
    if square <= limit * limit:
        return normal, trial, False
    return normal, scale(limit / math.sqrt(square), trial), True


COULOMB = Law(
    name="coulomb",
    parameters=CoulombJoint,
    function=coulomb,
    columns=lambda table, kn: (table.coefficient,),
    shear_limit=lambda parameters, normal, memory, kn: parameters[:, 0] * normal,
    source="Cundall 1971; thesis 4.3",
)
