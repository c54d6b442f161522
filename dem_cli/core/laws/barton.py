"""Barton's friction, which falls with the normal stress (thesis eq. 5-2 and 5-5).

    |s| ≤ N tan φ,   φ = JRC log10(JCS / σn) + φr,   φr ≤ φ ≤ φ_max

σn = N / A is the stress of the point. The angle grows without end as the stress goes to zero: it is cut off, as is
usual in rock mechanics, at 70° unless the table says otherwise.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, norm, scale
from dem_cli.core.laws.law import Law
from dem_cli.core.laws.stiffness import StiffJoint
from dem_cli.declarations import KeyProblem, Positive, parameter


class BartonJoint(StiffJoint):
    """Joint table [joints.*] with law = "barton": friction that falls with the normal stress."""

    law: Literal["barton"] = "barton"
    jrc: float = parameter(
        ge=0.0, le=20.0, description="joint roughness coefficient JRC [deg per decade of stress]", examples=[8.0]
    )
    jcs: Positive = parameter(
        description="joint compressive strength JCS [Pa]; above it the angle is φr", examples=[50e6]
    )
    residual_angle_deg: float = parameter(
        ge=0.0, lt=90.0, description="residual friction angle φr [deg]", examples=[28.0]
    )
    largest_angle_deg: float = parameter(
        default=70.0, ge=0.0, lt=90.0, description="largest friction angle φ_max, at low stress [deg]"
    )

    def check(self) -> None:
        """Check that the largest friction angle is at least the residual one."""
        super().check()
        if self.largest_angle_deg < self.residual_angle_deg:
            raise KeyProblem(
                f"{self.largest_angle_deg:g} is less than residual_angle_deg = {self.residual_angle_deg:g}",
                "largest_angle_deg",
            )

    @property
    def low_stress(self) -> float:
        """Stress below which the angle is cut off [Pa]."""
        if self.jrc == 0.0:
            return 0.0
        return self.jcs * 10.0 ** ((self.residual_angle_deg - self.largest_angle_deg) / self.jrc)


@inline
def barton(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Compute the forces of a contact point with friction that depends on its stress; columns: see `columns`."""
    if gap >= 0.0:
        return 0.0, scale(0.0, shear), True
    normal = -kn * gap
    stress = -parameters[joint, 0] * gap  # kn per area × closing
    friction = parameters[joint, 6]
    if stress >= parameters[joint, 2]:
        friction = parameters[joint, 5]
    elif stress > parameters[joint, 4]:
        friction = math.tan(parameters[joint, 3] + parameters[joint, 1] * math.log10(parameters[joint, 2] / stress))
    trial = axpy(-ks, slide, shear)
    size, limit = norm(trial), friction * normal
    if size <= limit:
        return normal, trial, False
    return normal, scale(limit / size, trial), True


def shear_limit(parameters, normal, memory, kn):
    """Compute the shear strength N tan φ at the stress of each point [N]."""
    stiffness, roughness, strength, residual, low, _, _ = parameters[:, :7].T
    stress = np.clip(normal * stiffness / kn, np.maximum(low, np.finfo(float).tiny), strength)
    return functions.tan(residual + roughness * functions.log10(strength / stress)) * normal


def columns(table, kn):
    """List the parameters: kn [Pa/m], JRC [rad], JCS [Pa], φr [rad], stress where φ is cut off [Pa], smallest and
    largest tan φ.
    """
    residual, largest = math.radians(table.residual_angle_deg), math.radians(table.largest_angle_deg)
    return (kn, math.radians(table.jrc), table.jcs, residual, table.low_stress, math.tan(residual), math.tan(largest))


BARTON = Law(
    name="barton",
    parameters=BartonJoint,
    function=barton,
    columns=columns,
    shear_limit=shear_limit,
    source="Barton 1978; thesis 5.2.2, equations 5-2 and 5-5",
)
