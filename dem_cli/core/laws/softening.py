"""Friction that falls with the slip: constant, then linear, then constant (thesis eq. 7-10 to 7-15, Figure 7-10).

    |s| ≤ μ(S) N,   μ(S) = μ for S ≤ ΔU1,   μ(S) = β μ for S ≥ ΔU1 + ΔU2,   linear between

S is the plastic slip that the point has gone through, wherever to: its path, not its distance. Chosen by the key
`softening` of law = "coulomb".
"""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.kernels.jit import inline
from dem_cli.core.kernels.vec import axpy, dot, scale
from dem_cli.core.laws.envelope import frictional
from dem_cli.core.laws.law import Law
from dem_cli.declarations import Parameters, parameter


class Softening(Parameters):
    """softening of a Coulomb joint: friction that falls with the slip; constant, then linear, then constant."""

    residual: float = parameter(
        ge=0.0, le=1.0, description="share β of the friction that is left in the end [-]", examples=[0.8]
    )
    slip_start: float = parameter(
        ge=0.0, description="slip ΔU1 at which the friction starts to fall [m]", examples=[0.0009]
    )
    slip_length: float = parameter(
        ge=0.0, description="further slip ΔU2 over which it falls, linearly; 0: at once [m]", examples=[0.0001]
    )


@inline
def friction_softening(gap, slide, shear, kn, ks, parameters, joint, memory, point):
    """Compute the forces of a Coulomb contact point whose friction falls with its slip; remembers the slip."""
    if gap >= 0.0:
        return 0.0, scale(0.0, shear), True
    normal = -kn * gap
    trial = axpy(-ks, slide, shear)
    size = math.sqrt(dot(trial, trial))
    friction, residual = parameters[joint, 0], parameters[joint, 1]
    start, length = parameters[joint, 2], parameters[joint, 3]
    before = memory[point, 0]
    fallen = min(max(before - start, 0.0), length)
    now = friction if before <= start else residual
    if 0.0 < fallen < length:
        now = friction - (friction - residual) * fallen / length
    if size <= now * normal:
        return normal, trial, False
    # The slip x ends where the spring meets the curve, size − ks (x − before) = μ(x) N: on the first branch, ...
    force = friction * normal
    slip = before + (size - force) / ks
    if before > start or slip > start:
        # ... on the falling one, if it falls less steeply than the spring, ...
        drop = (friction - residual) * normal
        steep = ks * length - drop
        slip = start + length
        if steep > 0.0:
            slip = start + (size - ks * (start - before) - force) * length / steep
            force -= drop * (slip - start) / length
        # ... or on the last.
        if slip >= start + length:
            force = residual * normal
            slip = before + (size - force) / ks
    memory[point, 0] = slip
    return normal, scale(force / size, trial), True


def shear_limit(parameters, normal, memory, kn):
    """Compute the shear strength [N]: friction after the slip so far × normal force."""
    friction, residual, start, length = parameters[:, :4].T
    fallen = np.where(memory[:, 0] > start, 1.0, 0.0)
    ramp = length > 0.0
    fallen[ramp] = np.clip((memory[ramp, 0] - start[ramp]) / length[ramp], 0.0, 1.0)
    return (friction - (friction - residual) * fallen) * normal


def columns(table, kn):
    """List the parameters: μ, β μ, ΔU1, ΔU2."""
    softening = table.softening
    return (table.coefficient, softening.residual * table.coefficient, softening.slip_start, softening.slip_length)


FRICTION_SOFTENING = Law(
    name="friction-softening",
    parameters=Softening,
    function=friction_softening,
    columns=columns,
    shear_limit=shear_limit,
    envelope=lambda parameters, kn: frictional(parameters[:, 0]),
    residual=lambda parameters, kn: frictional(parameters[:, 1]),
    scalars=1,
    source="thesis 7.2.3, equations 7-10 to 7-15 and Figure 7-10",
)
