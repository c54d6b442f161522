"""One memory layout everywhere: another one would compile every kernel a second time, without a word."""

from __future__ import annotations

import pytest
from casefiles import CASES
from engine import simulation

from dem_cli.core.kernels.tiles.joint_tiles import JointTiles

NAMES = ("wall_21", "sliding_block", "arch_21", "tilted_block")


def arrays_of(record):
    """Name and array of every field, those of records inside it too."""
    for field, value in zip(record._fields, record, strict=True):
        yield from arrays_of(value) if isinstance(value, tuple) else ((field, value),)


@pytest.mark.parametrize("kinematics", ["fixed", "large"])
@pytest.mark.parametrize("name", NAMES)
def test_arrays_are_contiguous(name, kinematics):
    sim = simulation(CASES / "verification" / f"{name}.toml", kinematics)
    for _ in range(2):
        for record in (sim.bodies, sim.shape, sim.joints, sim.geometry, sim.contacts, sim.loads):
            for field, array in arrays_of(record):
                assert array.flags.c_contiguous, field
                narrow = ("int32", "uint32", "uint64") if field in JointTiles._fields else ("int8",)
                assert array.dtype.name in ("float64", "int64", *narrow), field
        if kinematics == "large":
            sim.detect()
