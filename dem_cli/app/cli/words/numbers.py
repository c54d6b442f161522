"""Format numbers with readable units: lengths, durations, load multipliers."""

from __future__ import annotations


def metres(value: float) -> str:
    """Format a length with a readable unit: 1.2e-05 -> "12 µm"."""
    for scale, unit in ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm")):
        if abs(value) >= scale or unit == "µm":
            return f"{value / scale:.3g} {unit}"
    raise AssertionError("unreachable")


def seconds(value: float) -> str:
    """Format a duration with a readable unit."""
    if value < 0.995:
        return f"{1000 * value:.0f} ms"
    if value < 120:
        return f"{value:.1f} s" if value < 10 else f"{value:.0f} s"
    return f"{value / 60:.0f} min" if value < 7200 else f"{value / 3600:.1f} h"


def load_text(value: float | None) -> str:
    """Format a load multiplier with four decimals."""
    return "–" if value is None else f"{value:.4f}" if abs(value) < 100 else f"{value:.6g}"
