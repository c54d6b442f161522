"""Records: what is read from samples of each quantity, and what a baseline correction takes out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dem_cli.core.motion.record import record
from dem_cli.core.motion.record_text import RecordError

steps = st.lists(st.floats(1e-3, 1.0), min_size=1, max_size=30)


@given(steps=steps, data=st.data())
def test_a_record_goes_through_its_samples(steps, data):
    times = np.concatenate(([0.0], np.cumsum(steps)))
    values = np.array(data.draw(st.lists(st.floats(-50, 50), min_size=len(times), max_size=len(times))))
    made = record(times + 7.0, values)
    assert made.acceleration(made.times) == pytest.approx(values, abs=1e-9)
    exact = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(made.times) * (values[1:] + values[:-1]))))
    assert made.velocity(made.times) == pytest.approx(exact, abs=1e-8)
    assert made.peak == pytest.approx(np.abs(values).max(), rel=1e-12, abs=1e-300)


@given(steps=steps, data=st.data())
def test_more_samples_of_the_same_lines_change_nothing(steps, data):
    times = np.concatenate(([0.0], np.cumsum(steps)))
    values = np.array(data.draw(st.lists(st.floats(-50, 50), min_size=len(times), max_size=len(times))))
    more = np.unique(np.concatenate((times, data.draw(st.lists(st.floats(0, times[-1]), max_size=20)))))
    more = more[np.concatenate(([True], np.diff(more) > 1e-9))]
    coarse, fine = record(times, values), record(more, np.interp(more, times, values))
    at = np.linspace(0, min(coarse.duration, fine.duration), 57)
    assert fine.velocity(at) == pytest.approx(coarse.velocity(at), abs=1e-6)
    assert fine.displacement(at) == pytest.approx(coarse.displacement(at), abs=1e-5)


@pytest.mark.parametrize("quantity", ["velocity", "displacement"])
@given(steps=st.lists(st.floats(0.01, 0.1), min_size=3, max_size=30), data=st.data())
def test_other_quantities_go_through_their_samples(quantity, steps, data):
    times = np.concatenate(([0.0], np.cumsum(steps)))
    values = np.array(data.draw(st.lists(st.floats(-1, 1), min_size=len(times), max_size=len(times))))
    made = record(times, values, quantity)
    assert getattr(made, quantity)(times) == pytest.approx(values - values[0], abs=1e-9)
    assert made.velocity(np.array(0.0)) == 0.0


def errors(quantity, function, second):
    """Largest errors of acceleration with 50, 100 and 200 samples of a second."""
    found = []
    for n in (50, 100, 200):
        made = record(np.linspace(0, 1, n + 1), function(np.linspace(0, 1, n + 1)), quantity)
        at = np.linspace(0, 1, 1001)
        found.append(np.abs(made.acceleration(at) - second(at)).max())
    return found


@pytest.mark.parametrize(
    ("quantity", "function"),
    [
        ("velocity", lambda t: (1 - np.cos(9 * t)) / 9),
        ("displacement", lambda t: (t - np.sin(9 * t) / 9) / 9),
    ],
)
def test_differentiation_is_of_second_order_at_least(quantity, function):
    coarse, middle, fine = errors(quantity, function, lambda t: np.sin(9 * t))
    assert coarse / middle > 3.5
    assert middle / fine > 3.5
    assert fine < 1e-3


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_a_baseline_of_its_order_is_taken_out_whole(order):
    rng = np.random.default_rng(3)
    times = np.sort(rng.uniform(0, 20, 400))
    drift = np.polynomial.Polynomial(rng.normal(size=order + 1) * 0.1)
    made = record(times, drift(times - times[0]), baseline=order)
    # the record is the drift's chords, whose integral is off by h³/12 times the second derivative in each step
    bend = np.abs(drift.deriv(2)(made.times)).max() if order > 1 else 0.0
    chords = (np.diff(times) ** 3).sum() / 12.0 * bend
    assert np.abs(made.velocity(made.times)).max() < 1e-11 + 2.0 * chords


def test_a_correction_makes_the_velocity_smaller_and_leaves_the_start_at_rest():
    times = np.linspace(0, 20, 2001)
    values = np.sin(3 * times) * np.exp(-0.2 * times) + 0.02 - 0.003 * times
    plain, corrected = record(times, values), record(times, values, baseline=1)
    assert corrected.velocity(np.array(0.0)) == 0.0
    assert np.sqrt((corrected.velocity(times) ** 2).mean()) < 0.5 * np.sqrt((plain.velocity(times) ** 2).mean())
    taken = plain.acceleration(times) - corrected.acceleration(times)
    assert np.diff(taken, 2) == pytest.approx(0.0, abs=1e-12)  # a straight line


def awkward(kind: str) -> tuple[np.ndarray, np.ndarray, str]:
    """Times, values and quantity of a record that a correction may make worse."""
    rng = np.random.default_rng(5)
    times = np.linspace(0.0, 10.0, 501)
    strong = np.sin(5.0 * times) * np.exp(-((times - 3.0) ** 2))
    return {
        "short": (times[:5], np.array([0.0, 1.0, 2.0, 1.0, 0.0]), "acceleration"),
        "offset": (times, strong + 0.3, "acceleration"),
        "drift": (times, strong + 0.05 * times - 0.1, "acceleration"),
        "one side": (times, np.where(times < 1.0, np.sin(np.pi * times), 0.0), "acceleration"),
        "there and back": (times, np.where(times < 2.0, np.sin(np.pi * times), 0.0), "acceleration"),
        "noise": (times, rng.normal(size=501), "acceleration"),
        "at rest in the end": (times, np.where(times < 4.0, np.sin(0.25 * np.pi * times), 0.0), "velocity"),
        "a place": (times, 0.1 * np.where(times < 4.0, 1.0 - np.cos(0.5 * np.pi * times), 0.0), "displacement"),
        "uneven": (times**1.5, strong + 0.1, "acceleration"),
    }[kind]


@pytest.mark.parametrize("order", [0, 1, 2, 3])
@pytest.mark.parametrize(
    "kind",
    ["short", "offset", "drift", "one side", "there and back", "noise", "at rest in the end", "a place", "uneven"],
)
def test_a_correction_leaves_the_base_no_faster_in_the_end(kind, order):
    times, values, quantity = awkward(kind)
    plain, corrected = record(times, values, quantity), record(times, values, quantity, baseline=order)
    before, after = (abs(float(one.velocity(one.times)[-1])) for one in (plain, corrected))
    fastest = np.abs(plain.velocity(plain.times)).max()
    assert after <= before + 1e-12 * fastest
    assert np.abs(corrected.velocity(corrected.times)).max() <= 2.0 * fastest  # and does not run away before
    taken = plain.acceleration(plain.times) - corrected.acceleration(plain.times)
    fitted = np.polynomial.Polynomial.fit(plain.times, taken, order)
    assert fitted(plain.times) == pytest.approx(taken, abs=1e-9)  # a polynomial of this order, and nothing else


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_a_baseline_needs_samples(order):
    times = np.arange(order + 2.0)
    record(times, times**2, baseline=order)
    if order:
        with pytest.raises(
            RecordError, match=f"order {order} needs at least {order + 2} samples; there are {order + 1}"
        ):
            record(times[:-1], times[:-1] ** 2, baseline=order)


def test_a_correction_of_a_velocity_record():
    times = np.linspace(0, 10, 501)
    drifting = record(times, np.sin(4 * times) * np.sin(0.3 * times) + 0.05 * times**2, "velocity", baseline=1)
    assert np.abs(drifting.velocity(times)).max() < 1.3
