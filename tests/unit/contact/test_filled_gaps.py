"""Gaps of the start in which another block lies are none; where it fills only a part of one, it stays."""

from __future__ import annotations

import time

import numpy as np
import pytest
from synthetic import boxes_model
from synthetic.spatial_case import spatial_case

from dem_cli.core.contact.gaps import gaps_of_start
from dem_cli.core.model.places import block_at, inside_blocks, undeformed
from dem_cli.masonry.assembly.assemble import assemble

WIDTH = 0.03


def planar(height: float):
    return boxes_model(
        [(0.0, -0.5, 3.0, 0.5, True), (0.0, 0.0, 1.0, 1.0, False), (1.0 + WIDTH, 0.0, 1.0, 1.0, False),
         (1.0, 0.0, WIDTH, height, False)]
    )  # fmt: skip


def spatial(height: float):
    def box(name, x0, x1, z0, z1, **keys):
        return {"id": name, "polygon": [[x0, z0], [x1, z0], [x1, z1], [x0, z1]], "y": [0.0, 1.0]} | keys

    return assemble(
        spatial_case(
            block=[
                box("base", 0.0, 3.0, -0.5, 0.0, fixed=True),
                box("a", 0.0, 1.0, 0.0, 1.0),
                box("b", 1.0 + WIDTH, 2.0, 0.0, 1.0),
                box("c", 1.0, 1.0 + WIDTH, 0.0, height),
            ]
        )
    )


@pytest.mark.parametrize("model_of", [planar, spatial])
def test_a_block_that_fills_a_gap_closes_it(model_of):
    assert len(gaps_of_start(model_of(1.0)).widths) == 0
    for height in (0.05, 0.5, 0.9):
        found = gaps_of_start(model_of(height))
        assert found.widths == pytest.approx([WIDTH])
        assert not found.close.any()


def test_thousands_of_gaps_take_no_time_by_their_square():
    """Thin slabs: each sees many others, within a share of its length, behind its neighbours. It was 31 s."""
    slabs = [(0.0, -1.0, 4.0, 1.0, True), *((0.0, 0.01 * k, 4.0, 0.01, False) for k in range(150))]
    began = time.process_time()
    assert len(gaps_of_start(boxes_model(slabs)).widths) == 0
    assert time.process_time() - began < 3.0


@pytest.mark.parametrize("model_of", [planar, spatial])
def test_many_points_are_found_as_one_by_one(model_of):
    model = model_of(0.5)
    corners = undeformed(model)
    numbers = np.random.default_rng(5)
    anywhere = numbers.uniform(corners.min(axis=0), corners.max(axis=0), (200, model.dimension))
    points = np.concatenate([anywhere, corners, 0.5 * (corners[1:] + corners[:-1]), corners + 1e-6])
    found = inside_blocks(model, points)
    assert found.tolist() == [block_at(model, point) is not None for point in points]
    assert 0 < found.sum() < len(found)
