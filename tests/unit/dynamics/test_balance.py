"""Towers let go next to their angle of balance: beyond it they fall, before it they return; neither is at rest."""

from __future__ import annotations

import math

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from dem_cli.core.dynamics.balanced_bodies import bodies_of
from dem_cli.core.dynamics.coda import Swings
from dem_cli.core.engine.settings import DEFAULT

G, HALF, HEIGHT = 9.81, 1.0, 10.0
BALANCE = math.atan(2.0 * HALF / HEIGHT)
RADIUS = math.hypot(HALF, 0.5 * HEIGHT)


def solid(name: str, half: float, bottom: float, top: float, space: bool, **more) -> dict:
    """A block as wide as twice `half`, in the plane or a box."""
    if not space:
        return block(name, rectangle(-half, bottom, half, top), **more)
    return {
        "id": name,
        "vertices": [[x, y, z] for z in (bottom, top) for y in (-1.0, 1.0) for x in (-half, half)],
        **more,
    }


def let_go(share: float, space: bool = False, stacked: bool = False, **analysis) -> dict:
    """A tower let go at a share of its angle of balance, whole or of two blocks that move as one."""
    ends = (0.0, 0.5 * HEIGHT, HEIGHT) if stacked else (0.0, HEIGHT)
    blocks = [solid(f"b{i}", HALF, *ends[i : i + 2], space) for i in range(len(ends) - 1)]
    return tables(
        solid("ground", 20.0, -1.0, 0.0, space, fixed=True), *blocks, joints={"dry": {"friction": 2.0}},
        initial=[{"blocks": [each["id"] for each in blocks], "tilt": share * BALANCE}],
        damping={"restitution": "housner"}, analysis={"kind": "time-history", "duration": 0.2} | analysis,
        **({"dimension": 3} if space else {}),
    )  # fmt: skip


def time_until(share: float, angle: float) -> float:
    """When Housner's block, θ'' = −p² sin(α − θ) with p² = 3 g / 4 R, is at an angle [s]."""

    def at(time, state):
        return state[0] - angle

    at.terminal = True
    p2 = 0.75 * G / RADIUS
    found = solve_ivp(
        lambda t, y: [y[1], -p2 * math.sin(BALANCE - y[0])], (0.0, 60.0), [share * BALANCE, 0.0], events=at,
        rtol=1e-10, atol=1e-12,
    )  # fmt: skip
    return float(found.t_events[0][0])


@pytest.mark.parametrize("stacked", [False, True])
@pytest.mark.parametrize("space", [False, True])
def test_beyond_its_balance_it_falls(space, stacked):
    """1 % beyond; fallen at 60°, of two blocks when the upper one sank by its width, seen with the next look."""
    found = engine.solve(let_go(1.01, space, stacked))[0]
    assert found["collapsed"] is True
    sunk = brentq(lambda a: 0.75 * HEIGHT * (1.0 - math.cos(a)) - HALF * math.sin(a) - 2.0 * HALF, 0.5, 1.5)
    exact = time_until(1.01, sunk if stacked else math.radians(60.0))
    assert exact - 0.05 < found["collapse_time"] < exact + 0.25


@pytest.mark.parametrize("stacked", [False, True])
def test_before_its_balance_it_returns(stacked):
    found = engine.solve(let_go(0.99, stacked=stacked))[0]
    assert found["collapsed"] is False
    assert found["followed"] > time_until(0.99, 0.0) - 0.2


@pytest.mark.parametrize(("share", "falls"), [(1.001, True), (0.999, False)])
def test_hardly_out_of_balance(share, falls):
    """By 0.2 mrad: moved by less than a millimetre after a second."""
    assert engine.solve(let_go(share))[0]["collapsed"] is falls


@pytest.mark.parametrize("space", [False, True])
def test_two_blocks_hardly_out_of_balance(space):
    """By 0.02 mrad, flush on each other: they "stood", at rest. Exact is the fall of one block."""
    found = engine.solve(let_go(1.0001, space, stacked=True))[0]
    assert found["collapsed"] is True
    assert abs(found["collapse_time"] - time_until(1.0001, 1.0)) < 0.5


@pytest.mark.parametrize("stacked", [False, True])
@pytest.mark.parametrize("space", [False, True])
def test_in_balance_nobody_knows(space, stacked):
    """On its edge, as near to the balance as numbers and joints allow: whatever is said, it does not stand at rest."""
    found = engine.solve(let_go(1.0, space, stacked, coda=1.0))[0]
    assert found["ending"] == "still moving"
    assert found["collapsed"] is None


def test_a_frame_hardly_out_of_balance():
    """Columns tilted beyond their balance, a lintel on their corners: the same balance, tan α = width/height."""
    width, height, share = 0.8, 4.0, 1.0001
    angle = share * math.atan(width / height)
    cosine, sine = math.cos(angle), math.sin(angle)
    lifted = [cosine * width - sine * height - width, sine * width + cosine * height - height]
    case = tables(
        block("ground", rectangle(-9.0, -1.0, 9.0, 0.0), fixed=True),
        *(block(name, rectangle(x, 0.0, x + width, height)) for name, x in (("l", -1.9), ("r", 1.1))),
        block("t", rectangle(-1.9, height, 1.9, height + 0.6)), joints={"dry": {"friction": 2.0}},
        initial=[{"block": "l", "tilt": angle}, {"block": "r", "tilt": angle}, {"block": "t", "displacement": lifted}],
        damping={"restitution": "housner"}, analysis={"kind": "time-history", "duration": 0.2},
    )  # fmt: skip
    assert engine.solve(case)[0]["collapsed"] is True


def test_without_a_coda_a_second_more_is_looked_at():
    assert engine.solve(let_go(1.01, coda=0.0))[0]["ending"] == "still moving"
    found = engine.solve(let_go(0.2, coda=0.0, duration=20.0))[0]
    assert (found["ending"], found["followed"]) == ("stood", 0.0)


@pytest.mark.parametrize("share", [1.0001, 1.03])
def test_what_slows_down_towards_its_balance_has_not_turned_back(share):
    """Pushed outwards at 0.99 of its balance, by more speed than it needs: it "stood, still rocking"."""
    p2, angle = 0.75 * G / RADIUS, 0.99 * BALANCE
    speed = share * math.sqrt(2.0 * p2 * (1.0 - math.cos(BALANCE - angle)))
    case = let_go(0.99, duration=0.05)
    lean = math.atan2(0.5 * HEIGHT, HALF) + angle  # of the centroid about the corner that carries it
    push = [-speed * RADIUS * math.sin(lean), speed * RADIUS * math.cos(lean), speed]
    case["initial"] = [{"block": "b0", "tilt": angle, "velocity": push}]
    found = engine.solve(case)[0]
    assert found["collapsed"] is True
    assert found["collapse_time"] > 5.0


def test_a_tenth_of_a_second_says_nothing_of_what_rocks():
    """It falls after some five seconds; one look after the motion it was taken for one that had turned back."""
    found = engine.solve(let_go(1.01, coda=0.1))[0]
    assert found["collapsed"] is None


def test_blocks_flush_on_each_other_are_one_body():
    """Blocks 0 and 1 meet along a face, 1 and 2 on a corner; 3 is alone."""
    blocks, points = np.array([[0, 1], [0, 1], [1, 2]]), np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    bodies = bodies_of(blocks, points, 1e-6, 4)
    assert bodies[0] == bodies[1]
    assert len(set(bodies[1:].tolist())) == 3


class Drawn:
    """Places of one block, as `Swings` asks for them."""

    smallest, free, settings = 1.0, slice(None), DEFAULT

    def __init__(self, places: np.ndarray):
        self.now, self._places = 0, places

    def places(self) -> np.ndarray:
        return self._places[self.now : self.now + 1, None]


def grew(places: np.ndarray) -> bool:
    drawn = Drawn(1e-4 * places)
    swings = Swings(drawn)
    for drawn.now in range(1, len(places)):
        swings.look()
    return swings.grew()


def test_what_goes_on_is_not_at_rest():
    time = np.linspace(0.0, 1.0, 21)
    assert grew(np.cosh(1.2 * time) - 1.0)
    assert grew(np.exp(1.2 * time))  # it "stood", since it moved already when it was first looked at
    assert grew(-np.exp(1.2 * time))
    assert grew(time)  # slides on
    assert not grew(1.0 - np.exp(-4.0 * time))  # settles
    assert not grew(np.cos(40.0 * time))  # trembles
    assert not grew(np.exp(-time) * np.cos(40.0 * time))
    assert not grew(1e-3 * time)  # next to nothing
