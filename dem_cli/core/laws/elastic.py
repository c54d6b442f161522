"""Elastic joint without any limit: carries tension and shear as they come.

    N = −kn gap,   s = s_old − ks Δu

For joints that are not to fail. Points that meet later were never joined: they press and stick, but come apart.
"""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, scale
from dem_cli.core.laws.envelope import envelope
from dem_cli.core.laws.law import Law
from dem_cli.core.laws.stiffness import StiffJoint


class ElasticJoint(StiffJoint):
    """Joint table [joints.*] with law = "elastic": tension and shear without limit."""

    integrable: ClassVar[bool] = False
    plane_points: ClassVar[int] = 3  # these have the bending stiffness of a rectangle

    law: Literal["elastic"] = "elastic"

    @property
    def bends(self) -> bool:
        """False: a joint that never opens has the bending stiffness of a rectangle with three points."""
        return False


@inline
def elastic(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Compute normal force and shear force of two springs; memory: 1 where they hold the blocks together."""
    if gap >= 0.0 and memory[point, 0] == 0.0:
        return 0.0, scale(0.0, shear), True
    return -kn * gap, axpy(-ks, slide, shear), False


def pressed(parameters, overlaps, memory, kn):
    """Compute normal forces kn × overlap [N], tension where the blocks are held together."""
    return kn * np.where(memory[:, 0] == 0.0, np.maximum(overlaps, 0.0), overlaps)


ELASTIC = Law(
    name="elastic",
    parameters=ElasticJoint,
    function=elastic,
    columns=lambda table, kn: (kn,),
    shear_limit=lambda parameters, normal, memory, kn: np.full(len(normal), np.inf),
    envelope=lambda parameters, kn: envelope(len(kn), cohesion=np.inf, tension=np.inf),
    pressed=pressed,
    scalars=1,
    intact=(1.0,),
    bonded=True,
    source="Hooke's law",
)
