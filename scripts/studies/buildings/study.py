"""Study of buildings: cost of each stage from plan to report."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from studies.buildings import measure
from studies.study import StudyRunner
from studies.template import table

WHAT = {
    "generate": "blocks from the plan",
    "check": "`dem check`: read, generate, validate, estimate",
    "gravity": "`dem run`, gravity: to rest",
    "pushover": "`dem run`, pushover: gravity, bracket of 1 %, methods compared, files",
    "render": "`dem render`: a picture",
    "report": "`dem report`: one page",
}


class BuildingStudy(StudyRunner):
    """A house and a block of houses."""

    def said(self, section: str, found: Any) -> str:
        spent = ", ".join(f"{row['stage']} {row['seconds']:g} s" for row in found["stages"])
        return f"{section}: {found['blocks']} blocks: {spent}"

    def problems(self, section: str, found: Any) -> list[str]:
        return [] if found["status"] == "ok" else [f"{section}: {found['status']}"]


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """What page.md.j2 shows."""
    kept = {name: {**section, "table": stages(section)} for name, section in found.items() if name != "machine"}
    return {"house": None, "town": None} | kept


def stages(section: Mapping[str, Any]) -> str:
    """A table of what each stage took."""
    rows = [
        [WHAT[row["stage"]], f"{row['seconds']:.2f} s", "" if row["megabytes"] is None else f"{row['megabytes']} MB"]
        for row in section["stages"]
    ]
    return table(("stage", "CPU", "memory"), rows)


STUDY = BuildingStudy(
    "buildings", "Buildings from their plan", {"house": measure.house, "town": measure.town}, values, machine=True
)
