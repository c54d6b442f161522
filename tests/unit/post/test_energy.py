"""What an energy ledger is drawn against."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.results.post.energy import across


class Kept:
    """What a run left, as far as the ledger asks."""

    def __init__(self, kind, stage, displacement):
        self.kind = kind
        self.history = {"stage": np.array([stage] * 3), "displacement": displacement * np.arange(3.0)}


@pytest.mark.parametrize(
    ("kind", "stage", "column", "label"),
    [
        ("pushover", "collapse", "displacement", "largest displacement of a block [mm]"),
        ("settlement", "settlement", "displacement", "largest displacement of a block [mm]"),
        ("cycle", "loading", "step", "solver step"),
        ("time-history", "shaking", "time", "time [s]"),
    ],
)
def test_a_ledger_is_drawn_against_what_grows(kind, stage, column, label):
    found = across(Kept(kind, stage, 0.01))
    assert (found.column, found.label) == (column, label)
    assert found.factor == (1e3 if column == "displacement" else 1.0)
