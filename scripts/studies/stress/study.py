"""Study of stability: structures with known failure loads, and figures with limits, along axes that break programs.

Every stress is one record (records.py). WRONG is an answer of status ok, without a warning, outside its bracket and
0.5 %; exit code 1 after any.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from studies import measured, storage
from studies.stress import invariance, proportions, shaking, steady_state, stiffness, tables
from studies.stress.random_structures import page as random_structures
from studies.stress.verdicts import WRONG, StressRecord
from studies.study import StudyRunner
from studies.template import filled

AXES = {
    "stiffness": stiffness.joint_stiffness,
    "shear": stiffness.shear_stiffness,
    "stiffness-ratio": stiffness.stiffness_ratio,
    "thesis": stiffness.thesis,
    "mass": proportions.mass_ratios,
    "size": proportions.size_ratios,
    "slender": proportions.slender,
    "sliver": proportions.slivers,
    "gaps": proportions.gaps,
    "numbering": invariance.numbering,
    "place": invariance.place,
    "symmetry": invariance.symmetry,
    "units": invariance.units,
    "far": invariance.far,
    "rest": steady_state.rest,
    "time-step": steady_state.time_step,
    "past-limit": steady_state.past_the_limit,
    "work": steady_state.work_identity,
    "state": steady_state.state_closure,
    "bytes": invariance.same_bytes,
    "shaking": shaking.shaken,
}


class StressStudy(StudyRunner):
    """One section per axis: its records."""

    parts, solves = "AXIS", False

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--short", action="store_true", help="few values on small structures, below half a minute")
        parser.add_argument("--json", type=Path, help="keep every record in this file")
        parser.add_argument("--verbose", action="store_true", help="print every record")

    def check(self, options: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
        super().check(options, parser)
        missing = set(self.sections) - set(storage.read(self.name)) - set(options.chosen or self.sections)
        if options.write and (missing or options.short):
            parser.error("--write needs all axes in full: no short form, no axis of which nothing is kept")
        if options.redraw and missing - set(options.chosen):
            parser.error("nothing is kept to be drawn again")
        if options.json:
            options.json.write_text("[]\n", encoding="utf-8")

    def measure(self, section: str, options: argparse.Namespace) -> list[dict[str, Any]]:
        begun, found = time.process_time(), []
        for record in self.sections[section](options.short):
            found.append(record)
            if options.verbose or record.verdict == WRONG:
                print(f"  {tables.line(record)}", flush=True)
        print(f"{section}: {time.process_time() - begun:.0f} s", flush=True)
        rows = list(map(asdict, found))
        if options.json:
            before = json.loads(options.json.read_text(encoding="utf-8"))
            options.json.write_text(storage.text_of(before + rows) + "\n", encoding="utf-8")
        return rows

    def said(self, section: str, found: Any) -> str:
        return f"{section}: {tables.count(records_of(found))}"

    def problems(self, section: str, found: Any) -> list[str]:
        return [tables.line(record) for record in records_of(found) if record.verdict == WRONG]

    def write(self, found: Mapping[str, Any]) -> None:
        table = storage.read(self.name) | dict(found)
        storage.write(self.name, {name: table[name] for name in self.sections if name in table})
        measured.note(self.name, found)
        if set(table) == set(self.sections):
            self.draw(found)

    def text(self, table: Mapping[str, Any]) -> str:
        records = {name: records_of(rows) for name, rows in table.items()}
        said = {name: (axis.__doc__ or "").strip() for name, axis in self.sections.items()}
        about = {one.axis: said[name] for name, found in records.items() for one in found}
        every = [record for found in records.values() for record in found]
        return filled("stress/page.md.j2", **tables.values(every, about)) + random_structures.section()


def records_of(rows: Any) -> list[StressRecord]:
    """Records from JSON."""
    return [StressRecord(**row) for row in rows]


STUDY = StressStudy("stress", "The stability stress test: what held and how exactly, what was refused", AXES)
