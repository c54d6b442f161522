"""What the thesis measured on peperino blocks (5.2.2), and what can be made of it."""

from __future__ import annotations

import math

import numpy as np

from dem_cli.core.laws.registry import LAWS
from studies.template import minus
from studies.template import table as markdown

KG_PER_CM2 = 9.80665e4  # [Pa]
TABLE_5_1 = ((0.005, 0.61, 0.00694), (0.088, 0.551, 0.00225), (0.192, 0.579, 0.006), (0.441, 0.534, 0.003))
PEPERINO = {"jrc": 1.96, "jcs": 27.61e6, "residual_angle_deg": 23.14}
ROUGH = {"jrc": 15.0, "jcs": 1e8, "residual_angle_deg": 30.0}
RATIO, LOWEST, SLID = 0.68, 0.483, 0.12  # mean and lowest ratio of last to first friction; slip between them [m]


def barton(stress: float, **keys: float) -> float:
    """Friction coefficient at a normal stress [Pa], by the law of the program; peperino by default."""
    law = LAWS["barton"]
    table = law.parameters(**(keys or PEPERINO))
    columns = np.array([law.columns(table, 1.0)])
    return float(law.shear_limit(columns, np.array([stress]), np.zeros((1, 0)), np.ones(1))[0] / stress)


def barton_numbers() -> dict[str, str]:
    """Table 5-1 beside the law."""
    rows, errors = [], []
    for stress, mean, deviation in TABLE_5_1:
        law = barton(stress * KG_PER_CM2)
        errors.append(100.0 * (law / mean - 1.0))
        unit = f"{stress:g} ({stress * KG_PER_CM2 * 1e-3:.2f} kPa)"
        rows.append((unit, f"{mean:g} ± {deviation:g}", f"{law:.3f}", minus(f"{errors[-1]:+.1f} %")))
    low = LAWS["barton"].parameters(**PEPERINO).low_stress
    return {
        "table": markdown(("normal stress [kg/cm²]", "measured tan φ", "law", "error"), rows),
        "mean": f"{np.mean(np.abs(errors)):.1f} %",
        "low": f"{low:.0e} Pa",
    }


def scale_for(residual: float) -> float:
    """Slip S0 [m] with which the friction has fallen to the mean ratio after the slip of the tests."""
    return SLID / math.log((1.0 - residual) / (RATIO - residual))


def degrading_numbers() -> dict[str, str]:
    """Pairs of r and S0 that fit the mean of the tests equally well."""
    slips, rows = (0.01, 0.03, 0.06, 0.12, 0.5), []
    for residual in (0.0, 0.3, LOWEST, 0.6, 0.67):
        length = scale_for(residual)
        ratios = (residual + (1 - residual) * math.exp(-slip / length) for slip in slips)
        rows.append((f"{residual:g}", f"{1e3 * length:.0f} mm", *(f"{ratio:.2f}" for ratio in ratios)))
    head = ("r", "S0", *(f"μ/μ₀ after {100 * slip:.0f} cm" for slip in slips))
    return {
        "table": markdown(head, rows),
        "scale": f"{1e3 * scale_for(LOWEST):.0f} mm",
        "longest": f"{scale_for(0.0):.2f} m",
    }
