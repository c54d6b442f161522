"""Cases in 3D as tables, validated; peperino and one dry joint by default."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dem_cli.api import make_case_model
from dem_cli.case.reader import CaseSource, validate
from dem_cli.case.schema import Case


def spatial_case(**tables: Any) -> Case:
    """A case with dimension = 3."""
    given = {
        "dimension": 3,
        "materials": {"peperino": {"density": 2143.0}},
        "joints": {"dry": {"friction": 0.6}},
    }
    return validate(given | tables, make_case_model(), CaseSource(Path("case.toml"), ""))
