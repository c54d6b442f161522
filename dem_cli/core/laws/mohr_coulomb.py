"""Mohr-Coulomb joint: cohesion, tension cut-off, friction, dilation up to a limiting slip (papers 001 and 002).

    N = −kn (gap − d),   N ≥ −ft A,   |s| ≤ c A + μ N,   d = tan ψ min(|u|, zdil)

u is the plastic slip as a vector, so that the opening d goes back when the joint slips back. Intact until it fails in
tension or in shear; then cohesion, tension and friction are the residual ones at once. Points that meet later were
never bonded: friction only, the residual one. Only slip under compression opens the joint.

With a compressive strength points are crushed beyond it, N ≤ fc A (laws/cap.py); such a joint does not dilate.

With a residual tension the joint opens like a slack tie: it carries that much, and after unloading nothing until it is
as far open as it was.
"""

from __future__ import annotations

import math
from typing import ClassVar, Literal

import numpy as np

from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, dot, load, norm, scale, store
from dem_cli.core.laws.cap import capped, check_cap
from dem_cli.core.laws.envelope import Envelope, envelope
from dem_cli.core.laws.friction import FrictionJoint
from dem_cli.core.laws.law import Law
from dem_cli.declarations import KeyProblem, NonNegative, Positive, parameter

INTACT, NEVER, BROKEN = 1.0, 0.0, -1.0  # state of the bond, memory[point, 0]
STATE, PULLED, SLIP = 0, 1, 2  # memory: state, plastic opening [m], slip [m]


class MohrCoulombJoint(FrictionJoint):
    """Joint table [joints.*] with law = "mohr-coulomb": cohesion, tension cut-off, friction, dilation."""

    integrable: ClassVar[bool] = False
    plane_points: ClassVar[int] = 5  # a joint cracks point by point, in time histories too

    law: Literal["mohr-coulomb"] = "mohr-coulomb"
    cohesion: NonNegative = parameter(default=0.0, description="cohesion c [Pa]", examples=[0.1e6])
    tension: NonNegative = parameter(
        default=0.0,
        description="tensile strength ft [Pa], at most cohesion / friction: there the shear strength ends",
        examples=[0.05e6],
    )
    dilation_deg: float = parameter(
        default=0.0, ge=0.0, lt=90.0, description="dilation angle ψ [deg], at most the friction angle", examples=[5.0]
    )
    dilation_slip: NonNegative | None = parameter(
        default=None, description="slip zdil up to which the joint dilates [m]; default: without end", examples=[0.005]
    )
    cohesion_residual: NonNegative = parameter(default=0.0, description="cohesion after failure [Pa]")
    tension_residual: NonNegative = parameter(default=0.0, description="tensile strength after failure [Pa]")
    friction_residual: NonNegative | None = parameter(
        default=None, description="friction coefficient after failure [-]; default: as before", examples=[0.5]
    )
    compression: Positive | None = parameter(
        default=None,
        description="compressive strength fc [Pa], more than the tensile one, without dilation; default: never crushed",
        examples=[4e6],
    )

    @property
    def cracks(self) -> bool:
        """True where the joint cracks or is crushed bit by bit: it has any strength beside friction."""
        return self.cohesion > 0.0 or self.tension > 0.0 or self.compression is not None

    @property
    def residual(self) -> float:
        """Friction coefficient after failure [-]."""
        return self.coefficient if self.friction_residual is None else self.friction_residual

    def check(self) -> None:
        """Check that residual strengths are at most the peak ones, and tension ends at the tip of its cone."""
        super().check()
        self._residual_is_less()
        self._tension_within_the_cone()
        self._crushed_beyond_all_else()
        self._dilates_less_than_it_rubs()

    def _residual_is_less(self) -> None:
        for key in ("cohesion", "tension"):
            left, whole = getattr(self, f"{key}_residual"), getattr(self, key)
            if left > whole:
                raise KeyProblem(f"{left:g} is more than '{key}' = {whole:g}", f"{key}_residual")
        if self.residual > self.coefficient:
            raise KeyProblem(f"{self.residual:g} is more than friction = {self.coefficient:g}", "friction_residual")

    def _tension_within_the_cone(self) -> None:
        for key, friction in (("", self.coefficient), ("_residual", self.residual)):
            tension, cohesion = getattr(self, f"tension{key}"), getattr(self, f"cohesion{key}")
            if tension * friction > cohesion * (1.0 + 1e-9):
                raise KeyProblem(
                    f"{tension:g} Pa is beyond the tip of the cone; "
                    f"must be at most cohesion / friction = {cohesion / friction:g} Pa",
                    f"tension{key}",
                )

    def _crushed_beyond_all_else(self) -> None:
        check_cap(self.compression, self.tension)
        if self.compression is not None and self.dilation_deg > 0.0:
            raise KeyProblem("not allowed with 'compression': a joint that is crushed does not dilate", "dilation_deg")

    def _dilates_less_than_it_rubs(self) -> None:
        angle = math.degrees(math.atan(self.residual))
        if self.dilation_deg > angle * (1.0 + 1e-9):
            raise KeyProblem(
                f"{self.dilation_deg:g} is more than the friction angle, {angle:g} degrees: sliding would make energy",
                "dilation_deg",
            )


@inline
def slip_while_dilating(start, away, reach, force, ks, grip):
    """Solve force − ks x = grip min(|start + x away|, reach) for the slip x; the smallest root.

    start: slip so far; away: unit vector along which it slips on. At x = 0 the left side is larger.
    """
    x = 0.0
    if norm(start) >= reach:
        x = (force - grip * reach) / ks
        start, force = axpy(x, away, start), grip * reach
    square = dot(start, start)
    if square >= reach * reach:
        return x
    # The square of the equation, a x² − 2 b x + c = 0 with c > 0: its first root, so that nothing cancels.
    a, b = ks * ks - grip * grip, force * ks + grip * grip * dot(start, away)
    c = (force - grip * math.sqrt(square)) * (force + grip * math.sqrt(square))
    further = c / (b + math.sqrt(max(b * b - a * c, 0.0)))
    if norm(axpy(further, away, start)) <= reach:
        return x + further
    return x + (force - grip * reach) / ks


@inline
def mohr_coulomb(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Compute normal force and shear force of a bonded, frictional, dilating contact point."""
    area, tangent, reach = kn / parameters[joint, 0], parameters[joint, 7], parameters[joint, 8]
    state, slip = memory[point, STATE], load(memory, point, SLIP, shear)
    trial = axpy(-ks, slide, shear)
    size = norm(trial)
    opening = gap
    if tangent > 0.0:
        opening -= tangent * min(norm(slip), reach)
    normal = -kn * opening
    if state == INTACT:
        limit = max(parameters[joint, 1] * area + parameters[joint, 3] * normal, 0.0)
        if normal >= -parameters[joint, 2] * area and size <= limit:
            return normal, trial, False
        state = BROKEN
        memory[point, STATE] = state
    # What is left of the bond. In tension nothing is carried until the joint is as far open as it was.
    cohesion, tension, friction, yields = 0.0, 0.0, parameters[joint, 6], False
    if state == BROKEN:
        cohesion, tension = parameters[joint, 4] * area, parameters[joint, 5] * area
    if opening > 0.0:
        normal = min(-kn * (opening - memory[point, PULLED]), 0.0)
        if normal < -tension:
            normal, yields = -tension, True
            memory[point, PULLED] = opening - tension / kn
        if normal == 0.0:
            return 0.0, scale(0.0, shear), True
    limit = max(cohesion + friction * normal, 0.0)
    if size <= limit:
        return normal, trial, yields
    if tangent > 0.0 and opening < 0.0:
        away, grip = scale(-1.0 / size, trial), friction * kn * tangent
        further = slip_while_dilating(slip, away, reach, size - cohesion + friction * kn * gap, ks, grip)
        slip = axpy(further, away, slip)
        normal = kn * (tangent * min(norm(slip), reach) - gap)
        if normal < 0.0:
            normal, slip = 0.0, axpy((size - cohesion) / ks - further, away, slip)
        limit = min(cohesion + friction * normal, size)
        store(memory, point, SLIP, slip)
    return normal, scale(limit / size, trial), True


def shear_limit(parameters, normal, memory, kn):
    """Compute the shear strength c A + μ N of the bond as it is [N]; points that were never bonded have no c."""
    area = kn / parameters[:, 0]
    intact, broken = memory[:, STATE] == INTACT, memory[:, STATE] == BROKEN
    cohesion = np.where(intact, parameters[:, 1], np.where(broken, parameters[:, 4], 0.0))
    friction = np.where(intact, parameters[:, 3], parameters[:, 6])
    return np.maximum(cohesion * area + friction * normal, 0.0)


def intact(parameters, kn) -> Envelope:
    """Return the strength envelope of the intact bond: c A, ft A [N] and μ."""
    return _bond(parameters[:, 1:4], parameters, kn)


def broken(parameters, kn) -> Envelope:
    """Return the residual strength envelope after failure of the bond: c A, ft A [N] and μ."""
    return _bond(parameters[:, 4:7], parameters, kn)


def _bond(strengths, parameters, kn) -> Envelope:
    """Strength envelope of a bond; strengths: c, ft [Pa] and μ, (n_points, 3). Dilation that ends is left out."""
    area, endless = kn / parameters[:, 0], np.isinf(parameters[:, 8])
    cohesion, tension, friction = strengths.T
    return envelope(
        len(kn), friction=friction, cohesion=cohesion * area, tension=tension * area,
        dilation=np.where(endless, parameters[:, 7], 0.0),
    )  # fmt: skip


def columns(table, kn):
    """List the parameters: kn, then c, ft, μ intact, the same after failure, tan ψ, zdil."""
    return (
        kn, table.cohesion, table.tension, table.coefficient,
        table.cohesion_residual, table.tension_residual, table.residual,
        math.tan(math.radians(table.dilation_deg)), math.inf if table.dilation_slip is None else table.dilation_slip,
    )  # fmt: skip


def pressed(parameters, overlaps, memory, kn):
    """Compute normal forces kn × overlap [N], that by dilation included; tension as far as the bond holds it."""
    tangent = parameters[:, 7]
    slips = np.sqrt((memory[:, SLIP : SLIP + 2] ** 2).sum(axis=1))
    closed = overlaps + tangent * np.minimum(slips, np.where(tangent > 0.0, parameters[:, 8], 0.0))
    left = np.where(memory[:, STATE] == BROKEN, parameters[:, 5] * kn / parameters[:, 0], 0.0)
    pulled = np.clip(kn * (closed + memory[:, PULLED]), -left, 0.0)
    return np.where((memory[:, STATE] == INTACT) | (closed >= 0.0), kn * closed, pulled)


MOHR_COULOMB = Law(
    name="mohr-coulomb",
    parameters=MohrCoulombJoint,
    function=mohr_coulomb,
    columns=columns,
    shear_limit=shear_limit,
    envelope=intact,
    residual=broken,
    pressed=pressed,
    scalars=2,
    vectors=1,
    intact=(INTACT,),
    bonded=True,
    variant=lambda table: None if table.compression is None else CRUSHED,
    source="papers 001 (brittle bond) and 002 (dilation up to a limiting slip)",
)

CRUSHED: Law = capped(MOHR_COULOMB, "mohr-coulomb with compression", 9)
