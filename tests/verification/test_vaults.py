"""Vaults in space: a barrel is its arch, a dome is as thin as lunes may be, stones that bind carry hoops."""

from __future__ import annotations

import pytest
from engine import solve
from oracle.lune import FacetedDome, least_thickness

STONE = {"materials": {"stone": {"density": 2200.0}}}
ARCH = {"kind": "arch", "voussoirs": 15, "inner_radius": 2.0, "ring": 0.4}
BARREL = {"kind": "vault", "shape": "barrel", "span": 4.0, "length": 3.0, "thickness": 0.4, "voussoirs": 15, "rows": 2}
ON_WALLS = {"kind": "arch", "voussoirs": 9, "inner_radius": 1.0, "ring": 0.25, "thickness": 0.5}
DOME = {"kind": "vault", "shape": "dome", "radius": 1.0, "thickness": 0.05, "courses": 12, "per_course": 12}


def case(*structures: dict, friction: float = 0.7, **tables) -> dict:
    return STONE | {"structure": list(structures), "joints": {"dry": {"friction": friction}}} | tables


def test_a_barrel_carries_what_its_arch_does():
    """A share of the weight sideways, found to 0.02 %: the same in the plane and in space, heads staggered or not."""
    found = []
    for dimension, table in ((2, ARCH), (3, BARREL), (3, BARREL | {"offset": 0.0})):
        analysis = {"kind": "pushover", "direction": [1.0, 0.0, 0.0][:dimension], "resolution": 2e-4}
        summary, _ = solve(case(table, dimension=dimension, analysis=analysis))
        low, high = summary["failure_load_bracket"]
        assert summary["failure_mode"] == "rocking"
        found.append(0.5 * (low + high))
    assert found[1:] == pytest.approx(2 * [found[0]], rel=1e-4)


def pushed(dimension: int, *structures: dict) -> float:
    analysis = {"kind": "pushover", "direction": [1.0, 0.0, 0.0][:dimension], "resolution": 1e-3}
    summary, _ = solve(case(*structures, dimension=dimension, analysis=analysis))
    assert summary["status"] == "ok"
    return sum(summary["failure_load_bracket"]) / 2.0


def test_an_arch_stands_on_walls_of_others():
    """Two walls and an arch without a base carry what the same arch with columns of its own does, in 2D and in 3D."""
    own = pushed(2, ON_WALLS | {"columns": {"width": 0.6, "height": 1.0, "courses": 4}})
    wall = {
        "kind": "wall",
        "block": [0.6, 0.25],
        "courses": 4,
        "blocks_per_course": 1,
        "bond": "stack",
        "thickness": 0.5,
    }
    for dimension in (2, 3):
        away = [0.0] * (dimension - 1)
        left, right = (wall | {"id": side, "origin": [x, *away]} for side, x in (("left", -1.6), ("right", 1.0)))
        arch = ON_WALLS | {"base": False, "origin": [*away, 1.0]}
        assert pushed(dimension, left, right, arch) == pytest.approx(own, rel=1e-3)


def test_a_dome_of_lunes_is_as_thin_as_theirs():
    """Heads above heads: twelve lunes side by side. Forces in equilibrium exist down to 0.042392 of the radius."""
    exact = least_thickness(FacetedDome(12, 12, 0.7))
    assert exact == pytest.approx(0.042392, abs=2e-6)
    table = DOME | {"bond": "stack"}
    analysis = {"kind": "safety", "vary": "structure.0.thickness", "between": [0.03, 0.06], "resolution": 0.002}
    summary, _ = solve(case(table, dimension=3, analysis=analysis))
    low, high = sorted(summary["critical_value_bracket"])
    assert low < exact < high
    assert high - low < 0.0021 * exact


def test_lunes_of_the_fine_limit():
    """Heyman's hemisphere: 0.042; 150 courses and 200 lunes: 0.04284, with hoops or without, whatever the friction."""
    fine = [
        least_thickness(FacetedDome(100, 100, friction, hoops=hoops)) for friction, hoops in ((0.3, True), (9, False))
    ]
    assert fine == pytest.approx(2 * [0.0428], abs=1e-4)
    assert least_thickness(FacetedDome(32, 64, 0.22)) > 0.06  # the springing slides


def test_a_bonded_dome_is_held_by_friction_in_its_beds():
    """Stones that lie across the heads below them carry hoop tension: half as thick as lunes, it stands."""
    for bond, stands in (("stack", False), ("running", True)):
        summary, _ = solve(case(DOME | {"bond": bond, "thickness": 0.03}, dimension=3, analysis={"kind": "gravity"}))
        assert (summary["status"] == "ok") == stands
