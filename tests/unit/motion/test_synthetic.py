"""Artificial accelerograms: reproducible, at rest at the end, and fit for Eurocode 8."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.case.tables.base_motion import ArtificialTable
from dem_cli.core.motion.intensity_measures import fit
from dem_cli.core.motion.motion import Motion
from dem_cli.core.motion.synthetic import envelope, power_spectrum, suite


def table(**keys):
    return ArtificialTable(**{"spectrum": "EC8-1", "soil": "B", "ag": 2.0, **keys})


def histories(records):
    return np.stack([record.acceleration(record.times) for record in records])


def test_a_record_depends_on_seed_and_number_only():
    seven, two = histories(suite(table(count=7).asked, 5)), histories(suite(table(count=2).asked, 5))
    assert np.abs(seven[:2] - two).max() < 1e-11  # rounding of products of matrices of another size
    assert (histories(suite(table(count=2).asked, 5)) == two).all()
    assert np.abs(histories(suite(table(count=2).asked, 6)) - two).max() > 1.0
    assert np.abs(histories(suite(table(count=2).asked, 5, stream=1)) - two).max() > 1.0
    assert np.abs(two[0] - two[1]).max() > 1.0


@pytest.mark.parametrize("keys", [{}, {"duration": 8.0, "plateau": 4.0, "rise": 1.0}, {"time_step": 0.02}])
def test_from_rest_to_rest(keys):
    for record in suite(table(count=3, **keys).asked, 1):
        end = np.array(record.duration)
        assert record.duration == keys.get("duration", 20.0)
        assert record.acceleration(np.array(0.0)) == 0.0
        assert abs(record.velocity(end)) < 1e-12
        assert abs(record.displacement(end)) < 1e-11


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"spectrum": "EC8-2", "soil": "D", "ag": 1.0},
        {"soil": "A", "damping": 0.02},
        {
            "spectrum": ((0.0, 3.0), (0.1, 7.5), (0.4, 7.5), (1.0, 3.0), (4.0, 0.4)),
            "soil": None,
            "ag": None,
        },
    ],
)
def test_suites_of_seven_meet_eurocode_8(keys):
    """EN 1998-1 3.2.3.1.2(4)b, c over all periods from 0.04 s to 4 s, and not by being too strong on the whole."""
    made = table(count=7, **keys)
    motions = [Motion(record) for record in suite(made.asked, 1)]
    found = fit(motions, made.target)
    assert found.meets
    assert found.mean_peak >= 1.0
    assert found.least_mean >= 0.90
    assert found.ratios.mean() == pytest.approx(1.0, abs=0.05)


def test_iterations_bring_the_spectrum_closer():
    def misfit(iterations):
        made = table(count=5, iterations=iterations)
        found = fit([Motion(record) for record in suite(made.asked, 2)], made.target)
        return np.sqrt((np.log(found.ratios) ** 2).mean())

    none, some = misfit(0), misfit(12)
    assert some < 0.5 * none


def test_every_peak_reaches_the_ground_acceleration():
    made = table(count=20)
    assert min(record.peak for record in suite(made.asked, 3)) >= made.target.ground * (1 - 1e-12)


def test_envelope():
    times = np.linspace(0, 20, 2001)
    shape = envelope(times, 2.0, 10.0)
    assert shape[100] == pytest.approx(0.25)
    assert (shape[200:1201] == 1.0).all()
    assert shape[-1] == pytest.approx(0.05)
    assert (np.diff(shape[1201:]) < 0).all()
    assert envelope(times, 5.0, 15.0)[-1] == 1.0


def test_power_spectrum_gives_back_the_response_spectrum():
    """Random vibration: response variance from G, times the peak factor, against the target (white-noise formula)."""
    target = table().target
    omegas = 2 * np.pi * np.arange(0.1, 35.0, 0.05)
    power = power_spectrum(target, omegas)
    assert (power >= 0.0).all()
    step, damping = omegas[1] - omegas[0], 0.05
    for period in (0.2, 0.5, 1.0):
        w = 2 * np.pi / period
        transfer = w**4 / ((w**2 - omegas**2) ** 2 + (2 * damping * w * omegas) ** 2)
        deviation = np.sqrt((power * transfer).sum() * step)
        factor = float(target(period)) / deviation
        assert 2.0 < factor < 3.6  # peak factors of a few to a hundred cycles


def test_a_structure_of_known_period():
    made = table(count=3, first_period=0.5)
    found = fit([Motion(record) for record in suite(made.asked, 1)], made.target, made.first_period)
    assert found.periods[[0, -1]] == pytest.approx([0.1, 1.0])
