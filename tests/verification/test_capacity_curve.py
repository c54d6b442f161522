"""Capacity curves under displacement control against closed forms: blocks that slide or rock, 2D, 3D and a table."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, solve, tables

from dem_cli.statics.bilinear import bilinear

BASE = block("base", rectangle(-2, -1, 3, 0), fixed=True)


def controlled(follow: float, *blocks: dict, friction: float = 0.6, kn: float | None = None, **analysis) -> dict:
    joint = {"friction": friction} | ({} if kn is None else {"kn": kn, "ks": kn, "points": 5})
    keys = {"control": "displacement", "follow": follow, "increments": 40, **analysis}
    return tables(BASE, *blocks, joints={"dry": joint}, analysis=keys)


def curve_of(summary: dict) -> tuple[np.ndarray, np.ndarray]:
    found = summary["capacity_curve"]
    return np.array(found["displacements"]), np.array(found["loads"])


@pytest.mark.parametrize("pattern", ["mass", "tilt"])
def test_a_block_that_slides(pattern):
    """Elastic with the stiffness of its joint, then flat at μ; the bilinear system is the curve."""
    kn, weight = 2e8, 2000.0 * 9.81
    summary, _ = solve(controlled(0.002, block("b", rectangle(0, 0, 1, 0.2)), kn=kn, pattern=pattern))
    u, loads = curve_of(summary)
    assert summary["status"] == "ok"
    assert summary["failure_load"] == pytest.approx(0.6, rel=2e-3)
    assert loads.max() == pytest.approx(0.6, rel=2e-4)  # at rest: 1e-4 of the own weight unbalanced
    assert loads[-1] == pytest.approx(0.6, rel=2e-4)
    system = bilinear(u, loads)
    if pattern == "mass":
        top = 1.0 + 3 * 0.1**2 / 0.5**2  # a push at half of the height turns the block on its joint, h/2 over it
        assert system.stiffness * 0.2 * weight == pytest.approx(kn / top, rel=0.01)  # the windward points slip first
    assert system.yield_load == pytest.approx(0.6, rel=2e-3)


def test_a_block_that_rocks():
    """λ = tan(α − θ) over its whole way: peak b/h, nothing where its centre is over its corner."""
    width, height = 0.2, 1.0
    summary, records = solve(controlled(0.09, block("b", rectangle(0, 0, width, height)), friction=2.0))
    u, loads = curve_of(summary)
    assert summary["failure_load"] == pytest.approx(width / height, rel=2e-3)
    lean = np.arctan2(width, height)
    radius = np.hypot(width, height) / 2.0
    turned = lean - np.arcsin(np.clip(np.sin(lean) - u / radius, -1.0, 1.0))
    rocks = u > 1e-3  # before, its joint opens
    assert rocks.sum() > 20
    assert loads[rocks] == pytest.approx(np.tan(lean - turned[rocks]), abs=2e-4)
    assert summary["capacity_curve"]["whole"]
    assert abs(summary["energy_closure"]) < 1e-3
    stages = [row.stage for row in records.rows]
    assert stages == sorted(stages, key=["gravity", "loading", "collapse"].index)
    assert "collapse" in stages


def test_to_and_fro():
    """The loop of a block that slides on an elastic joint: friction takes 4 μ W (u − 2 μ W/k) per cycle between ±u."""
    kn, far, weight = 2e8, 0.002, 0.2 * 2000.0 * 9.81
    path = [far, -far, far]
    keys = {"kind": "cycle", "control": "displacement", "path": path, "step": 2e-4}
    joint = {"friction": 0.6, "kn": kn, "ks": kn, "points": 5}
    case = tables(BASE, block("b", rectangle(0, 0, 1, 0.2)), joints={"dry": joint}, analysis=keys)
    summary, records = solve(case)
    loads = [point["load"] for point in summary["turning_points"]]
    assert loads == pytest.approx([0.6, -0.6, 0.6], rel=2e-4)
    assert [point["controlled"] for point in summary["turning_points"]] == path
    elastic = 0.6 * weight / (kn / (1.0 + 3 * 0.1**2 / 0.5**2))
    ways = (far - elastic) + 2 * (2 * far - 2 * elastic)
    assert records.rows[-1].energy.friction == pytest.approx(0.6 * weight * ways, rel=1e-3)


def test_a_block_that_rocks_to_and_fro():
    """On joints of "auto" stiffness: tan(α − θ) to either side, as geometry moves without being told to."""
    keys = {"kind": "cycle", "control": "displacement", "path": [0.04, -0.04], "step": 0.02}
    case = tables(BASE, block("b", rectangle(0, 0, 0.5, 1.0)), joints={"dry": {"friction": 1.0}}, analysis=keys)
    summary, _ = solve(case)
    lean, radius = np.arctan2(0.5, 1.0), np.hypot(0.5, 1.0) / 2.0
    exact = np.tan(np.arcsin(np.sin(lean) - 0.04 / radius))
    assert [point["load"] for point in summary["turning_points"]] == pytest.approx([exact, -exact], rel=2e-3)
    assert summary["status"] == "ok"


def test_a_peak_beyond_the_end_is_said():
    summary, _ = solve(controlled(1e-6, block("b", rectangle(0, 0, 0.2, 1)), friction=2.0))
    assert any("still rises where it ends" in line for line in summary["warnings"])


def test_the_curve_of_a_rocking_block_is_idealised():
    """A curve that falls in a straight line from its peak: ultimate displacement at a fifth of the way down."""
    u = np.concatenate([np.linspace(0.0, 0.01, 50), np.linspace(0.01, 0.1, 50)[1:]])
    loads = np.where(u <= 0.01, 20.0 * u, 0.2 * (0.1 - u) / 0.09)
    system = bilinear(u, loads)
    assert system.softened
    assert system.ultimate_displacement == pytest.approx(0.01 + 0.2 * 0.09)
    assert system.stiffness == pytest.approx(20.0)
    area = 0.5 * 0.01 * 0.2 + 0.5 * (0.2 + 0.16) * 0.2 * 0.09
    taken = system.yield_load * (system.ultimate_displacement - system.yield_displacement / 2.0)
    assert taken == pytest.approx(area, rel=1e-9)
    assert not bilinear(u[:55], loads[:55]).softened
    assert bilinear(u, -loads) is None


@pytest.mark.parametrize("kind", ["pushover", "cycle"])
def test_a_live_load_that_cancels_itself_moves_nothing(kind):
    pushes = [{"block": "b", "force": [force, 0.0], "kind": "live"} for force in (1e3, -1e3)]
    keys = {"pushover": {"follow": 0.01}, "cycle": {"path": [0.01], "step": 0.001}}[kind]
    keys = {"kind": kind, "control": "displacement", "pattern": "live"} | keys
    case = tables(BASE, block("b", rectangle(0, 0, 0.2, 1)), load=pushes, analysis=keys)
    summary, _ = solve(case)
    assert summary["status"] == "not converged"
    assert any("the live load moves nothing" in line for line in summary["warnings"])


@pytest.mark.parametrize(("tension", "holds"), [(None, True), (2e4, False)])
def test_a_peak_that_hangs_on_the_stiffness_says_so(tension, holds):
    """A joint that softens as it opens: stiff ones carry W b/2 + ft b²/2, on "auto" ones it has opened at the peak."""
    case = controlled(0.005, block("b", rectangle(0, 0, 0.7, 1.75)), friction=1.0)
    if tension is not None:
        energies = {"fracture_energy_tension": 20.0, "fracture_energy_shear": 100.0}
        case["joints"]["dry"] |= {"law": "fracture", "tension": tension, "cohesion": 3e4} | energies
    summary, _ = solve(case)
    assert summary["status"] == "ok"
    assert summary["softer_joints_hold"] is holds
    assert any("on joints 10 times as soft" in line for line in summary["warnings"]) is not holds
