"""How far structures lean over elastic joints, against sums in closed form; the stiffness that follows from it."""

from __future__ import annotations

import numpy as np
import pytest
from engine import Scene, block, rectangle, scene, simulation, tables

from dem_cli.core.engine.automatic_stiffness import leaning, needed_ratio, ratio_of, shown_closure
from dem_cli.core.engine.settings import DEFAULT

RATIO = DEFAULT.stiffness.statics
RESOLUTION = 0.002
BASE = block("base", rectangle(-1, -1, 9, 0), fixed=True)


def stack(blocks: int, width: float, height: float, left: float = 0.0, name: str = "b") -> list[dict]:
    """Blocks one on the other, from y = 0."""
    places = [i * height for i in range(blocks)]
    return [block(f"{name}{i}", rectangle(left, y, left + width, y + height)) for i, y in enumerate(places)]


def share(blocks: int, width: float, height: float, side: float | None = None, ratio: float = RATIO) -> float:
    """Σ (W y)² / K / (W₀ y₀) of a stack of weight 1 a block, K = kn A c²/4, kn of `stiffness_scale`; 1 m thick."""
    kn = ratio / (np.sqrt(width * height) * min(width, height))
    stiffness = kn * width * (side or width) ** 2 / 4.0
    moments = np.arange(1, blocks + 1) ** 2 * 0.5 * height
    return float((moments**2).sum() / stiffness / moments[-1])


@pytest.mark.parametrize(("blocks", "width", "height"), [(1, 1.0, 1.0), (5, 1.0, 0.5), (30, 0.5, 1.0)])
def test_a_stack_leans_as_the_sum_says(blocks, width, height):
    sim = simulation(tables(BASE, *stack(blocks, width, height)), "large", RATIO)
    assert leaning(sim) == pytest.approx(share(blocks, width, height), rel=1e-9)


@pytest.mark.parametrize(
    ("pushed", "side"),
    [([1.0, 0.0, 0.0], 0.5), ([0.0, 1.0, 0.0], 0.3), ([3.0, 4.0, 0.0], np.hypot(0.5 * 0.6, 0.3 * 0.8)), (None, 0.3)],
)
def test_a_stack_in_space_leans_where_it_is_pushed(pushed, side):
    """Feet c × d of 0.5 m × 0.3 m: Σ k (r·e)² = kn c d (c² e_x² + d² e_y²)/4, of the worst e without a live load."""
    stones = [
        {"id": f"b{i}", "polygon": rectangle(0.0, i, 0.5, i + 1.0), "y": [0.0, 0.3], "fixed": i == 0} for i in range(6)
    ]
    live = {"load": [{"block": "b5", "force": pushed, "kind": "live"}], "analysis": {"pattern": "live"}}
    case = {**tables(*stones), "dimension": 3, **(live if pushed else {"analysis": {"kind": "gravity"}})}
    sim = simulation(case, "fixed", RATIO)
    moments = np.arange(1, 6) ** 2 * 0.5
    stiffness = RATIO / (0.15 ** (2 / 3) * 0.3) * 0.15 * side**2 / 4.0
    assert leaning(sim) == pytest.approx(float((moments**2).sum() / stiffness / moments[-1]), rel=1e-9)


def test_many_courses_lean_as_the_third_power():
    """n³ h W / 10 K, in the limit."""
    kn = RATIO / (np.sqrt(0.5) * 0.5)
    assert share(400, 0.5, 1.0) == pytest.approx(400**3 / (10.0 * kn * 0.5 * 0.5**2 / 4.0), rel=1e-2)


def profiled(courses: int) -> Scene:
    profile = {"sides": 3, "lengths": [0.016, 0.008, 0.016], "aperture": 1e-4}
    column = {"kind": "column", "block": [0.04, 0.0175], "courses": courses, "base_extension": 0.02, "thickness": 1.0}
    return scene(tables(structure=[column], joints={"dry": {"friction": 0.6, "profile": profile}}))


def test_a_profile_stands_on_its_middle_side():
    case = profiled(14).case.model_dump(by_alias=True, exclude_none=True, exclude_unset=True)
    sim = simulation(case, "large", RATIO)
    assert leaning(sim) == pytest.approx(share(14, 0.04, 0.0175, side=0.008), rel=1e-6)


def test_each_structure_counts_by_itself():
    """A stack beside it changes nothing, whatever they stand on; the one that leans most counts."""
    tall, low = stack(20, 0.5, 0.5), stack(3, 0.5, 0.5, left=4.0, name="low")
    alone = leaning(simulation(tables(BASE, *tall), "large", RATIO))
    assert leaning(simulation(tables(BASE, *low, *tall), "large", RATIO)) == pytest.approx(alone, rel=1e-12)


def test_given_stiffness_is_no_matter_of_ours():
    joints = {"dry": {"friction": 0.6, "kn": 1e7}}
    sim = simulation(tables(BASE, *stack(30, 0.5, 1.0), joints=joints), "large", RATIO)
    assert leaning(sim) == ratio_of(sim) == 0.0
    assert needed_ratio(sim) == 0.0


def test_stiffness_grows_with_what_leans():
    case = tables(BASE, *stack(100, 0.5, 1.0))
    sim = simulation(case, "large", RATIO)
    assert ratio_of(sim) == pytest.approx(RATIO, rel=1e-12)
    for resolution, allowed in ((RESOLUTION, DEFAULT.stiffness.leaning), (None, DEFAULT.stiffness.leaning_at_once)):
        needed = needed_ratio(simulation(tables(BASE, *stack(30, 0.5, 1.0)), "large", RATIO), resolution)
        assert needed == pytest.approx(max(RATIO, RATIO * share(30, 0.5, 1.0) / allowed), rel=1e-9)
    needed = needed_ratio(sim, RESOLUTION)
    assert needed == pytest.approx(RATIO * share(100, 0.5, 1.0) / DEFAULT.stiffness.leaning, rel=1e-9)
    assert leaning(simulation(case, "large", needed)) == pytest.approx(DEFAULT.stiffness.leaning, rel=1e-9)


def test_joints_that_bond_lean_by_less_than_the_resolution():
    """Their closure is not taken back (core/engine/rigid_joints.py)."""
    joints = {"dry": {"law": "mohr-coulomb", "friction": 0.6, "cohesion": 1e5}}
    sim = simulation(tables(BASE, *stack(30, 0.5, 1.0), joints=joints), "large", RATIO)
    assert not sim.takes_back
    allowed = DEFAULT.relief.of_resolution * RESOLUTION
    assert ratio_of(sim) * leaning(sim) / needed_ratio(sim, RESOLUTION) == pytest.approx(allowed, rel=1e-9)


def test_round_off_is_the_limit():
    """A stack of 500: 2e9 were needed; forces balance to 0.3e-5 of the weight with what round-off allows."""
    sim = simulation(tables(BASE, *stack(500, 0.5, 1.0)), "large", RATIO)
    wanted = RATIO * share(500, 0.5, 1.0) / DEFAULT.stiffness.leaning
    tolerance = DEFAULT.stiffness.noise * DEFAULT.relaxation.tolerance
    assert needed_ratio(sim, RESOLUTION) == pytest.approx(tolerance * 0.5 / (np.finfo(float).eps * 500.0))
    assert needed_ratio(sim, RESOLUTION) < 1e-2 * wanted


def test_closure_shown_costs_less_than_the_resolution():
    sim = simulation(tables(BASE, *stack(30, 0.5, 1.0)), "large", RATIO)
    sim.leans = leaning(sim)
    for resolution in (RESOLUTION, 1e-4):
        shown = shown_closure(sim, resolution)
        assert shown * leaning(sim) <= DEFAULT.relief.of_resolution * resolution * (1 + 1e-12)
        assert shown <= DEFAULT.relief.shown
    assert shown_closure(sim) == DEFAULT.relief.shown
