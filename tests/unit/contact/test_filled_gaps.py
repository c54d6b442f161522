"""Gaps of the start in which another block lies are none; where it fills only a part of one, it stays."""

from __future__ import annotations

import pytest
from synthetic import boxes_model
from synthetic.spatial_case import spatial_case

from dem_cli.assembly.assemble import assemble
from dem_cli.contact.gaps import gaps_of_start

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
