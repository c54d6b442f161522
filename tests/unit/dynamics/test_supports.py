"""Blocks that lose their support in a time history: off a pedestal they have fallen, on it they stand."""

from __future__ import annotations

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables

FRICTION, G, WIDTH = 0.3, 9.81, 0.8
GROUND, STONE = (-9.0, -1.0, 9.0, 0.0), {"dry": {"friction": FRICTION}}
DEPTH = (-0.5, 0.5)


def drawn(name: str, left: float, bottom: float, right: float, top: float, space: bool, **more) -> dict:
    """A rectangle of the plane, or the same as a box."""
    if not space:
        return block(name, rectangle(left, bottom, right, top), **more)
    corners = [[x, y, z] for z in (bottom, top) for y in DEPTH for x in (left, right)]
    return {"id": name, "vertices": corners, **more}


def slid(distance: float, height: float, space: bool, *others: dict, tall: float = 0.4, **analysis) -> dict:
    """A case of a block on a pedestal whose friction stops it after a distance, where it is still on it [m]."""
    speed = (2.0 * FRICTION * G * distance) ** 0.5
    blocks = [
        drawn("ground", *GROUND, space, fixed=True),
        drawn("pedestal", -0.5 * WIDTH, 0.0, 0.5 * WIDTH, height, space, fixed=True),
        drawn("b", -0.5 * WIDTH, height, 0.5 * WIDTH, height + tall, space), *others,
    ]  # fmt: skip
    velocity = [speed] + [0.0] * (5 if space else 2)
    return tables(
        *blocks, joints=STONE, initial=[{"block": "b", "velocity": velocity}],
        analysis={"kind": "time-history", "duration": 1.2} | analysis, **({"dimension": 3} if space else {}),
    )  # fmt: skip


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize(("distance", "height", "falls"), [(1.2, 0.3, True), (1.2, 0.1, True), (0.08, 0.3, False)])
def test_off_its_pedestal_it_has_fallen(distance, height, falls, space):
    """By less than its least width of 0.4 m."""
    found = engine.solve(slid(distance, height, space))[0]
    assert found["collapsed"] is falls
    if falls:
        assert "lost its support" in found["collapse"]
        assert found["fallen_blocks"]["first"] == ["b"]
    else:
        assert found["ending"] == "stood"


def test_off_a_step_of_one_block_it_has_fallen():
    """The ground and the step are one block: another face of it carries the stone in the end."""
    parts = [rectangle(-9.0, -1.0, 9.0, 0.0), rectangle(-9.0, 0.0, 0.4, 0.2)]
    case = slid(1.2, 0.2, False)
    case["block"] = [{"id": "ground", "parts": parts, "fixed": True}, block("b", rectangle(-0.4, 0.2, 0.4, 0.6))]
    assert engine.solve(case)[0]["collapsed"] is True


def test_leaning_on_the_edge_of_its_pedestal_it_has_fallen():
    """It stops with its centre just beyond the edge, and comes to rest aslant between the edge and the ground."""
    case = slid(0.43, 0.2, False)
    case["joints"] = {"dry": {"friction": 0.7}}
    case["initial"][0]["velocity"][0] = (2.0 * 0.7 * G * 0.43) ** 0.5
    assert engine.solve(case)[0]["collapsed"] is True


@pytest.mark.parametrize(("step", "falls"), [(0.0, False), (0.005, False), (0.05, True)])
def test_on_to_a_neighbour_of_its_pedestal(step, falls):
    """At the same height, or a joint's width below, it stands as before; a real step down is a fall."""
    other = drawn("other", 0.4, 0.0, 3.0, 0.3 - step, False, fixed=True)
    found = engine.solve(slid(1.0, 0.3, False, other))[0]
    assert found["collapsed"] is falls


def test_what_is_carried_along_has_not_fallen():
    """The upper one of two stands on the lower one, which slides off; dropped = 1 m lets both be."""
    upper = drawn("upper", -0.4, 0.7, 0.4, 0.9, False)
    case = slid(1.2, 0.3, False, upper)
    case["initial"] = [{"blocks": ["b", "upper"], "velocity": case["initial"][0]["velocity"]}]
    found = engine.solve(case)[0]
    assert found["collapsed"] is True
    case["analysis"]["dropped"] = 1.0
    assert engine.solve(case)[0]["collapsed"] is False


def test_repeats_and_fragility_see_the_same_fall():
    pulse = {"kind": "pulse", "shape": "half-sine", "amplitude": 12.0, "frequency": 1.2}
    case = slid(1.2, 0.3, False) | {"motion": pulse}
    del case["initial"]
    case["analysis"] |= {"repeats": 2, "duration": 2.0}
    assert engine.solve(case)[0]["repeats"]["share_collapsed"] == 1.0
    case["analysis"] = {"kind": "fragility", "intensities": [1.0, 12.0]}
    assert engine.solve(case)[0]["share"] == [0.0, 1.0]


def test_a_lintel_with_one_end_on_the_ground_has_fallen():
    """Its other pier still carries it, beside its centre; between both piers there is nothing any more."""
    piers = [
        drawn("p1", -0.3, 0.0, 0.2, 0.45, False), drawn("p2", 2.0, 0.0, 3.6, 0.45, False),
        drawn("b", -0.1, 0.45, 2.4, 0.95, False),
    ]  # fmt: skip
    case = tables(
        drawn("ground", *GROUND, False, fixed=True), *piers, joints=STONE,
        initial=[{"block": "p1", "velocity": [-3.5, 0.0, 0.0]}], analysis={"kind": "time-history", "duration": 2.0},
    )  # fmt: skip
    found = engine.solve(case)[0]
    assert found["collapsed"] is True
    assert "b" in found["fallen_blocks"]["first"]


@pytest.mark.parametrize("parts", [1, 2])
def test_what_slides_on_to_the_next_stone_of_a_ramp_stands(parts):
    """20°, friction 0.6: it stops after v² / 2 g (μ cos − sin) = 0.28 m, wherever the joint of the ramp is."""
    slope = np.radians(20.0)
    along, up = np.array([np.cos(slope), -np.sin(slope)]), np.array([np.sin(slope), np.cos(slope)])

    def stone(name: str, left: float, right: float, bottom: float, top: float, **more) -> dict:
        corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
        return block(name, [(x * along + y * up).tolist() for x, y in corners], **more)

    ends = (-3.0, 0.12, 3.0) if parts == 2 else (-3.0, 3.0)
    ramp = [stone(f"g{i}", *ends[i : i + 2], -0.5, 0.0, fixed=True) for i in range(parts)]
    case = tables(
        *ramp, stone("b", -0.1, 0.1, 0.0, 0.2), joints={"dry": {"friction": 0.6}},
        initial=[{"block": "b", "velocity": [*(1.1 * along).tolist(), 0.0]}],
        analysis={"kind": "time-history", "duration": 1.0},
    )  # fmt: skip
    found = engine.solve(case)[0]
    way = 1.1**2 / (2.0 * G * (0.6 * np.cos(slope) - np.sin(slope)))
    assert found["collapsed"] is False
    assert found["largest_displacement"] == pytest.approx(way, rel=2e-3)
