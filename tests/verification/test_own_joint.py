"""The yardstick of docs/chapter7.md, the thesis's own joint, against what rigid blocks must do. Nothing of dem_cli."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracle import microrotation_walls as walls
from oracle import rolling_polygons as statics
from oracle.microrotation import Rule

ANGLE = 1.0 / 60.0  # between two sides of the single block's polygon


def swept(name, pivot, **changes):
    structure = walls.structures()[name]._replace(**changes)
    rows = list(walls.sweep(structure, Rule(structure.friction, pivot == "end", 1.0), walls.Patience()))
    assert rows[-1].state == "failed"
    assert {row.state for row in rows[:-1]} == {"rest"}
    return rows


@pytest.mark.parametrize("pivot", ["end", "vertex"])
def test_single_block(pivot):
    """Table 7-1: turns where the resultant passes 0.1 m and 0.3 m from the middle, then over its corner."""
    rows = swept("block", pivot, start=0.1, step=0.005)
    first, second = ([row.load for row in rows[:-1] if row.turns] + [0.0, 0.0])[:2]
    assert sum(row.turns for row in rows[:-1]) == 2
    assert 0.2 <= first <= 0.2 + 2 * 0.005
    # shear acts at the nodes, one of them lower by the turn so far: the arm is known within that
    low, high = ((0.3 - 0.5 * ANGLE) / (0.5 - 0.5 * ANGLE + lower * ANGLE) for lower in (1.0, 0.0))
    assert low < second < high + 2 * 0.005
    over = math.tan(math.pi / 4 - 2 * ANGLE)
    assert rows[-2].load - 0.005 < over < rows[-1].load + 0.005
    assert next(row.top for row in rows if row.load == first) == pytest.approx(0.5 * ANGLE, rel=0.02)


def test_the_pivot_lets_a_block_sink_or_not():
    """About the far node the centroid sinks by half the width times the turn; about the vertex it rises."""
    assert swept("block", "end", start=0.1, step=0.1)[2].sinks == pytest.approx(-0.5 * ANGLE, rel=0.02)
    assert swept("block", "vertex", start=0.1, step=0.1)[2].sinks > -1e-4


@pytest.mark.parametrize("pivot", ["end", "vertex"])
def test_column_of_14_blocks(pivot):
    """A column fails near where statics of rolling lets it, wherever its blocks turn about; thesis: 0.13, 10.5 mm."""
    rows = swept("column_14", pivot, start=0.12, step=0.001)
    made = statics.column(14, 0.0175, (0.016, 0.008, 0.016), 1e-4)
    assert sum([rows[-2].load, rows[-1].load]) / 2 == pytest.approx(statics.raised(made)[-1].ends, rel=0.01)
    assert rows[-2].top == pytest.approx(10.5e-3, rel=0.03)


def test_polygon():
    """7.3.1: 16, 8 and 16 mm, 0.1 mm deep, turn by 0.00625; on half a block by twice that, or cut short."""
    for scaled, places, angle in ((True, (0, 8, 12, 20), 0.0125), (False, (0, 6, 14, 20), 0.00625)):
        vertex, turns = walls.polygon((0.016, 0.008, 0.016), 1e-4, 0.02, scaled)
        assert np.allclose(1e3 * vertex, places)
        assert np.allclose(turns, (-angle, 0.0, angle))


def test_joints_of_the_walls():
    """Blocks of the thesis; of 21, 6 bed joints of half a block per course, and head joints between neighbours."""
    for name, blocks in (("t21", 21), ("t110", 110), ("t231", 231)):
        boxes = np.array(walls.structures()[name].boxes)
        assert (boxes[:, 1] > -1e-9).sum() == blocks
    pairs = walls.touching(np.array(walls.structures()["t21"].boxes))
    assert sum(not head for _, _, head, _ in pairs) == 6 * 6
    assert sum(head for _, _, head, _ in pairs) == 3 * 3 + 3 * 2
