"""When a path has come to its plateau: early loads may rest and rise again, later the first rest counts."""

from __future__ import annotations

import pytest

from dem_cli.core.limit.path import is_plateau
from dem_cli.core.limit.settings import PathSettings

SETTINGS = PathSettings()


@pytest.mark.parametrize(
    ("since", "reached", "slope", "ended"),
    [
        (0.9, 1.2, 0.0, False),  # early, one increment, however flat
        (0.9, 1.7, 0.0, False),
        (0.9, 1.9, 0.9, True),  # it lasted until the displacement had doubled
        (2.0, 2.6, 0.4, True),  # later one flat increment is enough,
        (2.0, 2.6, 0.9, False),
        (2.0, 3.4, 0.9, True),  # or two that are nearly so
        (float("inf"), 50.0, 0.9, False),  # it still grows
    ],
)
def test_plateau(since, reached, slope, ended):
    assert is_plateau(SETTINGS, reached, since, slope) is ended
