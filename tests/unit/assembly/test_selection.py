"""Blocks by patterns, groups, structures and courses, and what a group means to a load, a monitor, a settlement."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.analyses.settlement import SupportMovement
from dem_cli.case.selection import Selection
from dem_cli.core.dynamics.ground import GroundMotion
from dem_cli.core.engine.monitors import Monitors
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.ground_motions import motions_of
from dem_cli.masonry.assembly.solver_request import solver_request

LEFT = {"kind": "wall", "id": "left", "block": [1.0, 0.5], "courses": 4, "blocks_per_course": 2}
RIGHT = {"kind": "wall", "id": "right", "block": [1.0, 0.5], "courses": 2, "blocks_per_course": 2, "origin": [5.0, 0.0]}
WALLS = [LEFT, RIGHT]


@pytest.fixture
def model_of(case_of):
    """A function from the tables of a case with two walls to its model."""
    return lambda **tables: assembly(case_of(structure=WALLS, **tables)).model


def names(model, name, fixed=None) -> set[str]:
    return {model.block_ids[i] for i in model.chosen(name, fixed)}


def monitored(*selections, **groups):
    """Tables that select blocks, and do nothing else."""
    return {"monitor": [{"quantity": "displacement", **one} for one in selections], "groups": groups}


def test_patterns(model_of):
    model = model_of(**monitored({"block": "left-4-*"}, {"block": "*-2-?"}, {"block": "left-top-*"}, {"block": "*"}))
    assert names(model, "left-4-*") == {"left-4-1", "left-4-2"}
    assert names(model, "*-2-?") == {"left-2-1", "left-2-2", "right-2-1", "right-2-2"}
    assert names(model, "left-top-*") == {"left-4-1", "left-4-2"}  # aliases are names as well
    assert len(model.chosen("*")) == model.n_blocks
    assert names(model, "*", fixed=True) == {"left-base", "right-base"}


def test_structures_and_courses(model_of):
    model = model_of(
        **monitored({"structure": "right"}, {"structure": "left", "course": 4}, {"structure": "left", "course": [2, 3]})
    )
    right = {name for name in model.block_ids if name.startswith("right-")}
    assert names(model, "structure right") == right
    assert names(model, "structure right", fixed=False) == right - {"right-base"}
    assert names(model, "structure left course 4") == names(model, "left-4-*") | {"left-4-1", "left-4-2"}
    assert {name.split("-")[1] for name in names(model, "structure left course 2 to 3")} == {"2", "3"}


def test_groups_of_patterns_groups_courses_and_boxes(model_of):
    groups = {
        "tops": ["crown", {"structure": "right", "course": 2}],
        "crown": ["left-4-*", "left-4-1"],
        "corner": [{"box": [[4.0, -1.0], [5.6, 9.0]]}],
        "lower": [{"structure": "left", "course": [1, 2], "box": [[0.0, 0.0], [0.7, 9.0]]}],
    }
    model = model_of(**monitored(*({"block": name} for name in groups), **groups))
    assert names(model, "tops") == {"left-4-1", "left-4-2", "right-2-1", "right-2-2"}
    assert len(model.chosen("crown")) == 2
    assert names(model, "corner") == {"right-1-1", "right-2-1"}
    assert names(model, "lower") == {"left-1-1", "left-2-1"}


WRONG = [
    ("monitor.0.block", {"block": "lefd-4-*"}, "no block is called like 'lefd-4-*', did you mean 'left-4-"),
    ("monitor.0.course", {"structure": "left", "course": 9}, "structure 'left' has courses 1 to 4"),
    ("settlement.0.block", {"block": "left-4-*"}, "none of the 2 blocks of 'left-4-*' is fixed"),
    ("settlement.0.structure", {"structure": "left", "course": 1}, "none of the 3 blocks of structure 'left' course 1"),
    (
        "initial.0.block",
        {"block": "*-base", "tilt": 0.1},
        "every block of '*-base' is fixed; only blocks that can move",
    ),
    ("motion.0.blocks.0", {"kind": "none", "blocks": ["left-4-*"]}, "is fixed; only a fixed block can be moved"),
    ("monitor.0.between.1", {"between": ["left-1-1", "left-2-*"], "quantity": "slip"}, "stands for 2 blocks; one is"),
]
WRONG_GROUPS = [
    ("left-1-1", ["*"], (), "is the name of a block already"),
    ("left-top", ["*"], (), "is the name of a block already"),
    ("a*", ["*"], (), "names have no * and ?"),
    ("a", ["b"], (0,), "group 'a' is part of itself"),
    ("a", ["left-1-1", "lefft-1-1"], (1,), "unknown block 'lefft-1-1', did you mean 'left-1-1'?"),
    ("a", [{"box": [[90, 0], [91, 1]]}], (0, "box"), "no block has its centroid in it"),
]


@pytest.mark.parametrize("name", ["left", "s", "c", "structure", "1"])
def test_a_structure_is_quoted_whatever_its_name(name):
    """Of one called 's' messages said 's'tructure s."""
    assert Selection(structure=name).said == f"structure '{name}'"
    assert Selection(structure=name, course=(1, 2)).said == f"structure '{name}' course 1 to 2"


@pytest.mark.parametrize(("where", "table", "says"), WRONG, ids=[row[0] for row in WRONG])
def test_mistakes(case_of, where, table, says):
    key = where.split(".")[0]
    with pytest.raises(CaseError) as caught:
        assembly(case_of(structure=WALLS, **{key: [table]}))
    assert [".".join(map(str, problem.path)) for problem in caught.value.problems] == [where]
    assert says in caught.value.problems[0].message


@pytest.mark.parametrize(("name", "members", "path", "says"), WRONG_GROUPS, ids=[row[3] for row in WRONG_GROUPS])
def test_mistakes_in_groups(case_of, name, members, path, says):
    with pytest.raises(CaseError) as caught:
        assembly(case_of(structure=WALLS, groups={name: members, "b": ["a" if name == "a" else "*"]}))
    assert caught.value.problems[0].path == ("groups", name, *path)
    assert says in caught.value.problems[0].message


def test_a_damping_of_several_blocks(case_of):
    with pytest.raises(CaseError, match=r"'left-4-.' stands for 2 blocks; one is meant here"):
        assembly(case_of(structure=WALLS, damping={"restitution": "housner", "block": "left-4-*"}))


def test_a_monitor_of_a_group_is_the_mean_by_mass(case_of):
    heavy = {"id": "heavy", "vertices": [[9, 0], [12, 0], [12, 1], [9, 1]]}
    light = {"id": "light", "vertices": [[13, 0], [14, 0], [14, 1], [13, 1]]}
    floor = {"id": "floor", "vertices": [[8, -1], [15, -1], [15, 0], [8, 0]], "fixed": True}
    tables = [
        {"block": "*", "component": "x"},
        {"block": "*"},
        {"block": "*", "quantity": "rotation"},
        {"block": "heavy"},
    ]
    case = case_of(block=[heavy, light, floor], monitor=tables)
    monitors = Monitors(solver_request(case).monitors, assembly(case).model)
    assert [monitors.model.block_ids[i] for i in monitors.watched] == ["heavy", "light"]
    samples = np.zeros((1, 2, 3, 3))
    samples[0, :, 0, :2] = monitors.model.centroids[monitors.watched]
    samples[0, :, 0] += [[0.4, 0.8, 0.01], [0.8, -2.4, -0.02]]
    found = monitors.series(samples, np.zeros((1, 3, 2)))[0]
    assert found == pytest.approx([0.5, 0.5, 0.0025, np.hypot(0.4, 0.8)], rel=1e-14)


@pytest.mark.parametrize("dimension", [2, 3])
def test_supports_of_a_group_settle_as_one_rigid_body(case_of, dimension):
    """Distances between them stay, all along the way; their common centroid goes straight."""
    piers = [
        dict(LEFT, kind="column", block=[1.0, 0.5], courses=1, id=f"p{k}", origin=[3.0 * k, *[0.0] * (dimension - 1)])
        for k in range(3)
    ]
    for pier in piers:
        del pier["blocks_per_course"]
    turn = 20.0 if dimension == 2 else [0.0, 20.0, 0.0]
    way = [0.1, -0.2] if dimension == 2 else [0.1, 0.0, -0.2]
    table = {"block": "p?-base", "displacement": way, "rotation_deg": turn}
    case = case_of(dimension=dimension, structure=piers, settlement=[table], analysis={"kind": "settlement"})
    model = assembly(case).model
    movement, bases = SupportMovement(case, model), np.flatnonzero(model.fixed)
    assert movement.curved
    for share in (0.3, 1.0):
        motion = movement.at(share)
        moved = model.centroids[bases] + motion[bases, :dimension]
        assert moved.mean(axis=0) - model.centroids[bases].mean(axis=0) == pytest.approx(
            share * np.array(way), abs=1e-14
        )
        assert np.linalg.norm(np.diff(moved, axis=0), axis=1) == pytest.approx([3.0, 3.0], rel=1e-14)
        angle = share * np.radians(20.0)
        up = np.sin(angle) if dimension == 2 else -np.sin(angle)
        assert np.diff(moved, axis=0)[0] == pytest.approx(
            3.0 * np.array([np.cos(angle), *[0.0] * (dimension - 2), up]), abs=1e-14
        )
        assert not motion[~model.fixed].any()


def test_a_motion_moves_supports_by_alias_and_pattern(case_of):
    """An alias used to be accepted, and moved nothing."""
    pulse = {"kind": "pulse", "amplitude": 1.0, "frequency": 1.0}
    one = case_of(
        structure=[LEFT], motion=[{"blocks": ["base"], **pulse}], analysis={"kind": "time-history", "duration": 1.0}
    )
    both = case_of(
        structure=WALLS, motion=[{"blocks": ["right-*"], **pulse}], analysis={"kind": "time-history", "duration": 1.0}
    )
    assert GroundMotion(motions_of(one), assembly(one).model).base
    found = GroundMotion(motions_of(both), assembly(both).model)
    assert [assembly(both).model.block_ids[i] for i in found.moving] == ["right-base"]


def test_common_ground(case_of):
    """One block under both walls, which have no bases; a structure that keeps its own, and one that hangs."""
    case = case_of(structure=WALLS, ground={"margin": 0.5, "height": 0.25})
    model = assembly(case).model
    assert "left-base" not in model.numbers
    assert [model.block_ids[i] for i in np.flatnonzero(model.fixed)] == ["ground"]
    corners = (model.vertices + model.centroids[model.vertex_blocks])[model.vertex_blocks == model.numbers["ground"]]
    assert corners.min(axis=0).tolist() == [-0.5, -0.25]
    assert corners.max(axis=0).tolist() == [7.5, 0.0]
    kept = assembly(case_of(structure=[LEFT | {"base": True}], ground={"level": -0.5})).model
    assert {kept.block_ids[i] for i in np.flatnonzero(kept.fixed)} == {"left-base", "ground"}
    with pytest.raises(CaseError, match="block 'left-1-1' reaches down to 0"):
        assembly(case_of(structure=WALLS, ground={"level": 0.5}))


def test_ground_in_space(case_of):
    model = assembly(
        case_of(
            dimension=3,
            structure=[LEFT, RIGHT | {"rotation_deg": 90.0, "origin": [5.0, 0.0, 0.0]}],
            ground={"margin": 1.0},
        )
    ).model
    corners = (model.vertices + model.centroids[model.vertex_blocks])[model.vertex_blocks == model.numbers["ground"]]
    assert corners.min(axis=0)[:2] == pytest.approx([-1.0, -1.5])
    assert corners.max(axis=0) == pytest.approx([6.5, 3.0, 0.0], abs=1e-15)
