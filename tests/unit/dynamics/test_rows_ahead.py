"""Ground motion worked out ahead: the same bits wherever a stretch begins, and few calls."""

from __future__ import annotations

import numpy as np

from dem_cli.core.dynamics.ground import AHEAD, RowsAhead

STEP = 1e-3 / 3.0


def test_rows_are_those_asked_for():
    calls = []

    def rows(first: int, n: int) -> tuple[np.ndarray, np.ndarray]:
        calls.append((first, n))
        times = STEP * (first + np.arange(n))
        return times, np.sin(times)[:, np.newaxis]

    table, first = RowsAhead(rows), 0
    for n in (5, 5, 5, 3, 400, 1, 0):
        times, values = table.stretch(first, n)
        assert (times == STEP * (first + np.arange(n))).all()
        assert values.tobytes() == np.sin(STEP * (first + np.arange(n)))[:, np.newaxis].tobytes()
        first += n
    assert calls == [(0, 5 * AHEAD), (18, 400 * AHEAD)]
    assert (table.stretch(2, 3)[0] == STEP * np.arange(2, 5)).all()  # back again
