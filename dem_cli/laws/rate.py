"""Static and dynamic friction: it falls with the speed of the slip (thesis 5.2.2, Figure 5-22).

    |s| ≤ μ(v) N,   μ(v) = μd + (μs − μd) exp(−v / vc)

v is the speed at which the point slips, so that a joint that sticks has the static friction μs. Where time has no
meaning (limit loads, gravity, settlements) all slip is slow: μ = μs.
"""

from __future__ import annotations

import math
from typing import Literal, Self

from pydantic import Field, model_validator

from dem_cli.case.base import KeyProblem, NonNegative, Positive
from dem_cli.kernels.jit import inline
from dem_cli.kernels.vec import axpy, norm, scale
from dem_cli.laws.decay import slip_on_decay
from dem_cli.laws.friction import FrictionJoint
from dem_cli.laws.law import Law


class RateJoint(FrictionJoint):
    """[joints.*] with law = "rate-dependent"; its friction is the static one."""

    law: Literal["rate-dependent"] = "rate-dependent"
    friction_dynamic: NonNegative = Field(
        description="friction coefficient μd of fast slip [-], at most the static one"
    )
    velocity: Positive = Field(description="speed of slip vc over which static friction falls to dynamic [m/s]")

    @model_validator(mode="after")
    def _dynamic_is_less(self) -> Self:
        if self.friction_dynamic > self.coefficient:
            raise KeyProblem(
                f"{self.friction_dynamic:g} is more than the static friction, {self.coefficient:g}", "friction_dynamic"
            )
        return self


@inline
def rate_dependent(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Coulomb contact point with the friction of its speed of slip; parameters: μs, μd, vc as slip per step."""
    if gap >= 0.0:
        return 0.0, scale(0.0, shear), True
    normal = -kn * gap
    trial = axpy(-ks, slide, shear)
    size = norm(trial)
    if size <= parameters[joint, 0] * normal:
        return normal, trial, False
    # The slip of this step, and with it the speed, is where the spring meets the curve.
    floor, drop = parameters[joint, 1] * normal, (parameters[joint, 0] - parameters[joint, 1]) * normal
    rate = 1.0 / parameters[joint, 2]
    slip = slip_on_decay(size, ks, floor, drop, rate)
    return normal, scale((floor + drop * math.exp(-rate * slip)) / size, trial), True


RATE_DEPENDENT = Law(
    name="rate-dependent",
    parameters=RateJoint,
    function=rate_dependent,
    columns=lambda table, kn: (table.coefficient, table.friction_dynamic, table.velocity),
    shear_limit=lambda parameters, normal, memory, kn: parameters[:, 0] * normal,
    rates=(2,),
    source="thesis 5.2.2, Figure 5-22: static and dynamic friction; the exponential is ours",
)
