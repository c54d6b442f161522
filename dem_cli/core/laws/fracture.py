"""Joint that softens as it cracks, in tension and in shear, by its fracture energies (Lourenço and Rots 1997).

    opening:  t = s ft A beyond the peak, secant to the origin below;   closing: N = −kn gap
    sliding:  |s| ≤ s c A + μ N,   μ = μr + (μ0 − μr) s
    what is left of the strength:  s = exp(−ft w / G_I − c δ / G_II)

w is the largest inelastic opening, what the elastic spring kn leaves of the gap; δ is the path of the plastic slip. A
joint that only opens takes the energy G_I per area, one that only slides G_II beside its friction. Points that meet
later were never bonded, s = 0. Below a share s of 1e-9 the bond is gone. With a compressive strength points are crushed
beyond it, N ≤ fc A (laws/cap.py).

The stiffness must be larger than ft² / G_I and c² / G_II; softer springs hold more energy than the crack takes, and the
force drops at once. Where kn is "auto" the program does not check that.
"""

from __future__ import annotations

import math
from typing import ClassVar, Literal

import numpy as np

from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, norm, scale
from dem_cli.core.laws.cap import capped, check_cap
from dem_cli.core.laws.decay import slip_on_decay
from dem_cli.core.laws.envelope import Envelope, envelope, frictional
from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.laws.law import Law
from dem_cli.declarations import KeyProblem, NonNegative, Positive, parameter

STRENGTH, OPENED = 0, 1  # memory: share of the strength that is left [-], largest inelastic opening [m]
GONE = 1e-9  # share of the strength below which nothing is left


class FractureJoint(FrictionJoint):
    """Joint table [joints.*] with law = "fracture": strength that softens by fracture energies."""

    integrable: ClassVar[bool] = False
    plane_points: ClassVar[int] = 5  # a joint cracks point by point, in time histories too

    law: Literal["fracture"] = "fracture"
    tension: Positive = parameter(description="tensile strength ft [Pa], at most cohesion / friction", examples=[0.1e6])
    cohesion: Positive = parameter(description="cohesion c [Pa]", examples=[0.15e6])
    fracture_energy_tension: Positive = parameter(description="energy G_I that opening takes [J/m2]", examples=[10.0])
    fracture_energy_shear: Positive = parameter(
        description="energy G_II that sliding takes beside friction [J/m2]", examples=[50.0]
    )
    friction_residual: NonNegative | None = parameter(
        default=None, description="friction coefficient μr of the crack [-]; default: as before", examples=[0.6]
    )
    compression: Positive | None = parameter(
        default=None,
        description="compressive strength fc [Pa], more than the tensile one; default: never crushed",
        examples=[4e6],
    )

    @property
    def cracks(self) -> bool:
        """True: the joint cracks bit by bit as it bends."""
        return True

    @property
    def residual(self) -> float:
        """Friction coefficient of the crack [-]."""
        return self.coefficient if self.friction_residual is None else self.friction_residual

    def check(self) -> None:
        """Check that tension ends at the tip of the cone, friction does not grow, and the springs are stiff enough."""
        super().check()
        self._tension_within_the_cone()
        self._crushed_beyond_all_else()
        self._stiffer_than_it_softens()

    def _tension_within_the_cone(self) -> None:
        if self.tension * self.coefficient > self.cohesion * (1.0 + 1e-9):
            raise KeyProblem(
                f"{self.tension:g} Pa is beyond the tip of the cone; "
                f"must be at most cohesion / friction = {self.cohesion / self.coefficient:g} Pa",
                "tension",
            )
        if self.residual > self.coefficient:
            raise KeyProblem(f"{self.residual:g} is more than friction = {self.coefficient:g}", "friction_residual")

    def _crushed_beyond_all_else(self) -> None:
        check_cap(self.compression, self.tension)

    def _stiffer_than_it_softens(self) -> None:
        for key, strength, energy in (("kn", "tension", "tension"), ("ks", "cohesion", "shear")):
            steepest = getattr(self, strength) ** 2 / getattr(self, f"fracture_energy_{energy}")
            stiffness = getattr(self, key)
            if stiffness != "auto" and stiffness <= steepest:
                raise KeyProblem(
                    f"{stiffness:g} Pa/m is softer than the joint softens; "
                    f"must be more than {strength}² / fracture_energy_{energy} = {steepest:g} Pa/m",
                    key,
                )


@inline
def fracture(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Compute normal force and shear force of a point that cracks; remembers strength and opening."""
    strength = before = memory[point, STRENGTH]
    if gap >= 0.0 and strength == 0.0:
        return 0.0, scale(0.0, shear), True
    area, friction = kn / parameters[joint, 0], parameters[joint, 4]
    trial, normal, slips = axpy(-ks, slide, shear), -kn * gap, False
    if gap > 0.0:
        opened, peak = memory[point, OPENED], strength * parameters[joint, 2] * area
        normal = -peak * gap / (opened + peak / kn)
        if gap > opened + peak / kn:
            further = slip_on_decay(kn * (gap - opened), kn, 0.0, peak, parameters[joint, 5])
            strength *= math.exp(-parameters[joint, 5] * further)
            normal = -kn * (gap - opened - further)
            memory[point, OPENED] = opened + further
    size = norm(trial)
    floor = friction * normal
    drop = strength * (parameters[joint, 1] * area + (parameters[joint, 3] - friction) * normal)
    if size > max(floor + drop, 0.0):
        slip = slip_on_decay(size, ks, floor, drop, parameters[joint, 6])
        limit, slips = floor + drop * math.exp(-parameters[joint, 6] * slip), True
        if limit < 0.0:  # pulled apart as far as it holds: nothing is left for shear
            limit, slip = 0.0, size / ks
        strength *= math.exp(-parameters[joint, 6] * slip)
        trial = scale(limit / size, trial)
        normal = max(normal, -strength * parameters[joint, 2] * area)
    memory[point, STRENGTH] = strength if strength > GONE else 0.0
    # A damaged point gives back along its secant what the energy balance counts as lost: report a loss in every step.
    return normal, trial, slips or 0.0 < before < 1.0 or strength < before


def shear_limit(parameters, normal, memory, kn):
    """Compute the shear strength s c A + μ N with the remaining strength s [N]."""
    strength, area = memory[:, STRENGTH], kn / parameters[:, 0]
    friction = parameters[:, 4] + (parameters[:, 3] - parameters[:, 4]) * strength
    return np.maximum(strength * parameters[:, 1] * area + friction * normal, 0.0)


def intact(parameters, kn) -> Envelope:
    """Return the strength envelope before cracking: c A, ft A [N] and μ."""
    area = kn / parameters[:, 0]
    return envelope(
        len(kn), friction=parameters[:, 3], cohesion=parameters[:, 1] * area, tension=parameters[:, 2] * area
    )


def columns(table, kn):
    """List the parameters: kn [Pa/m], c, ft [Pa], μ0, μr, ft / G_I, c / G_II [1/m]."""
    return (
        kn, table.cohesion, table.tension, table.coefficient, table.residual,
        table.tension / table.fracture_energy_tension, table.cohesion / table.fracture_energy_shear,
    )  # fmt: skip


def pressed(parameters, overlaps, memory, kn):
    """Normal forces kn × overlap [N]; in tension along the secant to the largest opening, up to the rest of ft A."""
    elastic = memory[:, STRENGTH] * parameters[:, 2] / parameters[:, 0]  # of the opening at the peak [m]
    opened = memory[:, OPENED] + elastic
    left = np.divide(elastic, opened, out=np.zeros(len(kn)), where=opened > 0.0)
    return kn * np.where(overlaps > 0.0, overlaps, -np.minimum(-left * overlaps, elastic))


FRACTURE = Law(
    name="fracture",
    parameters=FractureJoint,
    function=fracture,
    columns=columns,
    shear_limit=shear_limit,
    envelope=intact,
    residual=lambda parameters, kn: frictional(parameters[:, 4]),
    pressed=pressed,
    scalars=2,
    intact=(1.0,),
    bonded=True,
    variant=lambda table: None if table.compression is None else CRUSHED,
    source="after Lourenço and Rots 1997: exponential softening in tension and shear, coupled by one strength",
)

CRUSHED: Law = capped(FRACTURE, "fracture with compression", 7)
