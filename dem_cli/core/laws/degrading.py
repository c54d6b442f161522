"""Friction that wears off with the slip, exponentially (thesis 5.2.2: repeated sliding tests).

    |s| ≤ μ(S) N,   μ(S) = μ [r + (1 − r) exp(−S / S0)]

S is the plastic slip that the point has gone through, wherever to: its path, not its distance.
"""

from __future__ import annotations

import math
from typing import Literal

from dem_cli.core.arithmetic import functions
from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, norm, scale
from dem_cli.core.laws.decay import slip_on_decay
from dem_cli.core.laws.envelope import frictional
from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.laws.law import Law
from dem_cli.declarations import Positive, parameter


class DegradingJoint(FrictionJoint):
    """Joint table [joints.*] with law = "slip-degrading": friction that wears off with the slip."""

    law: Literal["slip-degrading"] = "slip-degrading"
    residual: float = parameter(
        ge=0.0, le=1.0, description="share r of the friction that is left in the end [-]", examples=[0.7]
    )
    slip_scale: Positive = parameter(description="slip S0 over which what goes falls to 1/e [m]", examples=[0.01])


@inline
def degrading(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Compute the forces of a Coulomb contact point whose friction wears off; remembers the slip."""
    if gap >= 0.0:
        return 0.0, scale(0.0, shear), True
    normal = -kn * gap
    trial = axpy(-ks, slide, shear)
    size = norm(trial)
    floor = parameters[joint, 1] * normal
    drop = (parameters[joint, 0] - parameters[joint, 1]) * normal * math.exp(-memory[point, 0] / parameters[joint, 2])
    if size <= floor + drop:
        return normal, trial, False
    slip = slip_on_decay(size, ks, floor, drop, 1.0 / parameters[joint, 2])
    memory[point, 0] += slip
    return normal, scale((floor + drop * math.exp(-slip / parameters[joint, 2])) / size, trial), True


def shear_limit(parameters, normal, memory, kn):
    """Compute the shear strength [N]: friction after the slip so far × normal force."""
    fresh, worn, length = parameters[:, :3].T
    return (worn + (fresh - worn) * functions.exp(-memory[:, 0] / length)) * normal


SLIP_DEGRADING = Law(
    name="slip-degrading",
    parameters=DegradingJoint,
    function=degrading,
    columns=lambda table, kn: (table.coefficient, table.residual * table.coefficient, table.slip_scale),
    shear_limit=shear_limit,
    envelope=lambda parameters, kn: frictional(parameters[:, 0]),
    residual=lambda parameters, kn: frictional(parameters[:, 1]),
    scalars=1,
    source="thesis 5.2.2, Figures 5-15 to 5-20; the exponential is ours",
)
