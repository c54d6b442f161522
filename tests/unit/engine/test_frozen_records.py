"""Frozen records are what frozen dataclasses of the standard library are."""

from __future__ import annotations

import dataclasses
import pickle

import pytest

from dem_cli import frozen_records
from dem_cli.core.engine.settings import DEFAULT, Settings


def record(dataclass):
    class Record:
        width: float
        names: list[str] = dataclasses.field(default_factory=list)
        count: int = 3

    return dataclass(frozen=True)(Record)


OURS, THEIRS = record(frozen_records.dataclass), record(dataclasses.dataclass)


def test_values_as_in_a_dataclass():
    ours, theirs = OURS(1.0, count=4), THEIRS(1.0, count=4)
    assert repr(ours) == repr(theirs)
    assert dataclasses.asdict(ours) == dataclasses.asdict(theirs) == {"width": 1.0, "names": [], "count": 4}
    assert ours == OURS(1.0, [], 4) != dataclasses.replace(ours, count=5)
    assert ours != theirs
    assert OURS(1.0).names is not OURS(1.0).names


@pytest.mark.parametrize("given", [((), {}), ((1.0,), {"width": 2.0}), ((1.0,), {"height": 2.0}), ((1, [], 2, 3), {})])
def test_values_that_do_not_fit(given):
    for of in (OURS, THEIRS):
        with pytest.raises(TypeError):
            of(*given[0], **given[1])


def test_nobody_changes_settings():
    with pytest.raises(dataclasses.FrozenInstanceError):
        DEFAULT.load_search.jump = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        del DEFAULT.load_search
    assert hash(Settings()) == hash(DEFAULT)
    assert pickle.loads(pickle.dumps(DEFAULT)) == DEFAULT
