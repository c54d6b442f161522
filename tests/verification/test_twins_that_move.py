"""Planar twins of what moves: prisms say what the plane says, far within what its cases allow to their references."""

from __future__ import annotations

import pytest
from studies.motion_in_space.tables import same
from studies.motion_in_space.twins import compared
from studies.places import CASES

# As a share of what the case allows; those that end on a threshold differ by round-off alone.
CLOSE = {
    "housner_ratio": 0.01,
    "rocking_free": 0.1,
    "rocking_rectangle": 0.01,
    "sliding_pulse": 0.01,
    "two_blocks_angles": 0.01,
    "vertical_vibration": 0.01,
    "settlement_two_blocks": 0.01,
    "settlement_portal": 0.01,
}


@pytest.mark.parametrize("name", CLOSE)
def test_a_prism_moves_as_its_polygon_does(name):
    found = compared(CASES / "verification" / f"{name}.toml")
    for row in found["quantities"]:
        assert same(row), row
        if isinstance(row["plane"], float):
            assert abs(row["space"] - row["plane"]) <= CLOSE[name] * row["allowed"], row


def test_energy_of_areas_that_change_is_no_work():
    """Features of flush faces change their names while a joint closes: that is no energy of re-weighting."""
    found = compared(CASES / "verification" / "two_blocks.toml")
    assert found["space"]["moved"] < 1e-5
    assert found["space"]["book"] < 1.2 * found["plane"]["book"]
