"""Vaults in space: a barrel is its arch, a dome is as thin as lunes may be, stones that bind carry hoops."""

from __future__ import annotations

import numpy as np
import pytest
from engine import solve
from oracle.limit_lp import limit_load
from oracle.lune import FacetedDome, least_thickness
from studies.vaults import hoops, thrust

from dem_cli.core.geometry import polygon
from dem_cli.masonry.structures.bridge import Bridge, build

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
    """Stones that lie across the heads below them carry hoop tension: the same ones, far thinner than lunes, stand."""
    for bond, stands in (("stack", False), ("running", True)):
        table = DOME | {"bond": bond, "thickness": 0.02, "per_course": 24, "facets": 48}
        summary, _ = solve(case(table, dimension=3, analysis={"kind": "gravity"}))
        assert (summary["status"] == "ok") == stands


def test_hoops_of_a_hemisphere_change_sign_where_the_membrane_says():
    """Elastic joints: 51.8° from the crown, and the membrane's force within 3 % of ρ g t R from 20° to 75°."""
    found = hoops.hoop_forces(*hoops.KINDS["joints that carry tension"])
    angles, forces = np.array(found["angles"]), np.array(found["forces"])
    assert hoops.change_of_sign(found["angles"], found["forces"]) == pytest.approx(hoops.CHANGE, abs=0.1)
    between = (angles > 20.0) & (angles < 75.0)
    assert np.abs(forces - hoops.membrane(np.radians(angles)))[between].max() < 0.03


def test_hoops_of_a_dry_hemisphere_open_below():
    found = hoops.hoop_forces(*hoops.KINDS["dry, in bond"])
    angles, forces = np.array(found["angles"]), np.array(found["forces"])
    assert np.abs(forces[angles > hoops.CHANGE]).max() < 1e-6
    assert forces[angles < 48.0].min() > 0.0


@pytest.mark.parametrize(("joint", "thrust_found"), [({"points": "vertices"}, 0.1315), ({}, 0.1325)])
def test_groin_and_cloister_vaults_push_their_supports_alike_within_what_statics_allows(joint, thrust_found):
    """With friction at the corners of joints, and with that of a spread pressure."""
    found = thrust.measure((0.4,), **joint)
    row = found["rows"][0]
    assert row["status"] == "ok"
    for force in row["supports"].values():
        assert force[2] == pytest.approx(-0.25, abs=2e-4)
        for k in (0, 1):
            assert abs(force[k]) == pytest.approx(thrust_found, abs=5e-4)
            assert row["range"][0] < abs(force[k]) < row["range"][1]
    row = found["cloister"][0]
    assert row["status"] == "ok"
    sliding = 0.5 * np.tan(np.arctan(thrust.FRICTION) + np.radians(20.0))  # two walls carry it all, on beds of 20°
    assert 2.0 * row["range"][1] == pytest.approx(sliding, rel=1e-4)
    for name, force in row["supports"].items():
        across = 0 if name.endswith(("east", "west")) else 1
        assert force[2] == pytest.approx(-0.25, abs=2e-4)
        assert abs(force[1 - across]) < 2e-4
        assert 2.0 * row["range"][0] < abs(force[across]) < 2.0 * row["range"][1]


@pytest.mark.parametrize("number", [4, 6, 9])
def test_an_axle_on_a_bridge_is_what_limit_analysis_says(number):
    """Four hinges: a linear program that shares nothing with `dem` gives the same load, to the width of the bracket."""
    keys = {"span": 6.0, "rise": 1.5, "ring": 0.45, "voussoirs": 15}
    blocks = build(Bridge.model_validate(keys))
    load = {"block": f"bridge-arch-1-{number}", "force": [0.0, -1000.0], "kind": "live"}
    analysis = {"kind": "pushover", "pattern": "live", "resolution": 1e-3}
    summary, _ = solve(case({"kind": "bridge"} | keys, dimension=2, load=[load], analysis=analysis))
    shapes = [block.parts[0] for block in blocks]
    live = np.zeros((len(blocks), 3))
    live[[block.id for block in blocks].index(f"arch-1-{number}"), 1] = -1000.0
    weights = [2200.0 * 9.81 * polygon.area(shape) for shape in shapes]
    exact = limit_load(shapes, [block.fixed for block in blocks], 0.7, weights=weights, live=live).multiplier
    low, high = summary["failure_load_bracket"]
    assert 0.5 * (low + high) == pytest.approx(exact, rel=1e-3)
