"""Shapes and motions: velocity and displacement are the exact integrals of the acceleration."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from dem_cli.core.motion.motion import Motion, moving_at_the_end
from dem_cli.core.motion.pulses import RectangularPulses, RickerWavelet, SineWave, impulse
from dem_cli.core.motion.record import record

SHAPES = {
    "sine": SineWave(3.0, 1.5, 1 / 1.5),
    "cosine": SineWave(3.0, 1.5, 1 / 1.5, math.pi / 2),
    "half-sine": SineWave(-2.0, 2.0, 0.25),
    "harmonic with ramps": SineWave(1.2, 2.5, 3.7, 0.4, 1.1),
    "only ramps": SineWave(1.0, 2.0, 3.0, 0.0, 1.5),
    "ricker": RickerWavelet(2.0, 3.0),
    "impulse": impulse(4.0, 0.3, 0.5),
    "steps": RectangularPulses([0.2, 0.1, 0.5], [1.0, -3.0, 0.7]),
    "acceleration": record(np.array([0.0, 0.1, 0.25, 0.3, 0.9]), np.array([0.5, 2.0, -1.0, 0.3, 0.0])),
    "velocity": record(np.linspace(0, 1, 9), np.sin(np.linspace(0, 7, 9)), "velocity"),
    "displacement": record(np.linspace(0, 1, 9), np.sin(np.linspace(0, 7, 9)) ** 2, "displacement"),
    "corrected": record(np.linspace(0, 1, 9), np.cos(np.linspace(0, 7, 9)), baseline=2),
}


def breaks(shape):
    """Times between which the acceleration of a shape is smooth."""
    inner = getattr(shape, "times", getattr(shape, "knots", np.zeros(1)))
    fine = np.linspace(0.0, shape.duration, 30)
    return np.unique(np.concatenate((inner, fine)))


def integrals(function, knots):
    """∫ from the first knot to each, by quadrature between neighbours."""
    pieces = [quad(function, a, b, epsabs=1e-13)[0] for a, b in zip(knots, knots[1:])]
    return np.concatenate(([0.0], np.cumsum(pieces)))


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_velocity_and_displacement_are_exact_integrals(shape):
    knots = breaks(shape)

    def inside(quantity):  # a jump belongs to either side: nudge the ends of a piece into it
        return lambda t: float(quantity(np.clip(t, 1e-12, shape.duration - 1e-12)))

    velocity = integrals(inside(shape.acceleration), knots)
    displacement = integrals(inside(shape.velocity), knots)
    assert shape.velocity(knots) == pytest.approx(velocity, abs=1e-10 * shape.peak)
    assert shape.displacement(knots) == pytest.approx(displacement, abs=1e-10 * shape.peak)


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_peak_is_the_largest_acceleration(shape):
    values = np.abs(shape.acceleration(np.linspace(0.0, shape.duration, 200_001)))
    assert values.max() <= shape.peak * (1 + 1e-6)
    assert values.max() == pytest.approx(shape.peak, rel=1e-5)


@given(start=st.floats(0, 50), t=st.floats(-5, 100), name=st.sampled_from(sorted(SHAPES)), factor=st.floats(-3, 3))
def test_before_a_motion_nothing_moves_and_after_it_the_velocity_stays(start, t, name, factor):
    shape = SHAPES[name]
    motion = Motion(shape, start=start, factor=factor)
    a, v, d = motion.acceleration(t), motion.velocity(t), motion.displacement(t)
    if t < start:
        assert (a, v, d) == (0.0, 0.0, 0.0)
    elif t > motion.duration + 1e-9:
        assert a == 0.0
        assert v == pytest.approx(motion.end_velocity, rel=1e-12, abs=1e-13)
        expected = motion.displacement(motion.duration) + v * (t - motion.duration)
        assert d == pytest.approx(expected, abs=1e-9)
    assert abs(a) <= motion.peak * (1 + 1e-9)


def test_arrays_of_any_form():
    motion = Motion(SHAPES["sine"], start=0.5)
    times = np.linspace(-1, 3, 12).reshape(3, 4)
    for quantity in (motion.acceleration, motion.velocity, motion.displacement):
        assert quantity(times).shape == (3, 4)
        assert quantity(times)[1, 2] == quantity(times[1, 2])


def test_closed_forms_of_pulses():
    """A cycle of a sine ends at rest, 2π A/ω² away; a cycle of a cosine ends at rest where it began."""
    w = 2 * math.pi * 1.5
    sine, cosine = SHAPES["sine"], SHAPES["cosine"]
    assert sine.velocity(np.array(sine.duration)) == pytest.approx(0.0, abs=1e-15)
    assert sine.displacement(np.array(sine.duration)) == pytest.approx(3.0 * 2 * math.pi / w**2)
    assert cosine.velocity(np.array(cosine.duration)) == pytest.approx(0.0, abs=1e-15)
    assert cosine.displacement(np.array(cosine.duration)) == pytest.approx(0.0, abs=1e-15)
    assert cosine.displacement(np.array(cosine.duration / 2)) == pytest.approx(2 * 3.0 / w**2)


def test_an_impulse_with_rebound_ends_at_rest():
    blow = impulse(4.0, 0.3, 0.5)
    assert blow.duration == pytest.approx(0.9)
    assert blow.velocity(np.array(0.3)) == pytest.approx(1.2)
    assert blow.velocity(np.array(0.9)) == pytest.approx(0.0, abs=1e-15)
    assert blow.displacement(np.array(0.9)) == pytest.approx(0.5 * 1.2 * 0.9)


def test_a_ricker_wavelet_is_all_but_over_at_its_ends():
    wavelet = SHAPES["ricker"]
    assert abs(wavelet.acceleration(np.array(0.0))) < 1e-7 * wavelet.peak
    assert wavelet.acceleration(np.array(0.5 * wavelet.duration)) == wavelet.peak


def test_a_motion_that_goes_on_is_spoken_of():
    assert moving_at_the_end(Motion(impulse(4.0, 0.3))).startswith("ends with a velocity of 1.2 m/s")
    assert moving_at_the_end(Motion(impulse(4.0, 0.3, 0.5))) == ""


def test_scaled():
    motion = Motion(SHAPES["sine"]).scaled(0.5).scaled(3.0)
    assert motion.peak == pytest.approx(4.5)
    assert motion.velocity(0.2) == pytest.approx(1.5 * Motion(SHAPES["sine"]).velocity(0.2))
