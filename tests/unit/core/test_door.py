"""The core's own door: arrays in, arrays out, beside exact values; the page about it says what it prints."""

from __future__ import annotations

import contextlib
import io
import math
from pathlib import Path

import numpy as np
import pytest
from shown import blocks

from dem_cli.core import DampingRequest, Structure, failure_load, joints, limit_load, shake
from dem_cli.declarations import KeyProblem

PAGE = Path(__file__).resolve().parents[3] / "docs" / "core.md"
GROUND, COLUMN = [(-1, -0.5), (3, -0.5), (3, 0), (-1, 0)], [(0.5, 0), (1.5, 0), (1.5, 4), (0.5, 4)]
DRY = joints(friction=0.7)


def column(dimension: int = 2) -> Structure:
    """A column of 1 m × 4 m on the ground."""
    drawn = [GROUND, COLUMN]
    if dimension == 3:
        drawn = [[(x, y, z) for x, z in block for y in (0.0, 1.0)] for block in drawn]
    return Structure(drawn, density=2500.0, fixed=[0])


def test_the_page_prints_what_it_says():
    code, said = blocks(PAGE)
    assert len(code.text.splitlines()) <= 30
    told = io.StringIO()
    with contextlib.redirect_stdout(told):
        exec(compile(code.text, "core.md", "exec"), {"__name__": "core"})
    assert told.getvalue().strip() == said.text.strip()


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_column_overturns_at_its_slenderness(dimension):
    """b/h = 0.25; the same by forces, in any unit of the multiplier."""
    structure, along = column(dimension), np.eye(dimension)[0]
    assert limit_load(structure, DRY, along).associated.upper == pytest.approx(0.25, rel=1e-6)
    weight = 2500.0 * 9.81 * 4.0
    found = failure_load(structure, DRY, np.array([0.0, 0.5 * weight])[:, None] * along)
    assert (found.status, found.warnings) == ("ok", ())
    assert found.low == pytest.approx(0.5, rel=1e-3)
    assert found.low <= found.high <= found.low * (1 + 1e-3)
    assert found.bound == pytest.approx(0.5, rel=1e-6)


def test_a_block_that_slides():
    square = Structure([GROUND, [(0, 0), (1, 0), (1, 1), (0, 1)]], fixed=[0])
    found = failure_load(square, joints(friction=0.3), (1, 0))
    assert (found.status, found.low) == ("ok", pytest.approx(0.3, rel=1e-3))


@pytest.mark.parametrize("dimension", [2, 3])
def test_housners_block_comes_back_in_time(dimension):
    """It is upright after arcosh(1 / (1 − θ/α)) / p, p² = 3g/4R, and rises less after the landing."""
    turn = -0.05 if dimension == 2 else (0.0, 0.05, 0.0)
    plastic = DampingRequest(restitution="housner")
    motion = shake(column(dimension), DRY, tilt={1: turn}, duration=1.5, damping=plastic, rate=1000.0)
    radius, slenderness = math.hypot(0.5, 2.0), math.atan(0.25)
    exact = math.acosh(1.0 / (1.0 - 0.05 / slenderness)) / math.sqrt(3.0 * 9.81 / (4.0 * radius))
    angle = motion.rotations[:, 0, 0] if dimension == 2 else -motion.rotations[:, 0, 1]
    assert motion.times[angle > 0.0][0] == pytest.approx(exact, rel=0.01)
    assert 0.02 < angle.max() < 0.05
    assert (motion.status, motion.collapsed) == ("ok", False)


def test_a_strong_pulse_overturns_it():
    pulse = 12.0 * np.sin(np.linspace(0.0, 2.0 * np.pi, 101))
    motion = shake(column(), DRY, np.column_stack([pulse, 0.0 * pulse]), duration=4.0)
    assert motion.collapsed
    assert motion.ending == "collapsed"


def test_mistakes_are_said():
    flat = [(0, 0), (1, 0), (2, 0)]
    for vertices, said in (([GROUND, flat], "block 1: "), ([[1.0, 2.0]], "one array"), ([], "one array")):
        with pytest.raises(ValueError, match=said):
            Structure(vertices)
    with pytest.raises(ValueError, match="must be positive"):
        Structure([GROUND], density=0.0)
    with pytest.raises(ValueError, match="load: a direction"):
        failure_load(column(), DRY, (0, 0))
    with pytest.raises(ValueError, match="'mohr-coulomb'"):
        joints("mohr-columb", friction=0.6)
    with pytest.raises(KeyProblem, match="is not allowed"):
        joints(friction=-0.6)
    with pytest.raises(ValueError, match="duration: is missing"):
        shake(column(), DRY)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"vertices": [GROUND, [(0, 0), (1, 0), (1, math.nan), (0, 1)]]}, "must be finite"),
        ({"density": math.inf}, "positive and finite"),
        ({"density": [1.0, 2.0, 3.0]}, "one of each of the 2 blocks"),
        ({"fixed": [7]}, "from 0 to 1"),
        ({"fixed": [-1]}, "from 0 to 1"),
    ],
)
def test_a_structure_of_wrong_numbers_is_refused(given, said):
    with pytest.raises(ValueError, match=said):
        Structure(**{"vertices": [GROUND, COLUMN]} | given)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"acceleration": [0.0, 1.0]}, "an array of numbers"),
        ({"acceleration": np.full(9, math.nan)}, "must be finite"),
        ({"acceleration": np.ones(9), "interval": 0.0}, "the interval positive"),
        ({"duration": -1.0}, "must be positive"),
        ({"duration": 1.0, "tilt": {0: 0.1}}, "not fixed"),
        ({"duration": 1.0, "tilt": {9: 0.1}}, "not fixed"),
    ],
)
def test_a_motion_of_wrong_numbers_is_refused(given, said):
    with pytest.raises(ValueError, match=said):
        shake(column(), DRY, **given)


def test_a_load_of_wrong_numbers_is_refused():
    with pytest.raises(ValueError, match="must be finite"):
        failure_load(column(), DRY, (math.nan, 0.0))
    with pytest.raises(ValueError, match="resolution: 0 is not allowed"):
        failure_load(column(), DRY, (1.0, 0.0), resolution=0.0)
