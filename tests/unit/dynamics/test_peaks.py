"""Peaks of time histories: of all that was followed and of every step, against exact blocks and the finest samples."""

from __future__ import annotations

import engine
import numpy as np
import pytest
from engine import Records, block, rectangle, tables
from scipy.integrate import solve_ivp

from dem_cli.analyses.ensembles.shaken_run import RestedStructure
from dem_cli.analyses.ensembles.variants import Variant
from dem_cli.core.dynamics.extremes import finest
from dem_cli.core.dynamics.ground import GroundMotion
from dem_cli.core.dynamics.history import TimeHistory
from dem_cli.core.engine.job import Job
from dem_cli.masonry.assembly.ground_motions import motions_of
from dem_cli.masonry.assembly.solver_request import solver_request
from dem_cli.results.output.store import ResultWriter

HIGH, HIGH_AT, LOW, LOW_AT = 0, 1, 2, 3
G, HEIGHT, FREQUENCY = 9.81, 6.0, 0.8
GROUND = block("ground", rectangle(-30.0, -1.0, 30.0, 0.0), fixed=True)
ALL = [
    {"block": "b", "quantity": "rotation"}, {"block": "b", "component": "x"}, {"block": "b"},
    {"point": [0.5, 6.0], "component": "y"}, {"point": [0.5, 6.0], "quantity": "velocity", "component": "x"},
    {"point": [0.5, 6.0], "quantity": "velocity"}, {"block": "b", "component": "x", "absolute": True},
    {"block": "b", "quantity": "velocity", "absolute": True},
]  # fmt: skip


def shaken(amplitude: float, space: bool = False, rate: float = 200.0, **analysis) -> dict:
    """A block of 6 m under one sine, in the plane or as a box of 1 m."""

    def solid(name: str, left: float, bottom: float, right: float, top: float, **more) -> dict:
        if not space:
            return block(name, rectangle(left, bottom, right, top), **more)
        return {
            "id": name,
            "vertices": [[x, y, z] for z in (bottom, top) for y in (-0.5, 0.5) for x in (left, right)],
        } | more

    monitors = [dict(each) for each in ALL]
    if space:
        for each in monitors:
            if "point" in each:
                each["point"] = [0.5, 0.5, 6.0]
            if each.get("component") == "y" and "point" in each:
                each["component"] = "z"
    return tables(
        solid("ground", -30.0, -1.0, 30.0, 0.0, fixed=True), solid("b", -0.5, 0.0, 0.5, HEIGHT),
        joints={"dry": {"friction": 5.0, "kn": 1e9}}, damping={"restitution": "housner"},
        motion={"kind": "pulse", "shape": "sine", "amplitude": amplitude, "frequency": FREQUENCY},
        analysis={"kind": "time-history"} | analysis, monitor=monitors, output={"frames": 0, "rate": rate},
        **({"dimension": 3} if space else {}),
    )  # fmt: skip


def extremes(records: Records, coda: bool = True) -> np.ndarray:
    """Of all stretches, with or without those after the motion, (n_monitors, 4)."""
    each = np.array([samples.extremes for samples in records.stretches if coda or not samples.coda])
    high, low = each[:, :, HIGH].argmax(axis=0), each[:, :, LOW].argmin(axis=0)
    columns = np.arange(each.shape[1])
    return np.column_stack([each[high, columns, :2], each[low, columns, 2:]])


def farthest(width: float, height: float, amplitude: float, tip: float) -> tuple[float, float]:
    """When Housner's block is farthest out, and how far [s, rad], under a push +A and its rebound −A/2, twice as long.

    θ'' = −p² [s sin(α − |θ|) − (a/g) cos(α − |θ|)], p² = 3 g / 4 R, s = sgn θ; ω⁺ = (1 − 1.5 sin² α) ω⁻ at θ = 0.
    """
    alpha, p2 = np.arctan2(width, height), 0.75 * G / (0.5 * np.hypot(width, height))
    time, state, side, best = 0.0, np.zeros(2), 1.0, (0.0, 0.0)

    def lands(t, y):
        return side * y[0] + (1.0 if t < time + 1e-9 else 0.0)  # not where it begins

    lands.terminal, lands.direction = True, -1.0
    for end, push in ((tip, amplitude), (3.0 * tip, -0.5 * amplitude), (3.0 * tip + 2.0, 0.0)):
        while time < end:

            def rates(t, y, side=side, push=push):
                arm = alpha - abs(y[0])
                return [y[1], -p2 * (side * np.sin(arm) - push / G * np.cos(arm))]

            way = solve_ivp(rates, (time, end), state, events=lands, rtol=1e-10, atol=1e-13, max_step=2e-3)
            out = np.abs(way.y[0]).argmax()
            best = max(best, (abs(way.y[0, out]), way.t[out]))
            time, state = way.t[-1], way.y[:, -1]
            if len(way.t_events[0]):
                side, state = -side, np.array([0.0, (1.0 - 1.5 * np.sin(alpha) ** 2) * state[1]])
    return best[1], best[0]


def test_the_peak_after_the_motion_is_that_of_housners_block():
    """Half of it, and half a second, come after the push; without the coda they were lost."""
    at, exact = farthest(0.75, 3.0, 3.924, 0.25)
    assert (at, exact) == (pytest.approx(1.264, abs=2e-3), pytest.approx(0.14216, abs=1e-4))
    case = tables(
        GROUND, block("b", rectangle(-0.375, 0.0, 0.375, 3.0)), joints={"dry": {"friction": 1.5}},
        motion={"kind": "pulse", "shape": "impulse", "amplitude": 3.924, "duration": 0.25, "rebound": 0.5},
        damping={"restitution": "housner"}, analysis={"kind": "time-history"},
        monitor=[{"block": "b", "quantity": "rotation"}],
    )  # fmt: skip
    found, records = engine.solve(case)
    turn, during = extremes(records)[0], extremes(records, coda=False)[0]
    assert turn[LOW] == pytest.approx(-exact, rel=0.005)
    assert turn[LOW_AT] == pytest.approx(at, abs=0.005)
    assert turn[LOW] < 1.9 * during[LOW]
    assert during[LOW_AT] < 0.75
    assert found["ending"] == "still rocking"
    assert found["collapsed"] is False


@pytest.mark.parametrize("space", [False, True])
def test_they_are_those_of_every_step(space):
    """Samples at every step have the same, samples at 20 Hz do not change them."""
    extreme = extremes(engine.solve(shaken(2.2, space, 1e6, coda=0.0))[1])
    fine = engine.solve(shaken(2.2, space, 1e6, coda=0.0))[1].history
    np.testing.assert_allclose(extreme[:, HIGH], fine.monitors.max(axis=0), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(extreme[:, LOW], fine.monitors.min(axis=0), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(extreme[:, HIGH_AT], fine.times[fine.monitors.argmax(axis=0)], atol=1e-9)
    coarse = engine.solve(shaken(2.2, space, 20.0, coda=0.0))[1]
    assert (extremes(coarse)[:, [HIGH, LOW]] == extreme[:, [HIGH, LOW]]).all()
    assert np.abs(coarse.history.monitors[:, 4]).max() < 0.999 * np.abs(extreme[4, [HIGH, LOW]]).max()


def test_one_of_many_runs_has_the_same():
    """To the bit: what `repeats` and fragilities read is what a time history reads."""
    made, observer = engine.scene(shaken(2.2)), Records()
    history = TimeHistory(
        Job.start(made.request, made.model, observer), GroundMotion(motions_of(made.case), made.model)
    )  # fmt: skip
    history.run()
    rested = RestedStructure(Variant(made.case, made.model, 0), motions_of(made.case), Records())
    run = rested.shaken(motions_of(made.case))
    assert run.ending == "still rocking"
    assert run.peaks == tuple(history.peaks.tolist())
    assert run.peaks[0] == np.abs(extremes(observer)[0, [HIGH, LOW]]).max()


def test_a_coda_that_ends_too_early_says_so():
    found = engine.solve(shaken(2.2, coda=0.2))[0]
    assert found["ending"] == "still moving"


def test_tall_structures_are_followed_longer():
    """20 √(H/2g): twice as long at four times the height; 5 s at least."""
    from dem_cli.core.dynamics.coda import longest_coda

    made = engine.scene(shaken(2.2))
    assert longest_coda(made.request, made.model) == pytest.approx(20.0 * np.sqrt(3.0 / 9.81))
    low = engine.scene(shaken(2.2) | {"block": [block("b", rectangle(0.0, 0.0, 1.0, 0.5))], "monitor": []})
    assert longest_coda(solver_request(low.case), low.model) == 5.0
    given = engine.scene(shaken(2.2, coda=1.5))
    assert longest_coda(given.request, given.model) == 1.5


def test_the_largest_overlap_is_that_of_any_step():
    """A block that lands from 0.2 m, where a look every 0.1 s sees none of it: √(m/kn) v about the deepest."""
    case = tables(
        block("ground", rectangle(-3.0, -1.0, 3.0, 0.0), fixed=True), block("b", rectangle(-0.5, 0.0, 0.5, 1.0)),
        joints={"dry": {"friction": 0.5, "kn": 1e8}}, damping={"none": True},
        initial=[{"block": "b", "displacement": [0.0, 0.2]}], analysis={"kind": "time-history", "duration": 0.35},
    )  # fmt: skip
    found = engine.solve(case)[0]
    deepest = np.sqrt(2.0 * 9.81 * 0.2 * engine.DENSITY / 1e8)
    assert found["largest_overlap"] == pytest.approx(deepest, rel=0.05)


def oscillating(rate: float) -> dict:
    """A block on an elastic joint of 70 Hz, 5 % of critical, whose base shakes it upwards with one sine of 49 Hz."""
    omega, base = 2.0 * np.pi * 70.0, rectangle(-3.0, -1.0, 3.0, 0.0)
    kn = 2200.0 * 0.5 * omega**2
    return tables(
        block("g", base, fixed=True), block("b", rectangle(-0.5, 0.0, 0.5, 0.5)), density=2200.0,
        joints={"dry": {"law": "elastic", "kn": kn, "ks": kn, "points": 2}}, damping={"stiffness": 0.1 / omega},
        motion={"kind": "pulse", "shape": "sine", "amplitude": 4.0, "frequency": 49.0, "direction": [0.0, 1.0]},
        analysis={"kind": "time-history", "duration": 0.1, "coda": 0.0}, output={"frames": 0, "rate": rate},
        monitor=[{"block": "b", "component": "y"}, {"block": "b", "quantity": "acceleration", "component": "y"}],
    )  # fmt: skip


def test_the_peak_of_an_elastic_joint_does_not_hang_on_samples():
    """Sampled at 60 Hz it would be missed by more than a tenth; the exact oscillator is integrated here."""
    omega = 2.0 * np.pi * 70.0
    ends = (0.0, 1.0 / 49.0, 0.1)
    state, low = np.array([-G / omega**2, 0.0]), 0.0
    for start, end, push in zip(ends, ends[1:], (4.0, 0.0)):
        way = solve_ivp(
            lambda t, y, push=push: [
                y[1], -push * np.sin(2.0 * np.pi * 49.0 * t) - 0.1 * omega * y[1] - omega**2 * y[0] - G,
            ], (start, end), state, rtol=1e-9, atol=1e-14, max_step=1e-4,
        )  # fmt: skip
        state, low = way.y[:, -1], min(low, way.y[0].min())
    found, records = engine.solve(oscillating(60.0))
    assert extremes(records)[0, LOW] == pytest.approx(low, rel=0.005)
    assert records.history.monitors[:, 0].min() > 0.9 * low
    assert found["impacts"] == 0


@pytest.mark.parametrize("space", [False, True])
def test_openings_slips_and_accelerations_do_not_hang_on_samples(space):
    """At 200 Hz an opening of 70 Hz was 0.7 % short, an acceleration 3.6 %; the bond opens as the block moves."""
    case = oscillating(60.0)
    if space:
        case["dimension"] = 3
        case["joints"]["dry"].pop("points")
        case["block"] = [
            {"id": "g", "polygon": rectangle(-3.0, -1.0, 3.0, 0.0), "y": [-1.0, 1.0], "fixed": True},
            {"id": "b", "polygon": rectangle(-0.5, 0.0, 0.5, 0.5), "y": [-0.4, 0.4]},
        ]
        case["motion"]["direction"] = [0.0, 0.0, 1.0]
        case["monitor"] = [each | {"component": "z"} for each in case["monitor"]]
    case["monitor"] += [{"between": ["g", "b"], "quantity": quantity} for quantity in ("opening", "slip")]
    coarse, fine = (
        extremes(engine.solve(case | {"output": {"frames": 0, "rate": rate}})[1])[:, [HIGH, LOW]]
        for rate in (60.0, 1e6)
    )
    np.testing.assert_array_equal(coarse, fine)
    peak = np.abs(
        coarse[0]
    ).max()  # the opening is the displacement of the block, at that end of the joint that it favours
    np.testing.assert_allclose(coarse[2], coarse[0], rtol=0.0, atol=1e-6 * peak)


def test_samples_between_samples():
    """A divisor of the steps between two samples, near to what is wanted and never below what memory allows."""
    assert finest(1000, 40, 1) == 40
    assert finest(994, 40, 1) == 71
    assert finest(997, 40, 1) == 1  # a prime number: every step
    assert finest(997, 40, 2) == 997
    assert finest(12, 1, 5) == 6
    assert finest(1, 1, 1) == 1


def test_peak_accelerations_of_blocks_that_hit_each_other_are_not_given(tmp_path):
    """Their samples are; those of repeats and of the runs of a fragility study are left out as well."""
    case = shaken(2.2, repeats=2)
    case["monitor"] = [{"block": "b", "quantity": "acceleration", "component": "x"}, {"block": "b", "component": "x"}]
    found, records = engine.solve(case)
    assert found["impacts"] > 0
    assert any("no peak accelerations are given" in text for text in found["warnings"])
    assert found["repeats"]["peaks"][0] is None
    assert found["repeats"]["peaks"][1]["max"] > 0.0
    model, quantities = engine.scene(case).model, ("acceleration", "displacement")
    writer = ResultWriter(tmp_path, model, "", {}, ("a", "u"), "time-history", quantities=quantities)
    for samples in records.stretches:
        writer.samples(samples)
    peaks = writer.measured(found)["peaks"]
    assert (peaks["a"]["peak"], peaks["a"]["unit"]) == (None, "m/s2")
    assert abs(peaks["u"]["peak"]) > abs(peaks["u"]["during_motion"])
    assert writer.measured({"impacts": 0})["peaks"]["a"]["peak"] is not None
    writer.abandon()
