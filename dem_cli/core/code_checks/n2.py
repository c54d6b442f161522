"""N2 method: target displacement of a bilinear oscillator under an elastic response spectrum.

An oscillator of period T yields at the acceleration a_y. Below the corner T_C of the spectrum it goes farther than an
elastic one, beyond it as far:

    q_u = S_e(T)/a_y,   d_e = S_e(T) (T/2π)²
    d_t = d_e/q_u (1 + (q_u − 1) T_C/T),  not less than d_e, not more than 3 d_e;  d_e where T ≥ T_C or q_u ≤ 1

Source: EN 1998-1:2004, annex B, B.2 to B.5; Fajfar 2000, A nonlinear analysis method for performance-based seismic
design, Earthquake Spectra 16(3).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from dem_cli.core.code_checks.oscillator import Participation, elastic_displacement, secant_period
from dem_cli.core.motion.eurocode import TargetSpectrum

MOST = 3.0  # times the elastic displacement: EN 1998-1, B.5


class Demand(NamedTuple):
    """Seismic demand of a spectrum on an oscillator."""

    period: float  # T* [s]
    elastic_acceleration: float  # S_e(T*) [m/s2]
    elastic_displacement: float  # d*_et [m]
    force_ratio: float  # q_u [-]: elastic force over that at yield
    target_displacement: float  # d*_t [m]


def demand(yield_displacement: float, yield_acceleration: float, spectrum: TargetSpectrum, corner: float) -> Demand:
    """Compute the demand on an oscillator by its yield displacement [m] and acceleration [m/s2]; corner: T_C [s]."""
    period = secant_period(yield_displacement, yield_acceleration)
    acceleration = float(spectrum(period))
    elastic = elastic_displacement(period, acceleration)
    ratio = acceleration / yield_acceleration
    return Demand(period, acceleration, elastic, ratio, elastic * _farther(ratio, corner / period))


def _farther(ratio: float, corner: float) -> float:
    """Compute the ratio of target to elastic displacement. corner: T_C/T."""
    if ratio <= 1.0 or corner <= 1.0:
        return 1.0
    return min(max((1.0 + (ratio - 1.0) * corner) / ratio, 1.0), MOST)


def strongest(found: Demand, corner: float, capacity: float) -> float:
    """Compute the factor on the spectrum at which its target displacement equals the capacity [m]."""
    elastic = capacity / found.elastic_displacement
    over, q = corner / found.period, found.force_ratio
    if over <= 1.0 or elastic * q <= 1.0:  # as far as an elastic one, or elastic still
        return elastic
    yields = found.elastic_displacement / q  # the yield displacement, by equal stiffness
    return max(((capacity / yields - 1.0) / over + 1.0) / q, elastic / MOST)


def check(
    system: dict[str, float], parts: Participation, gravity: float, spectrum: TargetSpectrum, corner: float
) -> dict[str, Any]:
    """Check a capacity curve by the N2 method: every number by its name in the summary.

    system: bilinear system of a curve of the load λ in shares of the weight [-] over the displacement of that load [m].
    gravity: acceleration at λ = 1 [m/s2]; by virtual work the oscillator feels λ gravity, whatever the shape.
    """
    capacity = system["ultimate_displacement"] / parts.factor
    yields, at = system["yield_displacement"] / parts.factor, system["yield_load"] * gravity
    found = demand(yields, at, spectrum, corner)
    factor = strongest(found, corner, capacity)
    return {
        "yield_acceleration": at,
        "yield_displacement": yields,
        "displacement_capacity": capacity,
        "corner_period": corner,
        **found._asdict(),
        "target_displacement_of_load": found.target_displacement * parts.factor,
        "demand_over_capacity": found.target_displacement / capacity,
        "ground_acceleration": spectrum.ground,
        "ground_acceleration_at_capacity": factor * spectrum.ground,
    }
