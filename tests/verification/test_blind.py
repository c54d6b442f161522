"""Blind predictions: made of what their source gives, unchanged since, and as reckoned by hand where one can."""

from __future__ import annotations

import numpy as np
import pytest
from casefiles import CASES, case_id, read, scene
from oracle import upright_arch
from reference import book

from dem_cli.app.api import build_model, load_case
from dem_cli.app.verify.blind import hash_of_case, refusal

SHELF = sorted((CASES / "blind").glob("*.toml"))
WALLS = ("classical", "efficient", "tall")
BEAM = 24.0  # weight of the beam per unit of area, in units

each_case = pytest.mark.parametrize("path", SHELF, ids=case_id)


def predictions(name: str) -> dict[str, dict]:
    """The [[prediction]] tables of a case by their quantity."""
    return {one["quantity"]: one for one in read(CASES / "blind" / f"{name}.toml")["prediction"]}


@each_case
def test_every_blind_case_is_predicted_and_unchanged(path):
    case = load_case(path).case
    assert case.blind == case.reference
    assert {one.path for one in case.blind} == {one.quantity for one in case.prediction}
    assert {one.sha256 for one in case.prediction} == {hash_of_case(path)}
    assert refusal(path, case) is None


@each_case
def test_a_case_that_changed_is_refused(path, tmp_path):
    file, text = tmp_path / path.name, path.read_text(encoding="utf-8")
    changed = text.replace("density = ", "density = 1", 1)
    assert changed != text
    file.write_text(changed, encoding="utf-8")
    assert "keys changed after the prediction of" in (refusal(file, load_case(file).case) or "")
    file.write_text(f"# a comment\n{text}", encoding="utf-8")
    assert refusal(file, load_case(file).case) is None


def test_all_of_the_data_book_is_predicted():
    asked = {path.stem for path in (CASES.parent / "tests/reference/blind").glob("*.toml")}
    assert asked == {"arch_vertical_cuts", "dry_granite_walls_cyclic", "walls_under_a_beam"}
    names = {
        f"wall_{bond}_{how}" for bond in book("blind/walls_under_a_beam")["layouts"] for how in ("tilted", "pushed")
    }
    loads = [round(test["axial_load_N"] / 1e3) for test in book("blind/dry_granite_walls_cyclic")["test"]]
    names |= {f"granite_{load}_{how}" for load in loads for how in ("cyclic", "pushed")} | {"arch_vertical_cuts"}
    assert {path.stem for path in SHELF} == names


@pytest.mark.parametrize("bond", WALLS)
@pytest.mark.parametrize("how", ["tilted", "pushed"])
def test_walls_are_laid_as_the_source_draws_them(bond, how):
    given = book("blind/walls_under_a_beam")
    tables = read(CASES / "blind" / f"wall_{bond}_{how}.toml")
    drawn = [one for one in tables["block"] if one["id"].startswith("unit-")]
    boxes = [[*np.min(one["vertices"], axis=0), *np.max(one["vertices"], axis=0)] for one in drawn]
    assert boxes == given["layouts"][bond]
    friction = {name: joint["friction"] for name, joint in tables["joints"].items()}
    assert friction == {"bed": given["material"]["bed_friction"], "head": given["material"]["head_friction"]}
    loaded = load_case(CASES / "blind" / f"wall_{bond}_{how}.toml")
    joints, model = loaded.case.joint_between, build_model(loaded)
    for a, b in neighbours(drawn):
        beside = np.max(a["vertices"], axis=0)[0] == np.min(b["vertices"], axis=0)[0]
        assert joints(a["material"], b["material"]) == ("head" if beside else "bed")
    weights = model.masses[~model.fixed]
    assert weights.sum() == pytest.approx(16e3 + (how == "pushed") * 4 * BEAM * 1e3)


def neighbours(blocks: list[dict]) -> list[tuple[dict, dict]]:
    """Pairs of blocks that share more than a corner: the left and the right one, or the upper and the lower one."""
    found = []
    for a in blocks:
        for b in blocks:
            (a0, a1), (b0, b1) = ((np.min(x["vertices"], axis=0), np.max(x["vertices"], axis=0)) for x in (a, b))
            overlap = np.minimum(a1, b1) - np.maximum(a0, b0)
            if (a1[0] == b0[0] and overlap[1] > 0) or (a0[1] == b1[1] and overlap[0] > 0):
                found.append((a, b))
    return found


# units that stay behind while all others turn about the foot (4, 0) of the wall: their numbers in the layout
LEFT_BEHIND = {"classical": (6, 9), "efficient": (3, 6, 8), "tall": (3, 7)}


@pytest.mark.parametrize("bond", WALLS)
def test_pushed_walls_turn_about_their_foot(bond):
    """Moments about (4, 0): the push 4.5 above it, the beam 2 beside it, and the units that move."""
    boxes = np.array(book("blind/walls_under_a_beam")["layouts"][bond])
    moving = np.delete(boxes, np.array(LEFT_BEHIND[bond]) - 1, axis=0)
    areas = (moving[:, 2] - moving[:, 0]) * (moving[:, 3] - moving[:, 1])
    arms = 4.0 - 0.5 * (moving[:, 0] + moving[:, 2])
    by_hand = (4.0 * BEAM * 2.0 + float(areas @ arms)) / 4.5
    found = predictions(f"wall_{bond}_pushed")["failure_load"]
    assert found["value"] == pytest.approx(by_hand, rel=1e-4)
    assert found["band"][0] < by_hand < found["band"][1]
    assert by_hand < 0.58 * 4.0 * BEAM  # the beam does not slide before


def test_tilted_walls_slide_or_an_end_turns_over():
    for bond in ("classical", "efficient"):
        assert predictions(f"wall_{bond}_tilted")["failure_load"]["value"] == pytest.approx(0.58, rel=5e-4)
    # unit 6, 2 high, and unit 2 on it turn about (4, 1): λ (2 · 1 + 2 · 2.5) = 2 · 0.5 + 2 · 1
    found = predictions("wall_tall_tilted")["failure_load"]
    assert found["value"] == pytest.approx(3.0 / 7.0, rel=5e-4)
    associated = scene_of_heads("tall").multiplier
    assert associated == pytest.approx(0.46369, rel=1e-4)
    assert found["band"][0] < 3.0 / 7.0 < associated < found["band"][1]


def scene_of_heads(bond: str):
    """The associated load of a tilted wall with frictionless heads, by the oracle."""
    return scene(CASES / "blind" / f"wall_{bond}_tilted.toml").limit(heads=False)


def test_arch_is_that_of_the_closed_form():
    closed, found = upright_arch.least(), predictions("arch_vertical_cuts")["critical_value"]
    assert closed.thickness == pytest.approx(0.109461, abs=5e-7)
    assert closed.angle_deg == pytest.approx(54.923, abs=1e-3)
    assert found["value"] == pytest.approx(closed.thickness, abs=2e-5)
    assert found["band"][0] < closed.thickness < found["band"][1]


def test_the_closed_form_stays_within_its_ring():
    closed = upright_arch.least()
    inner, outer = 1.0 - closed.thickness / 2.0, 1.0 + closed.thickness / 2.0
    for x in np.linspace(0.0, outer, 500)[1:-1]:
        line = upright_arch.thrust_line(closed.thickness, float(x))
        assert np.sqrt(max(inner**2 - x**2, 0.0)) - 1e-9 <= line <= np.sqrt(outer**2 - x**2) + 1e-9


@pytest.mark.parametrize("load", [100, 175, 250])
@pytest.mark.parametrize("how", ["cyclic", "pushed"])
def test_granite_walls_are_those_of_the_source(load, how):
    given = book("blind/dry_granite_walls_cyclic")
    tables, size = read(CASES / "blind" / f"granite_{load}_{how}.toml"), given["geometry"]
    (wall,), (weight, push) = tables["structure"], tables["load"]
    assert wall["block"] == [size["stone_length_m"], size["stone_height_m"]]
    assert wall["blocks_per_course"] * wall["block"][0] == pytest.approx(size["length_m"])
    assert wall["courses"] * wall["block"][1] == pytest.approx(size["height_m"])
    assert wall["thickness"] == size["thickness_m"]
    assert push["at"] == [0.5, size["height_of_horizontal_load_m"]]
    assert weight["force"] == [0.0, -1e3 * load]
    assert -weight["force"][1] in [test["axial_load_N"] for test in given["test"]]
    twin = read(CASES / "validation" / f"shear_wall_ws{load}.toml")
    assert [tables[key] for key in ("materials", "joints", "structure", "block", "load")] == [
        twin[key] for key in ("materials", "joints", "structure", "block", "load")
    ]


@pytest.mark.parametrize("load", [100, 175, 250])
def test_granite_walls_carry_less_than_rigid_ones_that_rock(load):
    """(N + W) L/2 over the height of the push, W = 4.8 kN and the beam; soft joints and leaning take less than 13 %."""
    rigid = (load * 1e3 + 4803.0 + 100.0 * 0.05 * 9.81) * 0.5 / 1.325
    found = predictions(f"granite_{load}_cyclic")
    for quantity, sign in (("highest_load", 1.0), ("lowest_load", -1.0)):
        assert 0.87 * rigid < sign * found[quantity]["value"] < rigid
