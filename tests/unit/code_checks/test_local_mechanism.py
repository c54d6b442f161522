"""Kinematic check of a mechanism: zero of its curve, and numbers of a straight one by hand."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.code_checks.local_mechanism import check, zero_of
from dem_cli.core.code_checks.oscillator import Participation
from dem_cli.core.motion.eurocode import listed

U = np.array([0.0, 0.001, 0.05, 0.1])


def line(u: np.ndarray, zero: float = 0.2) -> np.ndarray:
    """0.1 at the peak, straight down from there as if from 0."""
    return np.where(u < 0.0005, 0.0, 0.1 * (1.0 - u / zero))


def test_zero():
    beyond = np.append(U, 0.25)
    assert zero_of(beyond, line(beyond)) == (pytest.approx(0.2), False)
    assert zero_of(U, line(U)) == (pytest.approx(0.2), True)
    assert zero_of(U, line(U, 2.0)) is None  # 95 % of its peak is left
    assert zero_of(U, np.array([0.0, 0.05, 0.08, 0.1])) is None


def test_by_hand():
    """α = 0.1 (1 − d/0.2), e* = 3/4, Γ = 3/4, FC = 1.2 under a spectrum of 4 m/s² at all periods."""
    u = np.concatenate([[0.0], np.linspace(1e-9, 0.25, 400)])
    loads = np.where(u > 0.0, 0.1 * (1.0 - u / 0.2), 0.0)
    parts = Participation(mass=100.0, factor=0.75, effective_mass=75.0)
    found = check((u, loads), parts, 9.81, listed([(0.0, 4.0), (4.0, 4.0)]), 1.2, 2.0)
    assert found is not None
    start = 0.1 * 9.81 / (0.75 * 1.2)
    assert found["activation_acceleration"] == pytest.approx(start, rel=1e-6)
    assert found["linear_demand_over_capacity"] == pytest.approx(2.0 / start, rel=1e-6)
    assert found["displacement_capacity"] == pytest.approx(0.4 * 0.2 / 0.75)
    secant = 0.16 * 0.2 / 0.75
    assert found["secant_displacement"] == pytest.approx(secant)
    assert found["secant_acceleration"] == pytest.approx(0.84 * start)
    assert found["period"] == pytest.approx(2.0 * np.pi * np.sqrt(secant / (0.84 * start)))
    asked = 4.0 * secant / (0.84 * start)
    assert found["target_displacement"] == pytest.approx(asked)
    assert found["ground_acceleration_at_capacity"] == pytest.approx(4.0 * 0.4 * 0.2 / 0.75 / asked)
