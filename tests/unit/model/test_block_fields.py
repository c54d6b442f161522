"""A copy of a block with other fields is that of `dataclasses.replace`."""

from dataclasses import fields, replace

import numpy as np

from dem_cli.core.model.blocks import Block

BLOCK = Block("wall-1-1", (np.zeros((3, 2)),), "stone", 0.5, course=1, path=("structure", 0), rank=7)


def test_other_fields_and_no_more():
    other = {"id": "wall-1-2", "rank": 8, "path": ("structure", 1)}
    copied, expected = BLOCK.with_fields(**other), replace(BLOCK, **other)
    assert [getattr(copied, each.name) for each in fields(Block)] == [
        getattr(expected, each.name) for each in fields(Block)
    ]
    assert (BLOCK.id, BLOCK.rank) == ("wall-1-1", 7)
