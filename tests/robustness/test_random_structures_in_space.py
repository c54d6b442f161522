"""Random structures in space: bounds and ways of looking at a structure that cannot change its failure load."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from engine import solve
from studies.space.structures import box, mapped, mirrored, quarter, solid, tables, towards

RESOLUTION = 0.002  # of analysis, the default
TWISTED = 0.006  # joints that twist: the path takes the centre of pressure of the state before, the run that of now
GROUND = box("ground", (-3.0, -3.0, -0.3), (3.0, 3.0, 0.0), fixed=True)
AWAY = np.array([1e4, -1e4, 1e3])


def drums(rng: np.random.Generator) -> list[dict]:
    """Tapered drums with different numbers of sides, turned against each other, joints inclined by up to 8°."""
    blocks, bottom, slope, radius, n = [GROUND], 0.0, np.zeros(2), rng.uniform(0.35, 0.6), int(rng.integers(2, 5))
    for k in range(n):
        angles = rng.uniform(0.0, 6.0) + 2.0 * np.pi * np.arange(sides := rng.integers(3, 10)) / sides
        foot = radius * np.column_stack([np.cos(angles), np.sin(angles)])
        top, narrower = bottom + rng.uniform(0.25, 0.5), rng.uniform(0.85, 1.0)
        above = rng.uniform(-0.1, 0.1, 2) if k < n - 1 else np.zeros(2)
        head = narrower * foot
        corners = np.vstack([np.c_[foot, bottom + foot @ slope], np.c_[head, top + head @ above]])
        blocks.append(solid(f"drum-{k}", corners))
        bottom, slope, radius = top, above, narrower * radius
    return blocks


def arch(rng: np.random.Generator) -> list[dict]:
    """A barrel of few voussoirs on a skew plan between fixed springers."""
    n, ring, width, skew = (
        int(rng.integers(3, 7)),
        rng.uniform(0.25, 0.4),
        rng.uniform(0.3, 0.8),
        rng.uniform(-0.4, 0.4),
    )
    half = rng.uniform(0.9, 1.4)
    angles = np.pi / 2.0 + np.concatenate([[-half - 0.2], np.linspace(-half, half, n + 1), [half + 0.2]])
    blocks = []
    for k, pair in enumerate(zip(angles, angles[1:], strict=False)):
        corners = [
            (r * np.cos(a) + skew * y, y, r * np.sin(a)) for y in (0.0, width) for r in (1.0, 1.0 + ring) for a in pair
        ]
        blocks.append(solid(f"voussoir-{k}", corners, fixed=k in (0, n + 1)))
    return blocks


def case_of(kind: Callable[[np.random.Generator], list[dict]], seed: int, **joint) -> dict:
    rng = np.random.default_rng([16, seed])
    found = tables(*kind(rng), friction=float(rng.choice([0.4, 0.6, 0.8])), direction=towards(rng.uniform(0.0, 360.0)))
    found["analysis"]["limit"] = True
    for own in found["joints"].values():
        own.update(joint)
    return found


def far_away(case: dict) -> dict:
    return mapped(case, lambda points: points + AWAY, lambda directions: directions)


def shuffled(case: dict) -> dict:
    """Blocks and their corners in another order."""
    rng = np.random.default_rng(1)
    blocks = [{**block, "vertices": rng.permutation(block["vertices"]).tolist()} for block in case["block"]]
    return {**case, "block": [blocks[i] for i in rng.permutation(len(blocks))]}


def bracket(case: dict) -> tuple[float, float, dict]:
    summary, _ = solve(case)
    assert summary["status"] == "ok", summary["warnings"]
    assert summary["load_range"] is None
    return (*summary["failure_load_bracket"], summary["limit_analysis"])


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", [drums, arch])
def test_one_load_whatever_the_method_and_the_point_of_view(kind, seed):
    """Below the bound of joints that dilate; with the zero-dilation path; mirrored, turned, moved, shuffled."""
    case = case_of(kind, seed, points="vertices")
    low, high, limits = bracket(case)
    assert low <= limits["associated_bounds"][1] * (1.0 + 1e-6)
    assert (1.0 - RESOLUTION) * low <= limits["non_associated"] <= (1.0 + RESOLUTION) * high
    for change in (mirrored, quarter, far_away, shuffled):
        other_low, other_high, _ = bracket(change(case))
        assert max(low, other_low) <= min(high, other_high) * (1.0 + 0.5 * RESOLUTION), change.__name__


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", [drums, arch])
def test_joints_that_twist_carry_less_than_the_bound_and_what_the_path_carries(kind, seed):
    """Default joints: run and path are two histories of joints that twist, and the run says where they differ."""
    summary, _ = solve(case_of(kind, seed))
    limits, (low, high) = summary["limit_analysis"], summary["failure_load_bracket"]
    assert low <= limits["associated_bounds"][1] * (1.0 + 1e-6)
    assert (1.0 - TWISTED) * low <= limits["non_associated"] <= (1.0 + TWISTED) * high
    off = not (1.0 - RESOLUTION) * low <= limits["non_associated"] <= (1.0 + RESOLUTION) * high
    assert not off or any("methods differ" in text for text in summary["warnings"])


@pytest.mark.parametrize("off", [5e-8, 1e-7, 3e-7])
def test_a_corner_that_touches_within_tolerance_carries(off):
    """A foot of which one corner is rounded: of its two triangles one alone would carry, and no push at all."""
    block = box("block", (0.0, 0.0, 0.0), (0.6, 0.4, 0.5))
    corners = np.array(block["vertices"])
    corners[(corners == (0.6, 0.4, 0.0)).all(axis=1), 2] += off
    block["vertices"] = corners.tolist()
    summary, _ = solve(tables(GROUND, block, friction=2.0, direction=(1.0, 0.0, 0.0)))
    assert summary["contacts"] == 4
    assert summary["failure_load"] == pytest.approx(0.3 / 0.25, rel=1e-4)
