"""Elastic vibrations at the default step, against an exact oscillator; and the error that a run expects of itself."""

from __future__ import annotations

import math

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables
from scipy.integrate import solve_ivp

from dem_cli.core.dynamics.vibration_error import rates_at, rates_of, swing
from dem_cli.core.motion.spectrum import response_spectrum

HERTZ, PULSE, AMPLITUDE, DURATION = 70.0, 49.0, 4.0, 0.3
OMEGA, MASS_PER_AREA = 2.0 * math.pi * HERTZ, 1100.0  # of a block of 2200 kg/m3, half a metre high


def shaken(damping: dict, dimension: int = 2, kn: float | str = MASS_PER_AREA * OMEGA**2, **analysis) -> dict:
    """A block that bounces on an elastic joint at 70 Hz, under one sine of 49 Hz upwards."""
    ground, stone = rectangle(-3, -1, 3, 0), rectangle(-0.5, 0.0, 0.5, 0.5)
    blocks = [block("g", ground, fixed=True), block("b", stone)]
    if dimension == 3:
        blocks = [
            {"id": "g", "polygon": ground, "y": [-1.0, 1.0], "fixed": True},
            {"id": "b", "polygon": stone, "y": [-0.4, 0.4]},
        ]
    joint = {"law": "elastic", "kn": kn, "ks": kn} if kn != "auto" else {"friction": 0.7}
    up = [0.0] * (dimension - 1) + [1.0]
    return tables(
        *blocks,
        **({"dimension": 3} if dimension == 3 else {}),
        density=2200.0,
        joints={"j": joint | ({"points": 2} if dimension == 2 else {})},
        damping=damping,
        motion={"kind": "pulse", "amplitude": AMPLITUDE, "frequency": PULSE, "direction": up},
        analysis={"kind": "time-history", "duration": DURATION, "coda": 0.0} | analysis,
        monitor=[{"block": "b", "component": "y" if dimension == 2 else "z"}],
        output={"frames": 0, "rate": 20_000.0},
    )


def exact(times: np.ndarray, ratio: float) -> np.ndarray:
    """u'' + 2ζω u' + ω² u = −a, by an integration to 1e-11."""
    end = 1.0 / PULSE

    def integrated(start: float, stop: float, state, push: float):
        def motion(t, u):
            return [u[1], -2.0 * ratio * OMEGA * u[1] - OMEGA**2 * u[0] - push * math.sin(2.0 * math.pi * PULSE * t)]

        return solve_ivp(motion, (start, stop), state, method="DOP853", rtol=1e-11, atol=1e-16, dense_output=True)

    during = integrated(0.0, end, [0.0, 0.0], AMPLITUDE)
    after = integrated(end, times[-1] + 1e-9, during.y[:, -1], 0.0)
    return np.where(times <= end, during.sol(np.minimum(times, end))[0], after.sol(np.maximum(times, end))[0])


def error(case: dict, ratio: float) -> tuple[float, dict]:
    """Of the history, over the largest displacement; and the summary."""
    summary, records = engine.solve(case)
    moved = records.history.monitors[:, 0] - records.history.monitors[0, 0]
    wanted = exact(records.history.times, ratio)
    return float(np.abs(moved - wanted).max() / np.abs(wanted).max()), summary


DAMPINGS = {0.05: {"stiffness": 0.1 / OMEGA}, 0.01: {"stiffness": 0.02 / OMEGA}, 0.35: {"contact_fraction": 0.35}}


@pytest.mark.parametrize("ratio", list(DAMPINGS))
@pytest.mark.parametrize("dimension", [2, 3])
def test_histories_are_right_within_one_per_cent_at_the_default_step(ratio, dimension):
    """They were off by 2.4 and 11 % with 5 and 1 % of damping."""
    found, summary = error(shaken(DAMPINGS[ratio], dimension), ratio)
    assert found < 0.01
    assert not any("drifts" in text for text in summary["warnings"])


def test_an_undamped_vibration_is_right_as_well():
    found, summary = error(shaken({"none": True}), 0.0)
    assert found < 0.01
    assert summary["time_step"] > 0.09 * 0.25 * summary["largest_time_step"]


def started(ratio: float, dimension: int, **initial) -> dict:
    """A block on an elastic joint that starts displaced or moving upwards; its ground is at rest."""
    case = shaken(DAMPINGS.get(ratio, {"none": True}), dimension)
    case.pop("motion")
    up = [0.0] * (dimension - 1) + [1.0]
    spins = [0.0] * (3 if dimension == 3 else 1)
    given = {"displacement": up, "velocity": [*up, *spins]}
    case["initial"] = [{"block": "b"} | {key: [size * part for part in given[key]] for key, size in initial.items()}]
    return case


@pytest.mark.parametrize(
    ("ratio", "dimension", "initial"),
    [
        (0.0, 2, {"velocity": 0.02}),
        (0.01, 2, {"velocity": 0.02}),
        (0.01, 3, {"velocity": 0.02}),
        (0.01, 2, {"displacement": 4e-5}),
    ],
)
def test_a_block_that_starts_moving_vibrates_as_it_must(ratio, dimension, initial):
    """u = exp(−ζωt) [u0 cos ω't + (v0 + ζω u0)/ω' sin ω't]: undamped it was off by 69 %."""
    summary, records = engine.solve(started(ratio, dimension, **initial))
    times, moved = records.history.times, records.history.monitors[:, 0]
    place, speed = initial.get("displacement", 0.0), initial.get("velocity", 0.0)
    fading, turning = ratio * OMEGA, OMEGA * math.sqrt(1.0 - ratio**2)
    swings = place * np.cos(turning * times) + (speed + fading * place) / turning * np.sin(turning * times)
    wanted = np.exp(-fading * times) * swings
    rest = moved[0] - place  # under its weight
    assert np.abs(moved - rest - wanted).max() < 0.01 * np.abs(wanted).max()
    assert not any("drifts" in text for text in summary["warnings"])


def test_a_block_that_starts_moving_at_a_given_step_says_its_error():
    case = started(0.01, 2, velocity=0.02)
    case["analysis"]["margin"] = 0.3
    (said,) = [text for text in engine.solve(case)[0]["warnings"] if "drifts" in text]
    assert said.startswith("elastic vibration at 70 Hz drifts")


def test_a_block_that_is_thrown_keeps_its_step():
    """At 1 m/s it slides on its joint: that is no vibration."""
    case = started(0.0, 2, velocity=0.02)
    case["joints"] = {"j": {"kn": 2e8, "friction": 0.6}}
    case["initial"] = [{"block": "b", "velocity": [1.0, 0.0, 0.0]}]
    summary, _ = engine.solve(case)
    assert summary["time_step"] == pytest.approx(0.25 * summary["largest_time_step"])


@pytest.mark.parametrize("ratio", [0.05, 0.01])
@pytest.mark.parametrize("given", ["margin", "time_step"])
def test_a_step_that_is_given_stays_and_its_error_is_said(ratio, given):
    """Expected and measured errors are alike to a twentieth."""
    step = {"margin": 0.3} if given == "margin" else {"time_step": 7e-4}
    found, summary = error(shaken(DAMPINGS[ratio], **step), ratio)
    assert summary["time_step"] == pytest.approx(7e-4 if given == "time_step" else 0.3 * summary["largest_time_step"])
    (said,) = [text for text in summary["warnings"] if "drifts" in text]
    assert said.startswith("elastic vibration at 70 Hz drifts: its history is off by up to ")
    expected = float(said.split("up to ")[1].split(" %")[0]) / 100.0
    assert expected == pytest.approx(found, rel=0.05)
    margin = float(said.split("analysis.margin = ")[1].split()[0])
    better, again = error(shaken(DAMPINGS[ratio], margin=margin), ratio)
    assert better < 0.01
    assert not any("drifts" in text for text in again["warnings"])


def test_joints_that_the_program_chose_keep_their_step():
    """Blocks on them are rigid: their vibration is none of the structure."""
    summary, _ = engine.solve(shaken({"none": True}, kn="auto", duration=0.02))
    assert summary["time_step"] == pytest.approx(0.25 * summary["largest_time_step"])


def test_what_a_step_makes_of_a_rate():
    """Of no damping (2/Δt) asin(ωΔt/2); of any, the solution of z² (1 + l) − (2 − (ωΔt)²) z + 1 − l = 0."""
    omegas, ratios, step = np.array([10.0, 200.0, 200.0]), np.array([0.0, 0.0, 0.3]), 1e-3
    found = rates_at(step, omegas, ratios)
    assert found[:2].imag == pytest.approx(2.0 / step * np.arcsin(0.5 * step * omegas[:2]), rel=1e-12)
    assert found[:2].real == pytest.approx(0.0, abs=1e-9)
    z, lost = np.exp(found * step), ratios * omegas * step
    assert np.abs((1.0 + lost) * z * z - (2.0 - (omegas * step) ** 2) * z + 1.0 - lost).max() < 1e-14
    assert found == pytest.approx(rates_of(omegas, ratios), rel=3e-3)


def test_what_a_motion_makes_of_oscillators():
    """Largest displacements as the response spectrum has them; the drift of two jumps in closed form."""
    rng = np.random.default_rng(2)
    values, step = np.cumsum(rng.normal(size=(2, 1500)), axis=1), 0.005
    values -= np.linspace(values[:, :1], values[:, -1:], 1500, axis=1)[:, :, 0]
    omegas, ratio = np.array([6.0, 40.0, 250.0]), 0.03
    found = swing(values, step, 20.0, omegas, np.full(3, ratio))
    spectrum = response_spectrum(values, step, 2.0 * np.pi / omegas, ratio)
    assert found.largest == pytest.approx(spectrum.displacement, rel=0.03)
    # Of 1 m/s² for 0.05 s: two jumps, each of which begins c t exp(λt).
    omega, ratio, length, rest = 10.0, 0.02, 0.05, 100.0
    kick = swing(np.array([[1.0, 1.0]]), length, rest, np.array([omega]), np.array([ratio]))
    times = np.arange(0.0, rest, 1e-3)
    rate, size = rates_of(np.array([omega]), np.array([ratio]))[0], omega**-2 / math.sqrt(1.0 - ratio**2)
    later = np.maximum(times - length, 0.0)
    drift = size * np.abs(times * np.exp(rate * times) - later * np.exp(rate * later)).max()
    assert drift <= kick.drift[0, 0] < 1.02 * drift  # after the end a bound
    assert kick.vibration[0, 0] == pytest.approx(size, rel=1e-9)
