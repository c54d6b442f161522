"""Coulomb joint without tension and cohesion (thesis 4.3).

    N = kn ⟨−gap⟩,   s = s_old − ks Δu,   |s| ≤ μ N

The shear spring is incremental, so that a joint below its limit truly sticks.
"""

from __future__ import annotations

import math
from typing import Literal

from dem_cli.core.kernels.jit import always_inline, inline
from dem_cli.core.kernels.vec import axpy, dot, norm, scale
from dem_cli.core.laws.envelope import frictional
from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.laws.law import Law
from dem_cli.core.laws.softening import FRICTION_SOFTENING, Softening
from dem_cli.declarations import parameter


class CoulombJoint(FrictionJoint):
    """Joint table [joints.*] with law = "coulomb": friction without tension and cohesion."""

    law: Literal["coulomb"] = "coulomb"
    softening: Softening | None = parameter(
        default=None,
        description="friction that falls with the slip: { residual, slip_start, slip_length }",
        examples=[{"residual": 0.8, "slip_start": 0.0009, "slip_length": 0.0001}],
    )


@inline
def coulomb(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Compute normal force and shear force at a Coulomb contact point."""
    if gap >= 0.0:
        return 0.0, scale(0.0, shear), True
    normal = -kn * gap
    trial = axpy(-ks, slide, shear)
    limit = parameters[joint, 0] * normal
    square = dot(trial, trial)
    if square <= limit * limit:
        return normal, trial, False
    return normal, scale(limit / math.sqrt(square), trial), True


@always_inline
def coulomb_of_lanes(gap, slide, shear, kn, ks, numbers, at):
    """Compute normal force and shear force at a Coulomb contact point without branches, and whether work was lost."""
    closed = gap < 0.0
    normal = -kn * gap if closed else 0.0
    trial = axpy(-ks, slide, shear)
    limit = numbers[at] * normal
    square = dot(trial, trial)
    slips = square > limit * limit
    share = limit / (norm(trial) if slips else 1.0) if slips else 1.0
    return normal, scale(share if closed else 0.0, trial), slips & (closed | (dot(shear, shear) > 0.0))


COULOMB = Law(
    name="coulomb",
    parameters=CoulombJoint,
    function=coulomb,
    of_lanes=coulomb_of_lanes,
    n_of_lanes=1,
    columns=lambda table, kn: (table.coefficient,),
    shear_limit=lambda parameters, normal, memory, kn: parameters[:, 0] * normal,
    envelope=lambda parameters, kn: frictional(parameters[:, 0]),
    variant=lambda table: FRICTION_SOFTENING if table.softening else None,
    source="Cundall 1971; thesis 4.3",
)
