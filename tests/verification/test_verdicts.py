"""What a run concludes: fails, cannot fail, does not stand, not converged; and what the load is a multiple of."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from casefiles import CASES
from engine import Records, block, moved, rectangle, scene, simulation, solve, tables

from dem_cli.analyses import solve as solver
from dem_cli.core.engine import measures
from dem_cli.core.engine.budget import Budget
from dem_cli.core.kernels import records as slot
from dem_cli.core.statics.compliance import compliance
from dem_cli.core.statics.equilibrium import settle_or_fail, stand

VERIFICATION = CASES / "verification"
QUIET = ("analysis.follow=0.0", "output.frames=0")
BASE = block("base", rectangle(-2, -1, 3, 0), fixed=True)
WEIGHT = 2000.0 * 9.81


def crate(**more) -> dict:
    """A block of 1 × 1 m: slides at μ = 0.6."""
    return tables(BASE, block("b", rectangle(0, 0, 1, 1)), **more)


def test_fails():
    summary, records = solve(crate())
    assert summary["status"] == "ok"
    assert summary["failure_mode"] == "sliding"
    low, high = summary["failure_load_bracket"]
    assert low == summary["failure_load"] == pytest.approx(0.6, rel=1e-4)
    assert low < high <= low * 1.0021
    assert summary["proof_of_failure"]["by"] == "limit analysis"  # at 0.6, above which no forces balance
    assert 0.0 < summary["proof_of_failure"]["released_share_of_work"] <= 1.0
    assert summary["mechanism"]["moving_blocks"] == {"count": 1, "first": ["b"]}
    assert records.rows[0].stage == "gravity"


@pytest.mark.parametrize("resolution", [0.02, 0.002, 0.0005])
def test_bracket_is_as_narrow_as_asked(resolution):
    summary, _ = solve(crate(analysis={"resolution": resolution}))
    low, high = summary["failure_load_bracket"]
    assert 0 < (high - low) / low <= resolution * 1.0001
    assert low <= 0.6 * (1 + 1e-6) <= high * (1 + 1e-4)


def test_a_mechanism_a_little_above_the_failure_load_takes_no_part():
    """Columns that turn over at 1/2 and at 1/2 · 1.001: what shows the failure of one does not move the other."""
    near = tables(
        BASE,
        block("low", rectangle(-1, 0, 0, 2)),
        block("high", rectangle(1, 0, 2, 2 / 1.001)),
        friction=0.9,
        analysis={"direction": [-1.0, 0.0]},
    )
    summary, _ = solve(near)
    assert summary["failure_load_bracket"] == pytest.approx([0.5, 0.5], rel=2e-3)
    assert summary["proof_of_failure"]["by"] == "limit analysis"
    assert summary["mechanism"]["moving_blocks"] == {"count": 1, "first": ["low"]}


@pytest.mark.parametrize("name", ["wall_21_mu075", "stack_bond_mu060"])
def test_failure_is_the_motion_from_where_it_began(name):
    """Where the creep ends in a higher equilibrium than the loads did, that one lies further on than proven failure."""
    records = Records()
    case, model = scene(CASES / "verification" / f"{name}.toml", "analysis.follow=0")
    summary = solver.solve(case, model, records).summary
    assert summary["search"][-1]["state"] == "equilibrium"  # that of the creep, after the failure
    before, after = records.frames[-2:]
    assert (before.stage, after.stage) == ("loading", "collapse")
    moved = after.positions - before.positions
    assert float((model.live_loads[:, :2] * moved).sum()) > 0.0


def test_cannot_fail():
    summary, _ = solve(VERIFICATION / "wedged_block.toml")
    assert summary["failure_load"] is None
    assert summary["failure_mode"] is None
    assert summary["status"] == "no failure up to a load multiplier of 20"
    low, high = summary["failure_load_bracket"]
    assert low >= 20.0
    assert high is None


@pytest.mark.parametrize("max_load", [0.3, 0.59])
def test_does_not_fail_up_to_the_largest_load(max_load):
    summary, _ = solve(crate(analysis={"max_load": max_load}))
    assert summary["failure_load"] is None
    assert summary["status"] == f"no failure up to a load multiplier of {max_load:g}"
    assert summary["failure_load_bracket"][1] is None


@pytest.mark.parametrize("name", ["overhang_falls", "leaning_column"])
def test_does_not_stand(name):
    summary, _ = solve(VERIFICATION / f"{name}.toml")
    assert summary["status"] == "does not stand under its dead loads"
    assert summary.get("failure_load") is None


def crate_over_the_edge(share: float) -> dict:
    """A block of which this share lies beyond the edge of its support."""
    ledge = block("ledge", rectangle(-2, -1, 1 - share, 0), fixed=True)
    return tables(ledge, block("b", rectangle(0, 0, 1, 1)), analysis={"kind": "gravity"})


@pytest.mark.parametrize(("share", "stands"), [(0.49, True), (0.499, True), (0.501, False), (0.51, False)])
def test_stands_up_to_its_balance(share, stands):
    summary, _ = solve(crate_over_the_edge(share))
    assert (summary["status"] == "ok") is stands


def test_not_converged():
    """A tiny budget: says so, keeps the bracket so far, names no failure load."""
    summary, _ = solve(VERIFICATION / "wall_21.toml", *QUIET, "analysis.max_steps=9000")
    assert summary["status"] == "not converged"
    assert summary["failure_load"] is None
    low, high = summary["failure_load_bracket"]
    assert 0.0 <= low <= 0.6
    assert high == pytest.approx(0.6, rel=1e-4)  # by limit analysis
    assert any("max_steps" in warning for warning in summary["warnings"])


def test_not_converged_exit_code(tmp_path):
    command = [sys.executable, "-m", "dem_cli", "run", VERIFICATION / "wall_21.toml", "-q", "--json"]
    command += ["-o", tmp_path / "out", "--set", "analysis.max_steps=9000"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 3, done.stderr
    assert json.loads(done.stdout)["status"] == "not converged"
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["failure_load"] is None


def test_more_steps_never_lose_an_equilibrium():
    """Of two interrupted searches the one with more steps knows at least as much."""
    lows = []
    for steps in (6000, 9000, 12_000, 40_000):
        summary, _ = solve(VERIFICATION / "wall_21.toml", *QUIET, f"analysis.max_steps={steps}")
        lows.append(summary["failure_load_bracket"][0] or 0.0)
        assert lows[-1] <= 0.601
    assert lows[-1] > 0.59


# -- what the multiplier multiplies, and what the stiffness is -----------------------------------------


@pytest.mark.parametrize("force", [1.0, 1e6])
def test_live_force(force):
    """A live load of 1 N: the multiplier is the force in N."""
    load = [{"block": "b", "force": [force, 0.0], "kind": "live"}]
    summary, _ = solve(crate(load=load, analysis={"pattern": "live", "max_load": 1e9}))
    assert summary["failure_load"] * force == pytest.approx(0.6 * WEIGHT, rel=1e-4)


def test_live_force_with_a_lever():
    """Pushed at its top a block of 1 × 1 m turns over at half its weight."""
    load = [{"block": "b", "force": [1.0, 0.0], "at": [0.0, 1.0], "kind": "live"}]
    summary, _ = solve(crate(load=load, analysis={"pattern": "live", "max_load": 1e9}))
    assert summary["failure_load"] == pytest.approx(0.5 * WEIGHT, rel=1e-5)
    assert summary["failure_mode"] == "rocking"


@pytest.mark.parametrize(("force", "mode", "load"), [
    ((0.0, 1.0), "lifting", WEIGHT),
    ((0.5, 1.0), "sliding", 0.6 * WEIGHT / 1.1),
])  # fmt: skip
def test_what_comes_off_does_not_slide(force, mode, load):
    """Pulled straight up a block leaves its joint without a slip; obliquely it slides before that."""
    pull = [{"block": "b", "force": list(force), "at": [0.5, 0.1], "kind": "live"}]
    summary, _ = solve(crate(load=pull, analysis={"pattern": "live", "max_load": 1e9}))
    assert summary["failure_load"] == pytest.approx(load, rel=2e-3)  # the bracket
    assert summary["failure_mode"] == mode


@pytest.mark.parametrize(("size", "status"), [(1e-2, "ok"), (1e-5, "not converged")])
def test_a_block_too_light_to_prove_anything_of(size, status):
    """Beside one that is 1e10 times as heavy a pebble may fly away unseen: no run that says so is in order."""
    pebble = block("pebble", rectangle(2.0, 0.0, 2.0 + size, size))
    summary, _ = solve(tables(BASE, block("b", rectangle(0, 0, 1, 1)), pebble, analysis={"kind": "gravity"}))
    assert summary["status"] == status
    said = [text for text in summary["warnings"] if "its equilibrium is not proven" in text]
    assert bool(said) == (status != "ok")


def test_largest_live_force_by_default():
    """A force of 1 N that must grow to 12 kN is no self-locking."""
    # The default largest load counts in dead loads, not in newtons.
    load = [{"block": "b", "force": [1.0, 0.0], "kind": "live"}]
    summary, _ = solve(crate(load=load, analysis={"pattern": "live"}))
    assert summary["status"] == "ok"


def test_dead_force():
    """A dead push uses up part of the friction: λ = μ − P/W; one from above adds to it."""
    push = [{"block": "b", "force": [0.2 * WEIGHT, 0.0]}]
    assert solve(crate(load=push))[0]["failure_load"] == pytest.approx(0.4, rel=1e-3)
    press = [{"block": "b", "force": [0.0, -0.5 * WEIGHT]}]
    assert solve(crate(load=press, friction=0.5))[0]["failure_load"] == pytest.approx(0.75, rel=1e-3)


def test_upward_push_is_no_failure_load_below_the_weight():
    """pattern = mass, straight up: the block lifts off at λ = 1."""
    summary, _ = solve(crate(analysis={"direction": [0.0, 1.0]}))
    assert summary["failure_load"] == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("direction", [(1.0, 0.0), (-1.0, 0.0), (3.0, 4.0), (1.0, -1.0)])
def test_direction(direction):
    """Sliding under a push along (cos a, sin a): λ = μ / (cos a + μ sin a)."""
    summary, _ = solve(crate(analysis={"direction": list(direction)}, friction=0.3))
    cosine, sine = np.array(direction) / np.hypot(*direction)
    expected = 0.3 / (abs(cosine) + 0.3 * sine)
    assert summary["failure_load"] == pytest.approx(expected, rel=1e-3)


COLUMN = [block(f"c{i}", rectangle(0, 0.2 * i, 0.3, 0.2 * i + 0.2)) for i in range(5)]
# Loads at which an equilibrium was proven with moving geometry, raised to in small steps from gravity.
STANDS = {(1e9, 1.0): 0.2995, (1e9, 0.3): 0.2992, (1e9, 0.1): 0.2992, (5e7, 1.0): 0.293}


def given(kn: float, ratio: float, kinematics: str = "auto") -> dict:
    joint = {"friction": 0.6, "kn": kn, "ks": ratio * kn, "points": 2}
    return tables(BASE, *COLUMN, joints={"dry": joint}, analysis={"kinematics": kinematics})


@pytest.mark.parametrize(("kn", "kinematics"), [(1e9, "fixed"), (1e11, "fixed"), (1e11, "large")])
@pytest.mark.parametrize("ratio", [0.1, 1.0])
def test_given_stiffness_drops_out(kn, ratio, kinematics):
    """Of fixed geometry always, of moving geometry where it is high; measured 1e-8 and 7e-4."""
    summary, _ = solve(given(kn, ratio, kinematics))
    assert summary["status"] == "ok"
    assert summary["failure_load"] == pytest.approx(0.3, rel=1e-7 if kinematics == "fixed" else 2e-3)


@pytest.mark.parametrize(("kn", "ratio"), STANDS)
def test_soft_given_joints_move_the_geometry(kn, ratio):
    """Joints that let a column lean: moving geometry, a word about it, and no equilibrium above."""
    summary, _ = solve(given(kn, ratio))
    assert summary["kinematics"] == "large"
    assert any("given kn" in line for line in [*summary["skipped"], *summary["warnings"]])
    assert summary["failure_load_bracket"][1] > STANDS[kn, ratio]
    assert 0.999 * STANDS[kn, ratio] < summary["failure_load"] <= 0.3


def waxed_top(density: float) -> dict:
    """A block of another material on a joint of its own friction, 0.2; all others have 0.6."""
    return tables(
        {**BASE, "material": "stone"},
        block("b", rectangle(0, 0, 2, 0.5), material="stone"),
        block("top", rectangle(0.5, 0.5, 1.5, 0.8), material="oak"),
        materials={"stone": {"density": 2000.0}, "oak": {"density": density}},
        joints={"dry": {"friction": 0.6}, "waxed": {"friction": 0.2}},
        interface=[{"between": ["oak", "stone"], "joint": "waxed"}],
    )


def test_interface_decides_between_materials():
    """The top block slides first, at the friction of its own joint."""
    summary, _ = solve(waxed_top(2000.0))
    assert summary["failure_load"] == pytest.approx(0.2, rel=2e-3)
    assert summary["mechanism"]["moving_blocks"]["first"] == ["top"]


@pytest.mark.parametrize("density", [700.0, 70.0, 7.0])
def test_light_block_on_a_heavy_one(density):
    """The friction angle does not ask for the weight."""
    # An unbalanced force measured in mean block weights once "proved" 0.2003, 0.2046 and 0.248.
    summary, _ = solve(waxed_top(density))
    assert summary["failure_load"] <= 0.2 * (1 + 1e-3)
    assert summary["failure_load"] == pytest.approx(0.2, rel=3e-3)


def tower(lower: float, upper: float) -> dict:
    """A block of 0.5 × 1 m and one of 0.5 × 0.2 m on it, of two densities: both turn over together."""
    return tables(
        {**BASE, "material": "m0"},
        block("lower", rectangle(0, 0, 0.5, 1), material="m0"),
        block("upper", rectangle(0, 1, 0.5, 1.2), material="m1"),
        friction=1.0,
        materials={"m0": {"density": lower}, "m1": {"density": upper}},
        analysis={"max_steps": 1_000_000},
    )


@pytest.mark.parametrize("ratio", [1e-6, 1e-4, 1e4])
def test_a_knock_is_no_failure(ratio):
    """Blocks of very different weight: the light one must not be thrown, nor its flight be taken for failure."""
    # A jolt of the heavy block once sent the light one flying: "failure" at 0.0078 for 1e-6, at 0.12 for 1e-4.
    lower, upper = np.array([1.0, 0.2]) * [1.0, ratio]
    exact = 0.25 * (lower + upper) / (lower * 0.5 + upper * 1.1)
    summary, _ = solve(tower(2000.0, 2000.0 * ratio))
    assert summary["status"] == "ok"
    assert summary["failure_load"] == pytest.approx(exact, rel=2.5e-3)
    assert summary["failure_load"] <= exact * (1 + 1e-5)


@pytest.mark.parametrize("softness", [1e3, 1e4])
def test_a_toppled_block_at_rest_has_failed(softness):
    """On joints so soft that it falls over within a few steps and lies on its side for good."""
    # Its rest was once an equilibrium: 0.4997 and 0.9997 instead of 0.25.
    weight = 0.25 * WEIGHT
    joint = {"friction": 1.0, "kn": softness * weight / (0.5 * 0.25), "points": 2}
    case = tables(BASE, block("b", rectangle(0, 0, 0.25, 1)), joints={"dry": joint}, analysis={"kinematics": "large"})
    summary, _ = solve(case, "analysis.max_steps=500000", "analysis.follow=0.0")
    assert summary["status"] == "ok"
    assert summary["failure_load"] <= 0.25 * (1 + 1e-5)
    assert summary["failure_load"] > 0.25 * (1 - 25 / softness)


def in_two_pieces(b: dict) -> dict:
    """The same block, cut along a diagonal."""
    corners = b["vertices"]
    return {**{k: v for k, v in b.items() if k != "vertices"}, "parts": [corners[:3], [corners[0], *corners[2:]]]}


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_pieces_change_no_load(kinematics):
    """Two columns and a lintel, each of two triangles: b/H."""
    # Inner edges were faces once: 0.128 with either geometry.
    blocks = [
        block("left", rectangle(0.0, 0.0, 0.4, 2.0)),
        block("right", rectangle(2.6, 0.0, 3.0, 2.0)),
        block("lintel", rectangle(-0.1, 2.0, 3.1, 2.5)),
    ]
    ground = block("ground", rectangle(-4, -1, 7, 0), fixed=True)
    case = tables(ground, *map(in_two_pieces, blocks), friction=0.7, analysis={"kinematics": kinematics, "follow": 0.0})
    summary, _ = solve(case)
    assert summary["failure_load"] == pytest.approx(0.2, rel=1e-3)
    assert abs(summary["energy_closure"]) < 1e-2


@pytest.mark.parametrize(("name", "load"), [("wall_21", 0.599), ("arch_21", 0.147), ("column_14", 0.163)])
def test_a_held_equilibrium_does_not_move(name, load):
    """Held on just below failure: kinetic energy below 1e-12 of the elastic one, forces that balance ever better."""
    sim = simulation(VERIFICATION / f"{name}.toml")
    load, budget = load / sim.live_scale, Budget(10**6)
    assert stand(sim, budget).state == "equilibrium"
    _, elastic = compliance(sim)
    verdict = settle_or_fail(sim, load, budget, elastic * load)
    assert verdict.state == "equilibrium"
    assert verdict.unbalanced < 1e-5
    assert sim.kinetic_energy() == 0.0  # brought to rest
    places, way = sim.places(), measures.largest_displacement(sim)
    sim.advance(60_000, slot.HOLD_LOAD)
    assert sim.kinetic_energy() < 1e-12 * sim.elastic_energy()
    assert sim.unbalanced < 0.1 * verdict.unbalanced
    assert np.abs(sim.places() - places).max() < 1e-3 * way


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
def test_far_from_the_origin(kinematics):
    """Eight million blocks away: the same load, and places as the case has them."""
    # Coordinates from [0, 0] leave moving geometry too few digits: from 1e5 blocks on nothing came to rest.
    away = 2.0**23
    case = crate(analysis={"kinematics": kinematics, "follow": 0.0}, output={"frames": 3})
    (near, _), (far, records) = solve(case), solve(moved(case, shift=(away, -away)))
    assert far["status"] == "ok"
    assert far["failure_load"] == pytest.approx(near["failure_load"], rel=1e-6)
    frame = records.frames[0]
    assert frame.positions[1] == pytest.approx([away + 0.5, -away + 0.5], abs=1e-3)
    assert frame.contacts.points[:, 1] == pytest.approx(-away, abs=1e-3)


def test_a_collapse_is_known_whatever_follows():
    """A slender block falls on a face 14 times as wide as the one it stood on, for which its step is too long."""
    pulse = {"kind": "harmonic", "amplitude": 4.0, "frequency": 1.5, "duration": 2.0}
    slender = tables(BASE, block("b", rectangle(0, 0, 0.07, 1)), motion=pulse, damping={"none": True})
    summary, _ = solve(slender | {"analysis": {"kind": "time-history"}})
    assert (summary["status"], summary["ending"], summary["collapse_block"]) == ("ok", "collapsed", "b")
    assert summary["collapse_time"] == pytest.approx(0.71, abs=0.02)
    assert abs(summary["energy_closure"]) > 0.2
    assert any("the collapse is known, not what follows: blew up at" in text for text in summary["warnings"])
    assert any("up to the collapse the energy closes within" in text for text in summary["warnings"])
