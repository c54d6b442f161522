"""Response spectra against closed forms and against general solvers of differential equations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import lfilter, lsim

from dem_cli.core.motion.eurocode import SOILS, damping_correction, eurocode, listed
from dem_cli.core.motion.pulses import SineWave
from dem_cli.core.motion.spectrum import (
    crest,
    exponential,
    oscillator,
    peak,
    pseudo_accelerations,
    response_spectrum,
    responses,
    subdivided,
)

NOISE = np.cumsum(np.random.default_rng(1).normal(size=400)) * np.hanning(400)


@pytest.mark.parametrize("step", [0.002, 0.01, 0.05])
@pytest.mark.parametrize("period", [0.03, 0.3, 3.0, 30.0])
@pytest.mark.parametrize("damping", [0.0, 0.05, 0.7])
def test_the_recursion_is_exact_between_any_samples(step, period, damping):
    """lsim with linear interpolation is exact too: the two must agree to rounding, however long the step."""
    omega = 2 * math.pi / period
    u, v = responses(NOISE, oscillator(omega, damping, step))
    system = ([[0, 1], [-(omega**2), -2 * damping * omega]], [[0], [-1]], np.eye(2), np.zeros((2, 1)))
    _, states, _ = lsim(system, NOISE, step * np.arange(len(NOISE)))
    for mine, theirs in zip((u, v), states.T):
        assert mine == pytest.approx(theirs, abs=1e-9 * np.abs(theirs).max())


def test_against_a_solver_of_differential_equations():
    """A damped oscillator under three straight lines, at tight tolerance; peaks between samples included."""
    times, values = np.array([0.0, 0.2, 0.4, 0.6]), np.array([0.0, 3.0, -2.0, 0.0])
    for period, damping in ((0.1, 0.02), (0.45, 0.05), (2.0, 0.2)):
        w = 2 * math.pi / period

        def motion(t, x, w=w, damping=damping):
            return x[1], -np.interp(t, times, values, right=0.0) - 2 * damping * w * x[1] - w * w * x[0]

        grid = np.linspace(0, 0.6 + period, 20_001)
        found = solve_ivp(motion, (0, grid[-1]), [0, 0], "DOP853", grid, rtol=1e-11, atol=1e-13, max_step=0.02)
        u, v = found.y
        spectrum = response_spectrum(values, 0.2, np.array([period]), damping)
        assert spectrum.displacement[0] == pytest.approx(np.abs(u).max(), rel=3e-5)
        assert spectrum.velocity[0] == pytest.approx(np.abs(v).max(), rel=3e-5)
        assert spectrum.acceleration[0] == pytest.approx(np.abs(w * w * u + 2 * damping * w * v).max(), rel=3e-5)
        assert spectrum.pseudo_acceleration[0] == w * w * spectrum.displacement[0]


def test_resonance_closed_form():
    """Undamped at resonance u = (A/2ω²)(ωt cos ωt − sin ωt), largest at the end of n cycles: (A/2ω²) 2πn."""
    cycles, frequency = 5, 2.0
    w = 2 * math.pi * frequency
    wave = SineWave(1.0, frequency, cycles / frequency)
    times = np.linspace(0, wave.duration, 4001)
    spectrum = response_spectrum(wave.acceleration(times), times[1], np.array([1 / frequency]), 0.0)
    assert spectrum.displacement[0] == pytest.approx(2 * math.pi * cycles / (2 * w * w), rel=1e-5)
    # of which the chords of the sine are (ω dt)²/12 = 5e-6


@pytest.mark.parametrize("ratio", [0.3, 0.8, 1.5, 4.0])
def test_half_sine_pulse_closed_form(ratio):
    """Undamped under a half sine of length td, r = td/T (Chopra, Dynamics of Structures, section 4.8), long enough to
    have its peak in the pulse for r > 1/2, otherwise in the free vibration after it: 4 r cos(π r)/(1 − 4 r²)."""
    td = 0.5
    period = td / ratio
    times = np.linspace(0, td, 20_001)
    wave = SineWave(1.0, 1 / (2 * td), td)
    spectrum = response_spectrum(wave.acceleration(times), times[1], np.array([period]), 0.0)
    if ratio < 0.5:
        factor = abs(4 * ratio * math.cos(math.pi * ratio) / (1 - 4 * ratio**2))
    else:
        b = 1 / (2 * ratio)  # T/(2 td)
        peaks = [2 * math.pi * k / (math.pi / td + 2 * math.pi / period) for k in range(1, 20)]
        inside = [t for t in peaks if t <= td]
        factor = max(abs(math.sin(math.pi * t / td) - b * math.sin(2 * math.pi * t / period)) for t in inside)
        factor /= abs(1 - b * b)
    assert spectrum.pseudo_acceleration[0] == pytest.approx(factor, rel=2e-5)


def test_crest_of_a_cubic_parabola():
    t = np.linspace(-1, 1, 8)
    step = t[1] - t[0]
    assert crest(3.0 - (t - 0.123) ** 2, -2 * (t - 0.123) * step) == pytest.approx(3.0)
    assert crest(-(3.0 - (t - 0.9) ** 2), 2 * (t - 0.9) * step) == pytest.approx(3.0)
    assert crest(np.sin(t), np.cos(t) * step) == pytest.approx(math.sin(1.0))
    assert crest(np.zeros(5), np.zeros(5)) == 0.0


def test_rectangular_pulse_doubles():
    spectrum = response_spectrum(np.ones(1001), 0.001, np.array([0.2, 1.0, 10.0]), 0.0)
    assert spectrum.pseudo_acceleration[:2] == pytest.approx(2.0, rel=1e-5)
    assert spectrum.pseudo_acceleration[2] == pytest.approx(2 * math.sin(math.pi * 0.1), rel=1e-5)


def test_short_periods_have_the_peak_of_the_ground_and_long_ones_its_displacement():
    times = np.linspace(0, 4, 401)
    ground = SineWave(2.0, 1.0, 4.0, math.pi / 2, 1.0)
    spectrum = response_spectrum(ground.acceleration(times), 0.01, np.array([0.005, 400.0]), 0.05)
    assert spectrum.acceleration[0] == pytest.approx(2.0, rel=2e-3)
    assert spectrum.displacement[1] == pytest.approx(np.abs(ground.displacement(times)).max(), rel=1e-2)


def test_the_error_of_sixty_points_a_period():
    """Against 2400 points: sampling alone would miss up to 1.4e-3."""
    periods = np.geomspace(0.03, 4.0, 25)
    coarse = response_spectrum(NOISE, 0.01, periods)
    fine = response_spectrum(NOISE, 0.01, periods, points=2400)
    for field in ("displacement", "velocity", "acceleration"):
        assert getattr(coarse, field) == pytest.approx(getattr(fine, field), rel=1e-4)


def test_many_records_at_once_are_the_same_as_one_by_one():
    records = np.stack((NOISE, NOISE[::-1], -NOISE))
    periods = np.array([0.02, 0.2, 2.0])
    together = response_spectrum(records, 0.01, periods)
    for i in range(3):
        alone = response_spectrum(records[i], 0.01, periods)
        assert together.displacement[i] == pytest.approx(alone.displacement, rel=1e-14)
        assert together.acceleration[i] == pytest.approx(alone.acceleration, rel=1e-14)


@pytest.mark.parametrize("size", [1e-9, 0.3, 1.0, 7.0])
def test_exponential(size):
    matrix = size * np.random.default_rng(2).normal(size=(4, 4))
    assert exponential(matrix) == pytest.approx(expm(matrix), rel=1e-11, abs=1e-12 * np.abs(expm(matrix)).max())


def test_subdivided_is_linear():
    assert subdivided(np.array([[0.0, 2.0, -2.0]]), 4).tolist() == [[0, 0.5, 1, 1.5, 2, 1, 0, -1, -2]]


def test_peak_of_a_parabola_is_exact():
    t = np.linspace(-1, 1, 8)
    assert peak(3.0 - (t - 0.123) ** 2) == pytest.approx(3.0)
    assert peak(np.stack((-(3.0 - (t - 0.123) ** 2), t))) == pytest.approx([3.0, 1.0])
    assert peak(np.array([2.0, 1.0])) == 2.0
    assert peak(np.zeros(5)) == 0.0


@pytest.mark.parametrize("kind", SOILS)
@pytest.mark.parametrize("soil", "ABCDE")
def test_eurocode_spectra(kind, soil):
    """Values at the corners, by hand from EN 1998-1 3.2 to 3.5, and no jump anywhere."""
    s, tb, tc, td = SOILS[kind][soil]
    target = eurocode(kind, soil, 2.0)
    assert target(0.0) == target.ground == pytest.approx(2.0 * s)
    assert target(np.array([tb, tc])) == pytest.approx(2.0 * s * 2.5)
    assert target(2 * tc) == pytest.approx(2.0 * s * 2.5 / 2)
    assert target(td) == pytest.approx(2.0 * s * 2.5 * tc / td)
    assert target(2 * td) == pytest.approx(2.0 * s * 2.5 * tc / td / 4)
    for corner in (tb, tc, td):
        assert target(corner - 1e-9) == pytest.approx(float(target(corner + 1e-9)), rel=1e-6)


def test_damping_correction():
    assert damping_correction(0.05) == 1.0
    assert damping_correction(0.02) == pytest.approx(math.sqrt(10 / 7))
    assert damping_correction(0.5) == 0.55
    assert eurocode("EC8-1", "A", 1.0, 0.10)(0.3) == pytest.approx(2.5 * math.sqrt(10 / 15))


def test_listed_spectrum():
    target = listed([(0.0, 2.0), (0.5, 5.0), (2.0, 1.0)])
    assert target.ground == 2.0
    assert target(np.array([0.25, 0.5, 1.25, 9.0])) == pytest.approx([3.5, 5.0, 3.0, 1.0])
    assert target.scaled(2.0)(0.25) == pytest.approx(7.0)


def test_oscillators_side_by_side_are_filters_one_after_the_other():
    """The same numbers to the last digit, as artificial motions are made with them."""
    records = np.stack((NOISE, NOISE[::-1]))
    omegas = np.array([2.0, 20.0, 150.0])
    filters = [oscillator(omega, 0.05, 0.01) for omega in omegas]
    moved = [
        lfilter(one.displacement, one.denominator, records, zi=records[:, :1] * one.start[0])[0] for one in filters
    ]
    expected = omegas**2 * peak(np.stack(moved, axis=1))
    np.testing.assert_array_equal(pseudo_accelerations(records, filters, omegas), expected)
