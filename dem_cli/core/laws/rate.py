"""Static and dynamic friction: friction that falls with the speed of the slip (thesis 5.2.2, Figure 5-22).

    |s| ≤ μ(v) N,   μ(v) = μd + (μs − μd) exp(−v / vc)

A joint that sticks has the static friction μs. While it slips v is the speed at which the blocks move past each other
at the point, the spring between them included; it sticks again when the spring falls below the limit. Where time has no
meaning (limit loads, gravity, settlements) all slip is slow: μ = μs.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, norm, scale
from dem_cli.core.laws.envelope import frictional
from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.laws.law import Law
from dem_cli.declarations import KeyProblem, NonNegative, Positive, parameter


class RateJoint(FrictionJoint):
    """Joint table [joints.*] with law = "rate-dependent"; its friction is the static one."""

    law: Literal["rate-dependent"] = "rate-dependent"
    friction_dynamic: NonNegative = parameter(
        description="friction coefficient μd of fast slip [-], at most the static one", examples=[0.5]
    )
    velocity: Positive = parameter(
        description="speed of slip vc over which static friction falls to dynamic [m/s]", examples=[0.05]
    )

    def check(self) -> None:
        """Check that dynamic friction is at most the static one."""
        super().check()
        if self.friction_dynamic > self.coefficient:
            raise KeyProblem(
                f"{self.friction_dynamic:g} is more than the static friction, {self.coefficient:g}", "friction_dynamic"
            )


@inline
def rate_dependent(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Forces of a Coulomb contact point with speed-dependent friction; memory: speed of slip, 0 where it sticks."""
    if gap >= 0.0:
        memory[point, 0] = 0.0
        return 0.0, scale(0.0, shear), True
    normal, static = -kn * gap, parameters[joint, 0]
    trial = axpy(-ks, slide, shear)
    size = norm(trial)
    if memory[point, 0] == 0.0 and size <= static * normal:
        return normal, trial, False
    # vc is slip per step here, and infinite where time has no meaning.
    friction = parameters[joint, 1] + (static - parameters[joint, 1]) * math.exp(-norm(slide) / parameters[joint, 2])
    if size <= friction * normal:
        memory[point, 0] = 0.0
        return normal, trial, False
    memory[point, 0] = friction
    return normal, scale(friction * normal / size, trial), True


def shear_limit(parameters, normal, memory, kn):
    """Shear strength [N]: friction at the speed, or the static one where the point sticks, × normal force."""
    return np.where(memory[:, 0] > 0.0, memory[:, 0], parameters[:, 0]) * normal


RATE_DEPENDENT = Law(
    name="rate-dependent",
    parameters=RateJoint,
    function=rate_dependent,
    columns=lambda table, kn: (table.coefficient, table.friction_dynamic, table.velocity),
    shear_limit=shear_limit,
    envelope=lambda parameters, kn: frictional(parameters[:, 0]),
    scalars=1,
    rates=(2,),
    source="thesis 5.2.2, Figure 5-22: static and dynamic friction; the exponential is ours",
)
