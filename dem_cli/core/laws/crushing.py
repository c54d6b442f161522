"""Coulomb joint with a compressive strength: beyond it the stone is crushed, perfectly plastic.

    N = kn ⟨−gap − z⟩ ≤ fc A,   |s| ≤ μ N

z is the closing that has gone into crushing; it stays, so that the joint unloads with kn and opens at gap = −z.
"""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, norm, scale
from dem_cli.core.laws.envelope import Envelope, envelope
from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.laws.law import Law
from dem_cli.declarations import Positive, parameter


class CrushingJoint(FrictionJoint):
    """Joint table [joints.*] with law = "crushing": friction and a compressive strength."""

    integrable: ClassVar[bool] = False
    law: Literal["crushing"] = "crushing"
    compression: Positive = parameter(description="compressive strength fc [Pa]", examples=[8e6])

    @property
    def cracks(self) -> bool:
        """True: the joint is crushed bit by bit from its edge."""
        return True


@inline
def crushing(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Compute the forces of a Coulomb contact point with a compressive strength; remembers the crushed depth."""
    closing = -gap - memory[point, 0]
    if closing <= 0.0:
        return 0.0, scale(0.0, shear), True
    normal, crushes = kn * closing, False
    most = parameters[joint, 2] * kn / parameters[joint, 0]
    if normal > most:
        normal, crushes = most, True
        memory[point, 0] = -gap - most / kn
    trial = axpy(-ks, slide, shear)
    size, limit = norm(trial), parameters[joint, 1] * normal
    if size <= limit:
        return normal, trial, crushes
    return normal, scale(limit / size, trial), True


def strength(parameters, kn) -> Envelope:
    """Return the strength envelope: friction, and the compressive strength fc A [N]."""
    return envelope(len(kn), friction=parameters[:, 1], compression=parameters[:, 2] * kn / parameters[:, 0])


def pressed(parameters, overlaps, memory, kn):
    """Compute normal forces kn ⟨overlap − z⟩, at most fc A [N]: the rest of the overlap is crushed stone."""
    return np.minimum(kn * np.maximum(overlaps - memory[:, 0], 0.0), parameters[:, 2] * kn / parameters[:, 0])


CRUSHING = Law(
    name="crushing",
    parameters=CrushingJoint,
    function=crushing,
    columns=lambda table, kn: (kn, table.coefficient, table.compression),
    shear_limit=lambda parameters, normal, memory, kn: parameters[:, 1] * normal,
    envelope=strength,
    pressed=pressed,
    scalars=1,
    bonded=True,
    source="the cap in compression of interface models, here without hardening (Lourenço and Rots 1997)",
)
