"""Papers 001 and 002 in space: cases have the numbers of the data book, verdicts on its curves follow the loads."""

from __future__ import annotations

import math

import pytest
from casefiles import CASES, read, references
from reference import book, value
from studies.paper001 import walls
from studies.paper001.house import PUSHED, SHAKEN

from dem_cli.app import api

LEMOS = book("lemos_2019_wall")
HOUSE = book("lemos_stone_house")


@pytest.mark.parametrize("kind", walls.FILES)
def test_walls_have_size_joints_and_supports_of_the_book(kind):
    tables = read(walls.FOLDER / f"{walls.FILES[kind]}.toml")
    (wall,), joint = tables["structure"], tables["joints"]["dry"]
    material, geometry = LEMOS["material"], LEMOS["geometry"]
    assert (joint["kn"], joint["ks"]) == (material["kn_Pa_m"], material["ks_Pa_m"])
    assert joint["friction_angle_deg"] == material["friction_angle_deg"]
    assert wall["sides"] == [{"face": "+y", "strip": geometry["support_strip_m"]}]
    for run in walls.runs_of_sweep(walls.FOLDER / f"{walls.FILES[kind]}.toml"):
        model = api.build_model(api.load_case(walls.FOLDER / f"{walls.FILES[kind]}.toml", run.overrides))
        stone = geometry["length_m"] * geometry["height_m"] * geometry["thickness_m"] * 2300.0
        assert model.masses[~model.fixed].sum() == pytest.approx(stone, rel=1e-12)


def test_offsets_and_shapes_of_regular_walls():
    runs = walls.runs_of_sweep(walls.FOLDER / "lemos_wall.toml")
    asked = [(run.values["name"].partition(",")[0], run.values["structure.0.offset"]) for run in runs]
    assert asked == [
        (shape, offset) for shape in (walls.SQUARE, walls.LONG) for offset in LEMOS["geometry"]["offsets_m"]
    ]


def test_statistics_of_coursed_walls():
    (wall,), printed = read(walls.FOLDER / "lemos_coursed.toml")["structure"], LEMOS["geometry"]["irregular"]
    names = {"spacing": "spacing", "segment": "segment", "deviation": "vertical_dev", "head_spacing": "block_length"}
    for key, name in names.items():
        mean = printed["vertical_dev_mean_m"] if key == "deviation" else printed[f"{name}_mean_m"]
        spread = printed["vertical_dev_m"] if key == "deviation" else printed[f"{name}_dev_m"]
        assert wall[key] == [mean, spread]
    assert wall["head_angle_deg"] == [printed["angle_mean"], printed["angle_dev"]]


def curve(name: str, *points: tuple[float, float]) -> dict:
    return {"name": name, "bracket": [points[-1][1], points[-1][1]], "curve": [list(point) for point in points]}


def test_stiffness_is_read_off_the_rising_branch():
    """0.02 at 0.5 mm, though the curve comes down through 0.02 again."""
    wall = curve("x", (0.0, 0.0), (1.0, 0.04), (50.0, 0.0))
    assert walls.stiffness(wall) == pytest.approx(0.02 / 0.5e-3)


def test_orderings_follow_the_loads():
    loads = {"1 × 1 m": (0.08, 0.19, 0.185), "2 × 1 m": (0.08, 0.28, 0.27)}
    regular = [
        curve(f"{shape}, offset {offset}", (1.0, load))
        for shape, those in loads.items()
        for offset, load in zip(walls.OFFSETS, those, strict=True)
    ]
    voronoi = [curve(f"Voronoi {n}", (1.0, load)) for n, load in enumerate((0.16, 0.165, 0.17))]
    coursed = [curve(f"coursed {n}", (1.0, load)) for n, load in enumerate((0.25, 0.26, 0.27))]
    found = {"regular": regular, "voronoi": voronoi, "coursed": coursed}
    assert all(walls.orderings(found).values())
    voronoi[0]["bracket"] = [0.2, 0.2]
    regular[1]["bracket"] = [0.07, 0.07]
    coursed.pop()
    broken = dict.fromkeys(["order_offset", "order_voronoi", "order_irregular", "order_shape"], False)
    assert walls.orderings(found) == broken | {"order_shape": True}


@pytest.mark.parametrize("file", [PUSHED, SHAKEN, CASES / "validation/lemos_stone_house_modes.toml"])
def test_the_house_has_the_joints_of_the_book(file):
    tables, material = read(file), HOUSE["material"]
    mortar, foot = tables["joints"]["mortar"], tables["joints"]["foot"]
    for joint, angle in ((mortar, material["friction_deg_post"]), (foot, material["friction_deg_base"])):
        assert (joint["cohesion"], joint["tension"]) == (material["cohesion_Pa"], material["tensile_Pa"])
        assert joint["friction_angle_deg"] == angle
        assert joint["kn"] == pytest.approx(
            value("lemos_stone_house", "softening") * material["masonry_E_Pa"] / material["joint_spacing_bed_m"],
            rel=1e-3,
        )
        assert {"cohesion_residual", "tension_residual"} & set(joint) == set()
    house = tables["structure"][0]
    assert house["thickness"] == HOUSE["geometry"]["wall_thickness_m"]
    assert house["block"] == [material["joint_spacing_head_m"], material["joint_spacing_bed_m"]]
    model = api.build_model(api.load_case(file))
    assert (~model.fixed).sum() == pytest.approx(HOUSE["geometry"]["blocks_about"], rel=0.1)


def test_the_table_moves_by_the_published_peak():
    case = api.load_case(SHAKEN).case
    assert case.damping.rayleigh.ratio == 0.02
    assert case.damping.rayleigh.frequency == value("lemos_stone_house", "f1")
    assert read(PUSHED)["reference"]["tolerance"] == 0.05


def test_references_of_the_tilting_table():
    model, printed = read(CASES / "validation/restrepo_s24.toml"), book("restrepo_velez")
    assert model["joints"]["dry"]["friction"] == printed["material"]["friction_coefficient"]
    assert model["materials"]["marble"]["density"] == printed["material"]["density_kg_m3"]
    stone = printed["geometry"]["block_m"]
    assert model["structure"][0]["block"] == [stone["width"], stone["height"]]
    assert model["structure"][0]["thickness"] == stone["thickness"]
    found = [one["failure_load"] for one in references(CASES / "validation/restrepo_s24.toml")]
    assert found == [value("restrepo_velez", name) for name in ("S24_dem", "S24_exp")]


def test_the_panel_in_space_is_the_wall_of_the_plane():
    """Joints, height, thickness, push over its weight, references."""
    plane, space = (CASES / f"validation/griffith_{name}.toml" for name in ("wall", "panel"))
    assert {**read(space)["joints"]["bed"], "points": 5} == read(plane)["joints"]["bed"]
    wanted = [one.get("value", one.get("failure_load")) for one in references(plane)]
    assert [one.get("value", one.get("failure_load")) for one in references(space)] == wanted
    model = api.build_model(api.load_case(space))
    free = ~model.fixed
    weight = model.masses[free].sum() * 9.81
    assert model.live_loads[free].sum(axis=0)[1] == pytest.approx(weight, rel=1e-5)


def test_the_settling_wall_has_the_bricks_of_the_book():
    """The crack climbs by half a brick a course: 43.6°."""
    tables, printed = read(CASES / "validation/bui_settlement.toml"), book("bui_settlement")
    (wall,) = tables["structure"]
    brick = wall["block"]
    assert wall["blocks_per_course"] * brick[0] == pytest.approx(printed["geometry"]["length_m"])
    assert wall["courses"] * brick[1] == pytest.approx(printed["geometry"]["height_m"])
    assert wall["thickness"] == printed["geometry"]["thickness_m"]
    assert -tables["settlement"][0]["displacement"][2] == printed["loading"]["settlement_m"]
    slope = 2.0 * brick[1] / brick[0]
    assert slope == pytest.approx(value("bui_settlement", "repose"), abs=1e-3)
    assert math.degrees(math.atan(slope)) == pytest.approx(43.6, abs=0.05)
