"""Soft joints with points at their ends in time histories: said where bending counts, and only there."""

from __future__ import annotations

import re

import pytest
from engine import block, rectangle, scene, solve, tables

from dem_cli.core.dynamics.bending_stiffness import bending_doubts

DENSITY, G = 2000.0, 9.81
SHAKEN = {"kind": "time-history", "duration": 0.02, "settle": False}
CUBE = {"polygon": [[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 3.0]], "y": [0.0, 1.0]}


def case(dimension: int = 2, **joint) -> dict:
    """A block of 1 × 3 m on fixed ground."""
    made = tables(
        block("ground", rectangle(-3.0, -1.0, 4.0, 0.0), fixed=True), block("b", rectangle(0.0, 0.0, 1.0, 3.0)),
        density=DENSITY, joints={"dry": {"friction": 2.0, **joint}}, analysis=SHAKEN, motion={"kind": "none"},
    )  # fmt: skip
    if dimension == 3:
        ground = {"polygon": [[-3.0, -1.0], [4.0, -1.0], [4.0, 0.0], [-3.0, 0.0]], "y": [-1.0, 2.0]}
        made |= {"dimension": 3, "block": [ground | {"id": "ground", "fixed": True}, CUBE | {"id": "b"}]}
    return made


def doubts(dimension: int = 2, **joint) -> list[str]:
    made = scene(case(dimension, **joint))
    return bending_doubts(made.request, made.model)


@pytest.mark.parametrize(("dimension", "points"), [(2, 5), (3, 3)])
def test_both_turns_are_those_of_the_springs(dimension, points):
    """ε = 2 ρ g (h/b)²/kn on the ends, three times that on points that bend as the area does."""
    kn = 1e9
    (text,) = doubts(dimension, kn=kn)
    ends = 2.0 * DENSITY * G * 9.0 / kn
    found = [float(number) for number in re.findall(r"by ([0-9.e-]+)", text)]
    assert found == pytest.approx([ends, 3.0 * ends], rel=0.05)  # two digits
    assert f"points = {points} by" in text


@pytest.mark.parametrize("joint", [{}, {"kn": 1e11}, {"kn": 1e9, "points": 2}, {"kn": 1e9, "law": "elastic"}])
def test_nothing_is_said_of_stiff_joints_and_of_points_that_are_given(joint):
    joint = joint | ({"friction": None} if "law" in joint else {})
    made = case(**joint)
    made["joints"]["dry"] = {key: value for key, value in made["joints"]["dry"].items() if value is not None}
    found = scene(made)
    assert bending_doubts(found.request, found.model) == []


def test_a_run_says_it():
    summary, _ = solve(case(kn=1e9))
    assert any("bends too little" in text for text in summary["warnings"])
    summary, _ = solve(case(kn=1e9, points=2))
    assert not any("bends too little" in text for text in summary["warnings"])
