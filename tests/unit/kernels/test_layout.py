"""One memory layout everywhere: another one would compile every kernel a second time, without a word."""

from __future__ import annotations

import pytest
from casefiles import CASES
from engine import simulation

NAMES = ("wall_21", "sliding_block", "arch_21", "tilted_block")


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
@pytest.mark.parametrize("name", NAMES)
def test_arrays_are_contiguous(name, kinematics):
    sim = simulation(CASES / "verification" / f"{name}.toml", kinematics)
    for _ in range(2):
        for record in (sim.bodies, sim.shape, sim.joints, sim.geometry, sim.contacts, sim.loads):
            for field, array in zip(record._fields, record, strict=True):
                assert array.flags.c_contiguous, field
                assert array.dtype.name in ("float64", "int64", "int8"), field
        if kinematics == "large":
            sim.detect()
