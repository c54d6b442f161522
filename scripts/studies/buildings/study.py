"""Study of buildings: cost of each stage from plan to report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from studies.buildings import measure
from studies.study import StudyRunner
from studies.template import bracket, table

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
        if section == "bonds":
            return "\n".join(f"{row['bond']}: {row['failure_load_bracket']}" for row in found)
        spent = ", ".join(f"{row['stage']} {row['seconds']:g} s" for row in found["stages"])
        return f"{section}: {found['blocks']} blocks: {spent}"

    def problems(self, section: str, found: Any) -> list[str]:
        if section == "bonds":
            return [f"{row['bond']}: {row['status']}" for row in found if row["failure_load_bracket"] is None]
        return [] if found["status"] == "ok" else [f"{section}: {found['status']}"]


def values(found: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that page.md.j2 shows."""
    costs = {name: {**found[name], "table": stages(found[name])} for name in ("house", "town") if name in found}
    return {"house": None, "town": None, "bonds": bonds(found.get("bonds", []))} | costs


def bonds(rows: Sequence[Mapping[str, Any]]) -> str:
    """A table of the failure load in each bond."""
    shown = [
        [
            row["bond"],
            str(row["blocks"]),
            "stands" if row["status"] == "ok" else row["status"],
            bracket(row["failure_load_bracket"]) if row["failure_load_bracket"] else "–",
            row["failure_mode"] or "–",
            f"{row['seconds']:.1f} s",
        ]
        for row in rows
    ]
    head = ("bond", "blocks", "under its weight", "at least, not above", "mode", "CPU")
    return table(head, shown) if shown else ""


def stages(section: Mapping[str, Any]) -> str:
    """A table of what each stage took."""
    rows = [
        [WHAT[row["stage"]], f"{row['seconds']:.2f} s", "" if row["megabytes"] is None else f"{row['megabytes']} MB"]
        for row in section["stages"]
    ]
    return table(("stage", "CPU", "memory"), rows)


SECTIONS = {"house": measure.house, "town": measure.town, "bonds": measure.bonds}
STUDY = BuildingStudy("buildings", "Buildings from their plan", SECTIONS, values, machine=True)
