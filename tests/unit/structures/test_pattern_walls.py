"""Walls of irregular masonry: volumes, shared faces, names, what is refused, and loads known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError
from synthetic.skins import free_volume, model_of, open_area

import dem_cli
from dem_cli.case.base import KeyProblem
from dem_cli.core.geometry import polygon
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.sanity import doubts
from dem_cli.masonry.structures.patterns.wall_section import WallSection, build, figures
from dem_cli.masonry.structures.registry import GENERATORS, generated_blocks, generated_figures

LENGTH, HEIGHT, THICKNESS = 4.0, 2.4, 0.5
DOOR = {"x": 1.5, "y": 0.0, "width": 0.9, "height": 1.4, "lintel": {"height": 0.2, "bearing": 0.25}}
ARCH = {"x": 1.5, "y": 0.0, "width": 0.8, "height": 1.2, "arch": {"voussoirs": 9, "ring": 0.2}}
COURSES = {"spacing": [0.4, 0.05], "segment": [0.8, 0.3], "deviation": [0.0, 0.04], "head_spacing": [0.6, 0.2]}
SIZE = {"size": [LENGTH, HEIGHT], "thickness": THICKNESS}
WALLS = {
    "rubble": SIZE | {"kind": "voronoi-wall", "cell": 0.4, "stretch": 1.5, "seed": 3},
    "courses": SIZE | {"kind": "coursed-wall", "head_angle_deg": [0.0, 6.0], "seed": 3} | COURSES,
    "herringbone": SIZE | {"kind": "herringbone-wall", "block": [0.4, 0.2]},
    "reticulate": SIZE | {"kind": "herringbone-wall", "block": [0.2, 0.2]},
    "rows": SIZE | {"kind": "herringbone-wall", "block": [0.45, 0.15], "bond": "rows", "angle_deg": 50.0},
}
QUOINS = WALLS["rubble"] | {"quoins": {"length": 0.5, "height": 0.25}}
SECTION = {"kind": "wall-section", "size": [0.8, 3.0], "course": [0.25, 0.05], "face": [0.2, 0.05], "cell": 0.12}


def blocks(table: dict, seed: int = 1):
    kind = GENERATORS[table["kind"]].parameters
    return generated_blocks(kind.model_validate(table), seed)


def free(table: dict):
    return [block for block in blocks(table) if not block.fixed]


@pytest.mark.parametrize("extra", [{"openings": [DOOR]}, {"openings": [ARCH]}, {"gable": {"height": 1.0}}], ids=str)
@pytest.mark.parametrize("name", WALLS)
def test_in_space_stones_fill_the_wall_and_share_their_faces(name, extra):
    """What is in the open is both faces of the wall, its ends, top and foot, and the jambs and soffit of an opening."""
    model = model_of(WALLS[name] | extra | {"base": False})
    face, rim = LENGTH * HEIGHT, 2.0 * (LENGTH + HEIGHT)
    if extra.get("openings") == [DOOR]:
        face, rim = face - 0.9 * 1.4, rim + 2.0 * 1.4
    elif extra.get("openings") == [ARCH]:
        soffit = 0.4 * np.array([[-np.cos(a), np.sin(a)] for a in np.pi * np.arange(10) / 9.0])
        face -= 0.8 * 1.2 + polygon.area(soffit)
        rim += 2.0 * 1.2 - 0.8 + np.hypot(*np.diff(soffit, axis=0).T).sum()
    elif extra:
        face, rim = face + 0.5 * LENGTH * 1.0, rim - LENGTH + 2.0 * np.hypot(LENGTH / 2.0, 1.0)
    assert free_volume(model) == pytest.approx(face * THICKNESS, rel=1e-12)
    assert open_area(model) == pytest.approx(2.0 * face + rim * THICKNESS, rel=1e-9)


def test_pieces_without_an_area_beside_an_arch_are_gone():
    """A corner of a stone on the line of the arch left one that went there and straight back: KeyError."""
    arch = {"x": 0.649, "y": 0.3, "width": 0.4, "height": 0.379, "arch": {"voussoirs": 5, "ring": 0.15}}
    points = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.2], [1.0, 1.6], [0.0, 1.2]]
    courses = {"spacing": [0.3, 0.00367], "segment": [0.8, 0.2], "deviation": [0.0, 0.0275], "head_spacing": [0.5, 0.1]}
    wall = {"kind": "coursed-wall", "thickness": 0.516, "openings": [arch], "outline": {"points": points}, "id": "s"}
    soffit = 0.2 * np.array([[-np.cos(a), np.sin(a)] for a in np.pi * np.arange(6) / 5.0])
    stones = [block for block in blocks(wall | courses, 800) if not block.fixed]
    area = sum(polygon.area(part) for block in stones for part in block.parts)
    assert area == pytest.approx(2.0 * 1.2 + 0.4 - 0.4 * 0.379 - polygon.area(soffit), rel=1e-12)


@pytest.mark.parametrize("through", [0, 1, 4])
def test_a_section_fills_its_outline(through):
    model = model_of(SECTION | {"through": through, "thickness": 1.5, "base": False})
    assert free_volume(model) == pytest.approx(0.8 * 3.0 * 1.5, rel=1e-12)
    assert open_area(model) == pytest.approx(2.0 * 0.8 * 3.0 + 2.0 * (0.8 + 3.0) * 1.5, rel=1e-9)


def test_a_section_of_through_stones_alone_has_no_core():
    """It was an internal error, in what is built and in what `dem check` says of it."""
    section = WallSection.model_validate(SECTION | {"through": 1})
    stones = [block for block in build(section) if not block.fixed]
    assert [block.id for block in stones] == [f"through-{k + 1}" for k in range(len(stones))]
    assert len(stones) > 8
    assert all(np.ptp(block.parts[0][:, 0]) == 0.8 for block in stones)
    assert figures(section) == [("core", "none: every course is a through-stone")]


@pytest.mark.parametrize("seed", range(4))
def test_face_stones_of_a_section_have_no_steps_that_are_shorter_than_edges_may_be(seed):
    """Two depths drawn almost alike would leave the core an edge of nothing, and the run a joint that never rests."""
    thin = SECTION | {"face": [0.2, 0.02], "shortest": 0.05, "seed": seed}
    stones = [block for block in free(thin) if block.id.startswith("left")]
    depths = np.array([block.parts[0][:, 0].max() for block in stones])
    steps = np.abs(np.diff(depths))
    assert ((steps == 0.0) | (steps >= 0.05 * 0.12)).all()
    assert len(set(depths)) > 1
    assert 0.18 <= depths.min() <= depths.max() <= 0.22


@pytest.mark.parametrize("name", WALLS)
@pytest.mark.parametrize("seed", range(3))
def test_quoins_and_openings_leave_the_area_exact(name, seed):
    table = WALLS[name] | {"quoins": QUOINS["quoins"], "openings": [DOOR]}
    table |= {"seed": seed} if "seed" in table else {"block": [0.3 + 0.1 * seed, 0.1]}
    stones = free(table)
    areas = {block.id: sum(polygon.area(part) for part in block.parts) for block in stones}
    assert sum(areas.values()) == pytest.approx(LENGTH * HEIGHT - 0.9 * 1.4, rel=1e-12)
    assert all(polygon.is_convex(part) for block in stones for part in block.parts)
    assert sum(name.startswith("quoin-left-") for name in areas) == 10
    assert areas["quoin-left-1"] == pytest.approx(0.5 * 0.24)
    assert areas["quoin-right-1"] == pytest.approx(0.25 * 0.24)


def test_names():
    rubble = [
        block.id for block in blocks(WALLS["rubble"] | {"openings": [ARCH], "sides": [{"face": "-y", "strip": 0.5}]})
    ]
    assert rubble[:4] == ["base", "side-1-left", "side-1-right", "1"]
    assert rubble[-9:] == [f"arch-1-{n + 1}" for n in range(9)]
    courses = blocks(WALLS["courses"])
    assert [block.id for block in courses[:3]] == ["base", "1-1", "1-2"]
    assert {block.course for block in courses[1:]} == {1, 2, 3, 4, 5, 6}
    section = [block.id for block in blocks(SECTION | {"through": 4})]
    assert section[:4] == ["base", "left-1", "right-1", "left-2"]
    assert "through-4" in section
    assert section[-1].startswith("core-")
    rows = [block.id for block in blocks(WALLS["rows"])]
    assert rows[1:3] == ["1-1", "1-2"]


def test_a_seed_of_the_table_comes_before_that_of_the_case():
    without = {key: value for key, value in WALLS["rubble"].items() if key != "seed"}
    corners = [np.concatenate([part for block in blocks(table, seed) for part in block.parts])
               for table, seed in ((without, 3), (without, 4), (WALLS["rubble"], 4))]  # fmt: skip
    assert corners[0].tobytes() == corners[2].tobytes()
    assert corners[0].tobytes() != corners[1].tobytes()


def test_herringbone_stones_are_those_asked_for():
    whole = [block.parts[0] for block in free(WALLS["herringbone"]) if len(block.parts) == 1]
    whole = [part for part in whole if len(part) == 4 and abs(polygon.area(part) - 0.08) < 1e-12]
    sides = [np.sort(np.hypot(*(part - np.roll(part, 1, axis=0)).T)) for part in whole]
    assert len(whole) > 80
    assert np.array(sides) == pytest.approx(np.tile([0.2, 0.2, 0.4, 0.4], (len(sides), 1)))
    leans = [block.parts[0] for block in free(WALLS["rows"]) if abs(polygon.area(block.parts[0]) - 0.0675) < 1e-12]
    assert all(np.ptp(part[:, 1]) == pytest.approx(0.45 * np.sin(np.radians(50.0))) for part in leans)


def test_figures_say_what_was_drawn():
    kind = GENERATORS["coursed-wall"].parameters
    table = kind.model_validate(WALLS["courses"])
    found = dict(generated_figures(table, 1))
    assert list(found) == ["stones", "spacing", "segment", "deviation", "head_spacing", "head_angle_deg"]
    count = len(free(WALLS["courses"]))
    assert found["stones"].startswith(f"{count} stones of ")
    assert found["spacing"].startswith("0.4 ± ")
    assert found["spacing"].endswith(" m, 6 drawn")


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (WALLS["rubble"] | {"cells": 20}, "found both"),
        ({"kind": "voronoi-wall", "size": [4.0, 2.0]}, "found none"),
        (WALLS["rubble"] | {"cell": 4.0}, "only one stone"),
        (WALLS["rubble"] | {"cell": 0.005}, "more than 100,000"),
        (WALLS["rubble"] | {"shortest": 0.5}, "less than or equal to 0.3"),
        (WALLS["rubble"] | {"quoins": {"length": 1.5, "height": 0.3}}, "a third of the wall"),
        (QUOINS | {"openings": [ARCH | {"x": 0.6}]}, "crosses the quoins"),
        (WALLS["rubble"] | {"openings": [DOOR | {"height": 2.3}]}, "lintel would reach up to 2.5"),
        (WALLS["rubble"] | {"gable": {"height": 1.0, "edges": "stepped"}}, "'stepped' is not allowed"),
        (WALLS["rubble"] | {"gable": {"height": 1.0, "ridge": 4.0}}, "less than the length"),
        (WALLS["rubble"] | {"gable": {"height": 1.0}, "openings": [DOOR | {"x": 0.3, "y": 1.2}]}, "above the top"),
        (WALLS["rubble"] | {"sides": [{"face": "-y", "strip": 2.5}]}, "half the length of the wall"),
        (WALLS["courses"] | {"deviation": [0.0, 0.2]}, "the deviation must be at most 0.1"),
        (WALLS["herringbone"] | {"block": [0.5, 0.2]}, "whole number of heights, such as 0.4"),
        (WALLS["herringbone"] | {"block": [0.1, 0.2]}, "at least the height"),
        (WALLS["herringbone"] | {"block": [0.004, 0.004]}, "at most 100,000"),
        (SECTION | {"face": [0.35, 0.05]}, "of 0.8 for a core"),
        (SECTION | {"face": [0.2, 0.19]}, "at most 0.15"),
        (SECTION | {"course": [4.0, 0.0]}, "only 3 high"),
    ],
)  # fmt: skip
def test_what_cannot_be_built_says_why(table, message):
    with pytest.raises((ValidationError, KeyProblem), match=message):
        blocks(table)


CASE = {
    "title": "irregular masonry",
    "materials": {"stone": {"density": 2300.0}},
    "joints": {"dry": {"friction": 0.7}},
    "analysis": {"kind": "gravity"},
}


def push(direction: list[float]) -> dict:
    return {"kind": "pushover", "direction": direction, "resolution": 0.002}


def test_a_free_standing_wall_of_any_stones_turns_over_its_foot():
    """Prisms across the whole thickness have no weaker line than the bed on the base: t / H."""
    wall = {"kind": "voronoi-wall", "size": [1.6, 2.0, 0.4], "cells": 8, "relax": 5, "seed": 2}
    result = dem_cli.run(CASE | {"dimension": 3, "structure": [wall], "analysis": push([0.0, 1.0, 0.0])})
    assert result.summary["failure_load"] == pytest.approx(0.4 / 2.0, rel=0.003)


def test_courses_of_one_stone_are_a_column():
    """Level beds, one stone each: b / h."""
    even = {"spacing": [0.25, 0.0], "segment": [0.5, 0.0], "deviation": [0.0, 0.0], "head_spacing": [0.5, 0.0]}
    wall = {"kind": "coursed-wall", "size": [0.5, 2.0]} | even
    result = dem_cli.run(CASE | {"structure": [wall], "analysis": push([1.0, 0.0])})
    assert result.summary["failure_load"] == pytest.approx(0.25, rel=0.003)


@pytest.mark.parametrize(
    ("table", "stands"),
    [
        (WALLS["rubble"], True),
        (WALLS["courses"], True),
        (WALLS["herringbone"], False),  # stones at the free ends lie on planes of 45°
        (WALLS["herringbone"] | {"quoins": {"length": 0.6, "height": 0.3}}, True),
        (SECTION, True),
    ],
    ids=["rubble", "courses", "herringbone", "herringbone with quoins", "section"],
)
def test_verdicts_under_gravity(table, stands):
    status = dem_cli.run(CASE | {"structure": [table]}).summary["status"]
    assert status == ("ok" if stands else "does not stand under its dead loads")


@pytest.mark.parametrize(
    ("table", "key"),
    [
        (WALLS["rubble"] | {"relax": 0}, "relax"),
        (WALLS["rubble"] | {"relax": 3}, None),
        (QUOINS | {"relax": 0}, None),
        (WALLS["herringbone"], "angle_deg"),
        (WALLS["herringbone"] | {"quoins": QUOINS["quoins"]}, None),
    ],
)
def test_stones_that_may_slide_out_at_free_ends_are_a_doubt(table, key):
    made = dem_cli.load(CASE | {"structure": [table], "analysis": push([1.0, 0.0])})
    found = [doubt.path for doubt in doubts(made.case, *assembly(made.case)[:2], []) if "slide out" in doubt.message]
    assert found == ([("structure", 0, key)] if key else [])
    gravity = dem_cli.load(CASE | {"structure": [table]}).case
    assert not [doubt for doubt in doubts(gravity, *assembly(gravity)[:2], []) if "slide out" in doubt.message]
