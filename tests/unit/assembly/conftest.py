"""Cases as dictionaries."""

from __future__ import annotations

from pathlib import Path

import pytest

from dem_cli.app.api import make_case_model
from dem_cli.case.reader import CaseSource, validate


@pytest.fixture
def case_of():
    """A function from the tables of a case to the validated case; peperino and one dry joint by default."""

    def build(**tables):
        given = {
            "materials": {"peperino": {"density": 2143.0}},
            "joints": {"dry": {"friction": 0.6}},
        } | tables
        return validate(given, make_case_model(), CaseSource(Path("case.toml"), ""))

    return build


@pytest.fixture
def wall():
    """The table of the thesis's 21-block wall."""
    return {"kind": "wall", "block": [0.04, 0.0175], "courses": 6, "blocks_per_course": 3, "thickness": 0.08}
