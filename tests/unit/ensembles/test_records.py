"""Records of a fragility analysis: motions by themselves, and components of one event that are scaled together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from synthetic.spatial_case import spatial_case

from dem_cli.analyses.ensembles.record_search import records_of, scaled
from dem_cli.case.schema import Case
from dem_cli.errors import CaseError

WALL = {"kind": "wall", "block": [1.0, 0.5], "courses": 2, "blocks_per_course": 2}


def fragility(*motions: dict[str, Any]) -> Case:
    """A case in space with these motions."""
    analysis = {"kind": "fragility", "intensities": [1.0, 2.0], "unit_acceleration": 2.0}
    return spatial_case(structure=[WALL], analysis=analysis, motion=list(motions))


def pulse(amplitude: float, direction: list[float], **more) -> dict[str, Any]:
    return {"kind": "pulse", "amplitude": amplitude, "frequency": 2.0, "direction": direction, **more}


def test_components_of_one_event_are_scaled_together():
    case = fragility(
        pulse(3.0, [1.0, 0.0, 0.0], event="kobe"),
        pulse(1.0, [0.0, 1.0, 0.0]),
        pulse(6.0, [0.0, 2.0, 0.0], event="kobe"),
        pulse(1.5, [0.0, 0.0, 1.0], event="kobe", start=0.1),
    )
    kobe, alone = records_of(case)
    assert (kobe.name, kobe.peak, len(kobe.components)) == ("kobe", 6.0, 3)
    assert (alone.name, alone.peak) == ("sine", 1.0)
    components = scaled(kobe, 1.5, case.analysis)
    assert [motion.peak for motion in components] == pytest.approx([1.5, 3.0, 0.75])
    assert np.array([motion.direction for motion in components]) == pytest.approx(np.eye(3))
    assert [motion.peak for motion in scaled(alone, 1.5, case.analysis)] == pytest.approx([3.0])


def test_suites_of_one_event_go_record_by_record():
    made = {"kind": "artificial", "spectrum": "EC8-1", "soil": "B", "ag": 1.0, "event": "suite"}
    case = fragility(made | {"count": 2}, made | {"count": 2, "direction": [0.0, 1.0, 0.0]})
    records = records_of(case)
    assert [record.name for record in records] == ["suite 1", "suite 2"]
    assert [len(record.components) for record in records] == [2, 2]
    uneven = fragility(made | {"count": 2}, pulse(1.0, [0.0, 0.0, 1.0], event="suite"))
    with pytest.raises(CaseError, match=r"'suite' has 2 record\(s\) in motion.0 and 1 here"):
        records_of(uneven)
