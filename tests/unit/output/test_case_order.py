"""Blocks of results are in the order of the case, whatever the order in which solvers number them; the same blocks."""

from __future__ import annotations

import numpy as np
import pytest
import tomli_w
from engine import block, rectangle

import dem_cli
from dem_cli.app.api import build_model, load_case

NAMES = ["c-2", "c-1", "beam", "ground", "right", "left"]  # a column of its own, and blocks from the top down
SHAPES = {
    "beam": rectangle(-1.0, 1.0, 1.0, 1.4),
    "ground": rectangle(-4.0, -0.2, 6.0, 0.0),
    "right": rectangle(0.5, 0.0, 1.0, 1.0),
    "left": rectangle(-1.0, 0.0, -0.5, 1.0),
}


def case(dimension: int) -> dict:
    drawn = [block(name, SHAPES[name]) for name in NAMES[2:]]
    if dimension == 3:
        drawn = [{"id": name, "polygon": SHAPES[name], "y": [0.0, 1.0]} for name in NAMES[2:]]
    drawn[1]["fixed"] = True
    ends = [[-0.6, 0.5], [0.6, 0.5]] if dimension == 2 else [[-0.6, 0.5, 0.5], [0.6, 0.5, 0.5]]
    column = {"id": "c", "kind": "column", "block": [0.5, 0.5], "courses": 2, "base": False}
    column["origin"] = [3.0, 0.0] if dimension == 2 else [3.0, 0.5, 0.0]
    return {
        **({"dimension": 3} if dimension == 3 else {}),
        "materials": {"stone": {"density": 2000.0}},
        "joints": {"j": {"friction": 0.6}},
        "structure": [column],
        "block": drawn,
        "tie": [{"id": "t", "ends": ends, "stiffness": 1e6}],
        "analysis": {"kind": "gravity"},
    }


@pytest.mark.parametrize("dimension", [2, 3])
def test_results_have_blocks_in_the_order_of_the_case(tmp_path, dimension):
    (tmp_path / "case.toml").write_text(tomli_w.dumps(case(dimension)))
    solved = build_model(load_case(tmp_path / "case.toml"))
    with dem_cli.run(tmp_path / "case.toml", out=tmp_path / "out") as found:
        model, frame, joints = found.model, found.frames[-1], found.joints()
        contacts = found.contacts()
    assert sorted(model.block_ids) == sorted(solved.block_ids)
    assert model.block_ids != solved.block_ids  # solvers count from the lowest up
    assert list(model.block_ids[2:]) == NAMES[2:]
    assert set(model.block_ids[:2]) == {"c-1", "c-2"}
    for name, shape in SHAPES.items():
        k = model.block_ids.index(name)
        middle = np.mean(shape, axis=0)
        assert model.centroids[k, [0, -1]] == pytest.approx(middle)
        assert frame.positions[k, [0, -1]] == pytest.approx(middle, abs=1e-3)
        assert model.fixed[k] == (name == "ground")
    reaches = model.shapes.radii
    for a, b in joints["blocks"]:
        assert np.linalg.norm(model.centroids[a] - model.centroids[b]) < reaches[a] + reaches[b]
    pairs = {frozenset((model.block_ids[a], model.block_ids[b])) for a, b in joints["blocks"]}
    touching = [("ground", "left"), ("ground", "right"), ("left", "beam"), ("right", "beam"), ("c-1", "c-2")]
    assert {frozenset(pair) for pair in touching} <= pairs
    held = np.zeros(len(NAMES))  # what contacts press up on each block, less what they press down, is its weight
    for (a, b), force in zip(contacts["blocks"], contacts["force"]):
        held[a] -= force[-1]
        held[b] += force[-1]
    free = ~model.fixed
    assert held[free] == pytest.approx(9.81 * model.masses[free], rel=0.01)
    assert {tuple(model.block_ids[k] for k in frame.links.places.blocks)} == {("left", "right")}
