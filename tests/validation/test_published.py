"""Published tests as cases: their references are those of the data book, their structures what it describes."""

from __future__ import annotations

import numpy as np
import pytest
from casefiles import CASES, read, references, scene
from engine import solve
from oracle.bent_column import BentColumn
from reference import book, value

SW = {load: CASES / f"validation/shear_wall_sw{load}.toml" for load in (30, 100, 200, 250)}
WS = {stress: CASES / f"validation/shear_wall_ws{stress}.toml" for stress in (40, 100, 175, 250)}


@pytest.mark.parametrize("load", SW)
def test_sandstone_walls(load):
    """Twin tests as mean and standard deviation."""
    tests = [row["value"] for row in book("lourenco_sw_walls")["result"]
             if row["id"].startswith(f"SW.{load}.") and row["id"].endswith("_peak")]  # fmt: skip
    measured, bound, *curves = references(SW[load])
    assert measured["value"] == np.mean(tests)
    assert measured.get("scatter") == (pytest.approx(np.std(tests, ddof=1), rel=1e-4) if len(tests) > 1 else None)
    assert bound["value"] == value("lourenco_sw_walls", f"SW{load}_rigid_lp")
    drawn = [(one["displacements"], one["value"]) for one in curves]
    assert drawn == [(row["displacement_m"], row["value"]) for row in book("lourenco_sw_walls")["result"]
                     if row["id"].startswith(f"SW.{load}.") and row["id"].endswith("_curve")]  # fmt: skip
    model = scene(SW[load])
    assert -model.dead[model.ids.index("beam"), 1] == 1e3 * load


@pytest.mark.parametrize("stress", WS)
def test_granite_walls(stress):
    (measured,) = references(WS[stress])
    assert measured["failure_load"] == value("vasconcelos_dry_walls", f"WS.{stress}_peak")
    model = scene(WS[stress])
    free = ~model.fixed
    pressed = -model.dead[model.ids.index("beam"), 1] / (1.0 * 0.2)
    row = next(row for row in book("vasconcelos_dry_walls")["result"] if row["id"] == f"WS.{stress}_peak")
    assert pressed == row["vertical_stress_Pa"]
    assert model.weights[free].sum() == pytest.approx(4800.0, rel=0.02)


def joint_stiffness(wall: float, stone: float, course: float) -> float:
    """kn of a joint every `course` that makes a wall as soft as was measured [Pa/m]: 1/E = 1/Eb + 1/(kn h)."""
    return 1.0 / (course * (1.0 / wall - 1.0 / stone))


@pytest.mark.parametrize("load", SW)
def test_joints_of_sandstone_walls(load):
    """By the modulus of each wall while its load was put on, as in the data book."""
    material = book("lourenco_sw_walls")["material"]
    which = material["loads_N"].index(1e3 * load)
    joint = read(SW[load])["joints"]["dry"]
    wall = material["masonry_E_Pa_by_load"][which]
    assert joint["kn"] == material["kn_inferred_Pa_m"][which]
    assert joint["ks"] == material["ks_inferred_Pa_m"][which]
    assert joint["kn"] == pytest.approx(joint_stiffness(wall, material["stone_E_Pa"], 0.1), rel=1e-3)


@pytest.mark.parametrize(("stress", "wall"), [(40, 3287e6), (100, 3287e6), (175, 4068e6), (250, 4722e6)])
def test_joints_of_granite_walls(stress, wall):
    """The same, modulus of the twin walls in the database; none was measured under the smallest load."""
    stone = book("vasconcelos_dry_walls")["material"]["stone_E_Pa"]
    joint = read(WS[stress])["joints"]["dry"]
    assert joint["kn"] == pytest.approx(joint_stiffness(wall, stone, 0.15), rel=1e-3)
    assert joint["ks"] == pytest.approx(joint["kn"] / 2.4, rel=1e-3)


GRIFFITH = CASES / "validation/griffith_wall.toml"


def bent(joint: dict) -> BentColumn:
    """The wall of Griffith's test on these joints, by itself."""
    return BentColumn(18, 0.11, 1.5 / 18, 1800.0, joint["kn"], joint["ks"], pushed=8, held=0.01)


def test_joints_of_the_bent_wall():
    """Calibrated on the first branch of the measured curve, 0.0725 of the weight at 0.0065 of the thickness."""
    (row,) = (row for row in book("griffith_oop_wall")["result"] if row["id"] == "curve")
    place, load = row["displacement_over_t"][2] * 0.11, row["value"][2]
    (found,) = bent(read(GRIFFITH)["joints"]["bed"]).loads(np.linspace(0.0, place, 7)[1:])[-1:]
    assert found == pytest.approx(load, rel=0.02)


def test_bent_wall():
    """Its peak by a static solution of its own; the line of a rigid wall, 2 t/H."""
    rigid, measured, other = references(GRIFFITH)
    assert [one.get("value", one.get("failure_load")) for one in (rigid, measured, other)] == [
        value("griffith_oop_wall", name) for name in ("rigid", "peak", "dem")
    ]
    summary, _ = solve(GRIFFITH, "analysis.follow=0.0", "analysis.resolution=0.005")
    assert summary["limit_analysis"]["associated"] == pytest.approx(2 * 0.11 / 1.5, rel=0.01)
    peak = bent(read(GRIFFITH)["joints"]["bed"]).loads(np.linspace(0.0, 0.0126, 22)[1:]).max()
    low, high = summary["failure_load_bracket"]
    assert low == pytest.approx(peak, rel=0.005)
    assert high == pytest.approx(peak, rel=0.01)
    model = scene(GRIFFITH)
    assert model.weights[~model.fixed].sum() == pytest.approx(2913.57, rel=1e-4)
