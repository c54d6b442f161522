"""Kinematic check of a local mechanism: acceleration that activates it, and displacement against a spectrum.

The curve α(d) of load over displacement of a mechanism is that of an oscillator,

    a* = α g / (e* FC),   d* = d / Γ,   e* = M*/Σm,

whose masses take part as their virtual displacements say (oscillator.py); FC is the confidence factor. Linear check:
a*₀ at the peak of the curve against a_g S / q. Non-linear check: it can go d*_u = 0.4 of the displacement at which the
curve is zero, and is asked for the spectral displacement of its secant period T_s through d*_s = 0.4 d*_u:

    T_s = 2π √(d*_s / a*_s),   S_De(T_s) = S_e(T_s) (T_s/2π)² ≤ d*_u

Source: circular 617/2009 to the Italian code of 2008, C8A.4.1 and C8A.4.2, for mechanisms that stand on the ground;
circular 7/2019 to that of 2018, C8.7.1.2.1, has the same oscillator, with periods and limit states of its own, which
are not those here. Mechanisms further up feel the spectrum of their floor: give it as a list.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dem_cli.core.code_checks.oscillator import Participation, elastic_displacement, secant_period
from dem_cli.core.motion.eurocode import TargetSpectrum

ULTIMATE = 0.4  # of the displacement at which the curve is zero
SECANT = 0.4  # of the ultimate displacement: where the secant goes through
LEAST_FALL = 0.8  # of the peak: a curve that ends above has no zero that could be found


def zero_of(displacements: np.ndarray, loads: np.ndarray) -> tuple[float, bool] | None:
    """Find the displacement at which a falling curve reaches zero [m], and whether that is beyond its end; else None.

    Beyond its end it goes on in the straight line through its end and the middle of its way down.
    """
    peak = int(np.argmax(loads))
    below = np.flatnonzero(loads[peak:] <= 0.0)
    if len(below):
        k = peak + int(below[0])
        share = loads[k - 1] / (loads[k - 1] - loads[k])
        return float(displacements[k - 1] + share * (displacements[k] - displacements[k - 1])), False
    last = float(loads[-1])
    if last >= LEAST_FALL * loads[peak]:
        return None
    k = peak + int(np.argmin(np.abs(loads[peak:] - 0.5 * (loads[peak] + last))))
    if k == len(loads) - 1:
        k -= 1
    slope = (last - loads[k]) / (displacements[-1] - displacements[k])
    return (float(displacements[-1] - last / slope), True) if slope < 0.0 else None


def check(
    curve: tuple[np.ndarray, np.ndarray],
    parts: Participation,
    gravity: float,
    spectrum: TargetSpectrum,
    confidence: float,
    behaviour: float,
) -> dict[str, Any] | None:
    """Check a local mechanism: every number by its name in the summary; None where the curve does not fall far enough.

    curve: displacements of the load [m] and loads in shares of the weight, (n,) each. gravity: [m/s2]. confidence: FC;
    behaviour: q of the linear check.
    """
    displacements, loads = curve
    zero = zero_of(displacements, loads)
    if zero is None:
        return None
    peak = int(np.argmax(loads))
    per_load = gravity / (parts.share * confidence)
    at_zero, ultimate = zero[0] / parts.factor, ULTIMATE * zero[0] / parts.factor
    secant = SECANT * ultimate
    load = float(np.interp(secant * parts.factor, displacements, loads))
    period = secant_period(secant, load * per_load)
    asked = elastic_displacement(period, float(spectrum(period)))
    needed, activation = spectrum.ground / behaviour, float(loads[peak]) * per_load
    return {
        "confidence": confidence,
        "behaviour": behaviour,
        "multiplier": float(loads[peak]),
        "activation_acceleration": activation,
        "required_acceleration": needed,
        "linear_demand_over_capacity": needed / activation,
        "zero_displacement_of_load": zero[0],
        "zero_extrapolated": zero[1],
        "zero_displacement": at_zero,
        "displacement_capacity": ultimate,
        "secant_displacement": secant,
        "secant_acceleration": load * per_load,
        "period": period,
        "elastic_acceleration": float(spectrum(period)),
        "target_displacement": asked,
        "demand_over_capacity": asked / ultimate,
        "ground_acceleration": spectrum.ground,
        "ground_acceleration_at_activation": spectrum.ground * activation / needed,
        "ground_acceleration_at_capacity": spectrum.ground * ultimate / asked,
    }
