"""A column on joints of every law while the ground moves."""

from __future__ import annotations

from typing import Any

from studies.polygons import rectangle

MARGIN, OTHER_MARGIN = 0.15, 0.145  # of the time step; the other one shows how sensitive the column is

JOINTS: dict[str, dict[str, Any]] = {
    "coulomb": {"friction": 0.5},
    "softening": {"friction": 0.5, "softening": {"residual": 0.6, "slip_start": 1e-3, "slip_length": 1e-3}},
    "profile": {"friction": 0.5, "profile": {"sides": 3, "aperture": 1e-3}},
    "barton": {"law": "barton", "jrc": 8.0, "jcs": 5e7, "residual_angle_deg": 26.0},
    "rate-dependent": {"law": "rate-dependent", "friction": 0.5, "friction_dynamic": 0.3, "velocity": 0.05},
    "crushing": {"law": "crushing", "friction": 0.5, "compression": 1e6},
    "mohr-coulomb": {"law": "mohr-coulomb", "friction": 0.5, "cohesion": 3e4, "tension": 1e4, "points": 2},
    "fracture": {
        "law": "fracture",
        "friction": 0.5,
        "cohesion": 3e4,
        "tension": 1e4,
        "fracture_energy_tension": 10.0,
        "fracture_energy_shear": 30.0,
        "points": 2,
    },
    "elastic": {"law": "elastic", "points": 2},
}


def shaken_column(joint: dict[str, Any]) -> dict[str, Any]:
    """Three blocks that slide and rock for a second. Joints have points at their ends, as prisms have them."""
    blocks = [{"id": "base", "vertices": rectangle(-2.0, -0.5, 2.0, 0.0), "fixed": True}]
    blocks += [{"id": f"b{i}", "vertices": rectangle(-0.3, 0.4 * i, 0.3, 0.4 * i + 0.4)} for i in range(3)]
    return {
        "materials": {"stone": {"density": 2000.0}},
        "joints": {"j": {"kn": 1e9, **joint}},
        "block": blocks,
        "motion": {"kind": "harmonic", "amplitude": 6.0, "frequency": 3.0, "duration": 1.0},
        "analysis": {"kind": "time-history", "margin": MARGIN},
        "monitor": [{"block": "b2", "component": "x"}],
        "output": {"frames": 0},
    }
