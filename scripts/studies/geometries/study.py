"""Study of geometries: random structures of every generator, in fixed and in moving geometry."""

from __future__ import annotations

import argparse
from typing import Any

from studies.geometries import tables
from studies.geometries.measure import measure
from studies.geometries.structures import seeds
from studies.study import StudyRunner


class GeometryStudy(StudyRunner):
    """One section per seed."""

    parts = "SEED"

    def measure(self, section: str, options: argparse.Namespace) -> dict[str, Any]:
        return measure(int(section))

    def said(self, section: str, found: Any) -> str:
        return " | ".join(tables.cells(section, found))

    def problems(self, section: str, found: Any) -> list[str]:
        return [f"{section}: {text}" for text in tables.problems(found)]


STUDY = GeometryStudy(
    "geometries",
    "Random structures of every generator in fixed and in moving geometry, beside their bound",
    {str(seed): None for seed in seeds()},
    tables.values,
    machine=True,
)
