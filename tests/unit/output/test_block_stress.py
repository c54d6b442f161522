"""Mean stress of blocks against closed forms: loads at points, weight, ties, bars, loads that follow; 2D and 3D."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import dem_cli
from dem_cli.core.model.uniform_strain import components, tensors
from dem_cli.results.output.block_stress import mean_stresses

WIDE, HIGH, DEEP, DENSITY, GRAVITY = 0.4, 0.6, 0.5, 2000.0, 9.81
AREA = WIDE * DEEP
WEIGHT = DENSITY * GRAVITY * AREA * HIGH


def box(name: str, x: float, z: float, dimension: int, *, fixed: bool = False, wide: float = WIDE) -> dict:
    flat = [[x, z], [x + wide, z], [x + wide, z + HIGH], [x, z + HIGH]]
    if dimension == 2:
        return {"id": name, "fixed": fixed, "thickness": DEEP, "vertices": flat}
    return {"id": name, "fixed": fixed, "vertices": [[x, y, z] for x, z in flat for y in (0.0, DEEP)]}


def at(x: float, z: float, dimension: int, y: float = DEEP / 2) -> list[float]:
    return [x, z] if dimension == 2 else [x, y, z]


def case(dimension: int, blocks: list[dict], **tables: Any) -> dict:
    return {
        "dimension": dimension,
        "gravity": GRAVITY,
        "materials": {"stone": {"density": DENSITY}},
        "joints": {"dry": {"friction": 0.7}},
        "block": blocks,
        "analysis": {"kind": "gravity"},
    } | tables


def stress_of(case: dict, block: str, stage: int = -1) -> np.ndarray:
    """Mean stress of a block in a frame of its run, (d, d)."""
    found = dem_cli.run(case)
    return mean_stresses(found.model, found.frames[stage])[found.model.block_ids.index(block)]


BOTH = pytest.mark.parametrize(("dimension", "kinematics"), [(2, "fixed"), (2, "large"), (3, "fixed"), (3, "large")])


@BOTH
def test_a_load_on_top_presses_all_of_the_block_and_its_weight_half_of_it(dimension, kinematics):
    load = {"block": "b", "force": at(0.0, -5e4, dimension, 0.0), "at": at(WIDE / 2, HIGH, dimension)}
    blocks = [box("base", 0.0, -HIGH, dimension, fixed=True), box("b", 0.0, 0.0, dimension)]
    found = stress_of(case(dimension, blocks, load=[load], analysis={"kind": "gravity", "kinematics": kinematics}), "b")
    assert found[-1, -1] == pytest.approx(-(5e4 + WEIGHT / 2) / AREA, rel=1e-4)
    assert np.abs(found - np.diag(np.diag(found))).max() < 1e-3 * 5e4 / AREA
    assert abs(found[0, 0]) < 2e-3 * 5e4 / AREA


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_load_at_the_foot_leaves_the_stone_to_its_weight(dimension):
    load = {"block": "b", "force": at(0.0, -5e4, dimension, 0.0), "at": at(WIDE / 2, 0.0, dimension)}
    blocks = [box("base", 0.0, -HIGH, dimension, fixed=True), box("b", 0.0, 0.0, dimension)]
    assert stress_of(case(dimension, blocks, load=[load]), "b")[-1, -1] == pytest.approx(-WEIGHT / 2 / AREA, rel=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_in_geometry_of_the_start_it_does_not_matter_how_far_a_block_has_moved(dimension):
    """A stone that sinks by 6 cm on a soft bed and slides by 4 cm: arms are those of the start."""
    push = {"block": "b", "force": at(2e4, -5e4, dimension, 0.0), "at": at(WIDE / 2, 0.0, dimension)}
    blocks = [box("base", -1.0, -HIGH, dimension, fixed=True, wide=3.0), box("b", 0.0, 0.0, dimension)]
    made = case(dimension, blocks, load=[push], analysis={"kind": "gravity", "kinematics": "fixed"})
    made["joints"]["dry"] |= {"kn": 5e6, "ks": 3e6, "friction": 2.0}
    found = dem_cli.run(made)
    frame, b = found.frames[-1], found.model.block_ids.index("b")
    moved = frame.positions[b] - found.model.centroids[b]
    assert moved[0] > 0.03
    assert moved[-1] < -0.05
    mean = mean_stresses(found.model, frame)[b]
    assert mean[-1, -1] == pytest.approx(-WEIGHT / 2 / AREA, rel=1e-2)
    assert abs(mean[0, -1]) < 1e-2 * 2e4 / AREA


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_live_load_counts_with_its_multiplier(dimension):
    """Pushed at its top by λ F the block is sheared by λ F over its section, whatever presses at its foot."""
    live = {"block": "b", "force": at(1e4, 0.0, dimension, 0.0), "at": at(0.0, HIGH, dimension), "kind": "live"}
    blocks = [box("base", -1.0, -HIGH, dimension, fixed=True, wide=3.0), box("b", 0.0, 0.0, dimension)]
    made = case(dimension, blocks, load=[live], analysis={"kind": "pushover", "pattern": "live"})
    found = dem_cli.run(made)
    frame = max((frame for frame in found.frames if frame.stage == "loading"), key=lambda frame: frame.load)
    mean = mean_stresses(found.model, frame)[found.model.block_ids.index("b")]
    assert frame.load > 0.05
    assert mean[0, -1] == pytest.approx(frame.load * 1e4 / AREA, rel=1e-2)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_tie_through_two_blocks_presses_them_together(dimension):
    """Side by side on a floor without friction, drawn together at half height from their far sides."""
    blocks = [
        box("base", -1.0, -HIGH, dimension, fixed=True, wide=3.0),
        box("left", 0.0, 0.0, dimension), box("right", WIDE, 0.0, dimension),
    ]  # fmt: skip
    ends = [at(0.0, HIGH / 2, dimension), at(2 * WIDE, HIGH / 2, dimension)]
    tie = {"id": "t", "ends": ends, "block": "left", "other": "right", "stiffness": 1e6, "prestress": 2e4}
    made = case(dimension, blocks, tie=[tie])
    made["joints"]["dry"]["friction"] = 1e-6
    for name in ("left", "right"):
        found = stress_of(made, name)
        assert found[0, 0] == pytest.approx(-2e4 / (HIGH * DEEP), rel=1e-2)
        assert found[-1, -1] == pytest.approx(-WEIGHT / 2 / AREA, rel=1e-2)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("bonded", [False, True])
def test_a_block_that_hangs_on_a_bar_is_pressed_where_that_ends_below_its_middle(dimension, bonded):
    """Held at the end of the bar alone, at a height c: −W (h/2 − c)/V; evenly along the bar: half of the bar's arm."""
    end = 0.1
    bar = {"area": 1e-4, "young": 2e11, "bond_stiffness": 1e9 if bonded else 1.0, "dowel_stiffness": 1e6}
    if bonded:
        bar["bond_strength"] = WEIGHT / (HIGH - end) / 0.999
    path = [at(WIDE / 2, 2 * HIGH - end, dimension), at(WIDE / 2, end, dimension)]
    anchored = ["start"] if bonded else ["start", "end"]
    made = case(
        dimension,
        [box("top", 0.0, HIGH, dimension, fixed=True), box("b", 0.0, 0.0, dimension)],
        bars={"rod": bar},
        reinforcement=[{"id": "r", "bar": "rod", "path": path, "anchored": anchored, "element": 0.02}],
        analysis={"kind": "gravity", "kinematics": "fixed"},
    )
    lever = HIGH / 2 - end if not bonded else -((HIGH + end) / 2 - HIGH / 2)
    assert stress_of(made, "b")[-1, -1] == pytest.approx(-WEIGHT * lever / (AREA * HIGH), rel=0.02)


def test_a_load_that_follows_its_block_goes_along_with_its_arm():
    """A block on two props of unequal softness turns; a load at its top that turns with it keeps its own dyad."""
    from dem_cli.core.model.first_moments import first_moments, of_loads
    from dem_cli.core.model.following_loads import FollowingLoads

    arm, force, angle = np.array([[0.1, 0.3]]), np.array([[2.0, -7.0]]), 0.4
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    class Loaded:
        n_blocks, live_first_moments = 1, np.zeros((1, 3))
        dead_first_moments = first_moments(arm, force)
        following = FollowingLoads(np.array([0]), arm, force, np.array([True]), np.array([True]))

    found = of_loads(Loaded, np.array([[angle]]), 0.5, 2.0)
    moved, now = arm[0] @ turn.T, force[0] @ turn.T
    dyad = 0.5 * 0.5 * (np.outer(now, moved) + np.outer(moved, now))
    assert tensors(found)[0] == pytest.approx(dyad, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_components_and_tensors_are_each_other_s_inverse(dimension):
    drawn = np.random.default_rng(3).normal(size=(4, 3 * (dimension - 1)))
    assert np.array_equal(components(tensors(drawn)), drawn)
