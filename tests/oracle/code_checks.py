"""Safety checks by hand: N2 of a block that slides, kinematic check of a panel that rocks, both on Eurocode 8 spectra.

Written from the codes and the mechanics of one block, apart from dem_cli.
"""

from __future__ import annotations

import math

GRAVITY = 9.81


def spectrum_b(ag: float, period: float) -> float:
    """Elastic acceleration of EN 1998-1, type 1, ground B, damping 5 %."""
    s, tb, tc, td = 1.2, 0.15, 0.5, 2.0
    if period <= tb:
        return ag * s * (1.0 + 1.5 * period / tb)
    if period <= tc:
        return ag * s * 2.5
    return ag * s * 2.5 * (tc / period if period <= td else tc * td / period**2)


def sliding(ag: float = 3.5) -> dict[str, float]:
    """The block of cases/verification/sliding_n2.toml."""
    mass, tc = 2000.0 * 2.0 * 0.1, 0.5
    stiffness = 8e5 * 2.0 / (1.0 + 12.0 * 0.05**2 / 2.0**2 * 8e5 / 8e7)
    at = 0.6 * GRAVITY
    period = 2.0 * math.pi * math.sqrt(mass / stiffness)
    elastic = spectrum_b(ag, period)
    displacement = elastic * (period / (2.0 * math.pi)) ** 2
    q = elastic / at
    target = displacement / q * (1.0 + (q - 1.0) * tc / period)
    assert q > 1.0
    assert displacement < target < 3.0 * displacement
    return {
        "check.period": period, "check.yield_acceleration": at, "check.yield_displacement": mass * at / stiffness,
        "check.elastic_acceleration": elastic, "check.elastic_displacement": displacement, "check.force_ratio": q,
        "check.target_displacement": target,
    }  # fmt: skip


def panel(ag: float = 1.5, confidence: float = 1.35) -> dict[str, float]:
    """The panel of cases/verification/panel_mechanism.toml, one block: all of its mass takes part."""
    width, height, q = 0.3, 3.0, 2.0
    lean, radius = math.atan2(width, height), math.hypot(width, height) / 2.0
    activation = width / height * GRAVITY / confidence
    zero = width / 2.0  # its centre of mass is then over its corner
    ultimate = 0.4 * zero
    secant = 0.4 * ultimate
    acceleration = math.tan(math.asin(math.sin(lean) - secant / radius)) * GRAVITY / confidence
    period = 2.0 * math.pi * math.sqrt(secant / acceleration)
    asked = spectrum_b(ag, period) * (period / (2.0 * math.pi)) ** 2
    return {
        "check.activation_acceleration": activation,
        "check.linear_demand_over_capacity": 1.2 * ag / q / activation,
        "check.zero_displacement": zero, "check.displacement_capacity": ultimate,
        "check.secant_acceleration": acceleration, "check.period": period, "check.target_displacement": asked,
        "check.demand_over_capacity": asked / ultimate,
        "check.ground_acceleration_at_capacity": 1.2 * ag * ultimate / asked,
    }  # fmt: skip


CASES = {"sliding_n2": sliding, "panel_mechanism": panel}
