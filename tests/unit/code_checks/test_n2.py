"""N2: target displacements by EN 1998-1, annex B, and the spectrum at which the capacity is reached."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.code_checks.n2 import MOST, check, demand, strongest
from dem_cli.core.code_checks.oscillator import Participation, participation
from dem_cli.core.motion.eurocode import eurocode, listed

FLAT = listed([(0.0, 10.0), (4.0, 10.0)])


def yield_of(period: float, acceleration: float) -> float:
    return acceleration * (period / (2.0 * np.pi)) ** 2


@pytest.mark.parametrize(
    ("period", "at_yield", "times"),
    [
        (0.2, 2.0, (1.0 + 4.0 * 2.5) / 5.0),  # q 5, T_C/T 2.5
        (0.05, 2.0, MOST),
        (0.2, 20.0, 1.0),  # stays elastic
        (0.6, 2.0, 1.0),  # equal displacements
        (0.5, 2.0, 1.0),
    ],
)
def test_targets(period, at_yield, times):
    found = demand(yield_of(period, at_yield), at_yield, FLAT, 0.5)
    assert found.period == pytest.approx(period)
    assert found.force_ratio == pytest.approx(10.0 / at_yield)
    assert found.elastic_displacement == pytest.approx(10.0 * (period / (2.0 * np.pi)) ** 2)
    assert found.target_displacement == pytest.approx(times * found.elastic_displacement)


@pytest.mark.parametrize("period", [0.05, 0.2, 0.45, 0.6])
@pytest.mark.parametrize("ductility", [0.5, 1.0, 2.0, 30.0])
def test_the_spectrum_at_capacity_asks_for_it(period, ductility):
    at_yield = 3.0
    yields = yield_of(period, at_yield)
    factor = strongest(demand(yields, at_yield, FLAT, 0.5), 0.5, ductility * yields)
    again = demand(yields, at_yield, FLAT.scaled(factor), 0.5)
    assert again.target_displacement == pytest.approx(ductility * yields, rel=1e-12)


def test_numbers_of_a_shape():
    """A triangle of equal masses: Γ = 3n²/(4n² − 1), e* the same; the load by mass is felt as it is."""
    n = 4
    parts = participation(np.full(n, 50.0), np.arange(1, 2 * n, 2) * 0.37)
    expected = 3.0 * n**2 / (4.0 * n**2 - 1.0)
    assert parts.factor == pytest.approx(expected)
    assert parts.share == pytest.approx(expected)
    assert parts.mass == 200.0
    system = {"yield_displacement": 0.01, "yield_load": 0.2, "ultimate_displacement": 0.05}
    spectrum = eurocode("EC8-1", "A", 2.0)
    found = check(system, parts, 9.81, spectrum, 0.4)
    assert found["yield_acceleration"] == pytest.approx(0.2 * 9.81)
    assert found["displacement_capacity"] == pytest.approx(0.05 / expected)
    assert found["target_displacement_of_load"] == pytest.approx(found["target_displacement"] * expected)
    assert found["ground_acceleration"] == 2.0
    ratio = found["ground_acceleration_at_capacity"] / found["ground_acceleration"]
    assert (ratio > 1.0) == (found["demand_over_capacity"] < 1.0)


def test_blocks_that_do_not_move_do_not_count():
    """Half of the mass stands: the mean displacement, that of the load, is half of that of the other half."""
    parts = participation(np.ones(4), np.array([0.0, 0.0, 1.0, 1.0]), least=0.1)
    assert parts == Participation(mass=2.0, factor=0.5, effective_mass=2.0)
    with pytest.raises(ValueError, match="do not move along the load"):
        participation(np.ones(2), np.array([-1.0, 0.5]))
