"""Mass damping and rigid motion: when a tilted block lands, exactly, and what a run says where damping brakes it."""

from __future__ import annotations

import math

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables
from scipy.integrate import solve_ivp

from dem_cli.results.output.ending import ending_words

WIDTH, HEIGHT, TILT, G = 0.5, 2.0, 0.2, 9.81
RADIUS = 0.5 * math.hypot(WIDTH, HEIGHT)
ALPHA = math.atan2(WIDTH, HEIGHT)


def landing(rate: float = 0.0) -> float:
    """Time [s] until a tilted rigid block lands: R² 4/3 θ'' = −g R sin(α − θ), and a drag of `rate` on all its mass."""

    def motion(_: float, state: np.ndarray) -> list[float]:
        return [state[1], -0.75 * G / RADIUS * math.sin(ALPHA - state[0]) - rate * state[1]]

    def lands(_: float, state: np.ndarray) -> float:
        return state[0]

    lands.terminal = True
    found = solve_ivp(motion, (0.0, 5.0), [TILT, 0.0], events=lands, rtol=1e-10, atol=1e-12)
    return float(found.t_events[0][0])


def tilted(damping: dict, duration: float, dimension: int = 2) -> dict:
    ground, stone = rectangle(-3, -1, 3, 0), rectangle(-0.5 * WIDTH, 0.0, 0.5 * WIDTH, HEIGHT)
    space = {} if dimension == 2 else {"dimension": 3}
    return tables(
        *(
            [block("g", ground, fixed=True), block("b", stone)]
            if dimension == 2
            else [
                {"id": "g", "polygon": ground, "y": [-1.0, 1.0], "fixed": True},
                {"id": "b", "polygon": stone, "y": [-0.3, 0.3]},
            ]
        ),
        **space,
        gravity=G,
        joints={"j": {"friction": 1.5}},
        analysis={"kind": "time-history", "duration": duration, "coda": 0.0},
        damping=damping,
        initial=[{"block": "b", "tilt": TILT}],
        monitor=[{"block": "b", "quantity": "rotation"} | ({} if dimension == 2 else {"component": "y"})],
        output={"frames": 0, "rate": 2000.0},
    )


def landed(records) -> float:
    """When the rotation passes through 0 [s]."""
    times, angles = records.history.times, np.abs(records.history.monitors[:, 0])
    first = int(np.flatnonzero(np.diff(np.sign(records.history.monitors[:, 0])))[0])
    share = angles[first] / (angles[first] + angles[first + 1])
    return float(times[first] + share * (times[first + 1] - times[first]))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_rocking_block_lands_when_it_does_under_rayleigh_damping(dimension):
    """5 % at 10 Hz: the part of mass, by default until now, brought it down after 1.296 s."""
    summary, records = engine.solve(tilted({"rayleigh": {"ratio": 0.05, "frequency": 10.0}}, 1.0, dimension))
    assert landing() == pytest.approx(0.892, abs=1e-3)
    assert landed(records) == pytest.approx(landing(), rel=2e-3)
    assert "mass" not in summary["energy_shares"]
    assert "mass" not in ending_words(summary)


@pytest.mark.parametrize(
    ("damping", "rate"),
    [
        ({"rayleigh": {"ratio": 0.05, "frequency": 10.0, "mass": True}}, math.pi),
        ({"rayleigh": {"ratio": 0.05, "frequencies": [5.0, 20.0]}}, 0.8 * math.pi),
        ({"mass": 1.0}, 1.0),
    ],
    ids=["one frequency", "two", "plain"],
)
def test_a_run_says_that_mass_damping_brakes_a_rocking_block(damping, rate):
    summary, records = engine.solve(tilted(damping, 1.4, 3 if "mass" in damping else 2))
    assert landed(records) == pytest.approx(landing(rate), rel=5e-3)
    said = [text for text in summary["warnings"] if "mass-proportional damping" in text]
    assert len(said) == 1
    assert "rock, slide or fall" in said[0]
    assert "mass damping took" in ending_words(summary)


def test_a_little_mass_damping_is_not_worth_a_word():
    """0.01 1/s take some 1 % of the energy of a block that rocks for 1 s."""
    summary, _ = engine.solve(tilted({"mass": 0.01}, 1.0))
    assert not [text for text in summary["warnings"] if "mass-proportional" in text]
    assert "mass" not in ending_words(summary)


def test_mass_damping_of_elastic_vibration_is_what_was_asked_for():
    """A block that bounces on joints that stay closed: all the energy, and not a word."""
    case = tables(
        block("g", rectangle(-3, -1, 3, 0), fixed=True),
        block("b", rectangle(-0.5, 0.0, 0.5, 0.5)),
        joints={"j": {"friction": 1.0, "kn": 1e6, "ks": 1e6}},
        analysis={"kind": "time-history", "duration": 0.5, "coda": 0.0},
        damping={"rayleigh": {"ratio": 0.05, "frequency": 5.0, "stiffness": False}},
        initial=[{"block": "b", "velocity": [0.0, -0.05, 0.0]}],
        output={"frames": 0},
    )
    summary, _ = engine.solve(case)
    assert summary["energy_shares"]["mass"] == pytest.approx(1.0)
    assert summary["largest_displacement"] > 1e-4
    assert not [text for text in summary["warnings"] if "mass-proportional" in text]


def test_a_fragility_says_it_as_well():
    """Under a pulse of 3 m/s² that makes the block rock and leaves it standing."""
    case = tilted({"mass": 3.0}, 1.0)
    case["analysis"] = {"kind": "fragility", "intensities": [3.0]}
    case["motion"] = {"kind": "pulse", "amplitude": 1.0, "frequency": 2.0}
    del case["initial"]
    warnings = engine.solve(case)[0]["warnings"]
    assert any("of blocks that rock, slide or fall in one of the runs" in text for text in warnings)
