"""Blocks in space that are moved slowly: collapses, settlements, load paths and gaps, by hand and as planar twins."""

from __future__ import annotations

import math

import numpy as np
import pytest
from casefiles import CASES, read
from engine import Records, simulation, solve
from scipy.spatial.transform import Rotation
from studies.space.structures import bonded_barrel, box, corner_wall, prism, solid, tables
from synthetic.spatial_case import extruded_tables

from dem_cli.core.kernels import records as slot

CLOSED = 1e-3  # energy error over the largest energy of a collapse or a settlement
BASE = box("base", (-1.0, -1.0, -0.5), (1.0, 1.0, 0.0), fixed=True)


def settled(blocks: list[dict], *supports: dict, **more) -> dict:
    """A case in which supports move."""
    return tables(*blocks, analysis={"kind": "settlement"}, settlement=list(supports), **more)


def of_block(name: str) -> list[dict]:
    """Monitors of the displacement and of the rotation of a block, component by component."""
    return [{"block": name, "quantity": q, "component": c} for q in ("displacement", "rotation") for c in "xyz"]


def solved(case: dict, closed: float = CLOSED) -> tuple[dict, Records]:
    """A run whose energy closes, areas of contact points included."""
    summary, seen = solve(case)
    assert summary["status"] == "ok", summary["warnings"]
    assert abs(summary["energy_closure"]) < closed
    return summary, seen


def test_a_prism_follows_the_load_of_statics_over_its_oblique_edge():
    """Turned by θ it stands at λ = tan(α − θ), tan α = 0.115766 / 0.5: all along the curve within 0.5 % of tan α.

    The joints of the curve give: the edge sinks by 0.16 mm of 116 mm (0.14 %), and a creep has inertia.
    """
    case = read(CASES / "verification" / "space" / "prism_oblique_edge.toml")
    case["analysis"]["follow"] = 0.08
    summary, seen = solved(case, 1e-5)
    arm, half = 0.7 * 0.4 / (3.0 * math.hypot(0.7, 0.4)), 0.5
    size, alpha = math.hypot(arm, half), math.atan2(arm, half)
    rows = [row for row in seen.rows if row.stage == "collapse"]
    moved, loads = np.array([row.displacement for row in rows]), np.array([row.load for row in rows])
    exact = np.tan(alpha - 2.0 * np.arcsin(0.5 * moved / size))
    assert len(rows) > 20
    assert moved[-1] > 0.079
    assert np.abs(loads - exact).max() < 5e-3 * math.tan(alpha)
    assert summary["failure_mode"] == "rocking"
    assert summary["after_collapse"]["moved_blocks"]["first"] == ["prism"]


def test_a_support_takes_along_what_stands_on_it():
    """Three displacements and a turn of 20.3° about an oblique axis: all that stands on it moves as one with it.

    It is joints that give: the drums creep by some 1e-5 m, for the way of 0.08 m.
    """
    moved, turned = np.array([0.03, -0.02, 0.01]), np.array([2.0, -3.0, 20.0])
    drums = [box(f"b{i}", (-0.25, -0.15, 0.4 * i), (0.25, 0.15, 0.4 * i + 0.4)) for i in range(3)]
    support = {"block": "base", "displacement": moved.tolist(), "rotation_deg": turned.tolist()}
    _, seen = solved(settled([BASE, *drums], support, monitor=of_block("b2")))
    turn, arm = Rotation.from_rotvec(np.radians(turned)), np.array([0.0, 0.0, 1.25])  # from the middle of the support
    found = np.array(seen.rows[-1].monitors)
    assert found[:3] == pytest.approx(turn.apply(arm) - arm + moved, abs=2e-5)
    assert found[3:] == pytest.approx(turn.as_rotvec(), abs=2e-6)


def test_a_settling_arch_is_that_of_the_plane_whichever_way_it_stands():
    """The arch of settlement_portal.toml as prisms, along x and at 33° in plan, the support turning as well."""
    flat = read(CASES / "verification" / "settlement_portal.toml")
    flat.pop("reference")
    flat["settlement"][0]["rotation_deg"] = -0.5
    moved, turned_3, turned_4 = solved(flat)[1].rows[-1].monitors
    for azimuth in (0.0, 33.0):
        space = extruded_tables(flat)
        turn = Rotation.from_euler("z", azimuth, degrees=True)
        space["structure"][0]["rotation_deg"] = azimuth
        support = space["settlement"][0]
        support["displacement"] = turn.apply(support["displacement"]).tolist()
        support["rotation_deg"] = turn.apply(support["rotation_deg"]).tolist()
        space["monitor"] = of_block("arch-3") + of_block("arch-4")
        found = np.array(solved(space)[1].rows[-1].monitors)
        assert found[2] == pytest.approx(moved, abs=2e-6)  # joints deform by 1.5 µm each
        for at, planar in ((3, turned_3), (9, turned_4)):
            assert turn.inv().apply(found[at : at + 3]) == pytest.approx([0.0, -planar, 0.0], abs=2e-5)


@pytest.mark.parametrize("name", ["wall_21", "arch_21_mu040", "stack_bond_mu030"])
def test_twins_collapse_as_walls_and_arches_of_the_plane(name):
    """Sliding and hinges together: load by 1e-4, peak of the curve by 2 %, the mode and where it ends by 3 %.

    The curves creep on joints of other stiffness: "auto" goes by the size of faces in space, of edges in the plane.
    """
    flat = read(CASES / "verification" / f"{name}.toml")
    flat.pop("reference")
    (plane, planar), (space, spatial) = solved(flat), solved(extruded_tables(flat))
    assert space["failure_load"] == pytest.approx(plane["failure_load"], rel=1e-4)
    assert space["failure_mode"] == plane["failure_mode"]
    assert space["peak_of_curve"] == pytest.approx(plane["peak_of_curve"], rel=0.02)
    assert spatial.rows[-1].monitors == pytest.approx(planar.rows[-1].monitors, rel=0.03)


def test_a_wall_turns_over_its_foot_with_geometry_that_moves():
    """Out of plane at t / H = 0.125, and on soft joints at what a stack of the plane carries (P-Δ takes a tenth)."""
    case = read(CASES / "verification" / "space" / "panel.toml")
    case["structure"][0] |= {"courses": 4, "blocks_per_course": 2}
    case["analysis"]["kinematics"] = "large"
    assert solved(case)[0]["failure_load"] == pytest.approx(0.25, rel=2e-3)
    case["structure"][0] |= {"blocks_per_course": 1, "bond": "stack"}
    case["joints"]["dry"] |= {"kn": 1e7, "points": 2}
    stack = {"kind": "column", "block": [0.2, 0.2], "courses": 4, "thickness": 1.0, "base_extension": 0.2}
    flat = {key: case[key] for key in ("materials", "joints", "output")} | {"structure": [stack]}
    flat["analysis"] = {"kind": "pushover", "direction": [1.0, 0.0], "kinematics": "large"}
    (space, _), (plane, _) = solved(case), solved(flat)
    assert plane["failure_load"] < 0.225
    assert space["failure_load"] == pytest.approx(plane["failure_load"], rel=4e-3)  # both brackets


def test_a_load_path_moves_a_twin_as_the_wall_of_the_plane():
    """To and fro on joints of given stiffness: displacements at the turns within 2 %, what stays of them within 5 %.

    What stays is the slip of head joints, which hangs on the steps of pseudo-time.
    """
    flat = read(CASES / "verification" / "wall_21.toml")
    flat.pop("reference")
    flat["joints"]["dry"] |= {"kn": 1e9, "points": 2}
    flat["analysis"] = {
        "kind": "cycle", "direction": [1.0, 0.0], "path": [0.4, -0.4, 0.0], "step": 0.1, "kinematics": "large",
    }  # fmt: skip
    (plane, _), (space, _) = solved(flat), solved(extruded_tables(flat))
    assert [turn["load"] for turn in space["turning_points"]] == [0.4, -0.4, 0.0]
    for one, other in zip(space["turning_points"], plane["turning_points"], strict=True):
        within = 0.02 if one["load"] else 0.05
        assert one["displacement"] == pytest.approx(other["displacement"], rel=within)


def test_a_block_rolls_over_its_cap_there_and_back():
    """The polygon of five sides of the thesis as a cap on a square foot: two rotations move the block by 17.926 mm."""
    flat = read(CASES / "validation" / "block_on_polygon_cycle.toml")
    flat.pop("reference")
    for one in flat["block"]:
        one["thickness"] = 1.0
    turns = solved(extruded_tables(flat))[0]["turning_points"]
    assert [turn["load"] for turn in turns] == [0.8, 0.0, -0.8, 0.0]
    assert [turns[i]["displacement"] for i in (0, 2)] == pytest.approx([0.017926] * 2, rel=2e-3)
    assert [turns[i]["displacement"] for i in (1, 3)] == pytest.approx([0.0, 0.0], abs=4e-5)


def test_a_slab_comes_down_on_its_short_leg():
    """Legs under the corners of a slab, one of them short by g: it turns about the diagonal until the corner rests.

    It stands on the near corners of two legs, (0.9, 0) and (0, 0.9); the corner (0, 0) of the short one is 0.9 / √2
    from there.
    """
    gap, reach = 5e-4, 0.9 / math.sqrt(2.0)
    legs = [
        box(f"leg{i}", (x, y, 0.0), (x + 0.1, y + 0.1, 1.0 - (gap if i == 0 else 0.0)))
        for i, (x, y) in enumerate([(0.0, 0.0), (0.9, 0.0), (0.0, 0.9), (0.9, 0.9)])
    ]
    slab, ground = box("slab", (0, 0, 1.0), (1, 1, 1.1)), box("base", (-0.5, -0.5, -0.5), (1.5, 1.5, 0.0), fixed=True)
    push = {"block": "slab", "force": [0.0, 0.0, -2000.0], "at": [0.1, 0.1, 1.1]}
    case = tables(ground, *legs, slab, analysis={"kind": "gravity"}, load=[push], monitor=of_block("slab"))
    summary, seen = solved(case, 5e-3)  # half a millimetre, in some hundred steps of pseudo-time
    assert "may close" in " ".join(summary["skipped"])
    angle = math.asin(gap / reach)
    expected = angle * np.array([1.0, -1.0, 0.0]) / math.sqrt(2.0)
    assert np.array(seen.rows[-1].monitors[3:]) == pytest.approx(expected, abs=0.02 * angle)


def test_a_corner_of_walls_opens_as_one_of_them_settles():
    """The foot of a leg moves off, sinks and leans outwards: the walls come apart, and stand."""
    t = 0.2
    walls = [one for one in corner_wall() if not one.get("fixed")]
    feet = [
        box("along-x", (-t, -t, -t), (1.2 + t, t, 0.0), fixed=True),
        box("along-y", (-t, t, -t), (2.0 * t, 0.8 + t, 0.0), fixed=True),
    ]
    support = {"block": "along-y", "displacement": [0.0, 0.03, -0.01], "rotation_deg": [-1.5, 0.5, 1.0]}
    summary, _ = solved(settled([*walls, *feet], support))
    state = summary["joint_state"]
    assert state["open"] > 8  # of 74: corners that meet are no joints
    assert 0.02 < state["crack_width"]["value"] < 0.06
    assert abs(summary["reweighting"]["sum"]) < 1.0


def test_a_barrel_spreads_as_an_arch_of_the_plane():
    """Staggered rows of voussoirs over springings that move apart evenly: the crown of all sinks as in the plane."""
    solids = bonded_barrel()
    outline = {one["id"]: np.unique(np.round(np.array(one["vertices"])[:, [0, 2]], 12), axis=0) for one in solids}
    rings = [f"v{k}-0" for k in range(15)] + ["left", "right"]
    arch = [
        {"id": name, "vertices": outline[name].tolist(), "thickness": 1.5, "fixed": name in ("left", "right")}
        for name in rings
    ]
    case = settled(solids, {"block": "right", "displacement": [0.03, 0.0, 0.0]}, friction=0.6)
    case["joints"]["dry"] |= {"kn": 1e9, "points": 2}
    flat = {key: case[key] for key in ("materials", "joints", "analysis", "output")} | {"block": arch}
    flat["settlement"] = [{"block": "right", "displacement": [0.03, 0.0]}]
    flat["monitor"] = [{"block": "v7-0", "component": "y"}]
    case["monitor"] = [{"block": f"v7-{i}", "component": "z"} for i in range(3)]
    (_, planar), (_, spatial) = solved(flat), solved(case)
    assert planar.rows[-1].monitors[0] < -0.01
    assert spatial.rows[-1].monitors == pytest.approx(3 * planar.rows[-1].monitors, rel=2e-3)


def test_a_barrel_twists_with_its_support():
    """A springing that moves out, sinks and turns in plan: the mirror image moves as the mirror image of the run.

    By 2 % of how far it goes: how much slips hangs on the order of joints, whose blocks and tangents are others there.
    """
    way = {"displacement": [0.03, 0.0, -0.01], "rotation_deg": [0.0, 0.0, 0.6]}
    back = {"displacement": [0.03, 0.0, -0.01], "rotation_deg": [0.0, 0.0, -0.6]}
    blocks = bonded_barrel(9)
    other = [solid(b["id"], np.array(b["vertices"]) * (1.0, -1.0, 1.0), fixed=b.get("fixed", False)) for b in blocks]
    found = [
        np.array(solved(settled(solids, {"block": "right"} | moves, monitor=of_block("v4-0")))[1].rows[-1].monitors)
        for solids, moves in ((blocks, way), (other, back))
    ]
    assert abs(found[0][3:]).min() > 1e-4  # it turns about all three axes
    apart = found[1] * (1, -1, 1, -1, 1, -1) - found[0]
    for part in (slice(0, 3), slice(3, 6)):
        assert np.linalg.norm(apart[part]) < 0.02 * np.linalg.norm(found[0][part])


def test_a_state_that_comes_back_goes_on_to_the_same_bytes():
    """Renewal changes what joints are: they are saved as well."""
    stack = [prism(f"b{i}", [(0, 0), (0.7, 0), (0, 0.4)], 0.5 * i, 0.5 * i + 0.5) for i in range(2)]
    sim = simulation(tables(BASE, *stack, direction=(0.4, 0.7, 0.0)), "large", 1e4)
    sim.set_load(0.4)  # above failure
    sim.advance(1000, slot.HOLD_LOAD)
    saved = sim.save()
    ends = []
    for _ in range(2):
        sim.restore(saved)
        sim.advance(500, slot.HOLD_LOAD)
        ends.append((sim.bodies.positions.tobytes(), sim.contacts.normal.tobytes(), sim.joints.kn.tobytes()))
    assert not np.array_equal(sim.joints.kn, saved.joints.kn)
    assert ends[0] == ends[1]
