"""Units of acceleration, velocity and displacement in record files: for each quantity the factor to SI."""

from __future__ import annotations

STANDARD_GRAVITY = 9.80665  # m/s2: what records given in g are multiples of

SI_FACTORS: dict[str, dict[str, float]] = {
    "acceleration": {"g": STANDARD_GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01, "mm/s2": 0.001},
    "velocity": {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001},
    "displacement": {"m": 1.0, "cm": 0.01, "mm": 0.001},
}
